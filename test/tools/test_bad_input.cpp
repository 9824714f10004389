// Mistakes of users, one a row: each must end with the right exit code, one line of cause and one
// of remedy, and leave the directory as it was.

#include "open_shapes.h"
#include "tool_test.h"

#include <sys/stat.h>
#include <unistd.h>

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using tool_test::RunOptions;
using tool_test::RunResult;
using Words = std::vector<std::string>;

const std::map<std::string, std::string> programs = {{"mesh", RECONSTRUCTION_TOOL},
                                                     {"remesh", REMESH_TOOL},
                                                     {"morph", MORPH_TOOL},
                                                     {"texture", TEXTURE_TOOL},
                                                     {"scan", SCAN_TOOL}};

constexpr int failed = 1;
constexpr int wrong_usage = 2;

/// A command line, with | between its words, and a part of the first line on the standard error.
using Row = std::pair<std::string, std::string>;

Words wordsOf(const std::string& line) {
  Words words(1);
  for (const char c : line)
    if (c == '|')
      words.emplace_back();
    else
      words.back() += c;
  return words;
}

/// Clouds in.xyz and in.ply, a broken geometry image in.tif, and an output of an earlier run.
class BadInput : public tool_test::ToolTest {
protected:
  void SetUp() override {
    write("in.xyz", tool_test::linesOf(tool_test::ellipsoid(500)));
    write("in.ply", tool_test::plyOf(tool_test::ellipsoid(20)));
    write("in.tif", "II");
    write("kept.ply", "kept");
  }

  void expectAllRefused(const std::vector<Row>& rows, int exit_code,
                        const RunOptions& options = {}) const {
    for (const auto& [line, cause] : rows) {
      SCOPED_TRACE(line);
      Words words = wordsOf(line);
      const std::string program = programs.at(words.front());
      words.erase(words.begin());
      expectRefused(program, words, exit_code, cause, options);
    }
  }
};

TEST_F(BadInput, MistakesThatEveryToolRefuses) {
  for (const std::string run : {"mesh|in.xyz|out.ply", "remesh|in.xyz|out.ply",
                                "morph|in.xyz|in.ply|out.ply", "texture|in.xyz|out.ply"}) {
    const std::string tool = run.substr(0, run.find('|'));
    const std::string others = run.substr(run.find("in.xyz") + 6);
    expectAllRefused({{tool, " file is missing"},
                      {run.substr(0, run.rfind('|')), "the output file is missing"},
                      {run + "|b.ply", "one file too many: 'b.ply'"},
                      {tool + "|in.foo" + others, "'in.foo' has an extension"},
                      {tool + "|in.stl" + others, "'in.stl' is STL"},
                      {run.substr(0, run.rfind('|')) + "|out.pcd", "'out.pcd' has an extension"},
                      {run.substr(0, run.rfind('|')) + "|in.xyz", "an extension"},
                      {run + "|-quite", "unrecognised option '-quite'"},
                      {run + "|-k|2", "option -k: '2' is not allowed"},
                      {run + "|-json|", "option -json: the name of the file is empty"},
                      {run + "|-json|in.xyz", "'in.xyz' would overwrite 'in.xyz'"},
                      {run + "|-columns|x,y", "has no x, y and z"},
                      {run + "|-quiet|-verbose", "exclude each other"}},
                     wrong_usage);
    expectAllRefused({{tool + "|no.xyz" + others, "cannot read 'no.xyz': No such file"},
                      {run.substr(0, run.rfind('|')) + "|no/out.ply", "missing directory"},
                      {run + "|-json|no/r.json", "missing directory"}},
                     failed);
    RunOptions full;
    full.file_size_limit = 4000;
    expectAllRefused({{run + "|-quiet", "File too large"}}, failed, full);
    RunOptions full_output;
    full_output.standard_output = "/dev/full";
    expectAllRefused({{run + "|-json|-", "standard output"}, {tool + "|-h", "standard output"}},
                     failed, full_output);
  }
}

