// Mistakes of users, one a row: each must end with the right exit code, one line of cause and one
// of remedy, and leave the directory as it was.

#include "open_shapes.h"
#include "tool_test.h"

#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using tool_test::RunOptions;
using tool_test::RunResult;
using Words = std::vector<std::string>;

const std::string mesh_tool = RECONSTRUCTION_TOOL;
const std::string morph_tool = MORPH_TOOL;
const std::string remesh_tool = REMESH_TOOL;
const std::string scan_tool = SCAN_TOOL;
const std::string texture_tool = TEXTURE_TOOL;

constexpr int failed = 1;
constexpr int wrong_usage = 2;

struct Row {
  std::string tool;
  Words arguments;
  std::string cause;  ///< part of the first line on the standard error
};

/// Clouds in.xyz and in.ply, a broken geometry image in.tif, and an output of an earlier run.
class BadInput : public tool_test::ToolTest {
protected:
  void SetUp() override {
    write("in.xyz", tool_test::linesOf(tool_test::ellipsoid(500)));
    write("in.ply", tool_test::plyOf(tool_test::ellipsoid(20)));
    write("in.tif", "II");
    write("kept.ply", "kept");
  }

  void expectAllRefused(const std::vector<Row>& rows, int exit_code) const {
    for (const Row& row : rows) {
      SCOPED_TRACE(row.tool + " " + testing::PrintToString(row.arguments));
      expectRefused(row.tool, row.arguments, exit_code, row.cause);
    }
  }

  /// Options that the tool refuses beside good files.
  void expectOptionsRefused(const std::string& tool, const Words& files,
                            const std::vector<std::pair<Words, std::string>>& cases) const {
    for (const auto& [options, cause] : cases) {
      const Words arguments = tool_test::with(files, options);
      SCOPED_TRACE(tool + " " + testing::PrintToString(arguments));
      expectRefused(tool, arguments, wrong_usage, cause);
    }
  }
};

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
      const auto result = run(mesh_tool, {name, "out.ply"});
      EXPECT_EQ(result.exit_code, wrong_usage);
      EXPECT_NE(result.errors.find(format), std::string::npos) << result.errors;
      EXPECT_NE(result.errors.find("\n  remedy: convert it: " + command), std::string::npos)
          << result.errors;
    }
}

