#pragma once

#include "embedding.h"
#include "embedding_energy.h"
#include "graph_hierarchy.h"
#include "graphs.h"
#include "multilevel_embedding.h"
#include "spherical_param/sphere_triangulation.h"

/// A surface and short calls for the tests of the multilevel embedding and its parts.
namespace spherical_param::test {

/// An ellipsoid with dents and its true edges.
struct Cloud {
  Positions points;
  Graph graph;
};

inline Cloud dentedCloud(Index n) {
  const Positions sphere = spiralSphere(n);
  Cloud cloud;
  cloud.points = sphere;
  for (Index i = 0; i < n; ++i)
    cloud.points.col(i) *= 1.0 + 0.3 * std::sin(4.0 * sphere(0, i)) * std::cos(3.0 * sphere(1, i));
  cloud.points.row(2) *= 1.7;
  cloud.graph = graphOfMesh(cloud.points, triangulateSphere(sphere));
  return cloud;
}

struct Setting : EmbeddingOptions, Execution {};

inline Embedding embedByLevels(const Graph& graph, const GraphHierarchy& hierarchy,
                               const Setting& setting = {}) {
  return internal::embedByLevels(graph, hierarchy, setting, setting);
}

inline Embedding solve(const Graph& graph, const Setting& setting = {}, Index coarsest_size = 200,
                       std::uint32_t seed = 1) {
  return embedByLevels(graph, buildGraphHierarchy(graph, seed, coarsest_size), setting);
}

inline Setting converging(double tolerance) {
  Setting options;
  options.tolerance = tolerance;
  return options;
}

}  // namespace spherical_param::test
