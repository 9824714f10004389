#include "surface_plan.h"

#include "graphs.h"
#include "handle_shapes.h"
#include "open_shapes.h"

namespace spherical_param::test {
namespace {

SurfacePlan planOf(const Positions& points, const Graph& graph, SurfaceMode surface) {
  Options options;
  options.surface = surface;
  StageClock clock(options);
  return {points, graph, false, 1.0, options, clock};
}

TEST(SurfacePlan, FacesHaveTheHandlesOfTheCloud) {
  const Positions line = Eigen::Vector3d::UnitX() * Eigen::RowVectorXd::LinSpaced(20, 0.0, 19.0);
  for (const auto& [points, genus] : {std::pair(spiralSphere(500), 0),
                                      {torusCloud(40, 16), 1},
                                      {doubleTorus(0.15), 2},
                                      {gear(0.08), 1},
                                      {line, -1}}) {
    const Graph graph = localDelaunayGraph(points).graph;
    SurfacePlan plan = planOf(points, graph, SurfaceMode::Auto);
    EXPECT_FALSE(plan.openings().isOpen());
    const SphereMesh* faces = plan.faces();
    EXPECT_EQ(plan.faces(), faces);  // found once
    ASSERT_EQ(faces == nullptr, genus < 0);
    EXPECT_TRUE(genus < 0 || isSurfaceOverAll(withAllNodes(points, graph, *faces).triangles(),
                                              static_cast<Index>(points.cols()), genus));
  }
  EXPECT_EQ(SurfacePlan().faces(), nullptr);
}

TEST(SurfacePlan, OpeningsAreLeftOpenAsTheOptionsSay) {
  for (const auto& [radius, fills_auto] : {std::pair(0.15, true), {0.4, false}}) {
    const Positions points = sphereWithHoles(3000, 1, radius);
    const Graph graph = localDelaunayGraph(points).graph;
    for (const SurfaceMode surface : {SurfaceMode::Closed, SurfaceMode::Auto, SurfaceMode::Open}) {
      const OpenSurface openings = planOf(points, graph, surface).openings();
      const bool fills =
          surface == SurfaceMode::Closed || (surface == SurfaceMode::Auto && fills_auto);
      EXPECT_EQ(openings.isOpen(), !fills);
      EXPECT_EQ(openings.fillsPossible(), fills);
      EXPECT_EQ(openings.embeddedOpenings().openings.size(), 1U);
    }
  }
}

}  // namespace
}  // namespace spherical_param::test
