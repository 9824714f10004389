#include "formats/formats.h"

namespace spherical_param::tools {

const std::vector<FormatRow> format_table = {
    {".pcd", readPcd, writePcd, nullptr},  {".ply", readPly, writePly, writePly},
    {".obj", readObj, writeObj, writeObj}, {".vtk", nullptr, writeVtk, writeVtk},
    {".xyz", readXyz, writeXyz, nullptr},  {".txt", readXyz, writeXyz, nullptr},
    {".stl", nullptr, nullptr, writeStl},  {".off", nullptr, nullptr, writeOff},
};

}  // namespace spherical_param::tools