TEST_F(BadInput, FilesThatMakeNoSenseAreRefused) {
  ASSERT_EQ(symlink("in.ply", directory.file("link.ply").c_str()), 0);
  expectAllRefused(
      {{mesh_tool, {}, "the input file is missing"},
       {mesh_tool, {"in.xyz"}, "the output file"},
       {mesh_tool, {"in.xyz", "a.ply", "b.ply"}, "too many: 'b.ply'"},
       {mesh_tool, {"in.foo", "out.ply"}, "'in.foo' has an extension"},
       {mesh_tool, {"in\n.las", "out.ply"}, "'in?.las'"},
       {mesh_tool, {"in.xyz", "out"}, "'out' has an extension"},
       {mesh_tool, {"in.xyz", "out.pcd"}, "'out.pcd' has an extension"},
       {mesh_tool, {"in.xyz", "out.ply", "-sphere", ""}, "is empty"},
       {mesh_tool, {"in.xyz", "out.ply", "-json", ""}, "-json"},
       {mesh_tool, {"in.xyz", "./a.obj", "-sphere", "a.obj"}, "would overwrite"},
       {mesh_tool, {"in.xyz", "out.ply", "-json", "in.xyz"}, "would overwrite"},
       {mesh_tool, {"in.ply", "link.ply"}, "would overwrite"},
       {mesh_tool, {"in.xyz", "out_%03d.ply", "-parts", "all"}, "is a pattern for several parts"},
       {scan_tool, {}, "the shape is missing"},
       {scan_tool, {"sphere"}, "the output file"},
       {scan_tool, {"cube", "out.pcd"}, "unknown shape 'cube'"},
       {scan_tool, {"sphere", "out.stl"}, "extension"},
       {scan_tool, {"sphere", "out.ply", "-truth", "./out.ply"}, "would overwrite"},
       {remesh_tool, {}, "the input file is missing"},
       {remesh_tool, {"in.xyz", "a.ply", "b.ply"}, "one file too many"},
       {remesh_tool, {"in.xyz", "out.png"}, "out.png"},
       {remesh_tool, {"in.xyz", "out.stl", "-grid", "even"}, "out.stl"},
       {remesh_tool, {"in.stl", "out.ply"}, "in.stl"},
       {remesh_tool, {"in.tif", "out.tif"}, "geometry image"},
       {remesh_tool, {"in.xyz", "out.ply", "-harmonics", ""}, "-harmonics"},
       {remesh_tool, {"in.xyz", "out.ply", "-harmonics", "out.ply"}, "would overwrite"},
       {morph_tool, {"a.ply"}, "the second file is missing"},
       {morph_tool, {"in.ply", "in.xyz"}, "the output file"},
       {morph_tool, {"in.ply", "in.xyz", "m.ply", "n.ply"}, "one file too many"},
       {morph_tool, {"in.ply", "in.xyz", "m.xyz"}, "m.xyz"},
       {morph_tool, {"in.ply", "in.foo", "m.ply"}, "in.foo"},
       {morph_tool, {"in.ply", "in.xyz", "m_%s.ply"}, "% that is not a frame number"},
       {morph_tool, {"in.ply", "in.xyz", "m_%d_%d.ply"}, "% that is not a frame number"},
       {morph_tool, {"in.ply", "in.xyz", "m_%12d.ply"}, "% that is not a frame number"},
       {morph_tool, {"in.ply", "in.xyz", "m_%%.ply"}, "% that is not a frame number"},
       {morph_tool, {"in.ply", "in.xyz", "m.ply", "-pairs", ""}, "-pairs"},
       {morph_tool, {"in.ply", "in.xyz", "m.ply", "-json", "m_001.ply"}, "would overwrite"},
       {morph_tool, {"in.ply", "m_001.ply", "m.ply"}, "would overwrite"},
       {texture_tool, {}, "the input file is missing"},
       {texture_tool, {"in.ply", "out.stl"}, "out.stl"},
       {texture_tool, {"in.glb", "out.glb"}, "in.glb"},
       {texture_tool, {"in.ply", "in.ply"}, "would overwrite"},
       {texture_tool, {"in.ply", "out.ply", "-json", "out.png"}, "would overwrite"},
       {texture_tool, {"in.ply", "out.glb", "-image", "out.png"}, "-image"},
       {texture_tool, {"in.ply", "out.obj", "-image", "out.jpg"}, "out.jpg"},
       {texture_tool, {"in.ply", "out.obj", "-image", "a b.png"}, "a b.png"},
       {texture_tool, {"in.ply", "a b.obj"}, "a b"},
       {texture_tool, {"in.ply", "out.ply", "-image", "a\nb.png"}, "a?b.png"}},
      wrong_usage);
  EXPECT_NE(run(mesh_tool, {"in.vtk", "out.ply"}).errors.find("pcl_vtk2pcd in.vtk out.pcd"),
            std::string::npos);
}

