#include "formats/formats.h"

namespace spherical_param::tools {

const std::vector<FormatRow> format_table = {
    {".pcd", readPcd, writePcd, nullptr},       {".ply", readPly, writePly, writePly},
    {".obj", readObj, writeObj, writeObj},      {".vtk", nullptr, writeVtk, writeVtk},
    {".xyz", readText, writeXyz, nullptr},      {".txt", readText, writeXyz, nullptr},
    {".csv", readText, nullptr, nullptr},       {".asc", readText, nullptr, nullptr},
    {".pts", readText, nullptr, nullptr},       {".xyzn", readText, nullptr, nullptr},
    {".xyzrgb", readText, nullptr, nullptr},    {".stl", readStl, nullptr, writeStl, true, false},
    {".glb", nullptr, nullptr, writeGlb, true}, {".off", readOff, nullptr, writeOff},
    {".agr", readGrid, nullptr, nullptr},
};

}  // namespace spherical_param::tools
