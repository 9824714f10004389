#include "boundary_loops.h"
#include "corner_table.h"
#include "index_loops.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/self_intersection.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;

constexpr int kMaxRounds = 100;
constexpr int kSweepsOfRound = 5;

using Pairs = std::vector<std::array<Index, 2>>;

/// Slides vertices of a mesh along its surface.
class Sliding {
public:
  Sliding(const SphereSurface& surface, ResampledMesh& mesh, int threads)
      : surface_(surface), mesh_(mesh), threads_(threads),
        corners_(mesh.triangles, internal::columnCount(mesh.points), threads),
        moved_(internal::columnCount(mesh.points), 0), is_fixed_(moved_) {
    if (surface.isOpen())
      for (const std::vector<Index>& loop :
           internal::boundaryLoops(mesh.triangles, is_fixed_.size()))
        for (const Index v : loop)
          is_fixed_[v] = 1;
  }

  UntanglingReport run() {
    Execution options;
    options.threads = threads_;
    Pairs pairs = findSelfIntersections(mesh_.points, mesh_.triangles, options);
    UntanglingReport report;
    report.before = pairs.size();
    report.after = pairs.size();
    ResampledMesh best;
    internal::Indexed<char> moved_of_best;
    for (; !pairs.empty() && report.rounds < kMaxRounds; ++report.rounds) {
      if (best.points.cols() == 0) {
        best = mesh_;
        moved_of_best = moved_;
      }
      // Two rings around the triangles that intersect, and one more after every ten rounds.
      const std::vector<Index> zone = around(pairs, 2 + report.rounds / 10);
      for (int sweep = 0; sweep < kSweepsOfRound; ++sweep)
        for (const Index v : zone)
          slide(v);
      // Pairs that were there are among those of the zone.
      pairs = findSelfIntersectionsOf(mesh_.points, mesh_.triangles, trianglesAt(zone), options);
      if (pairs.size() < report.after) {
        report.after = pairs.size();
        best = mesh_;
        moved_of_best = moved_;
      }
    }
    if (report.rounds > 0) {
      mesh_ = std::move(best);
      report.moved = std::accumulate(moved_of_best.begin(), moved_of_best.end(), Index{0});
    }
    return report;
  }

private:
  /// The vertices of the triangles, and those that are up to some edges away, ascending.
  std::vector<Index> around(const Pairs& pairs, int rings) const {
    std::vector<Index> zone;
    for (const auto& pair : pairs)
      for (const Index t : pair)
        for (Index k = 0; k < 3; ++k)
          zone.push_back(mesh_.triangles(k, t));
    internal::sortUnique(zone);
    for (int ring = 0; ring < rings; ++ring) {
      std::vector<Index> wider = zone;
      for (const Index t : trianglesAt(zone))
        for (Index k = 0; k < 3; ++k)
          wider.push_back(mesh_.triangles(k, t));
      internal::sortUnique(wider);
      zone = std::move(wider);
    }
    return zone;
  }

  std::vector<Index> trianglesAt(const std::vector<Index>& vertices) const {
    std::vector<Index> triangles;
    for (const Index v : vertices)
      corners_.forEachCorner(v, [&](Index t, Index) { triangles.push_back(t); });
    internal::sortUnique(triangles);
    return triangles;
  }

  /// Moves a vertex towards its neighbours on the sphere, towards those that are far in space most,
  /// as far as no triangle is flipped.
  void slide(Index v) {
    if (is_fixed_[v] != 0)
      return;
    Vector3d sum = Vector3d::Zero();
    double weights = 0.0;
    corners_.forEachCorner(v, [&](Index t, Index k) {
      const Index neighbor = mesh_.triangles(internal::nextCorner(k), t);
      const double weight = (mesh_.points.col(neighbor) - mesh_.points.col(v)).squaredNorm();
      sum += weight * mesh_.directions.col(neighbor);
      weights += weight;
    });
    if (!(weights > 0.0))
      return;
    const Vector3d from = mesh_.directions.col(v);
    for (const double step : {0.5, 0.25, 0.125, 0.0625}) {
      const Vector3d to = ((1.0 - step) * from + step / weights * sum).normalized();
      if (!fits(v, to))
        continue;
      const SurfaceSample sample = surface_.evaluate(to);
      mesh_.directions.col(v) = to;
      mesh_.points.col(v) = sample.position;
      mesh_.normals.col(v) = sample.normal;
      moved_[v] = 1;
      return;
    }
  }

  bool fits(Index v, const Vector3d& direction) const {
    bool is_fit = direction.allFinite();
    corners_.forEachCorner(v, [&](Index t, Index k) {
      is_fit = is_fit &&
               internal::isOutward(
                   direction, mesh_.directions.col(mesh_.triangles(internal::nextCorner(k), t)),
                   mesh_.directions.col(mesh_.triangles(internal::previousCorner(k), t)));
    });
    return is_fit;
  }

  const SphereSurface& surface_;
  ResampledMesh& mesh_;
  int threads_;
  internal::CornerTable corners_;
  internal::Indexed<char> moved_;
  internal::Indexed<char> is_fixed_;  ///< on the boundary
};

}  // namespace

UntanglingReport untangle(const SphereSurface& surface, ResampledMesh& mesh, int threads) {
  const Eigen::Index n = mesh.points.cols();
  if (mesh.normals.cols() != n || mesh.directions.cols() != n)
    throw InvalidInput("untangle: " + std::to_string(n) + " points, " +
                       std::to_string(mesh.normals.cols()) + " normals and " +
                       std::to_string(mesh.directions.cols()) +
                       " directions; give a mesh of resampleSurface()");
  internal::checkTriangles("untangle", mesh.triangles, n);
  const int most = internal::threadCount(threads, internal::columnCount(mesh.points));
  return Sliding(surface, mesh, most).run();
}

}  // namespace spherical_param
