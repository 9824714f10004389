// What users do wrong, row by row: each must end with the right exit code, one line of cause and
// one of remedy, and leave the directory as it was.

#include "tool_runner.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

namespace {

using tool_test::run;
using tool_test::RunOptions;
using tool_test::RunResult;
using tool_test::TemporaryDirectory;

const std::string mesh_tool = RECONSTRUCTION_TOOL;
const std::string scan_tool = SCAN_TOOL;

enum class Kind { File, Directory, Pipe, Link };

/// Something in the directory before the tool runs.
struct Entry {
  std::string name;
  std::string content = "";  ///< of a link: where it leads to
  Kind kind = Kind::File;
  mode_t mode = 0644;
};

struct Row {
  std::string name;
  std::string tool;
  std::vector<Entry> entries;
  std::vector<std::string> arguments;
  int exit_code;
  std::string cause;  ///< part of the first line on the standard error
  bool unprivileged = false;
  std::size_t file_size_limit = 0;
  std::string standard_output = "";
};

void PrintTo(const Row& row, std::ostream* stream) {
  *stream << row.name;
}

void create(const TemporaryDirectory& directory, const Entry& entry) {
  const std::string path = directory.file(entry.name);
  switch (entry.kind) {
  case Kind::File:
    tool_test::writeFile(path, entry.content);
    break;
  case Kind::Directory:
    ASSERT_EQ(mkdir(path.c_str(), 0755), 0);
    break;
  case Kind::Pipe:
    ASSERT_EQ(mkfifo(path.c_str(), 0644), 0);
    return;
  case Kind::Link:
    ASSERT_EQ(symlink(entry.content.c_str(), path.c_str()), 0);
    return;
  }
  ASSERT_EQ(chmod(path.c_str(), entry.mode), 0);
}

/// The vertices of an octahedron and of a cube, as lines of text.
std::string goodPoints() {
  return "1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n"
         ".5 .5 .5\n-.5 .5 .5\n.5 -.5 .5\n-.5 -.5 .5\n.5 .5 -.5\n-.5 .5 -.5\n.5 -.5 -.5\n"
         "-.5 -.5 -.5\n";
}

const Entry good = {"good.xyz", goodPoints()};

/// So many points that meshes of them exceed a limit of size that leaves room for the files that
/// OpenMP makes for itself.
std::string manyPoints() {
  constexpr int count = 500;
  std::ostringstream text;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.399963229728653 * i;
    text << radius * std::cos(angle) << " " << radius * std::sin(angle) << " " << z << "\n";
  }
  return text.str();
}

const Entry large = {"large.xyz", manyPoints()};
constexpr std::size_t small_disk = 4000;    ///< bytes; too small for any mesh of `large`
constexpr std::size_t medium_disk = 30000;  ///< bytes; enough for a binary PLY mesh of `large`

std::string pcd(const std::string& fields, const std::string& size, const std::string& type,
                const std::string& count, const std::string& width, const std::string& height,
                const std::string& points, const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " + type +
         "\nCOUNT " + count + "\nWIDTH " + width + "\nHEIGHT " + height +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA " + data;
}

std::string xyzPcd(const std::string& points, const std::string& data) {
  return pcd("x y z", "4 4 4", "F F F", "1 1 1", points, "1", points, data);
}

std::string ply(const std::string& format, const std::string& elements, const std::string& data) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n" + data;
}

std::string vertices(const std::string& count, const std::string& properties) {
  return "element vertex " + count + "\n" + properties;
}

const std::string xyz_properties = "property float x\nproperty float y\nproperty float z\n";

std::string vtk(const std::string& rest) {
  return "# vtk DataFile Version 3.0\ntitle\n" + rest;
}

/// A file of the given content is read and refused.
Row content(const std::string& name, const std::string& file, const std::string& text,
            const std::string& cause) {
  return {name, mesh_tool, {{file, text}}, {file, "out.ply"}, 1, cause};
}

/// The arguments are refused, with a good input file at hand.
Row usage(const std::string& name, const std::vector<std::string>& arguments,
          const std::string& cause) {
  return {name, mesh_tool, {good}, arguments, 2, cause};
}

/// An option with its value is refused.
Row option(const std::string& name, const std::string& option_name, const std::string& value) {
  return {name,   mesh_tool,
          {good}, {"good.xyz", "out.ply", option_name, value},
          2,      "option " + option_name + ": '" + value + "'"};
}