TEST_F(BadInput, FormatsThatAreNotReadAreNamedWithACommandThatConvertsThem) {
  write("in.dat", "LASF" + std::string(9, '\0'));
  for (const auto& [file, format, command] :
       std::vector<std::tuple<Words, std::string, std::string>>{
           {{"in.las", "in.LAZ", "in.dat"}, " is LA", "pdal translate"},
           {{"in.e57"}, " is E57", "CloudCompare "},
           {{"in.ptx"}, " is PTX", "CloudCompare "},
           {{"in.stl"}, " is STL", "pcl_converter "},
           {{"in.glb"}, " is glTF", "assimp export "},
           {{"in.vtk"}, " is VTK", "pcl_vtk2pcd "},
           {{"in.bag"}, " is a bag of ROS", "rosrun pcl_ros bag_to_pcd "},
           {{"in.mcap", "in.db3"}, " is a bag of ROS 2", "ros2 bag play "}})
    for (const std::string& name : file) {
      const auto result = run(RECONSTRUCTION_TOOL, {name, "out.ply"});
      EXPECT_EQ(result.exit_code, wrong_usage);
      EXPECT_NE(result.errors.find(format), std::string::npos) << result.errors;
      EXPECT_NE(result.errors.find("\n  remedy: convert it: " + command), std::string::npos)
          << result.errors;
    }
}

TEST_F(BadInput, FilesThatMakeNoSenseAreRefused) {
  ASSERT_EQ(symlink("in.ply", directory.file("link.ply").c_str()), 0);
  expectAllRefused(
      {{"mesh|in\n.las|out.ply", "'in?.las'"},
       {"mesh|in.xyz|out", "'out' has an extension"},
       {"mesh|in.xyz|out.ply|-sphere|", "-sphere"},
       {"mesh|in.xyz|./a.obj|-sphere|a.obj", "would overwrite"},
       {"mesh|in.ply|link.ply", "would overwrite"},
       {"mesh|in.xyz|out_%03d.ply|-parts|all", "is a pattern for several parts"},
       {"mesh|in.xyz|out.ply|-sphere|s%03d.ply", "is a pattern, but the output is one file"},
       {"scan", "the shape is missing"},
       {"scan|sphere", "the output file"},
       {"scan|cube|out.pcd", "unknown shape 'cube'"},
       {"scan|sphere|out.stl", "extension"},
       {"scan|sphere|out.ply|-truth|./out.ply", "would overwrite"},
       {"remesh|in.xyz|out.png", "out.png"},
       {"remesh|in.xyz|out.stl|-grid|even", "out.stl"},
       {"remesh|in.tif|out.tif", "geometry image"},
       {"remesh|in.xyz|out.ply|-harmonics|", "-harmonics"},
       {"remesh|in.xyz|out.ply|-harmonics|out.ply", "would overwrite"},
       {"morph|in.ply|in.xyz|m_%s.ply", "% that is not a frame number"},
       {"morph|in.ply|in.xyz|m_%d_%d.ply", "% that is not a frame number"},
       {"morph|in.ply|in.xyz|m_%12d.ply", "% that is not a frame number"},
       {"morph|in.ply|in.xyz|m_%%.ply", "% that is not a frame number"},
       {"morph|in.ply|in.xyz|m.ply|-pairs|", "-pairs"},
       {"morph|in.ply|in.xyz|m.ply|-json|m_001.ply", "would overwrite"},
       {"morph|in.ply|m_001.ply|m.ply", "would overwrite"},
       {"texture|in.ply|in.ply", "would overwrite"},
       {"texture|in.ply|out.ply|-json|out.png", "would overwrite"},
       {"texture|in.ply|out.glb|-image|out.png", "-image"},
       {"texture|in.ply|out.obj|-image|out.jpg", "out.jpg"},
       {"texture|in.ply|out.obj|-image|a b.png", "a b.png"},
       {"texture|in.ply|a b.obj", "a b"},
       {"texture|in.ply|out.ply|-image|a\nb.png", "a?b.png"}},
      wrong_usage);
}