TEST_F(BadInput, OptionsThatMakeNoSenseAreRefused) {
  expectOptionsRefused(mesh_tool, {"in.xyz", "out.ply"},
                       {{{"-diameter", "1"}, "'-diameter'"},
                        {{"-iter", "5"}, "'-iter'"},
                        {{"-ki", "5"}, "'-ki'"},  // no abbreviations
                        {{"-quiet=1"}, "-quiet"},
                        {{"-x", "--", "-k"}, "'-x'"},
                        {{"-k"}, "missing"},
                        {{"-k", "-quiet"}, "has no value"},
                        {{"-k", "5", "-k", "6"}, "more than once"},
                        {{"-k", "2"}, "option -k: '2'"},
                        {{"-k", "25.5"}, "option -k: '25.5'"},
                        {{"-tolerance", "nan"}, "option -tolerance: 'nan'"},
                        {{"-damping", ""}, "option -damping: ''"},
                        {{"-method", "ball"}, "option -method: 'ball'"},
                        {{"-weights", "Uniform"}, "option -weights: 'Uniform'"},
                        {{"-outliers", "1001"}, "option -outliers: '1001'"},
                        {{"-history_frames", "5"}, "'-history_frames'"},
                        {{"-parts", "some"}, "'some' is not allowed"},
                        {{"-parts", "each", "-min-points", "3"}, "-min-points"},
                        {{"-topology", "torus"}, "'torus' is not allowed"},
                        {{"-sphere", "s%03d.ply"}, "is a pattern, but the output is one file"}});
  expectOptionsRefused(scan_tool, {"sphere", "out.pcd"},
                       {{{"more"}, "one word too many: 'more'"},
                        {{"-points", "3"}, "option -points: '3'"},
                        {{"-seed", "-1"}, "option -seed: '-1'"}});
  expectOptionsRefused(remesh_tool, {"in.xyz", "out.xyz", "-grid", "even"},
                       {{{"-points", "3"}, "-points"}, {{"-points", "16777217"}, "-points"}});
  expectOptionsRefused(remesh_tool, {"in.xyz", "out.tif"},
                       {{{"-side", "10"}, "10 is even"}, {{"-side", "1"}, "-side"}});
  expectOptionsRefused(remesh_tool, {"in.xyz", "out.ply"},
                       {{{"-grid", "cubic"}, "'cubic' is not allowed"},
                        {{"-harmonics", "c.json", "-degree", "513"}, "-degree"},
                        {{"-area-weight", "1.1"}, "-area-weight"},
                        {{"-map-sweeps", "1001"}, "-map-sweeps"}});
  expectOptionsRefused(morph_tool, {"in.ply", "in.xyz", "m.ply"},
                       {{{"-frames", "1"}, "-frames"},
                        {{"-align", "yes"}, "option -align: 'yes'"},
                        {{"-connectivity", "resampled", "-samples", "11"}, "-samples"}});
  expectOptionsRefused(texture_tool, {"in.ply", "out.glb"},
                       {{{"more.glb"}, "more.glb"},
                        {{"-chart", "mercator"}, "mercator"},
                        {{"-size", "15"}, "-size"},
                        {{"-gutter", "257"}, "-gutter"},
                        {{"-checker", "0"}, "-checker"}});
}

TEST_F(BadInput, OptionsThatDoNothingAreRefused) {
  const std::string nothing = " does nothing with ";
  expectOptionsRefused(
      mesh_tool, {"in.xyz", "out.ply"},
      {{{"-max-iterations", "5"}, "-max-iterations" + nothing + "-method default"},
       {{"-min-points", "60", "-topology", "sphere"}, "-min-points" + nothing + "-parts all"},
       {{"-time-limit", "1", "-method", "paper"}, "-time-limit" + nothing + "-method paper"}});
  expectOptionsRefused(remesh_tool, {"in.xyz", "out.ply"},
                       {{{"-side", "9"}, "-side" + nothing},
                        {{"-grid", "even", "-series"}, "-series" + nothing},
                        {{"-grid", "even", "-sphere", "s.ply"}, "-sphere" + nothing},
                        {{"-degree", "5"}, "-degree" + nothing},
                        {{"-map-sweeps", "0", "-area-weight", "1"}, "-area-weight" + nothing}});
  expectOptionsRefused(remesh_tool, {"in.xyz", "out.tif"},
                       {{{"-side", "9", "-points", "9"}, "-side" + nothing},
                        {{"-series"}, "-series" + nothing},
                        {{"-offset", "1,2,3"}, "-offset" + nothing},
                        {{"-ascii"}, "-ascii" + nothing}});
  for (const char* option : {"-points=9", "-fit=linear", "-k=9", "-map-sweeps=2", "-grid=even",
                             "-series", "-harmonics=c.json"})
    expectOptionsRefused(remesh_tool, {"in.tif", "out.ply"}, {{{option}, nothing}});
  expectOptionsRefused(morph_tool, {"in.ply", "in.xyz", "m.ply"},
                       {{{"-samples", "100"}, "-samples" + nothing}});
  expectRefused(texture_tool, {"in.ply", "out.glb", "-ascii"}, wrong_usage, "-ascii");
}