/// An option is refused because it would do nothing with another.
Row idle(const std::string& name, const std::vector<std::string>& options,
         const std::string& other) {
  std::vector<std::string> arguments = {"good.xyz", "out.ply"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return usage(name, arguments, " does nothing with " + other);
}

Row scanUsage(const std::string& name, const std::vector<std::string>& arguments,
              const std::string& cause) {
  return {name, scan_tool, {}, arguments, 2, cause};
}

std::vector<Row> inputFiles() {
  const std::string nan_points = "nan nan nan\nnan 0 0\n0 nan 0\ninf 1 1\n-inf 1 2\n";
  const std::string plane = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n";
  const std::string bytes24(24, '\1');
  return {
      {"MissingFile", mesh_tool, {}, {"no.pcd", "out.ply"}, 1, "No such file"},
      {"MissingDirectoryOfInput", mesh_tool, {}, {"no/no.pcd", "out.ply"}, 1, "No such file"},
      {"InputBehindAFile", mesh_tool, {good}, {"good.xyz/a.pcd", "out.ply"}, 1, "Not a directory"},
      {"DanglingLink",
       mesh_tool,
       {{"in.ply", "nowhere.ply", Kind::Link}},
       {"in.ply", "out.ply"},
       1,
       "No such file"},
      {"DirectoryAsInput",
       mesh_tool,
       {{"in.ply", "", Kind::Directory, 0755}},
       {"in.ply", "out.ply"},
       1,
       "is a directory"},
      {"PipeAsInput",
       mesh_tool,
       {{"in.ply", "", Kind::Pipe}},
       {"in.ply", "out.ply"},
       1,
       "not a regular file"},
      {"UnreadableInput",
       mesh_tool,
       {{"in.xyz", goodPoints(), Kind::File, 0000}},
       {"in.xyz", "out.ply"},
       1,
       "Permission denied",
       true},
      content("EmptyPcd", "in.pcd", "", "is empty"),
      content("EmptyPly", "in.ply", "", "is empty"),
      content("EmptyObj", "in.obj", "", "is empty"),
      content("EmptyVtk", "in.vtk", "", "is empty"),
      content("EmptyXyz", "in.xyz", "", "is empty"),

      content("PcdOfText", "in.pcd", goodPoints(), "unknown entry"),
      content("PcdOfZeros", "in.pcd", std::string(5000, '\0'), "unknown entry"),
      content("PcdHeaderCut", "in.pcd", "VERSION 0.7\nFIELDS x y z\n", "no PCD header"),
      content("PcdWithoutXyz", "in.pcd",
              pcd("a b c", "4 4 4", "F F F", "1 1 1", "4", "1", "4", "ascii\n1 2 3\n"),
              "no fields x, y and z"),
      content("PcdOfWholeNumbers", "in.pcd",
              pcd("x y z", "4 4 4", "I I I", "1 1 1", "4", "1", "4", "ascii\n1 2 3\n"),
              "does not hold one number"),
      content("PcdUnknownType", "in.pcd",
              pcd("x y z", "4 4 4", "F F Q", "1 1 1", "4", "1", "4", "ascii\n1 2 3\n"),
              "unknown type"),
      content("PcdSizeOfThree", "in.pcd",
              pcd("x y z", "4 4 3", "F F F", "1 1 1", "4", "1", "4", "ascii\n1 2 3\n"),
              "unknown type"),
      content("PcdSizesMissing", "in.pcd",
              pcd("x y z", "4 4", "F F F", "1 1 1", "4", "1", "4", "ascii\n1 2 3\n"),
              "differ in length"),
      content("PcdHugeCount", "in.pcd",
              pcd("x y z a", "4 4 4 4", "F F F F", "1 1 1 1000000000", "4", "1", "4",
                  "binary\n" + bytes24),
              "shorter than its header"),
      content("PcdNegativeCount", "in.pcd",
              pcd("x y z a", "4 4 4 4", "F F F F", "1 1 1 -1", "4", "1", "4", "binary\n" + bytes24),
              "values in a field"),
      content("PcdHugePointsAscii", "in.pcd", xyzPcd("1000000000", "ascii\n1 2 3\n"),
              "shorter than its header"),
      content("PcdHugePointsBinary", "in.pcd", xyzPcd("1000000000", "binary\n" + bytes24),
              "shorter than its header"),
      content("PcdHugePointsCompressed", "in.pcd",
              xyzPcd("1000000000", "binary_compressed\n" + bytes24), "shorter than its header"),
      content("PcdPointsBeyondAllIntegers", "in.pcd",
              xyzPcd("99999999999999999999", "binary\n" + bytes24), "number of points"),
      content("PcdNegativePoints", "in.pcd", xyzPcd("-5", "ascii\n1 2 3\n"), "number of points"),
      content("PcdPointsOfLetters", "in.pcd", xyzPcd("many", "ascii\n1 2 3\n"), "number of points"),
      content("PcdNoPoints", "in.pcd", xyzPcd("0", "ascii\n"), "no points"),
      content("PcdWidthTimesHeight", "in.pcd",
              pcd("x y z", "4 4 4", "F F F", "1 1 1", "3", "3", "4", "ascii\n1 2 3\n"),
              "WIDTH times HEIGHT"),
      content("PcdUnknownStorage", "in.pcd", xyzPcd("4", "zip\n1 2 3\n"), "stored as 'zip'"),
      content("PcdBinaryCut", "in.pcd", xyzPcd("4", "binary\n" + bytes24),
              "shorter than its header"),
      content("PcdAsciiCut", "in.pcd", xyzPcd("5", "ascii\n1.00 2.00 3.00\n4.000 5.000 6.000\n"),
              "fewer points"),
      content("PcdAsciiShortLine", "in.pcd", xyzPcd("4", "ascii\n1 2 3\n4 5\n6 7 8\n9 10 11\n"),
              "line 13 "),
      content("PcdAsciiLetters", "in.pcd", xyzPcd("4", "ascii\na b c\nd e f\ng h i\nj k l\n"),
              "line 12 "),
      content("PcdCompressedRubbish", "in.pcd",
              xyzPcd("2", std::string("binary_compressed\n\x08\0\0\0\x18\0\0\0rubbish!", 34)), ""),
      content("PcdCompressedWrongSize", "in.pcd",
              xyzPcd("4", std::string("binary_compressed\n\x08\0\0\0\xff\xff\0\0rubbish!", 34)),
              "compressed data"),

      content("PlyOfText", "in.ply", goodPoints(), "does not begin as a PLY"),
      content("PlyHeaderCut", "in.ply", "ply\nformat ascii 1.0\nelement vertex 4\n", "no end"),
      content("PlyUnknownFormat", "in.ply",
              ply("hexadecimal", vertices("4", xyz_properties), goodPoints()), "neither ascii"),
      content("PlyWithoutFormat", "in.ply",
              "ply\n" + vertices("4", xyz_properties) + "end_header\n" + goodPoints(),
              "neither ascii"),
      content("PlyWithoutVertices", "in.ply", ply("ascii", "", goodPoints()), "no vertices"),
      content("PlyWithoutXyz", "in.ply",
              ply("ascii", vertices("4", "property float a\n"), goodPoints()), "no x, y and z"),
      content("PlyTwiceX", "in.ply",
              ply("ascii", vertices("4", xyz_properties + "property float x\n"), goodPoints()),
              "twice"),
      content("PlyOfWholeNumbers", "in.ply",
              ply("ascii", vertices("4", "property int x\nproperty int y\nproperty int z\n"),
                  goodPoints()),
              "whole numbers"),
      content("PlyUnknownType", "in.ply",
              ply("ascii", vertices("4", "property quad x\n"), goodPoints()), "unknown type"),
      content("PlyBrokenProperty", "in.ply",
              ply("ascii", vertices("4", "property x\n"), goodPoints()), "broken property"),
      content("PlyUnknownEntry", "in.ply",
              ply("ascii", "elements vertex 4\n" + xyz_properties, goodPoints()), "unknown entry"),
      content(
          "PlyListInVertex", "in.ply",
          ply("ascii", vertices("4", xyz_properties + "property list uchar int a\n"), goodPoints()),
          "the list 'a'"),
      content("PlyColorsOutOfOrder", "in.ply",
              ply("ascii",
                  vertices("4", xyz_properties +
                                    "property uchar blue\nproperty uchar green\nproperty uchar "
                                    "red\n"),
                  goodPoints()),
              "one after the other"),
      content("PlyAlphaAlone", "in.ply",
              ply("ascii", vertices("4", xyz_properties + "property uchar alpha\n"), goodPoints()),
              "alpha"),
      content("PlyRangeGrid", "in.ply",
              ply("ascii",
                  vertices("4", xyz_properties) +
                      "element range_grid 5\nproperty list uchar int vertex_indices\n",
                  goodPoints()),
              "broken or not complete"),
      content("PlyHugeCountAscii", "in.ply",
              ply("ascii", vertices("1000000000", xyz_properties), goodPoints()),
              "shorter than its header"),
      content("PlyHugeCountBinary", "in.ply",
              ply("binary_little_endian", vertices("1000000000", xyz_properties), bytes24),
              "shorter than its header"),
      content("PlyHugeFaceCount", "in.ply",
              ply("ascii",
                  vertices("4", xyz_properties) +
                      "element face 1000000000\nproperty list uchar int vertex_indices\n",
                  goodPoints()),
              "shorter than its header"),
      content("PlyCountBeyondAllIntegers", "in.ply",
              ply("ascii", vertices("99999999999999999999", xyz_properties), goodPoints()),
              "number of elements"),
      content("PlyNegativeCount", "in.ply",
              ply("ascii", vertices("-1", xyz_properties), goodPoints()), "number of elements"),
      content("PlyNoPoints", "in.ply", ply("ascii", vertices("0", xyz_properties), ""),
              "no points"),
      content("PlyBinaryCut", "in.ply",
              ply("binary_big_endian", vertices("4", xyz_properties), bytes24),
              "shorter than its header"),
      content("PlyAsciiCut", "in.ply",
              ply("ascii", vertices("5", xyz_properties), "1.000 2.000 3.000\n4.000 5.0 6.0\n"),
              "fewer points"),
      content("PlyAsciiLetters", "in.ply",
              ply("ascii", vertices("4", xyz_properties), "a b c\nd e f\ng h i\nj k l\n"),
              "line 8 "),

      content("ObjOfRubbish", "in.obj", "\x01\x02\x03 {}\n", "line 1"),
      content("ObjShortVertex", "in.obj", "v 1 2 3\nv 1 2\n", "line 2"),
      content("ObjLetters", "in.obj", "v 1 2 c\n", "line 1"),
      content("ObjBrokenNormal", "in.obj", "v 1 2 3\nvn 1 x 0\n", "line 2"),
      content("ObjWithoutVertices", "in.obj", "o nothing\nf 1 2 3\n", "no points"),

      content("VtkOfText", "in.vtk", goodPoints(), "does not begin as a legacy VTK"),
      content("VtkOfXml", "in.vtk", "<VTKFile type=\"PolyData\">\n</VTKFile>\n",
              "does not begin as a legacy VTK"),
      content("VtkHeaderCut", "in.vtk", "# vtk DataFile Version 3.0\n", "legacy VTK"),
      content("VtkUnknownStorage", "in.vtk", vtk("HEX\nDATASET POLYDATA\n"), "stored as 'hex'"),
      content("VtkWithoutPoints", "in.vtk", vtk("ASCII\nDATASET POLYDATA\n"), "no points"),
      content("VtkNoPoints", "in.vtk", vtk("ASCII\nDATASET POLYDATA\nPOINTS 0 float\n"),
              "no points"),
      content("VtkHugeCountAscii", "in.vtk",
              vtk("ASCII\nDATASET POLYDATA\nPOINTS 1000000000 float\n1 2 3\n"),
              "shorter than its header"),
      content("VtkHugeCountBinary", "in.vtk",
              vtk("BINARY\nDATASET POLYDATA\nPOINTS 1000000000 float\n" + bytes24),
              "shorter than its header"),
      content("VtkNegativeCount", "in.vtk",
              vtk("ASCII\nDATASET POLYDATA\nPOINTS -4 float\n1 2 3\n"), "number of points"),
      content("VtkOfBytes", "in.vtk", vtk("ASCII\nDATASET POLYDATA\nPOINTS 2 char\n1 2 3 4 5 6\n"),
              "of type 'char'"),
      content("VtkBrokenPoints", "in.vtk", vtk("ASCII\nDATASET POLYDATA\nPOINTS\n"),
              "not complete"),
      content("VtkAsciiCut", "in.vtk",
              vtk("ASCII\nDATASET POLYDATA\nPOINTS 5 float\n1.00 2.00 3.00 4.000 5.000 6.000\n"),
              "broken"),
      content("VtkUnknownDataset", "in.vtk",
              vtk("ASCII\nDATASET NONSENSE\nPOINTS 2 float\n1 2 3 4 5 6\n"), "broken"),

      content("XyzOfLetters", "in.xyz", "hello world and more\n", "line 1"),
      content("XyzShortLine", "in.xyz", "1 2 3\n4 5\n", "line 2"),
      content("XyzRubbishInANumber", "in.xyz", "1 2 3\n1 2 3x\n", "line 2"),
      content("XyzOfBytes", "in.xyz",
              std::string("\x7f"
                          "ELF\x01\x02\0\0\0",
                          9),
              "line 1"),
      content("XyzOnlyComments", "in.txt", "# nothing\n# here\n", "no points"),

      content("NotANumberOnly", "in.xyz", nan_points, "at least 4"),
      content("OnePoint", "in.xyz", "1 2 3\n", "at least 4"),
      content("ThreePoints", "in.xyz", "1 0 0\n0 1 0\n0 0 1\n", "at least 4"),
      content("ThreePointsManyTimes", "in.xyz", "1 0 0\n0 1 0\n0 0 1\n1 0 0\n0 1 0\n0 0 1\n",
              "at least 4"),
      content("ThreeFinitePoints", "in.xyz", "1 0 0\n0 1 0\n0 0 1\nnan 1 1\n1e999 1 1\n",
              "at least 4"),
      content("PointsInAPlane", "in.xyz", plane, "in one plane"),
      {"AllButThreePointsAreOutliers",
       mesh_tool,
       {{"in.xyz", "0 0 0\n.1 0 0\n0 .1 0\n9 9 9\n-9 9 0\n"}},
       {"in.xyz", "out.ply", "-outliers", "0", "-outlier-method", "statistical"},
       1,
       "2 of 5 points are outliers"},
      {"TooFewPointsForOutliers",
       mesh_tool,
       {{"in.xyz", "1 0 0\n0 1 0\n0 0 1\nnan 1 1\n"}},
       {"in.xyz", "out.ply", "-outliers", "0"},
       1,
       "at least 4"},
      content("PointsOnALine", "in.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n", "in one plane"),
  };
}

std::vector<Row> commandLines() {
  return {
      {"NoArguments", mesh_tool, {}, {}, 2, "no input file"},
      usage("OnlyInput", {"good.xyz"}, "no output file"),
      usage("ThreeFiles", {"good.xyz", "a.ply", "b.ply"}, "too many: 'b.ply'"),
      usage("UnknownInputExtension", {"good.las", "out.ply"}, "'good.las' has an extension"),
      usage("InputWithoutExtension", {"good", "out.ply"}, "'good' has an extension"),
      usage("UnknownOutputExtension", {"good.xyz", "out.gltf"}, "'out.gltf' has an extension"),
      usage("OutputWithoutExtension", {"good.xyz", "out"}, "'out' has an extension"),
      usage("CloudFormatAsOutput", {"good.xyz", "out.pcd"}, "'out.pcd' has an extension"),
      usage("MeshFormatAsInput", {"in.stl", "out.ply"}, "'in.stl' has an extension"),
      usage("UnknownSphereExtension", {"good.xyz", "out.ply", "-sphere", "s.png"},
            "'s.png' has an extension"),
      usage("EmptySphere", {"good.xyz", "out.ply", "-sphere", ""}, "has an extension"),
      usage("EmptyJson", {"good.xyz", "out.ply", "-json", ""}, "-json"),
      usage("EmptyInput", {"", "out.ply"}, "has an extension"),
      usage("UnknownOption", {"good.xyz", "out.ply", "-diameter", "1"}, "'-diameter'"),
      usage("UnknownLongOption", {"good.xyz", "out.ply", "--diameter=1"}, "diameter"),
      usage("AbbreviatedOption", {"good.xyz", "out.ply", "-iter", "5"}, "'-iter'"),
      usage("MissingValueAtEnd", {"good.xyz", "out.ply", "-k"}, "missing"),
      usage("MissingFileBeforeOption", {"good.xyz", "out.ply", "-json", "--quiet"}, "has no value"),
      usage("MissingValueBeforeOption", {"good.xyz", "out.ply", "-k", "-quiet"}, "has no value"),
      usage("EmptyAdjacentValue", {"good.xyz", "out.ply", "-k="}, "k="),
      usage("ValueForASwitch", {"good.xyz", "out.ply", "-quiet=1"}, "quiet"),
      usage("RepeatedOption", {"good.xyz", "out.ply", "-k", "5", "-k", "6"}, "more than once"),
      option("KOfLetters", "-k", "abc"),
      option("KEmpty", "-k", ""),
      option("KOfTwo", "-k", "2"),
      option("KNegative", "-k", "-25"),
      option("KReal", "-k", "25.5"),
      option("KWithUnit", "-k", "5x"),
      option("KTooLarge", "-k", "99999999999999999999"),
      option("KExponent", "-k", "1e2"),
      option("WeightsUnknown", "-weights", "heavy"),
      option("WeightsEmpty", "-weights", ""),
      option("WeightsInCapitals", "-weights", "Uniform"),
      option("GraphUnknown", "-graph", "gabriel"),
      option("GraphEmpty", "-graph", ""),
      option("SolverUnknown", "-solver", "newton"),
      option("SolverEmpty", "-solver", ""),
      option("HullUnknown", "-hull", "cgal"),
      option("HullEmpty", "-hull", ""),
      option("OptimizeUnknown", "-optimize", "most"),
      option("OptimizeEmpty", "-optimize", ""),
      option("OptimizeInCapitals", "-optimize", "Full"),
      option("AttemptsZero", "-attempts", "0"),
      option("AttemptsTooMany", "-attempts", "101"),
      option("AttemptsReal", "-attempts", "1.5"),
      option("AttemptsOfLetters", "-attempts", "some"),
      option("SmoothNegative", "-smooth", "-1"),
      option("SmoothTooLarge", "-smooth", "10001"),
      option("SmoothReal", "-smooth", "2.5"),
      option("SmoothOfLetters", "-smooth", "yes"),
      option("SmoothEmpty", "-smooth", ""),
      option("OutliersNegative", "-outliers", "-1"),
      option("OutliersTooLarge", "-outliers", "1000.5"),
      option("OutliersNan", "-outliers", "nan"),
      option("OutliersInfinite", "-outliers", "inf"),
      option("OutliersOfLetters", "-outliers", "paper"),
      option("OutliersEmpty", "-outliers", ""),
      usage("OutlierMethodUnknown",
            {"good.xyz", "out.ply", "-outliers", "3", "-outlier-method", "radius"},
            "option -outlier-method: 'radius'"),
      usage("OutlierMethodEmpty", {"good.xyz", "out.ply", "-outliers", "3", "-outlier-method", ""},
            "option -outlier-method: ''"),
      usage("OutlierMethodWithoutOutliers", {"good.xyz", "out.ply", "-outlier-method", "paper"},
            "option -outlier-method does nothing without -outliers"),
      option("ExponentOfTwo", "-exponent", "2"),
      option("ExponentTooLarge", "-exponent", "16.1"),
      option("ExponentNan", "-exponent", "nan"),
      option("ExponentOfLetters", "-exponent", "three"),
      option("StartsZero", "-starts", "0"),
      option("StartsTooMany", "-starts", "101"),
      option("StartsReal", "-starts", "1.5"),
      option("SeedNegative", "-seed", "-1"),
      option("SeedTooLarge", "-seed", "4294967296"),
      option("SeedReal", "-seed", "0.5"),
      idle("IterationsOfTheMultilevelSolver", {"-iterations", "5"}, "-solver multilevel"),
      idle("StagnationOfTheMultilevelSolver", {"-solver", "multilevel", "-stagnation", "0"},
           "-solver multilevel"),
      idle("ExponentOfTheIterativeSolver", {"-exponent", "3", "-solver", "iterative"},
           "-solver iterative"),
      idle("StartsOfTheIterativeSolver", {"-starts", "2", "-solver", "iterative"},
           "-solver iterative"),
      idle("SeedOfTheIterativeSolverWithoutOptimization",
           {"-seed", "1", "-solver", "iterative", "-optimize", "none"},
           "-solver iterative and -optimize none"),
      idle("SeedOfTheIterativeSolverWithFlips",
           {"-optimize", "flips", "-seed", "1", "-solver", "iterative"},
           "-solver iterative and -optimize flips"),
      idle("ExponentOfUniformWeights", {"-exponent", "4", "-weights", "uniform"},
           "-weights uniform"),
      idle("ExponentOfInverseLengthWeights", {"-exponent", "4", "-weights", "inverse"},
           "-weights inverse"),
      option("IterationsNegative", "-iterations", "-1"),
      option("IterationsOfLetters", "-iterations", "many"),
      option("IterationsTooLarge", "-iterations", "3000000000"),
      option("ToleranceNegative", "-tolerance", "-1e-8"),
      option("ToleranceNan", "-tolerance", "nan"),
      option("ToleranceTooLarge", "-tolerance", "1e999"),
      option("ToleranceInfinite", "-tolerance", "inf"),
      option("ToleranceOfLetters", "-tolerance", "small"),
      option("LambdaZero", "-lambda", "0"),
      option("LambdaAboveOne", "-lambda", "1.0001"),
      option("LambdaNegative", "-lambda", "-0.5"),
      option("LambdaEmpty", "-lambda", ""),
      option("LambdaWithRest", "-lambda", "0.5 "),
      option("LambdaWithComma", "-lambda", "0,5"),
      usage("StagnationOfOne", {"good.xyz", "out.ply", "-stagnation", "1"}, "-stagnation"),
      option("StagnationNegative", "-stagnation", "-2"),
      option("ThreadsNegative", "-threads", "-1"),
      option("ThreadsTooMany", "-threads", "100000"),
      option("ThreadsOfLetters", "-threads", "all"),
      usage("LineBreakInAName", {"good\n.las", "out.ply"}, "'good?.las'"),
      usage("OutputIsInput", {"good.xyz", "./good.obj", "-sphere", "good.obj"}, "would overwrite"),
      usage("JsonIsInput", {"good.xyz", "out.ply", "-json", "good.xyz"}, "would overwrite"),
      usage("JsonIsOutput", {"good.xyz", "out.ply", "-json", "./out.ply"}, "would overwrite"),
      {"OutputIsInputByLink",
       mesh_tool,
       {{"in.ply", "anything"}, {"out.ply", "in.ply", Kind::Link}},
       {"in.ply", "out.ply"},
       2,
       "would overwrite"},
  };
}

std::vector<Row> outputFiles() {
  const Entry closed = {"closed", "", Kind::Directory, 0555};
  return {
      {"NoOutputDirectory", mesh_tool, {good}, {"good.xyz", "no/out.ply"}, 1, "no directory"},
      {"OutputBehindAFile", mesh_tool, {good}, {"good.xyz", "good.xyz/out.ply"}, 1, "out.ply"},
      {"OutputIsADirectory",
       mesh_tool,
       {good, {"out.ply", "", Kind::Directory, 0755}},
       {"good.xyz", "out.ply"},
       1,
       "is a directory"},
      {"NoSphereDirectory",
       mesh_tool,
       {good},
       {"good.xyz", "out.ply", "-sphere", "no/s.ply"},
       1,
       "no directory"},
      {"NoJsonDirectory",
       mesh_tool,
       {good},
       {"good.xyz", "out.ply", "-json", "no/r.json"},
       1,
       "no directory"},
      {"JsonIsADirectory",
       mesh_tool,
       {good, {"r.json", "", Kind::Directory, 0755}},
       {"good.xyz", "out.ply", "-json", "r.json"},
       1,
       "is a directory"},
      {"ClosedOutputDirectory",
       mesh_tool,
       {good, closed},
       {"good.xyz", "closed/out.ply"},
       1,
       "Permission denied",
       true},
      {"ReadOnlyOutput",
       mesh_tool,
       {good, {"out.ply", "kept", Kind::File, 0444}},
       {"good.xyz", "out.ply"},
       1,
       "Permission denied",
       true},
      {"NameTooLong",
       mesh_tool,
       {good},
       {"good.xyz", std::string(300, 'a') + ".ply"},
       1,
       "too long"},
      {"FullDiskKeepsTheOldFile",
       mesh_tool,
       {large, {"out.ply", "kept"}},
       {"large.xyz", "out.ply"},
       1,
       "File too large",
       false,
       small_disk},
      {"FullDiskForStl",
       mesh_tool,
       {large},
       {"large.xyz", "out.stl"},
       1,
       "File too large",
       false,
       small_disk},
      {"FullDiskForObj",
       mesh_tool,
       {large},
       {"large.xyz", "out.obj"},
       1,
       "File too large",
       false,
       small_disk},
      {"FullDiskForSphere",
       mesh_tool,
       {large},
       {"large.xyz", "out.ply", "-sphere", "s.stl"},
       1,
       "cannot write 's.stl': File too large",
       false,
       medium_disk},
      {"FullDiskForJson",
       mesh_tool,
       {large},
       {"large.xyz", "out.ply", "-json", "r.json", "-solver", "iterative", "-stagnation", "0",
        "-tolerance", "0"},
       1,
       "cannot write 'r.json': File too large",
       false,
       medium_disk},
      {"JsonToAFullDevice",
       mesh_tool,
       {good},
       {"good.xyz", "out.ply", "-json", "-"},
       1,
       "standard output",
       false,
       0,
       "/dev/full"},
      {"VerdictToAFullDevice",
       mesh_tool,
       {good},
       {"good.xyz", "out.ply"},
       1,
       "standard output",
       false,
       0,
       "/dev/full"},
      {"HelpToAFullDevice", mesh_tool, {}, {"-h"}, 1, "standard output", false, 0, "/dev/full"},
  };
}

std::vector<Row> scans() {
  const Entry closed = {"closed", "", Kind::Directory, 0555};
  return {
      {"NoArguments", scan_tool, {}, {}, 2, "no shape"},
      scanUsage("OnlyShape", {"sphere"}, "no output file"),
      scanUsage("ThreeWords", {"sphere", "a.pcd", "b.pcd"}, "too many"),
      scanUsage("UnknownShape", {"cube", "out.pcd"}, "no shape 'cube'"),
      scanUsage("EmptyShape", {"", "out.pcd"}, "no shape ''"),
      scanUsage("UnknownExtension", {"sphere", "out.las"}, "extension"),
      scanUsage("NoExtension", {"sphere", "out"}, "extension"),
      scanUsage("MeshFormatAsOutput", {"sphere", "out.stl"}, "extension"),
      scanUsage("UnknownTruthExtension", {"sphere", "out.pcd", "-truth", "t.pcd"}, "extension"),
      scanUsage("TruthIsOutput", {"sphere", "out.ply", "-truth", "./out.ply"}, "would overwrite"),
      scanUsage("UnknownOption", {"sphere", "out.pcd", "-diameter", "1"}, "'-diameter'"),
      scanUsage("MissingValue", {"sphere", "out.pcd", "-points"}, "missing"),
      scanUsage("ThreePoints", {"sphere", "out.pcd", "-points", "3"}, "option -points: '3'"),
      scanUsage("PointsOfLetters", {"sphere", "out.pcd", "-points", "x"}, "option -points: 'x'"),
      scanUsage("NegativePoints", {"sphere", "out.pcd", "-points", "-9"}, "option -points: '-9'"),
      scanUsage("TooManyPoints", {"sphere", "out.pcd", "-points", "1000000000"}, "option -points"),
      scanUsage("NegativeNoise", {"sphere", "out.pcd", "-noise", "-1"}, "option -noise: '-1'"),
      scanUsage("NoiseNan", {"sphere", "out.pcd", "-noise", "nan"}, "option -noise: 'nan'"),
      scanUsage("NoiseTooLarge", {"sphere", "out.pcd", "-noise", "1e999"}, "option -noise"),
      scanUsage("NegativeSeed", {"sphere", "out.pcd", "-seed", "-1"}, "option -seed: '-1'"),
      scanUsage("RealSeed", {"sphere", "out.pcd", "-seed", "1.5"}, "option -seed: '1.5'"),
      scanUsage("SeedTooLarge", {"sphere", "out.pcd", "-seed", "18446744073709551616"},
                "option -seed"),
      {"NoDirectory", scan_tool, {}, {"sphere", "no/out.pcd"}, 1, "no directory"},
      {"NoTruthDirectory",
       scan_tool,
       {},
       {"sphere", "out.pcd", "-truth", "no/t.ply"},
       1,
       "no directory"},
      {"OutputIsADirectory",
       scan_tool,
       {{"out.pcd", "", Kind::Directory, 0755}},
       {"sphere", "out.pcd"},
       1,
       "is a directory"},
      {"ClosedDirectory",
       scan_tool,
       {closed},
       {"sphere", "closed/out.pcd"},
       1,
       "Permission denied",
       true},
      {"FullDisk",
       scan_tool,
       {{"out.pcd", "kept"}},
       {"sphere", "out.pcd", "-points", "1000"},
       1,
       "File too large",
       false,
       small_disk},
      {"FullDeviceForTheReport",
       scan_tool,
       {},
       {"sphere", "out.pcd", "-points", "100"},
       1,
       "standard output",
       false,
       0,
       "/dev/full"},
  };
}

bool canRunUnprivileged(const std::string& tool) {
  const TemporaryDirectory directory;
  RunOptions options;
  options.directory = directory.path();
  options.unprivileged = true;
  return run(tool, {"-version"}, options).exit_code == 0;
}

class BadInput : public testing::TestWithParam<Row> {};

TEST_P(BadInput, IsRefusedWithCauseAndRemedyAndLeavesNothing) {
  const Row& row = GetParam();
  if (row.unprivileged && !canRunUnprivileged(row.tool)) {
    GTEST_SKIP() << "the tool is in a place that root alone may enter";
  }
  const TemporaryDirectory directory;
  for (const Entry& entry : row.entries) {
    create(directory, entry);
  }
  const auto before = directory.listing();

  RunOptions options;
  options.directory = directory.path();
  options.unprivileged = row.unprivileged;
  options.file_size_limit = row.file_size_limit;
  options.standard_output = row.standard_output;
  const RunResult result = run(row.tool, row.arguments, options);

  EXPECT_EQ(result.exit_code, row.exit_code) << "signal " << result.signal;
  const std::vector<std::string> lines = result.errorLines();
  ASSERT_EQ(lines.size(), 2U) << result.errors;
  EXPECT_NE(lines[0].find(row.cause), std::string::npos) << lines[0];
  const std::string remedy = "  remedy: ";
  EXPECT_EQ(lines[1].rfind(remedy, 0), 0U) << lines[1];
  EXPECT_GT(lines[1].size(), remedy.size());
  EXPECT_EQ(directory.listing(), before);
}

std::string nameOf(const testing::TestParamInfo<Row>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(InputFiles, BadInput, testing::ValuesIn(inputFiles()), nameOf);
INSTANTIATE_TEST_SUITE_P(CommandLines, BadInput, testing::ValuesIn(commandLines()), nameOf);
INSTANTIATE_TEST_SUITE_P(OutputFiles, BadInput, testing::ValuesIn(outputFiles()), nameOf);
INSTANTIATE_TEST_SUITE_P(Scans, BadInput, testing::ValuesIn(scans()), nameOf);

TEST(BadInputTable, HasAHundredRows) {
  EXPECT_GE(inputFiles().size() + commandLines().size() + outputFiles().size() + scans().size(),
            100U);
}

}  // namespace