TEST_F(BadInput, OptionsThatMakeNoSenseAreRefused) {
  expectAllRefused({{"mesh|in.xyz|out.ply|-ki|5", "'-ki'"},
                    {"mesh|in.xyz|out.ply|-quiet=1", "-quiet"},
                    {"mesh|in.xyz|out.ply|-x|--|-k", "'-x'"},
                    {"mesh|in.xyz|out.ply|-k", "missing"},
                    {"mesh|in.xyz|out.ply|-k|-quiet", "has no value"},
                    {"mesh|in.xyz|out.ply|-k|5|-k|6", "more than once"},
                    {"mesh|in.xyz|out.ply|-k|25.5", "option -k: '25.5'"},
                    {"mesh|in.xyz|out.ply|-tolerance|nan", "option -tolerance: 'nan'"},
                    {"mesh|in.xyz|out.ply|-damping|", "option -damping: ''"},
                    {"mesh|in.xyz|out.ply|-method|ball", "option -method: 'ball'"},
                    {"mesh|in.xyz|out.ply|-outliers|1001", "option -outliers: '1001'"},
                    {"mesh|in.xyz|out.ply|-history_frames|5", "'-history_frames'"},
                    {"mesh|in.xyz|out.ply|-parts|some", "'some' is not allowed"},
                    {"mesh|in.xyz|out.ply|-parts|each|-min-points|3", "-min-points"},
                    {"mesh|in.xyz|out.ply|-topology|torus", "'torus' is not allowed"},
                    {"scan|sphere|out.pcd|more", "one word too many: 'more'"},
                    {"scan|sphere|out.pcd|-points|3", "option -points: '3'"},
                    {"scan|sphere|out.pcd|-seed|-1", "option -seed: '-1'"},
                    {"remesh|in.xyz|out.xyz|-grid|even|-points|3", "-points"},
                    {"remesh|in.xyz|out.xyz|-grid|even|-points|16777217", "-points"},
                    {"remesh|in.xyz|out.tif|-side|10", "10 is even"},
                    {"remesh|in.xyz|out.tif|-side|1", "-side"},
                    {"remesh|in.xyz|out.ply|-grid|cubic", "'cubic' is not allowed"},
                    {"remesh|in.xyz|out.ply|-harmonics|c.json|-degree|513", "-degree"},
                    {"remesh|in.xyz|out.ply|-area-weight|1.1", "-area-weight"},
                    {"remesh|in.xyz|out.ply|-map-sweeps|1001", "-map-sweeps"},
                    {"morph|in.ply|in.xyz|m.ply|-frames|1", "-frames"},
                    {"morph|in.ply|in.xyz|m.ply|-align|yes", "option -align: 'yes'"},
                    {"morph|in.ply|in.xyz|m.ply|-connectivity|resampled|-samples|11", "-samples"},
                    {"texture|in.ply|out.glb|-chart|mercator", "mercator"},
                    {"texture|in.ply|out.glb|-size|15", "-size"},
                    {"texture|in.ply|out.glb|-gutter|257", "-gutter"},
                    {"texture|in.ply|out.glb|-checker|0", "-checker"}},
                   wrong_usage);
}