TEST_F(BadInput, MeshesWithHandlesHaveNoMapToOneSphere) {
  expectSuccess(scan_tool, {"torus", "torus.xyz", "-points", "1500"});
  write("both.xyz", tool_test::linesOf(tool_test::ellipsoid(2000, {1, 1, 1}, {9, 0, 0})) +
                        content("torus.xyz"));
  const std::string cause = "'torus.xyz' has no map to one sphere: its mesh has 1 handle";
  expectAllRefused({{mesh_tool, {"torus.xyz", "out.ply", "-sphere", "s.ply"}, cause},
                    {mesh_tool,
                     {"both.xyz", "out%03d.ply", "-parts", "each", "-sphere", "s%03d.ply"},
                     "part 2 of 'both.xyz' has no map to one sphere"},
                    {remesh_tool, {"torus.xyz", "out.ply", "-handles", "auto"}, cause},
                    {morph_tool, {"in.xyz", "torus.xyz", "out.ply", "-handles", "auto"}, cause}},
                   failed);
  write("tangle.xyz", tool_test::linesOf(spherical_param::test::terraces()));
  expectRefused(mesh_tool, {"tangle.xyz", "out.ply", "-sphere", "s.ply"}, failed,
                "'tangle.xyz' has no map to one sphere: it is a tangle");
  run(mesh_tool,
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
      {{mesh_tool, {"no.pcd", "out.ply"}, "No such file"},
       {mesh_tool, {"folder.ply", "out.ply"}, "is a directory"},
       {mesh_tool, {"pipe.ply", "out.ply"}, "not a regular file"},
       {mesh_tool, {"empty.ply", "out.ply"}, "is empty"},
       {mesh_tool, {"three.xyz", "out.ply"}, "at least 4"},
       {mesh_tool,
        {"in.xyz", "out.ply", "-parts", "each", "-min-points", "501"},
        "no part has min_points = 501"},
       {mesh_tool,
        {"flat.xyz", "out.ply", "-topology", "sphere"},
        "cannot mesh 'flat.xyz': all points lie in one plane"},
       {mesh_tool,
        {"outliers.xyz", "out.ply", "-topology", "sphere", "-outliers", "0"},
        "all points lie in one plane (left out: 1 stray point)"},
       {remesh_tool, {"no.xyz", "out.ply"}, "no.xyz"},
       {remesh_tool, {"no.tif", "out.ply"}, "no.tif"},
       {remesh_tool, {"in.tif", "out.ply"}, "in.tif"},
       {remesh_tool, {"flat.xyz", "out.ply"}, "cannot mesh 'flat.xyz'"},
       {remesh_tool,
        {"open.xyz", "out.tif", "-surface", "open"},
        "a geometry image has no openings"},
       {morph_tool, {"in.ply", "no.ply", "m.ply"}, "no.ply"},
       {morph_tool, {"in.ply", "flat.xyz", "m.ply"}, "cannot mesh 'flat.xyz'"},
       {morph_tool, {"in.ply", "in.xyz", "m.ply", "-pairs", "pairs.txt", "-quiet"}, "line 2"},
       {texture_tool, {"no.ply", "out.glb"}, "no.ply"}},
      failed);
}

TEST_F(BadInput, FilesThatCannotBeWrittenAreAFailureBeforeTheWork) {
  ASSERT_EQ(mkdir(directory.file("folder.ply").c_str(), 0755), 0);
  ASSERT_EQ(symlink("missing/out.ply", directory.file("dangling.ply").c_str()), 0);
  expectAllRefused(
      {{mesh_tool, {"in.xyz", "no/out.ply"}, "missing directory"},
       {mesh_tool, {"in.xyz", "in.xyz/out.ply"}, "out.ply"},
       {mesh_tool, {"in.xyz", "folder.ply"}, "is a directory"},
       {mesh_tool, {"in.xyz", "dangling.ply"}, "missing directory"},
       {mesh_tool, {"in.xyz", "out.ply", "-json", "no/r.json"}, "missing directory"},
       {remesh_tool, {"in.xyz", "no/out.ply"}, "missing directory"},
       {remesh_tool, {"in.xyz", "out.ply", "-harmonics", "no/c.json"}, "missing directory"},
       {morph_tool, {"in.ply", "in.xyz", "no/m.ply"}, "missing directory"},
       {texture_tool, {"in.ply", "no/out.glb"}, "missing directory"},
       {texture_tool, {"in.ply", "out.ply", "-image", "no/out.png"}, "missing directory"}},
      failed);
}

