#include "spherical_param/map/morphing.h"

#include "caps.h"
#include "corner_table.h"
#include "index_loops.h"
#include "input_checks.h"
#include "progress.h"
#include "rotation_search.h"
#include "space_filling_curve.h"
#include "sphere_locator.h"
#include "sphere_overlay.h"
#include "sphere_warp.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/resampling.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <utility>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using internal::CornerTable;
using internal::Indexed;

/// Vertices of both meshes become one if they are nearer than this fraction of the shortest of
/// their edges: it moves the map by less than a mesh can show, and both shapes keep all their
/// vertices.
constexpr double kSameVertex = 0.1;

void checkOptions(const MorphOptions& options) {
  internal::checkEnum("morphSurfaces: connectivity", options.connectivity,
                      MorphConnectivity::Resampled);
  internal::checkRange("morphSurfaces: samples", options.samples, 12, std::size_t{1} << 24U);
  // The motion solves dense systems of twice the size.
  internal::checkRange("morphSurfaces: number of pairs", options.pairs.size(), 0, 4096);
}

/// The pairs that may be honoured, each once.
struct PairChoice {
  std::vector<PointPair> pairs;
  std::vector<std::vector<std::size_t>> numbers;  ///< of each: where it is in the options
};

PairChoice choosePairs(const SphereSurface& first, const SphereSurface& second,
                       const std::vector<PointPair>& pairs,
                       std::vector<ImpossiblePair>& impossible) {
  PairChoice choice;
  std::unordered_map<Index, std::size_t> of_first;
  std::unordered_map<Index, std::size_t> of_second;
  const auto out_of_range = [](Index vertex, const SphereSurface& surface, const char* which) {
    return "vertex " + std::to_string(vertex) + " is not in the " + which + " mesh, which has " +
           std::to_string(surface.points().cols());
  };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PointPair& pair = pairs[i];
    if (pair.first < 0 || pair.first >= first.points().cols()) {
      impossible.push_back({i, out_of_range(pair.first, first, "first")});
      continue;
    }
    if (pair.second < 0 || pair.second >= second.points().cols()) {
      impossible.push_back({i, out_of_range(pair.second, second, "second")});
      continue;
    }
    const auto a = of_first.find(pair.first);
    const auto b = of_second.find(pair.second);
    if (a != of_first.end() && b != of_second.end() && a->second == b->second) {
      choice.numbers[a->second].push_back(i);
      continue;
    }
    if (a != of_first.end() || b != of_second.end()) {
      const bool is_first = a != of_first.end();
      const std::size_t earlier = choice.numbers[is_first ? a->second : b->second].front();
      impossible.push_back({i, "vertex " + std::to_string(is_first ? pair.first : pair.second) +
                                   " of the " + (is_first ? "first" : "second") +
                                   " mesh has another partner in pair " + std::to_string(earlier)});
      continue;
    }
    of_first[pair.first] = of_second[pair.second] = choice.pairs.size();
    choice.pairs.push_back(pair);
    choice.numbers.push_back({i});
  }
  return choice;
}

double shortestEdgeAt(const Positions& sphere, const Triangles& triangles,
                      const CornerTable& corners, Index v) {
  double shortest = std::numeric_limits<double>::infinity();
  corners.forEachCorner(v, [&](Index t, Index) {
    for (int k = 0; k < 3; ++k)
      if (triangles(k, t) != v)
        shortest = std::min(shortest, (sphere.col(triangles(k, t)) - sphere.col(v)).squaredNorm());
  });
  return std::sqrt(shortest);
}

CornerTable cornersOf(const Triangles& triangles, const Positions& vertices) {
  return {triangles, internal::columnCount(vertices), 1};
}

/// Moves a vertex on the sphere, unless that would flip one of its triangles.
bool moveVertex(Positions& sphere, const Triangles& triangles, const CornerTable& corners, Index v,
                const Vector3d& place) {
  const Vector3d old = sphere.col(v);
  sphere.col(v) = place;
  bool flips = false;
  corners.forEachCorner(
      v, [&](Index t, Index) { flips = flips || internal::isFlipped(sphere, triangles, t); });
  if (flips)
    sphere.col(v) = old;
  return !flips;
}

