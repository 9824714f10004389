#include "formats/text_lines.h"

#include "common/cloud_reader.h"
#include "common/errors.h"
#include "temporary_directory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

PointData read(const std::string& extension, const std::string& text,
               const std::vector<std::string>& columns = {}) {
  const tool_test::TemporaryDirectory directory;
  tool_test::writeFile(directory.file("a." + extension), text);
  return readCloud(directory.file("a." + extension), {}, columns);
}

struct Case {
  const char* name;
  const char* extension;
  std::string text;
  std::string further = "";  ///< n: it has normals, c: colours
};

const std::string byte_order_mark = "\xef\xbb\xbf";

template <typename... Values>
std::string bytes(Values... values) {
  std::string text;
  (text.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return text;
}

std::string binaryStl() {
  return "solid" + std::string(75, ' ') + bytes(std::uint32_t{1}) +
         bytes(0.0F, 0.0F, 1.0F, 1.0F, 2.0F, 3.0F, 4.5F, -5.0F, 6.0F, 1.0F, 2.0F, 3.0F) + "..";
}

/// Each holds the points (1, 2, 3) and (4.5, -5, 6), with normals x and z and colours red and blue.
const std::vector<Case> cases = {
    {"ColoursThenNormals", "xyz", "1 2 3 255 0 0 1 0 0\n4.5 -5 6 0 0 255 0 0 1\n", "nc"},
    {"HeadingCommentsBlankLines", "txt",
     "# a comment\nx;y;z;nx;ny;nz;r;g;b\n1;2;3;1;0;0;255;0;0; # end\r\n\n"
     "4.5;-5;6;0;0;1;0;0;255\r\n",
     "nc"},
    {"ColoursToOneByExtension", "xyzrgb", "1 2 3 1 0 0\n4.5 -5 6 0 0 1\n", "c"},
    {"RowsThatSemicolonsEnd", "txt", "1 2 3;\n4.5 -5 6;\n"},
    {"ColourThatIsNotComplete", "pcd",
     "FIELDS x y z red\nWIDTH 2\nDATA ascii\n1 2 3 255\n4.5 -5 6 0\n"},
    {"PcdWithCommas", "pcd", "FIELDS x, y, z\nWIDTH 2\nDATA ascii\n1,2,3\n4.5, -5, 6\n"},
    {"OffOfModelNet", "off", "OFF2 0 0\n1 2 3\n4.5 -5 6\n"},
    {"NumberOfPointsFirst", "xyz", "2\n1 2 3\n4.5 -5 6\n"},
    {"ByteOrderMarkDecimalCommasSemicolons", "txt",
     byte_order_mark + "1,0;2,0;3,0\n4,5;-5,0;6,0\n"},
    {"DecimalCommasBlanks", "xyz", "1,0 2,0 3,0\n4,5 -5,0 6,0\n"},
    {"DecimalCommasInQuotes", "csv", "\"1,0\",\"2,0\",\"3,0\"\n\"4,5\",\"-5,0\",\"6,0\"\n"},
    {"DecimalCommasUnderAHeading", "csv", "x,y,z\n1,0,2,0,3,0\n4,5,-5,0,6,0\n"},
    {"CommasAndBlanks", "csv", "1.0, 2.0, 3.0,\n4.5, -5.0, 6.0,\n"},
    {"IntensityThenColours", "pts", "2\n1 2 3 17 255 0 0\n4.5 -5 6 80 0 0 255\n", "c"},
    {"ColoursThenIntensity", "xyzrgb", "1 2 3 255 0 0 0.5\n4.5 -5 6 0 0 255 -7\n", "c"},
    {"NormalsAlone", "xyzn", "1 2 3 1 0 0\n4.5 -5 6 0 0 1\n", "n"},
    {"CloudCompare", "asc",
     "//X Y Z R G B Nx Ny Nz\n2\n1 2 3 255 0 0 1 0 0\n4.5 -5 6 0 0 255 0 0 1\n", "nc"},
    {"HeadingWithUnits", "txt", "Id X [mm] Y [mm] Z [mm]\n7 1 2 3\n8 4.5 -5 6\n"},
    {"ParaView", "csv",
     "\"time\",\"Points_m_XYZ:0\",\"Points_m_XYZ:1\",\"Points_m_XYZ:2\"\n7,1,2,3\n8,4.5,-5,6\n"},
    {"RowNumbersWords", "csv", ",x,y,z,class\n0,1,2,3,tree\n1,4.5,-5,6,\n"},
    {"AllComments", "xyz", "% a\n; b\n// c\n# x y z\n1 2 3\n4.5 -5 6\n"},
    {"CommentsAtTheEnd", "xyz", "; a; b\n1 2 3 ; a, b\n4.5 -5 6 // c\n"},
    {"SeparatorOfExcel", "csv", "sep=;\n1,0;2,0;3,0\n4,5;-5;6\n"},
    {"ObjNamedText", "txt", "v 1 2 3\nv 4.5 -5 6\n"},
    {"PcdWithByteOrderMark", "pcd",
     byte_order_mark + "FIELDS x y z\nWIDTH 2\nDATA ASCII\n1 2 3\n4.5 -5 6\n"},
    {"ExponentsOfFortran", "xyz", "1.0D+00 2d0 0.3D1\n4.5 -5 6\n"},
    {"TextOfUnknownExtension", "dat", "1 2 3\n4.5 -5 6\n"},
    {"PlyOfUnknownExtensionWithListsWordsAndLongIntegers", "dat",
     "ply\nformat ascii 1.0\nelement vertex 2\nproperty list uchar int views\nproperty float X\n"
     "property string name\nproperty int64 time\nproperty float Y\nproperty float "
     "Z\nend_header\n2 5 6 1 a 7 2 3\n0 4.5 b 8 -5 6\n"},
    {"PcdWithDecimalCommas", "pcd", "FIELDS x y z\nWIDTH 2\nDATA ascii\n1,0 2,0 3,0\n4,5 -5,0 6\n"},
    {"PcdWithoutWidthAndATypeOfColour", "pcd",
     "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F\nHEIGHT 1\nPOINTS 2\nDATA binary\n" +
         bytes(1.0F, 2.0F, 3.0F, 0xff0000U, 4.5F, -5.0F, 6.0F, 0xffU),
     "c"},
    {"PcdWithAFieldOfUnknownType", "pcd",
     "FIELDS x y z a\nTYPE F F F\nPOINTS 2\nDATA ascii\n1 2 3 9\n4.5 -5 6 9\n"},
    {"NodesOfTetGen", "node", "# a\n2 3 1 0\n0 1 2 3 7\n1 4.5 -5 6 7\n# b\n"},
    {"NumberedFromOneUnderTheirNumber", "csv", "2\n1,1,2,3\n2,4.5,-5,6\n"},
    {"BetweenBeginAndEnd", "pts", "BEGIN\n1 2 3\n4.5 -5 6\nEND\n"},
    {"LettersBeforePoints", "pts", "# a\nd 1 1 1\np 1 2 3\ns 1\np\t4.5 -5 6\n"},
    {"NamesOfMaps", "csv", "Northing,Easting,Lat,Elevation [m]\n2,1,50,3\n-5,4.5,50,6\n"},
    {"NamesOfCoordinates", "txt", "Point_Y X_UTM z speed\n2 1 3 9\n-5 4.5 6 9\n"},
    {"RowsThatGoOn", "txt", "#  ID, X, Y, Z, TRACK[] as (A, B)\n7 1 2 3 1 4\n5 4.5 -5 6 1 4 2 8\n"},
    {"Off", "off", "# a\nOFF 2 1 0\n\n1 2 3\n# b\n4.5 -5 6\n2 0 1\n"},
    {"OffWithNormalsAndColoursOfUnknownExtension", "dat",
     "CNOFF\n2 0 0\n1 2 3 1 0 0 255 0 0 255\n4.5 -5 6 0 0 1 0 0 255 255\n", "nc"},
    {"StlAsText", "stl",
     "solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\nVERTEX 4.5 -5 6\nvertex 1 2 3\n"},
    {"StlBinary", "stl", binaryStl()},
    {"GridOfEsri", "asc",
     "ncols 2\nNROWS 2\nxllcorner -0.75\nyllcenter -5\ndx 3.5\ndy 7\nnodata_value -1\n3 -1 "
     "-1\n6\n"},
    {"ColumnsOfSomethingElse", "xyz", "1 2 3 0.5 7 8\n4.5 -5 6 1 2 3\n"},
    {"ObjWithNormalsByFaces", "obj",
     "# test\no object\nv 1 2 3 1 0 0\nv 4.5 -5 6 0 0 1\nvn 0 0 1\nvn 1 0 0\n"
     "f 1//2 2/7/1 -1//-2\n",
     "nc"},
    {"ObjOfUnknownExtensionWithNormalsInOrder", "dat", "v 1 2 3\nvn 1 0 0\nv 4.5 -5 6\nvn 0 0 1\n",
     "n"},
    {"ObjWithAVertexWithoutNormal", "obj", "v 1 2 3\nv 4.5 -5 6\nvn 1 0 0\nf 1//1 2 1//1\n"},
    {"ObjWithColoursToTwoHundredAndFiftyFive", "obj", "v 1 2 3 255 0 0\nv 4.5 -5 6 0 0 255\n", "c"},
};

TEST(TextClouds, PointsNormalsAndColoursAreFoundInEveryNotation) {
  for (const Case& test : cases) {
    SCOPED_TRACE(test.name);
    const PointData data = read(test.extension, test.text);
    EXPECT_EQ(data.points, (std::vector<Point>{{1.0, 2.0, 3.0}, {4.5, -5.0, 6.0}}));
    const std::vector<Normal> normals = {{1.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 1.0F}};
    EXPECT_EQ(data.normals, test.further[0] == 'n' ? normals : std::vector<Normal>());
    const std::vector<Color> colors = {{255, 0, 0, 255}, {0, 0, 255, 255}};
    EXPECT_EQ(data.colors,
              test.further.find('c') != std::string::npos ? colors : std::vector<Color>());
  }
}

TEST(TextClouds, ColumnsCanBeNamedAndAreSaid) {
  const PointData data = read("txt", "z q x y red green blue\n3 9 1 2 4 5 6\n",
                              {"x", "y", "-", "z", "nx", "ny", "nz"});
  EXPECT_EQ(data.points, (std::vector<Point>{{3.0, 9.0, 2.0}}));
  EXPECT_EQ(data.normals, (std::vector<Normal>{{4.0F, 5.0F, 6.0F}}));
  EXPECT_EQ(data.contents, "text, 7 columns: x y - z nx ny nz, separated by blanks");
  const std::string commas = "1,0,2,0,3,0\n4,5,5,0,6,0\n";
  EXPECT_EQ(read("csv", commas, {"x", "y", "z"}).points[1], (Point{4.5, 5.0, 6.0}));
  EXPECT_EQ(read("csv", commas, {"x", "y", "z", "-", "-", "-"}).points[1], (Point{4.0, 5.0, 5.0}));
  EXPECT_EQ(read("csv", "1,2,3\n4,5,6\n").contents, "text, 3 columns: x y z, separated by commas");
  EXPECT_EQ(parseColumns("x,y, z"), (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_THROW(parseColumns("x,y"), UsageError);
  EXPECT_THROW(read("obj", "v 1 2 3\n", {"x", "y", "z"}), UsageError);
}

TEST(TextClouds, OtherColumnsAreScalars) {
  const PointData data = read("txt", "x y z \"Scalar field\" time\n1 2 3 0.5 1700000000.25\n");
  ASSERT_EQ(data.scalars.size(), 2U);
  EXPECT_EQ(data.scalars[0].name, "Scalar_field");
  EXPECT_FALSE(data.scalars[0].is_double);
  EXPECT_TRUE(data.scalars[1].is_double);
  EXPECT_EQ(data.scalars[1].values, (std::vector<double>{1700000000.25}));
  EXPECT_EQ(read("pts", "1 2 3 -700 1 2 3\n").scalars[0].name, "intensity");
}

TEST(TextClouds, AnIntensityMayStandAnywhereAmongColoursAndNormals) {
  for (const char* const line : {"1 2 3 0.5 7 8 9 0 0 1", "1 2 3 7 8 9 0.5 0 0 1",
                                 "1 2 3 7 8 9 0 0 1 0.5", "1 2 3 0 0 1 0.5 7 8 9"}) {
    const PointData data = read("asc", std::string(line) + "\n");
    ASSERT_EQ(data.scalars.size(), 1U) << line;
    EXPECT_EQ(data.scalars[0].values, (std::vector<double>{0.5})) << line;
    EXPECT_EQ(data.normals, (std::vector<Normal>{{0.0F, 0.0F, 1.0F}})) << line;
    EXPECT_EQ(data.colors.size(), 1U) << line;
  }
}

TEST(TextClouds, NumbersBeyondTheRangeOfDoubleAreInfiniteOrZeroAndWordsForNoNumberNotFinite) {
  const std::string zeros(400, '0');
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const std::string& large : {"1" + zeros + " -1" + zeros + ".5 0." + zeros + "1\n",
                                   std::string("1e400 -1e+400 1e-400\n")})
    EXPECT_EQ(read("xyz", large).points[0], (Point{infinity, -infinity, 0.0}));
  for (const Point& point : read("csv", "x,y,z\n1.#QNAN,-1.#IND,1.#INF\n-nan(ind),NULL,\n").points)
    for (const double value : point)
      EXPECT_FALSE(std::isfinite(value));
}

}  // namespace
}  // namespace spherical_param::tools