TEST_F(BadInput, OptionsThatDoNothingAreRefused) {
  const std::string nothing = " does nothing with ";
  expectAllRefused(
      {{"mesh|in.xyz|out.ply|-max-iterations|5", "-max-iterations" + nothing + "-method default"},
       {"mesh|in.xyz|out.ply|-min-points|60|-topology|sphere",
        "-min-points" + nothing + "-parts all"},
       {"mesh|in.xyz|out.ply|-time-limit|1|-method|paper",
        "-time-limit" + nothing + "-method paper"},
       {"remesh|in.xyz|out.ply|-side|9", "-side" + nothing},
       {"remesh|in.xyz|out.ply|-grid|even|-series", "-series" + nothing},
       {"remesh|in.xyz|out.ply|-grid|even|-sphere|s.ply", "-sphere" + nothing},
       {"remesh|in.xyz|out.ply|-degree|5", "-degree" + nothing},
       {"remesh|in.xyz|out.ply|-map-sweeps|0|-area-weight|1", "-area-weight" + nothing},
       {"remesh|in.xyz|out.tif|-side|9|-points|9", "-side" + nothing},
       {"remesh|in.xyz|out.tif|-series", "-series" + nothing},
       {"remesh|in.xyz|out.tif|-offset|1,2,3", "-offset" + nothing},
       {"remesh|in.xyz|out.tif|-ascii", "-ascii" + nothing},
       {"morph|in.ply|in.xyz|m.ply|-samples|100", "-samples" + nothing},
       {"texture|in.ply|out.glb|-ascii", "-ascii" + nothing}},
      wrong_usage);
  for (const char* option : {"-points=9", "-fit=linear", "-k=9", "-map-sweeps=2", "-grid=even",
                             "-series", "-harmonics=c.json"})
    expectAllRefused({{std::string("remesh|in.tif|out.ply|") + option, nothing}}, wrong_usage);
}

TEST_F(BadInput, MeshesWithHandlesHaveNoMapToOneSphere) {
  expectSuccess(SCAN_TOOL, {"torus", "torus.xyz", "-points", "1500"});
  write("both.xyz", tool_test::linesOf(tool_test::ellipsoid(2000, {1, 1, 1}, {9, 0, 0})) +
                        content("torus.xyz"));
  const std::string cause = "'torus.xyz' has no map to one sphere: its mesh has 1 handle";
  expectAllRefused({{"mesh|torus.xyz|out.ply|-sphere|s.ply", cause},
                    {"mesh|both.xyz|out%03d.ply|-parts|each|-sphere|s%03d.ply",
                     "part 2 of 'both.xyz' has no map to one sphere"},
                    {"remesh|torus.xyz|out.ply|-handles|auto", cause},
                    {"morph|in.xyz|torus.xyz|out.ply|-handles|auto", cause}},
                   failed);
  write("tangle.xyz", tool_test::linesOf(spherical_param::test::terraces()));
  expectAllRefused({{"mesh|tangle.xyz|out.ply|-sphere|s.ply",
                     "'tangle.xyz' has no map to one sphere: it is a tangle"}},
                   failed);
  run(RECONSTRUCTION_TOOL,
      {"torus.xyz", "out.ply", "-sphere", "s.ply", "-handles", "none", "-time-limit", "0"});
  EXPECT_TRUE(mesh("s.ply").isSphere());
}

TEST_F(BadInput, FilesThatCannotBeReadAreAFailure) {
  write("empty.ply", "");
  write("three.xyz", "1 0 0\n0 1 0\n0 0 1\n1 0 0\nnan 1 1\n1e999 1 1\n");
  write("flat.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n");
  write("outliers.xyz", "0 0 0\n.1 0 0\n0 .1 0\n9 9 9\n-9 9 0\n");
  write("open.xyz", tool_test::linesOf(spherical_param::test::hemisphere(500)));
  write("pairs.txt", "1 2\n1 two\n");
  ASSERT_EQ(mkdir(directory.file("folder.ply").c_str(), 0755), 0);
  ASSERT_EQ(mkfifo(directory.file("pipe.ply").c_str(), 0644), 0);
  expectAllRefused(
      {{"mesh|folder.ply|out.ply", "is a directory"},
       {"mesh|pipe.ply|out.ply", "not a regular file"},
       {"mesh|empty.ply|out.ply", "is empty"},
       {"mesh|three.xyz|out.ply", "at least 4"},
       {"mesh|in.xyz|out.ply|-parts|each|-min-points|501", "no part has min_points = 501"},
       {"mesh|flat.xyz|out.ply|-topology|sphere",
        "cannot mesh 'flat.xyz': all points lie in one plane"},
       {"mesh|outliers.xyz|out.ply|-topology|sphere|-outliers|0",
        "all points lie in one plane (left out: 1 stray point)"},
       {"remesh|no.tif|out.ply", "no.tif"},
       {"remesh|in.tif|out.ply", "in.tif"},
       {"remesh|flat.xyz|out.ply", "cannot mesh 'flat.xyz'"},
       {"remesh|open.xyz|out.tif|-surface|open", "a geometry image has no openings"},
       {"morph|in.ply|flat.xyz|m.ply", "cannot mesh 'flat.xyz'"},
       {"morph|in.ply|in.xyz|m.ply|-pairs|pairs.txt|-quiet", "line 2"}},
      failed);
}

