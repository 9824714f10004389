// Every generated shape, with every weight and by several methods, becomes a sphere through all of
// its points, even where the shape is no sphere.

#include "reference/mesh_topology.h"
#include "scan_shapes.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/reconstruct.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

namespace spherical_param::tools {
namespace {

constexpr std::size_t point_count = 1000;

enum class Method { Default, Converged, Paper };

using Case = std::tuple<ShapeInfo, EdgeWeights, Method>;

class ShapesAreMeshed : public testing::TestWithParam<Case> {};

std::string nameOfCase(const testing::TestParamInfo<Case>& info) {
  const char* const weights[] = {"Uniform", "Inverse", "Adaptive"};
  const char* const methods[] = {"ByDefault", "Converged", "AsInThePaper"};
  return std::string(std::get<0>(info.param).name) + "With" +
         weights[static_cast<std::size_t>(std::get<1>(info.param))] +
         methods[static_cast<std::size_t>(std::get<2>(info.param))];
}

Options optionsOf(EdgeWeights weights, Method method) {
  Options options;
  options.embedding.weights = weights;
  if (method == Method::Converged) {
    options.embedding.tolerance = 1e-8;
  }
  // The whole optimisation once for each shape: it takes longest where it is in vain.
  if (method != Method::Default || weights != EdgeWeights::Adaptive) {
    options.optimization.method = OptimizationMethod::Flips;
  }
  if (method == Method::Paper) {
    options.graph.method = GraphMethod::NearestNeighbors;
    options.embedding.method = EmbeddingMethod::Iterative;
    options.embedding.max_iterations = 100;
    options.triangulation.method = TriangulationMethod::Qhull;
    options.optimization.method = OptimizationMethod::None;
  }
  return options;
}

TEST_P(ShapesAreMeshed, AsAClosedOutwardSphereThroughAllPoints) {
  const auto& [shape, weights, method] = GetParam();
  ScanOptions options;
  options.shape = shape.shape;
  options.points = point_count;
  const Scan scan = generateScan(options);
  const Result result = reconstruct(scan.points, optionsOf(weights, method));
  EXPECT_EQ(result.vertexCount(), point_count);
  const MeshTopology topology =
      reference::topologyOf(result.triangles, static_cast<Index>(point_count));
  const TopologyFaults& faults = topology.faults;
  EXPECT_TRUE(faults.boundary_edges.empty() && faults.nonmanifold_edges.empty() &&
              faults.misoriented_edges.empty() && faults.nonmanifold_vertices.empty() &&
              faults.degenerate_triangles.empty() && faults.unused_vertices.empty());
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler_characteristic, 2);
  EXPECT_GT(measureMesh(scan.points, result.triangles).volume, 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    AllShapes, ShapesAreMeshed,
    testing::Combine(
        testing::ValuesIn(std::vector<ShapeInfo>(allShapes().begin(), allShapes().end())),
        testing::Values(EdgeWeights::Uniform, EdgeWeights::InverseLength, EdgeWeights::Adaptive),
        testing::Values(Method::Default, Method::Converged, Method::Paper)),
    nameOfCase);

}  // namespace
}  // namespace spherical_param::tools
