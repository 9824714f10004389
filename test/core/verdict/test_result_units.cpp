#include "result_units.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

TEST(ResultUnits, PointsWithoutAVertexAreNotMerged) {
  Consolidation consolidation;
  consolidation.points = positionsOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  consolidation.point_of_input = {0, 0, 1, 1, 1, 2};  // 3 and 4 are equal
  consolidation.distinct_at = {2, 2, 1};
  consolidation.report.merged = 2;
  Surface surface;
  surface.vertex_of_input = {-1, 0, 1};
  surface.input_of_vertex = {1, 2};
  toInput(consolidation, surface);
  EXPECT_EQ(surface.input_of_vertex, (std::vector<Index>{2, 5}));
  EXPECT_EQ(surface.consolidation->merged, 1U);

  std::vector<Index> unmeshed;
  toCloud({}, {10, 11, 12, 13, 14, 15}, surface, unmeshed);
  EXPECT_EQ(unmeshed, (std::vector<Index>{10, 11}));
  EXPECT_EQ(surface.inputs, (std::vector<Index>{12, 13, 14, 15}));
  EXPECT_EQ(surface.input_of_vertex, (std::vector<Index>{12, 15}));
  EXPECT_EQ(surface.duplicates(), 1U);
}

}  // namespace
}  // namespace spherical_param::test