/// Puts vertices of the second mesh that are next to one of the first at its place.
void joinVertices(const SphereSurface& first, const Triangles& triangles, Positions& sphere,
                  Indexed<Index>& partner) {
  Positions points(3, first.sphere().cols() + sphere.cols());
  points << first.sphere(), sphere;
  Indexed<char> is_taken(internal::columnCount(first.sphere()), 0);
  for (const Index i : partner)
    if (i >= 0)
      is_taken[i] = 1;
  const Indexed<SphereLocation> places =
      internal::locateAll(points, first.triangles(), first.sphere().cols());
  const CornerTable at_first = cornersOf(first.triangles(), first.sphere());
  const CornerTable at_second = cornersOf(triangles, sphere);
  for (const Index v : internal::mortonOrder(sphere)) {
    if (partner[v] >= 0)
      continue;
    Eigen::Index corner = 0;
    places[v].weights.maxCoeff(&corner);
    const Index other = first.triangles()(corner, places[v].triangle);
    const Vector3d place = first.sphere().col(other);
    if (is_taken[other] != 0 ||
        (place - sphere.col(v)).norm() >
            kSameVertex *
                std::min(shortestEdgeAt(first.sphere(), first.triangles(), at_first, other),
                         shortestEdgeAt(sphere, triangles, at_second, v)))
      continue;
    if (moveVertex(sphere, triangles, at_second, v, place)) {
      partner[v] = other;
      is_taken[other] = 1;
    }
  }
}

/// Whether a direction of the first sphere is in an opening of either surface.
class OpenPart {
public:
  /// \param sphere of the second surface, as it is on the first; must outlive this.
  OpenPart(const SphereSurface& first, const SphereSurface& second, const Positions& sphere,
           int threads)
      : first_(first), second_(second), locator_(sphere, second.triangles(), threads) {}

  bool holds(const Vector3d& direction) const {
    return first_.isCap(first_.locate(direction).triangle) ||
           second_.isCap(locator_.locate(direction).triangle);
  }

private:
  const SphereSurface& first_;
  const SphereSurface& second_;
  internal::SphereLocator locator_;
};

/// Gives places on the boundary a triangle of the mesh, where they have one of a cap.
void leaveCaps(const SphereSurface& surface, std::vector<SphereLocation>& places) {
  if (!surface.isOpen())
    return;
  const Triangles& triangles = surface.triangles();
  const CornerTable corners = cornersOf(triangles, surface.points());
  for (SphereLocation& place : places) {
    if (!surface.isCap(place.triangle))
      continue;
    std::array<Index, 3> order = {0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](Index a, Index b) { return place.weights[a] > place.weights[b]; });
    const Index nearest = triangles(order[0], place.triangle);
    const Index next = triangles(order[1], place.triangle);
    SphereLocation on_mesh;
    on_mesh.triangle = -1;
    double fraction = 0.0;  // towards `next`
    corners.forEachCorner(nearest, [&](Index t, Index k) {
      if (surface.isCap(t))
        return;
      const Index after = internal::nextCorner(k);
      const Index before = internal::previousCorner(k);
      const Index other = triangles(after, t) == next ? after : before;
      const bool has_both = triangles(other, t) == next;
      if (on_mesh.triangle >= 0 && !has_both)
        return;
      fraction = has_both
                     ? place.weights[order[1]] / (place.weights[order[0]] + place.weights[order[1]])
                     : 0.0;
      on_mesh.triangle = t;
      on_mesh.weights.setZero();
      on_mesh.weights[k] = 1.0 - fraction;
      on_mesh.weights[other] += fraction;
    });
    if (on_mesh.triangle >= 0)
      place = on_mesh;
  }
}

/// Leaves out the triangles over openings of either surface, and what only they use.
void cutOpenings(const OpenPart& open, MorphResult& morph) {
  Triangles triangles(3, morph.triangles.cols());
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < morph.triangles.cols(); ++t) {
    const auto corner = [&](Eigen::Index k) -> Vector3d {
      return morph.sphere.col(morph.triangles(k, t));
    };
    if (!open.holds(corner(0) + corner(1) + corner(2)))
      triangles.col(kept++) = morph.triangles.col(t);
  }
  triangles.conservativeResize(3, kept);
  const std::vector<Index> used = internal::compact(triangles, morph.sphere.cols());
  const auto keep = [&](Positions& positions) { positions = internal::columnsOf(positions, used); };
  const auto keep_places = [&](std::vector<SphereLocation>& places) {
    std::vector<SphereLocation> all = std::exchange(places, {});
    for (const Index v : used)
      places.push_back(internal::entry(all, v));
  };
  morph.triangles = std::move(triangles);
  keep(morph.first);
  keep(morph.second);
  keep(morph.sphere);
  keep_places(morph.first_places);
  keep_places(morph.second_places);
}

