// Every public function but reconstruct(): the first byte picks one. It is given any arguments.

#include "fuzz_stages.h"
#include "paper_method.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace fuzz {
namespace {

using namespace spherical_param;

void fuzzTriangulation(Bytes& bytes, const Positions& points, Watch& watch) {
  const bool is_by_qhull = bytes.oneIn(2);
  const bool is_raw = bytes.oneIn(8);
  const Positions sphere = is_raw ? points : normalized(points);
  const Execution execution = executionFrom(bytes, watch);
  const Triangles triangles = is_by_qhull ? internal::paper::convexHull(sphere, execution)
                                          : triangulateSphere(sphere, execution);
  require(isSphere(triangles, sphere), "the triangulation is a sphere over all points");
}

void fuzzOutliers(Bytes& bytes, const Positions& points, Watch& watch) {
  const auto n = static_cast<std::size_t>(points.cols());
  const auto are_points = [&](const std::vector<Index>& some) {
    return std::is_sorted(some.begin(), some.end()) &&
           stress::areLists({{0, some.size()}, some}, 1, n);
  };
  Options options;
  static_cast<Execution&>(options) = executionFrom(bytes, watch);
  options.outliers = bytes.choice<OutlierMode>(4);
  options.outlier_sigma = bytes.realOr(4.0);
  options.min_points = bytes.integerOr(8);
  const std::vector<Index> outliers = findOutliers(points, options);
  require(are_points(outliers), "outliers are points, in order");
  for (const std::vector<Index>& part : findParts(points, options)) {
    require(are_points(part), "parts are points, in order");
    for (const Index i : part)
      require(!std::binary_search(outliers.begin(), outliers.end(), i), "no outlier is in a part");
  }
}

/// Whether no coordinate has digits below 1e-100 of the largest one: intersections are then exact.
bool haveExactProducts(const Positions& points) {
  const double largest = points.size() > 0 ? points.cwiseAbs().maxCoeff() : 0.0;
  return (points.array() == 0.0 ||
          points.array().abs() * std::numeric_limits<double>::epsilon() / 2.0 >= 1e-100 * largest)
      .all();
}

void fuzzChecks(Bytes& bytes, const Positions& points, Watch& watch) {
  const Triangles triangles = trianglesFrom(bytes, normalized(points));
  const auto n = static_cast<std::size_t>(points.cols());
  const MeshTopology topology = checkTopology(triangles, n, bytes.integerOr(0));
  require(topology.isSphere() == isSphere(triangles, points), "the mesh is a sphere or not");
  measureMesh(points, triangles, bytes.integerOr(0));
  signedVolume(points, triangles);
  surfaceArea(points, triangles);
  areaWeightedNormals(points, triangles);
  Execution execution = executionFrom(bytes, watch);
  const auto pairs = findSelfIntersections(points, triangles, execution);
  require(std::is_sorted(pairs.begin(), pairs.end()), "pairs are in order");
  std::vector<Index> of;
  for (std::size_t i = bytes.below(8); i > 0; --i)
    of.push_back(bytes.index(static_cast<std::size_t>(triangles.cols())));
  execution.progress = {};
  const auto some = findSelfIntersectionsOf(points, triangles, of, execution);
  auto expected = pairs;
  const auto is_of = [&](Index t) { return std::find(of.begin(), of.end(), t) != of.end(); };
  expected.erase(
      std::remove_if(expected.begin(), expected.end(),
                     [&](const auto& pair) { return !is_of(pair[0]) && !is_of(pair[1]); }),
      expected.end());
  require(some == expected || !haveExactProducts(points),
          "the pairs of some triangles are those among all");
}

}  // namespace
}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fuzz;
  constexpr std::array<Call, 7> calls{fuzzTriangulation, fuzzOutliers, fuzzChecks,   fuzzSurface,
                                      fuzzTexture,       fuzzMorph,    fuzzHarmonics};
  Bytes bytes(data, size);
  const std::uint8_t which = bytes.byte();
  Watch watch(bytes);
  const std::size_t before = bytes.byte();
  // The points come last: a change of them moves no other byte.
  const std::size_t head = std::min<std::size_t>(size, 3 + 8 + before % 64);
  Bytes of_points(data + head, size - head);
  const Positions points = pointsFrom(of_points);
  std::string message;
  endingOf(
      watch, [&] { calls[which % calls.size()](bytes, points, watch); }, message);
  return 0;
}
