#include "common/point_pairs.h"

#include "common/errors.h"
#include "temporary_directory.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

/// Points at x = 0, 1, ...; of these the second is not meshed, and the last repeats the first.
CloudReconstruction cloudOf(int count) {
  CloudReconstruction cloud;
  Surface& surface = cloud.result.surfaces.emplace_back();
  auto data = std::make_shared<PointData>();
  for (int i = 0; i < count; ++i) {
    data->points.push_back({i + 1 < count ? static_cast<double>(i) : 0.0, 0.0, 0.0});
    if (i == 1)
      continue;
    surface.inputs.push_back(i);
    const bool repeats = i + 1 == count;
    surface.vertex_of_input.push_back(repeats ? 0 : static_cast<Index>(surface.vertexCount()));
    if (!repeats)
      surface.input_of_vertex.push_back(i);
  }
  cloud.data = data;
  return cloud;
}

class PointPairs : public testing::Test {
protected:
  std::vector<FilePair> read(const std::string& text) const {
    tool_test::writeFile(path, text);
    return readPointPairs(path, first, second);
  }

  const tool_test::TemporaryDirectory directory;
  const std::string path = directory.file("pairs.txt");
  const CloudReconstruction first = cloudOf(10);
  const CloudReconstruction second = cloudOf(20);
};

TEST_F(PointPairs, AreNumbersOrTheNearestVerticesAndKnowTheirLines) {
  const std::vector<FilePair> pairs =
      read("# the top, then the bottom\n2 3\n\n  9, 1 # a repeated one, and one that is no vertex\n"
           "3.4 0.1 0 ; 1.1 5 0\r\n0 19");
  // By line, points and vertices. The nearest to 1.1 that is a vertex is the point at 2.
  const std::vector<std::pair<std::size_t, std::array<int, 4>>> expected = {
      {2, {2, 3, 1, 2}}, {4, {9, 1, 0, -1}}, {5, {3, 2, 2, 1}}, {6, {0, 19, 0, 0}}};
  ASSERT_EQ(pairs.size(), expected.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::array<int, 4> pair{pairs[i].points[0], pairs[i].points[1], pairs[i].vertices[0],
                                  pairs[i].vertices[1]};
    EXPECT_EQ(pairs[i].line, expected[i].first);
    EXPECT_EQ(pair, expected[i].second) << i;
  }
}

TEST_F(PointPairs, WrongOnesAreRefusedWithTheirLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "is empty"},
      {"1 2\n1\n", "line 2: 1 word make"},
      {"# nothing\n1 2 3\n", "line 2"},
      {"1 2 3 4 5 6 7", "line 1"},
      {"\n\n1 two", "line 3: words like 'two'"},
      {"1.5 2", "line 1"},
      {"10 2", "unknown point '10' in a cloud of 10"},
      {"2 -1", "unknown point '-1' in a cloud of 20"},
      {"1 2 3 4 5 nan", "line 1"},
  };
  for (const auto& [text, cause] : cases) {
    try {
      read(text);
      ADD_FAILURE() << text;
    } catch (const Failure& failure) {
      EXPECT_NE(std::string(failure.what()).find(cause), std::string::npos) << failure.what();
      EXPECT_FALSE(failure.remedy().empty());
    }
  }
}

}  // namespace
}  // namespace spherical_param::tools