TEST_F(BadInput, FilesThatCannotBeWrittenAreAFailureBeforeTheWork) {
  ASSERT_EQ(mkdir(directory.file("folder.ply").c_str(), 0755), 0);
  ASSERT_EQ(symlink("missing/out.ply", directory.file("dangling.ply").c_str()), 0);
  expectAllRefused({{"mesh|in.xyz|in.xyz/out.ply", "out.ply"},
                    {"mesh|in.xyz|folder.ply", "is a directory"},
                    {"mesh|in.xyz|dangling.ply", "missing directory"},
                    {"remesh|in.xyz|out.ply|-harmonics|no/c.json", "missing directory"},
                    {"texture|in.ply|out.ply|-image|no/out.png", "missing directory"}},
                   failed);
}

TEST_F(BadInput, FilesWithoutRightsAreAFailure) {
  RunOptions unprivileged;
  unprivileged.unprivileged = true;
  if (run(RECONSTRUCTION_TOOL, {"-version"}, unprivileged).exit_code != 0)
    GTEST_SKIP() << "the tool is in a place that root alone may enter";
  ASSERT_EQ(mkdir(directory.file("closed").c_str(), 0555), 0);
  write("secret.xyz", "1 2 3\n");
  ASSERT_EQ(chmod(directory.file("secret.xyz").c_str(), 0000), 0);
  ASSERT_EQ(chmod(directory.file("kept.ply").c_str(), 0444), 0);
  const std::string denied = "Permission denied";
  expectAllRefused({{"mesh|secret.xyz|out.ply", denied},
                    {"mesh|in.xyz|closed/out.ply", denied},
                    {"mesh|in.xyz|kept.ply", denied}},
                   failed, unprivileged);
}

TEST_F(BadInput, AFullDiskIsAFailureAndKeepsTheOldFile) {
  const std::string full = ": File too large";
  const auto expect_full = [&](std::size_t bytes, const std::vector<Row>& rows) {
    RunOptions options;
    options.file_size_limit = bytes;
    expectAllRefused(rows, failed, options);
  };
  // Room for no output; or for a mesh, but not for more.
  expect_full(4000, {{"mesh|in.xyz|kept.ply", "cannot write 'kept.ply'" + full},
                     {"texture|in.ply|a.obj|-size|256", full},
                     {"texture|in.ply|a.glb|-size|256", full},
                     {"scan|sphere|kept.ply", full}});
  expect_full(15000, {{"remesh|in.xyz|kept.ply|-harmonics|c.json", full}});
  expect_full(30000, {{"mesh|in.xyz|kept.ply|-sphere|s.stl", "cannot write 's.stl'" + full},
                      {"mesh|in.xyz|kept.ply|-json|r.json|-method|paper|-tolerance|0",
                       "cannot write 'r.json'" + full},
                      {"remesh|in.xyz|a.tif|-side|65", full}});
}

TEST_F(BadInput, AFullStandardOutputIsAFailure) {
  RunOptions options;
  options.standard_output = "/dev/full";
  expectAllRefused({{"mesh|in.xyz|kept.ply", "standard output"},
                    {"scan|sphere|out.pcd|-points|99", "standard output"}},
                   failed, options);
}

}  // namespace