/// Positions at places of a surface; of the vertices as they are.
Positions positionsAt(const SphereSurface& surface, const std::vector<SphereLocation>& places,
                      int threads) {
  Positions positions(3, internal::indexCount(places));
  internal::forEachIndex(places.size(), threads, [&](Index i) {
    const SphereLocation& place = internal::entry(places, i);
    Eigen::Index corner = 0;
    if (place.weights.maxCoeff(&corner) == 1.0)
      positions.col(i) = surface.points().col(surface.triangles()(corner, place.triangle));
    else
      positions.col(i) = surface.evaluate(place).position;
  });
  return positions;
}

/// Cuts the faces of an overlay in triangles, by the diagonals that are short in both shapes: any
/// are right, as each face is flat in both.
Triangles triangulateFaces(const internal::SphereOverlay& overlay, const MorphResult& morph,
                           double first_scale, double second_scale) {
  Triangles triangles(3, 2 * overlay.directions.cols() - 4);
  Eigen::Index t = 0;
  Indexed<Index> face;
  const auto squared_length = [&](Index i, Index j) {
    return first_scale * (morph.first.col(i) - morph.first.col(j)).squaredNorm() +
           second_scale * (morph.second.col(i) - morph.second.col(j)).squaredNorm();
  };
  for (std::size_t f = 0; f + 1 < overlay.offsets.size(); ++f) {
    face.assign(overlay.corners.data() + overlay.offsets[f],
                overlay.corners.data() + overlay.offsets[f + 1]);
    for (Index n = internal::indexCount(face); n > 3; --n) {
      Index ear = 0;
      double shortest = std::numeric_limits<double>::infinity();
      for (Index i = 0; i < n; ++i) {
        const double length = squared_length(face[(i + n - 1) % n], face[(i + 1) % n]);
        if (length < shortest) {
          shortest = length;
          ear = i;
        }
      }
      triangles.col(t++) << face[(ear + n - 1) % n], face[ear], face[(ear + 1) % n];
      face.erase(face.begin() + ear);
    }
    triangles.col(t++) << face[0], face[1], face[2];
  }
  return triangles;
}

double inverseArea(const SphereSurface& surface) {
  return surface.area() > 0.0 ? 1.0 / surface.area() : 1.0;
}

/// A geodesic sphere with vertices at the places of pairs.
GridSphere gridWithPairs(const MorphOptions& options, const std::vector<Vector3d>& places) {
  GridSphere grid = makeGridSphere(SphereGrid::Icosahedral,
                                   gridFrequency(SphereGrid::Icosahedral, options.samples));
  if (places.empty())
    return grid;
  const CornerTable corners = cornersOf(grid.triangles, grid.directions);
  Indexed<char> is_taken(corners.vertexCount(), 0);
  const Positions regular = grid.directions;
  for (const Vector3d& place : places) {
    Index nearest = 0;
    (regular.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
    if (is_taken[nearest] == 0 &&
        moveVertex(grid.directions, grid.triangles, corners, nearest, place))
      is_taken[nearest] = 1;
  }
  return grid;
}

/// The morph on a grid, with vertices at `places`.
void morphOnGrid(const SphereSurface& first, const SphereSurface& second, const Positions& sphere,
                 const MorphOptions& options, const std::vector<Vector3d>& places,
                 const std::optional<OpenPart>& open, MorphResult& morph) {
  GridSphere grid = gridWithPairs(options, places);
  if (open) {
    internal::OpenSphere cut = internal::cutOpenings(
        grid.directions, grid.triangles, [&](const Vector3d& u) { return open->holds(u); });
    grid.directions = std::move(cut.directions);
    grid.triangles = std::move(cut.triangles);
  }
  morph.triangles = std::move(grid.triangles);
  morph.sphere = std::move(grid.directions);
  const auto locate = [&](const Positions& of_mesh, const Triangles& triangles) {
    Positions points(3, of_mesh.cols() + morph.sphere.cols());
    points << of_mesh, morph.sphere;
    return internal::locateAll(points, triangles, of_mesh.cols());
  };
  morph.first_places = locate(first.sphere(), first.triangles());
  morph.second_places = locate(sphere, second.triangles());
  morph.first = positionsAt(first, morph.first_places, options.threads);
  morph.second = positionsAt(second, morph.second_places, options.threads);
}

/// The morph of all vertices of both meshes and the crossings of their edges.
void morphOnOverlay(const SphereSurface& first, const SphereSurface& second,
                    const Positions& sphere, const Indexed<Index>& partner, int threads,
                    MorphResult& morph) {
  internal::SphereOverlay overlay = internal::overlaySpheres(
      first.sphere(), first.triangles(), sphere, second.triangles(), partner,
      internal::threadCount(threads, internal::columnCount(sphere)));
  morph.first_places = std::move(overlay.first);
  morph.second_places = std::move(overlay.second);
  morph.first = positionsAt(first, morph.first_places, threads);
  morph.second = positionsAt(second, morph.second_places, threads);
  morph.triangles = triangulateFaces(overlay, morph, inverseArea(first), inverseArea(second));
  morph.sphere = std::move(overlay.directions);
}

/// Sets the partners of the vertices whose landmarks arrived, and adds the other pairs to the
/// impossible ones. \return the places of the landmarks that arrived
std::vector<Vector3d> honouredPairs(const PairChoice& choice,
                                    const std::vector<internal::Landmark>& landmarks,
                                    const internal::SphereWarp& warp, Indexed<Index>& partner,
                                    std::vector<ImpossiblePair>& impossible) {
  std::vector<Vector3d> places;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!warp.reasons[i].empty()) {
      for (const std::size_t number : choice.numbers[i])
        impossible.push_back({number, warp.reasons[i]});
      continue;
    }
    partner[choice.pairs[i].second] = choice.pairs[i].first;
    places.push_back(landmarks[i].target);
  }
  std::sort(impossible.begin(), impossible.end(),
            [](const auto& one, const auto& other) { return one.pair < other.pair; });
  return places;
}

}  // namespace

