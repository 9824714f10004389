#include "formats/text_lines.h"

#include "common/cloud_reader.h"
#include "tool_runner.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

struct Case {
  const char* name;
  const char* extension;
  std::string text;
  bool has_normals;
  bool has_colors;
};

/// Each holds the points (1, 2, 3) and (4.5, -5, 6), with normals x and z and colours red and blue.
const std::vector<Case> cases = {
    {"Plain", "xyz", "1 2 3\n4.5 -5 +6", false, false},
    {"ColoursThenNormals", "xyz", "1 2 3 255 0 0 1 0 0\n4.5 -5 6 0 0 255 0 0 1\n", true, true},
    {"TitlesCommentsBlankLinesOtherSeparators", "txt",
     "# a comment\nx;y;z;nx;ny;nz;r;g;b\n1;2;3;1;0;0;255;0;0;more # end\r\n\n"
     "4.5,-5\t6;0;0;1;0;0;255;more\r\n",
     true, true},
    {"NumberOfPointsFirst", "xyz", "2\n1 2 3\n4.5 -5 6\n", false, false},
    {"ColumnsOfSomethingElse", "xyz", "1 2 3 0.5 7 8\n4.5 -5 6 1 2 3\n", false, false},
    {"ObjWithNormalsByFaces", "obj",
     "# test\no object\nv 1 2 3 1 0 0\nv 4.5 -5 6 0 0 1\nvn 0 0 1\nvn 1 0 0\n"
     "f 1//2 2/7/1 -1//-2\n",
     true, true},
    {"ObjWithNormalsInOrder", "obj", "v 1 2 3\nvn 1 0 0\nv 4.5 -5 6\nvn 0 0 1\n", true, false},
    {"ObjWithAVertexWithoutNormal", "obj", "v 1 2 3\nv 4.5 -5 6\nvn 1 0 0\nf 1//1 2 1//1\n", false,
     false},
    {"ObjWithColoursToTwoHundredAndFiftyFive", "obj", "v 1 2 3 255 0 0\nv 4.5 -5 6 0 0 255\n",
     false, true},
};

TEST(TextClouds, PointsNormalsAndColoursAreFoundInEveryNotation) {
  const tool_test::TemporaryDirectory directory;
  for (const Case& test : cases) {
    SCOPED_TRACE(test.name);
    const std::string path = directory.file(std::string("a.") + test.extension);
    tool_test::writeFile(path, test.text);
    const PointData data = readCloud(path);
    EXPECT_EQ(data.points, (std::vector<Point>{{1.0, 2.0, 3.0}, {4.5, -5.0, 6.0}}));
    const std::vector<Normal> normals = {{1.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
    EXPECT_EQ(data.normals, test.has_normals ? normals : std::vector<Normal>());
    const std::vector<Color> colors = {{255, 0, 0, 255}, {0, 0, 255, 255}};
    EXPECT_EQ(data.colors, test.has_colors ? colors : std::vector<Color>());
  }
}

TEST(TextClouds, NumbersBeyondTheRangeOfDoubleAreInfiniteOrZero) {
  const tool_test::TemporaryDirectory directory;
  const std::string zeros(400, '0');
  tool_test::writeFile(directory.file("a.xyz"),
                       "1" + zeros + " -1" + zeros + ".5 0." + zeros + "1\n1e400 -1e+400 1e-400\n");
  const PointData data = readCloud(directory.file("a.xyz"));
  ASSERT_EQ(data.points.size(), 2U);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const Point& point : data.points)
    EXPECT_EQ(point, (Point{infinity, -infinity, 0.0}));
}

}  // namespace
}  // namespace spherical_param::tools
