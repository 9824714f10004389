// Mistakes of users, one a row: each must end with the right exit code, one line of cause and one
// of remedy, and leave the directory as it was.

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

std::string xyzPcd(const std::string& points, const std::string& data) {
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + points +
         "\nHEIGHT 1\nPOINTS " + points + "\nDATA " + data;
}

std::string ply(const std::string& format, const std::string& points, const std::string& data,
                const std::string& further = "") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + points +
         "\nproperty float x\nproperty float y\nproperty float z\n" + further + "end_header\n" +
         data;
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

Row scanUsage(const std::string& name, const std::vector<std::string>& arguments,
              const std::string& cause) {
  return {name, scan_tool, {}, arguments, 2, cause};
}

std::vector<Row> inputFiles() {
  const std::string bytes24(24, '\1');
  return {
      {"MissingFile", mesh_tool, {}, {"no.pcd", "out.ply"}, 1, "No such file"},
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
      content("EmptyFile", "in.ply", "", "is empty"),

      content("PcdOfZeros", "in.pcd", std::string(5000, '\0'), "unknown entry"),
      content("PcdHeaderCut", "in.pcd", "VERSION 0.7\nFIELDS x y z\n", "no PCD header"),
      content("PcdHugePointsAscii", "in.pcd", xyzPcd("1000000000", "ascii\n1 2 3\n"),
              "shorter than its header"),
      content("PcdHugePointsBinary", "in.pcd", xyzPcd("1000000000", "binary\n" + bytes24),
              "shorter than its header"),
      content("PcdHugePointsCompressed", "in.pcd",
              xyzPcd("1000000000", "binary_compressed\n" + bytes24), "shorter than its header"),
      content("PcdPointsBeyondAllIntegers", "in.pcd",
              xyzPcd("99999999999999999999", "binary\n" + bytes24), "number of points"),
      content("PcdNegativePoints", "in.pcd", xyzPcd("-5", "ascii\n1 2 3\n"), "number of points"),
      content("PcdNoPoints", "in.pcd", xyzPcd("0", "ascii\n"), "no points"),
      content("PcdUnknownStorage", "in.pcd", xyzPcd("4", "zip\n1 2 3\n"), "stored as 'zip'"),
      content("PcdAsciiCut", "in.pcd", xyzPcd("5", "ascii\n1.00 2.00 3.00\n4.000 5.000 6.000\n"),
              "fewer points"),
      content("PcdAsciiShortLine", "in.pcd", xyzPcd("4", "ascii\n1 2 3\n4 5\n6 7 8\n9 10 11\n"),
              "line 11 "),

      content("PlyOfText", "in.ply", goodPoints(), "does not begin as a PLY"),
      content("PlyHeaderCut", "in.ply", "ply\nformat ascii 1.0\nelement vertex 4\n", "no end"),
      content("PlyUnknownFormat", "in.ply", ply("hexadecimal", "4", goodPoints()), "neither ascii"),
      content("PlyListInVertex", "in.ply",
              ply("ascii", "4", goodPoints(), "property list uchar int a\n"), "the list 'a'"),
      content("PlyHugeCount", "in.ply", ply("binary_little_endian", "1000000000", bytes24),
              "shorter than its header"),
      content("PlyCountBeyondAllIntegers", "in.ply",
              ply("ascii", "99999999999999999999", goodPoints()), "number of elements"),
      content("PlyNoPoints", "in.ply", ply("ascii", "0", ""), "no points"),
      content("PlyAsciiLetters", "in.ply", ply("ascii", "4", "a b c\nd e f\ng h i\nj k l\n"),
              "line 8 "),

      content("ObjOfRubbish", "in.obj", "\x01\x02\x03 {}\n", "line 1"),
      content("ObjShortVertex", "in.obj", "v 1 2 3\nv 1 2\n", "line 2"),
      content("ObjWithoutVertices", "in.obj", "o nothing\nf 1 2 3\n", "no points"),
      content("XyzOfLetters", "in.xyz", "hello world and more\n", "line 1"),
      content("XyzShortLine", "in.xyz", "1 2 3\n4 5\n", "line 2"),
      content("XyzOnlyComments", "in.txt", "# nothing\n# here\n", "no points"),

      content("ThreePointsManyTimes", "in.xyz", "1 0 0\n0 1 0\n0 0 1\n1 0 0\n0 1 0\n0 0 1\n",
              "at least 4"),
      content("ThreeFinitePoints", "in.xyz", "1 0 0\n0 1 0\n0 0 1\nnan 1 1\n1e999 1 1\n",
              "at least 4"),
      content("PointsInAPlane", "in.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n", "in one plane"),
      {"PointsInAPlaneButForOutliers",
       mesh_tool,
       {{"in.xyz", "0 0 0\n.1 0 0\n0 .1 0\n9 9 9\n-9 9 0\n"}},
       {"in.xyz", "out.ply", "-outliers", "0"},
       1,
       "(without 1 outlier): all points lie in one plane"},
  };
}

