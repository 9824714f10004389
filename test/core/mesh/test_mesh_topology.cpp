#include "spherical_param/mesh_topology.h"

#include "helpers.h"

#include <gtest/gtest.h>

namespace spherical_param::test {
namespace {

Triangles joined(const Triangles& a, const Triangles& b) {
  Triangles result(3, a.cols() + b.cols());
  result << a, b;
  return result;
}

/// The number of classes of some triangles: those that are joined are in one.
std::size_t countClasses(const std::vector<Eigen::Index>& triangles,
                         const std::function<bool(Eigen::Index, Eigen::Index)>& are_joined) {
  std::vector<std::size_t> class_of(triangles.size());
  std::iota(class_of.begin(), class_of.end(), 0U);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const auto [from, to] = std::pair(class_of[i], class_of[j]);
          are_joined(triangles[i], triangles[j]))
        std::replace(class_of.begin(), class_of.end(), from, to);
  return std::set<std::size_t>(class_of.begin(), class_of.end()).size();
}

/// From the definitions: a table of edges, and triangles that hang together by vertices, and around
/// a vertex by edges.
void expectTopologyByDefinition(const Triangles& triangles, Index n) {
  const MeshTopology topology = checkTopology(triangles, static_cast<std::size_t>(n));
  std::map<std::pair<Index, Index>, std::vector<bool>> edges;  // whether a side runs upwards
  std::map<Index, std::vector<Eigen::Index>> at;
  std::map<Index, std::vector<Eigen::Index>> around;  // without those that have a vertex twice
  std::vector<Eigen::Index> all;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    all.push_back(t);
    const Eigen::Matrix<Index, 3, 1> v = triangles.col(t);
    for (const Index w : v)
      at[w].push_back(t);
    if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0])
      for (int k = 0; k < 3; ++k) {
        edges[std::minmax({v[k], v[(k + 1) % 3]})].push_back(v[k] < v[(k + 1) % 3]);
        around[v[k]].push_back(t);
      }
  }
  const auto common = [&](Eigen::Index t, Eigen::Index u) {
    int count = 0;
    for (const Index v : triangles.col(t))
      count += (triangles.col(u).array() == v).any() ? 1 : 0;
    return count;
  };
  bool is_closed = triangles.cols() > 0;
  bool is_manifold = true;
  bool is_oriented = true;
  for (const auto& [edge, sides] : edges) {
    is_closed = is_closed && sides.size() > 1;
    is_manifold = is_manifold && sides.size() <= 2;
    is_oriented = is_oriented && (sides.size() == 1 || (sides.size() == 2 && sides[0] != sides[1]));
  }
  std::vector<Index> unused;
  std::vector<Index> nonmanifold;
  std::size_t whole = 0;  // triangles of three vertices
  for (Index v = 0; v < n; ++v) {
    if (at.count(v) == 0)
      unused.push_back(v);
    whole += around[v].size();
    const auto share_edge = [&](Eigen::Index t, Eigen::Index u) { return common(t, u) > 1; };
    if (countClasses(around[v], share_edge) > 1)
      nonmanifold.push_back(v);
  }
  EXPECT_EQ(topology.vertices, at.size());
  EXPECT_EQ(topology.edges, edges.size());
  EXPECT_EQ(topology.triangles, all.size());
  EXPECT_EQ(topology.components,
            countClasses(all, [&](Eigen::Index t, Eigen::Index u) { return common(t, u) > 0; }));
  EXPECT_EQ(topology.euler_characteristic,
            static_cast<long long>(at.size() + all.size()) - static_cast<long long>(edges.size()));
  EXPECT_EQ(topology.closed, is_closed);
  EXPECT_EQ(topology.edge_manifold, is_manifold && whole == 3 * all.size());
  EXPECT_EQ(topology.vertex_manifold, nonmanifold.empty());
  EXPECT_EQ(topology.oriented, is_oriented);
  EXPECT_EQ(topology.genus.has_value(), !all.empty() && topology.manifold() && is_oriented);
  if (topology.genus && is_closed) {
    EXPECT_EQ(topology.euler_characteristic,
              2 * static_cast<long long>(topology.components) - 2 * *topology.genus);
  }
  EXPECT_EQ(topology.isSphere(), isSphereOverAll(triangles, n));
  EXPECT_EQ(topology.nonmanifold_vertices, nonmanifold);
  EXPECT_EQ(topology.unused_vertices, unused);
}

TEST(MeshTopology, AgreesWithItsDefinitionOnRandomTrianglesAndDamagedSurfaces) {
  expectTopologyByDefinition(tetrahedron(), 4);
  expectTopologyByDefinition(torusTriangles(5, 5), 25);
  std::mt19937 random(5);
  for (int run = 0; run < 2000; ++run) {
    SCOPED_TRACE(run);
    // From a few triangles apart to many more than fit around so few vertices.
    const Index n = 3 + static_cast<Index>(random() % 12);
    Triangles triangles(3, static_cast<Eigen::Index>(random() % 60));
    for (Index& v : triangles.reshaped())
      v = static_cast<Index>(random() % unsigned(n));
    expectTopologyByDefinition(triangles, n);
    if (run % 7 != 0)
      continue;
    triangles = joined(torusTriangles(4, 4), joined(tetrahedron(16), tetrahedron(20)));
    for (int change = 0; change < run % 4; ++change)
      triangles.data()[random() % static_cast<unsigned>(triangles.size())] =
          static_cast<Index>(random() % 25);
    expectTopologyByDefinition(triangles, 25);
  }
}

}  // namespace
}  // namespace spherical_param::test
