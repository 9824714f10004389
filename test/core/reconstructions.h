#pragma once

#include "open_shapes.h"
#include "spherical_param/errors.h"
#include "spherical_param/option_table.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>

/// Clouds, options and checks for tests of reconstruct().
namespace spherical_param::test {

inline Positions ellipsoid(Index n) {
  return Eigen::Vector3d(1.0, 0.7, 0.5).asDiagonal() * spiralSphere(n);
}

/// A sphere with noise [distance of its points].
inline Positions noisySphere(Index n, double noise) {
  return withNoise(spiralSphere(n), noise * sphereSpacing(n), 7);
}

/// Two spheres with a gap between them.
inline Positions twoSpheres(Index n, Index m, double distance) {
  return horizontally(spiralSphere(n), movedTo(distance, spiralSphere(m)));
}

/// The same cloud several times, side by side along x.
inline Positions inARow(int count, double distance, const Positions& cloud) {
  return gridOf(count, static_cast<int>(cloud.cols()), [&](int i, int j) {
    return Eigen::Vector3d(cloud.col(j) + distance * i * Eigen::Vector3d::UnitX());
  });
}

/// Options by the names that the tools have for them: given("surface", "open", "smoothing", 3).
inline Options given(Options options) {
  return options;
}
template <typename Value, typename... More>
Options given(Options options, const char* name, const Value& value, const More&... more) {
  if constexpr (std::is_integral_v<Value>)
    setOption(options, name, std::int64_t{value});
  else
    setOption(options, name, value);
  return given(options, more...);
}
template <typename... More>
Options given(const char* name, const More&... more) {
  return given(Options(), name, more...);
}

/// One sphere through every point.
inline Options sphere(Options options = {}) {
  options.topology = TopologyMode::Sphere;
  return options;
}

/// The method as it was published.
inline Options paper() {
  return given("method", "paper");
}

/// Both methods, for one sphere.
inline std::vector<Options> bothMethods() {
  return {sphere(), paper()};
}

/// For clouds that cannot be meshed well: without the search for a better mesh.
inline Options quick(Options options = {}) {
  options.time_limit = 0.0;
  return options;
}

/// The options, with the details.
inline Options withDetails(Options options = {}) {
  options.details = true;
  return options;
}

/// The surface of a cloud.
inline Surface surfaceOf(const Positions& points, const Options& options = {},
                         const NeighborSearchFactory& search_of = {}) {
  return reconstruct(points, options, search_of).surface();
}

/// The same with neighbours by brute force.
inline Surface mesh(const Positions& points, const Options& options = {}) {
  return surfaceOf(points, options, bruteForceFactory(points));
}

inline Positions verticesOf(const Positions& points, const Surface& result) {
  return points(Eigen::all, result.input_of_vertex);
}

inline bool isFound(const Surface& result, const std::string& text) {
  return std::any_of(result.findings.begin(), result.findings.end(), [&](const Finding& finding) {
    return finding.text.find(text) != std::string::npos;
  });
}

/// Everything that is promised for any input.
inline void expectGuarantees(const Positions& points, const Surface& result) {
  const auto v = static_cast<Index>(result.vertexCount());
  EXPECT_TRUE(isSphereOverAll(result.triangles, v));
  EXPECT_TRUE(result.topology.isSphere());
  if (result.sphere.cols() > 0) {
    ASSERT_EQ(result.sphere.cols(), v);
    EXPECT_LT((result.sphere.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-14);
  }
  ASSERT_EQ(result.vertex_of_input.size(), static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i) {
    const Index vertex = result.vertex_of_input[static_cast<std::size_t>(i)];
    ASSERT_TRUE(vertex >= 0 && vertex < v);
    const Index first = result.input_of_vertex[static_cast<std::size_t>(vertex)];
    EXPECT_LE(first, i);
    EXPECT_EQ(points.col(i), points.col(first));
  }
  EXPECT_EQ(result.duplicates(), static_cast<std::size_t>(points.cols() - v));
  Positions vertices = result.points;
  if (!result.smoothing) {
    EXPECT_EQ(vertices, verticesOf(points, result));
  }
  EXPECT_EQ(result.self_intersections, findSelfIntersections(vertices, result.triangles));
  EXPECT_FALSE(result.verdict.empty());
  vertices.colwise() -= Eigen::Vector3d(vertices.col(0));
  const double rounding = 1e-9 * std::pow(vertices.colwise().norm().maxCoeff(), 3.0);
  EXPECT_NEAR(result.measures.volume, volumeOf(vertices, result.triangles), rounding);
  EXPECT_GE(result.measures.volume, 0.0);
}

/// A surface in one piece over all vertices, without intersections, of a genus and with a number of
/// openings, the longest first, whose loops are those of boundaryOf().
inline void expectSound(const Surface& result, Index genus, std::size_t openings) {
  EXPECT_TRUE(result.topology.isSurface());
  EXPECT_EQ(result.topology.genus, genus);
  EXPECT_EQ(result.genus(), static_cast<std::size_t>(genus));
  EXPECT_EQ(result.topology.euler_characteristic, 2 - 2 * genus - static_cast<long long>(openings));
  EXPECT_TRUE(result.self_intersections.empty());
  // There is no map of a handle to a sphere.
  EXPECT_TRUE(result.sphere.cols() == 0 ||
              (genus == 0 && result.sphere.cols() == result.points.cols()));
  EXPECT_EQ(result.boundary.size(), openings);
  EXPECT_EQ(result.isClosed(), openings == 0);
  if (openings == 0) {
    EXPECT_TRUE(
        isSurfaceOverAll(result.triangles, static_cast<Index>(result.vertexCount()), genus));
    EXPECT_GT(result.measures.volume, 0.0);
  }
  const std::map<Index, Index> next = boundaryOf(result.triangles);
  std::size_t vertices = 0;
  for (const std::vector<Index>& loop : result.boundary) {
    EXPECT_EQ(loop.front(), *std::min_element(loop.begin(), loop.end()));
    EXPECT_LE(loop.size(), result.boundary.front().size());
    for (std::size_t i = 0; i < loop.size(); ++i)
      EXPECT_EQ(next.at(loop[i]), loop[(i + 1) % loop.size()]);
    vertices += loop.size();
  }
  EXPECT_EQ(vertices, next.size());
}

}  // namespace spherical_param::test