std::vector<Row> commandLines() {
  return {
      {"NoArguments", mesh_tool, {}, {}, 2, "no input file"},
      usage("OnlyInput", {"good.xyz"}, "no output file"),
      usage("ThreeFiles", {"good.xyz", "a.ply", "b.ply"}, "too many: 'b.ply'"),
      usage("UnknownInputExtension", {"good.las", "out.ply"}, "'good.las' has an extension"),
      usage("VtkAsInput", {"in.vtk", "out.ply"}, "'in.vtk' has an extension"),
      usage("OutputWithoutExtension", {"good.xyz", "out"}, "'out' has an extension"),
      usage("CloudFormatAsOutput", {"good.xyz", "out.pcd"}, "'out.pcd' has an extension"),
      usage("EmptySphere", {"good.xyz", "out.ply", "-sphere", ""}, "has an extension"),
      usage("EmptyJson", {"good.xyz", "out.ply", "-json", ""}, "-json"),
      usage("UnknownOption", {"good.xyz", "out.ply", "-diameter", "1"}, "'-diameter'"),
      usage("OptionOfAnotherTool", {"good.xyz", "out.ply", "-depth", "8"}, "'-depth'"),
      usage("AbbreviatedOption", {"good.xyz", "out.ply", "-iter", "5"}, "'-iter'"),
      usage("MissingValueAtEnd", {"good.xyz", "out.ply", "-k"}, "missing"),
      usage("MissingValueBeforeOption", {"good.xyz", "out.ply", "-k", "-quiet"}, "has no value"),
      usage("ValueForASwitch", {"good.xyz", "out.ply", "-quiet=1"}, "quiet"),
      usage("RepeatedOption", {"good.xyz", "out.ply", "-k", "5", "-k", "6"}, "more than once"),
      option("WholeNumberTooSmall", "-k", "2"),
      option("WholeNumberTooLarge", "-k", "99999999999999999999"),
      option("WholeNumberOfLetters", "-k", "5x"),
      option("WholeNumberWithFraction", "-k", "25.5"),
      option("RealNegative", "-tolerance", "-1e-8"),
      option("RealNan", "-tolerance", "nan"),
      option("RealTooLarge", "-tolerance", "1e999"),
      option("RealAtAnExcludedEnd", "-damping", "0"),
      option("RealEmpty", "-damping", ""),
      option("RealWithComma", "-damping", "0,5"),
      option("NameUnknown", "-graph", "gabriel"),
      option("NameInCapitals", "-weights", "Uniform"),
      usage("OptionOfTheOtherSolver", {"good.xyz", "out.ply", "-max_iterations", "5"},
            "does nothing with -embedding multilevel"),
      usage("OptionOfOtherWeights",
            {"good.xyz", "out.ply", "-exponent", "4", "-weights", "uniform"},
            "does nothing with -weights uniform"),
      usage("OptionOfTheWholeOptimization",
            {"good.xyz", "out.ply", "-retries", "5", "-optimization", "flips"},
            "does nothing with -optimization flips"),
      usage("LineBreakInAName", {"good\n.las", "out.ply"}, "'good?.las'"),
      usage("OutputIsInput", {"good.xyz", "./good.obj", "-sphere", "good.obj"}, "would overwrite"),
      usage("JsonIsInput", {"good.xyz", "out.ply", "-json", "good.xyz"}, "would overwrite"),
      {"OutputIsInputByLink",
       mesh_tool,
       {{"in.ply", "anything"}, {"out.ply", "in.ply", Kind::Link}},
       {"in.ply", "out.ply"},
       2,
       "would overwrite"},
      scanUsage("ScanWithoutOutput", {"sphere"}, "no output file"),
      scanUsage("ScanOfUnknownShape", {"cube", "out.pcd"}, "no shape 'cube'"),
      scanUsage("ScanToAMeshFormat", {"sphere", "out.stl"}, "extension"),
      scanUsage("ScanTruthIsOutput", {"sphere", "out.ply", "-truth", "./out.ply"},
                "would overwrite"),
      scanUsage("ScanOfThreePoints", {"sphere", "out.pcd", "-points", "3"}, "option -points: '3'"),
      scanUsage("ScanWithANegativeSeed", {"sphere", "out.pcd", "-seed", "-1"},
                "option -seed: '-1'"),
  };
}