TEST_F(BadInput, FilesWithoutRightsAreAFailure) {
  RunOptions unprivileged;
  unprivileged.unprivileged = true;
  if (run(mesh_tool, {"-version"}, unprivileged).exit_code != 0)
    GTEST_SKIP() << "the tool is in a place that root alone may enter";
  ASSERT_EQ(mkdir(directory.file("closed").c_str(), 0555), 0);
  write("secret.xyz", "1 2 3\n");
  ASSERT_EQ(chmod(directory.file("secret.xyz").c_str(), 0000), 0);
  ASSERT_EQ(chmod(directory.file("kept.ply").c_str(), 0444), 0);
  for (const Words& files : std::vector<Words>{
           {"secret.xyz", "out.ply"}, {"in.xyz", "closed/out.ply"}, {"in.xyz", "kept.ply"}}) {
    SCOPED_TRACE(testing::PrintToString(files));
    expectRefused(mesh_tool, files, failed, "Permission denied", unprivileged);
  }
}

TEST_F(BadInput, AFullDiskIsAFailureAndKeepsTheOldFile) {
  // Room for no output; or for a mesh, but not for more.
  constexpr std::size_t small = 4000;
  constexpr std::size_t medium = 30000;
  const std::string full = "File too large";
  const std::vector<std::pair<Row, std::size_t>> cases = {
      {{mesh_tool, {"in.xyz", "kept.ply"}, "cannot write 'kept.ply': " + full}, small},
      {{mesh_tool, {"in.xyz", "kept.ply", "-sphere", "s.stl"}, "cannot write 's.stl': " + full},
       medium},
      {{mesh_tool,
        {"in.xyz", "kept.ply", "-json", "r.json", "-method", "paper", "-tolerance", "0"},
        "cannot write 'r.json': " + full},
       medium},
      {{remesh_tool, {"in.xyz", "kept.ply", "-harmonics", "c.json"}, full}, medium / 2},
      {{remesh_tool, {"in.xyz", "a.tif", "-side", "65"}, full}, medium},
      {{morph_tool, {"in.xyz", "in.ply", "m.ply", "-frames", "2"}, full}, small},
      {{texture_tool, {"in.ply", "kept.ply", "-size", "256"}, full}, small},
      {{texture_tool, {"in.ply", "a.obj", "-size", "256"}, full}, small},
      {{texture_tool, {"in.ply", "a.glb", "-size", "256"}, full}, small},
      {{scan_tool, {"sphere", "kept.ply"}, full}, small}};
  for (const auto& [row, bytes] : cases) {
    SCOPED_TRACE(row.tool + " " + testing::PrintToString(row.arguments));
    RunOptions options;
    options.file_size_limit = bytes;
    expectRefused(row.tool, row.arguments, failed, row.cause, options);
  }
}

TEST_F(BadInput, AFullStandardOutputIsAFailure) {
  RunOptions options;
  options.standard_output = "/dev/full";
  for (const Row& row : std::vector<Row>{{mesh_tool, {"in.xyz", "out.ply", "-json", "-"}, ""},
                                         {mesh_tool, {"in.xyz", "kept.ply"}, ""},
                                         {mesh_tool, {"-h"}, ""},
                                         {scan_tool, {"sphere", "out.pcd", "-points", "99"}, ""}}) {
    SCOPED_TRACE(row.tool + " " + testing::PrintToString(row.arguments));
    expectRefused(row.tool, row.arguments, failed, "standard output", options);
  }
}

}  // namespace