MorphResult morphSurfaces(const SphereSurface& first, const SphereSurface& second,
                          const MorphOptions& options) {
  checkOptions(options);
  const internal::FractionReport report = internal::reportOf(options, "morph");
  internal::reportFraction(report, 0.0);
  MorphResult morph;
  const PairChoice choice = choosePairs(first, second, options.pairs, morph.impossible);

  if (options.align) {
    std::vector<std::pair<Vector3d, Vector3d>> directions;
    for (const PointPair& pair : choice.pairs)
      directions.emplace_back(first.sphere().col(pair.first), second.sphere().col(pair.second));
    morph.rotation = internal::searchRotation(first, second, directions, options.threads, report);
  }
  morph.alignment_error = internal::alignmentError(first, second, morph.rotation, options.threads);

  // The second sphere, turned onto the first.
  Positions sphere = second.sphere();
  if (options.align)
    sphere = (morph.rotation.transpose() * sphere).colwise().normalized();
  std::vector<internal::Landmark> landmarks;
  for (const PointPair& pair : choice.pairs)
    landmarks.push_back({pair.second, first.sphere().col(pair.first)});
  internal::SphereWarp warp =
      internal::moveLandmarks(sphere, second.triangles(), landmarks, options.threads, report);
  if (internal::countFlipped(warp.sphere, second.triangles(), options.threads) > 0)
    throw ComputeError("morphSurfaces: the second map has triangles that rounding flips when it "
                       "is rotated; use a map of less distortion, or align = false");
  sphere = std::move(warp.sphere);
  morph.worst_pair = warp.worst;

  Indexed<Index> partner(internal::columnCount(sphere), -1);
  const std::vector<Vector3d> places =
      honouredPairs(choice, landmarks, warp, partner, morph.impossible);

  std::optional<OpenPart> open;
  if (first.isOpen() || second.isOpen())
    open.emplace(first, second, sphere, options.threads);
  if (options.connectivity == MorphConnectivity::AllVertices) {
    joinVertices(first, second.triangles(), sphere, partner);
    internal::reportFraction(report, 0.0);
    morphOnOverlay(first, second, sphere, partner, options.threads, morph);
    if (open)
      cutOpenings(*open, morph);
  } else {
    morphOnGrid(first, second, sphere, options, places, open, morph);
  }
  internal::reportFraction(report, 0.0);
  leaveCaps(first, morph.first_places);
  leaveCaps(second, morph.second_places);
  internal::reportFraction(report, 1.0);
  return morph;
}

Positions inBetween(const MorphResult& morph, double t) {
  if (!std::isfinite(t))
    throw InvalidInput("inBetween: t = " + std::to_string(t) + " is not finite; use 0 to 1");
  if (morph.first.cols() != morph.second.cols())
    throw InvalidInput("inBetween: " + std::to_string(morph.first.cols()) + " and " +
                       std::to_string(morph.second.cols()) +
                       " vertices; use what morphSurfaces() returned");
  if (t == 0.0)
    return morph.first;
  if (t == 1.0)
    return morph.second;
  return (1.0 - t) * morph.first + t * morph.second;
}

}  // namespace spherical_param