Row fullDisk(const std::string& name, const std::vector<std::string>& arguments,
             const std::string& cause, std::size_t bytes) {
  return {name, mesh_tool, {large, {"out.ply", "kept"}}, arguments, 1, cause, false, bytes};
}

Row fullDevice(const std::string& name, const std::string& tool,
               const std::vector<std::string>& arguments) {
  return {name, tool, {good}, arguments, 1, "standard output", false, 0, "/dev/full"};
}

std::vector<Row> outputFiles() {
  return {
      {"NoOutputDirectory", mesh_tool, {good}, {"good.xyz", "no/out.ply"}, 1, "no directory"},
      {"OutputBehindAFile", mesh_tool, {good}, {"good.xyz", "good.xyz/out.ply"}, 1, "out.ply"},
      {"OutputIsADirectory",
       mesh_tool,
       {good, {"out.ply", "", Kind::Directory, 0755}},
       {"good.xyz", "out.ply"},
       1,
       "is a directory"},
      {"NoJsonDirectory",
       mesh_tool,
       {good},
       {"good.xyz", "out.ply", "-json", "no/r.json"},
       1,
       "no directory"},
      {"ClosedOutputDirectory",
       mesh_tool,
       {good, {"closed", "", Kind::Directory, 0555}},
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
      {"DanglingLinkAsOutput",
       mesh_tool,
       {good, {"out.ply", "missing/out.ply", Kind::Link}},
       {"good.xyz", "out.ply"},
       1,
       "no directory"},
      fullDisk("FullDiskKeepsTheOldFile", {"large.xyz", "out.ply"}, "File too large", small_disk),
      fullDisk("FullDiskForSphere", {"large.xyz", "out.ply", "-sphere", "s.stl"},
               "cannot write 's.stl': File too large", medium_disk),
      fullDisk("FullDiskForJson",
               {"large.xyz", "out.ply", "-json", "r.json", "-embedding", "iterative",
                "-stagnation_window", "0", "-tolerance", "0"},
               "cannot write 'r.json': File too large", medium_disk),
      fullDevice("JsonToAFullDevice", mesh_tool, {"good.xyz", "out.ply", "-json", "-"}),
      fullDevice("VerdictToAFullDevice", mesh_tool, {"good.xyz", "out.ply"}),
      fullDevice("HelpToAFullDevice", mesh_tool, {"-h"}),
      fullDevice("ScanToAFullDevice", scan_tool, {"sphere", "out.pcd", "-points", "100"}),
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

TEST(VtkAsInput, IsRefusedWithTheCommandThatConvertsIt) {
  const TemporaryDirectory directory;
  RunOptions options;
  options.directory = directory.path();
  const std::vector<std::string> lines =
      run(mesh_tool, {"in.vtk", "out.ply"}, options).errorLines();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NE(lines[1].find("pcl_vtk2pcd in.vtk out.pcd"), std::string::npos) << lines[1];
}

}  // namespace
