#include "spherical_param/map/morphing.h"

#include "caps.h"
#include "corner_table.h"
#include "index_loops.h"
#include "input_checks.h"
#include "progress.h"
#include "rotation_search.h"
#include "sphere_locator.h"
#include "sphere_overlay.h"
#include "sphere_warp.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/resampling.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
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
  const auto fault_of = [](Index vertex, const SphereSurface& surface, const char* which) {
    const Eigen::Index count = surface.points().cols();
    return vertex >= 0 && vertex < count ? std::string()
                                         : "vertex " + std::to_string(vertex) + " is not in the " +
                                               which + " mesh, which has " + std::to_string(count);
  };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const PointPair& pair = pairs[i];
    std::string fault = fault_of(pair.first, first, "first");
    if (fault.empty())
      fault = fault_of(pair.second, second, "second");
    if (!fault.empty()) {
      impossible.push_back({i, fault});
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
  const bool fits = internal::fitsAt(place, v, sphere, triangles, corners);
  if (fits)
    sphere.col(v) = place;
  return fits;
}

/// Puts vertices of the second mesh that are next to one of the first at its place.
void joinVertices(const SphereSurface& first, const Triangles& triangles, Positions& sphere,
                  Indexed<Index>& partner) {
  Indexed<char> is_taken(internal::columnCount(first.sphere()), 0);
  for (const Index i : partner)
    if (i >= 0)
      is_taken[i] = 1;
  const CornerTable at_first = cornersOf(first.triangles(), first.sphere());
  const CornerTable at_second = cornersOf(triangles, sphere);
  for (Index v = 0; v < partner.count(); ++v) {
    if (partner[v] >= 0)
      continue;
    const SphereLocation location = first.locate(sphere.col(v));
    Eigen::Index corner = 0;
    location.weights.maxCoeff(&corner);
    const Index other = first.triangles()(corner, location.triangle);
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

/// Positions at places of a surface. Vertices keep theirs, without rounding.
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

double inverseArea(const SphereSurface& surface) {
  return surface.area() > 0.0 ? 1.0 / surface.area() : 1.0;
}

/// Triangulates the faces of an overlay by diagonals that are short in both shapes; any diagonal is
/// right, as each face is flat in both. Leaves out the faces in openings.
Triangles triangulateFaces(const internal::SphereOverlay& overlay, const SphereSurface& first,
                           const SphereSurface& second, const MorphResult& morph) {
  std::vector<Index> corners;
  Indexed<Index> face;
  const auto squared_length = [&](Index i, Index j) {
    return (morph.first.col(i) - morph.first.col(j)).squaredNorm() * inverseArea(first) +
           (morph.second.col(i) - morph.second.col(j)).squaredNorm() * inverseArea(second);
  };
  for (Index f = 0; f < overlay.first_triangles.count(); ++f) {
    if (first.isCap(overlay.first_triangles[f]) || second.isCap(overlay.second_triangles[f]))
      continue;
    face.assign(overlay.corners.begin() + overlay.offsets[f],
                overlay.corners.begin() + overlay.offsets[f + 1]);
    for (Index n = face.count(); n > 3; --n) {
      Index ear = 0;
      double shortest = std::numeric_limits<double>::infinity();
      for (Index i = 0; i < n; ++i) {
        const double length = squared_length(face[(i + n - 1) % n], face[(i + 1) % n]);
        if (length < shortest) {
          shortest = length;
          ear = i;
        }
      }
      corners.insert(corners.end(), {face[(ear + n - 1) % n], face[ear], face[(ear + 1) % n]});
      face.erase(face.begin() + ear);
    }
    corners.insert(corners.end(), face.begin(), face.end());
  }
  return Eigen::Map<const Triangles>(corners.data(), 3, internal::indexCount(corners) / 3);
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

/// The places of directions on a sphere.
template <typename Locator>
std::vector<SphereLocation> locateAll(const Positions& directions, const Locator& locator,
                                      int threads) {
  std::vector<SphereLocation> places(internal::columnCount(directions));
  internal::forEachIndex(places.size(), threads, [&](Index i) {
    internal::entry(places, i) = locator.locate(directions.col(i));
  });
  return places;
}

/// The morph on a grid, with vertices at `places`.
///
/// \param sphere of the second surface, as it is on the first.
void morphOnGrid(const SphereSurface& first, const SphereSurface& second, const Positions& sphere,
                 const MorphOptions& options, const std::vector<Vector3d>& places,
                 MorphResult& morph) {
  const internal::SphereLocator on_second(sphere, second.triangles(), options.threads);
  GridSphere grid = gridWithPairs(options, places);
  if (first.isOpen() || second.isOpen())
    internal::cutOpenings(grid.directions, grid.triangles, [&](const Vector3d& u) {
      return first.isCap(first.locate(u).triangle) || second.isCap(on_second.locate(u).triangle);
    });
  morph.triangles = std::move(grid.triangles);
  morph.sphere = std::move(grid.directions);
  morph.first_places = locateAll(morph.sphere, first, options.threads);
  morph.second_places = locateAll(morph.sphere, on_second, options.threads);
  if (std::any_of(morph.second_places.begin(), morph.second_places.end(),
                  [](const SphereLocation& place) { return place.triangle < 0; }))
    throw ComputeError("morphSurfaces: coordinates on the sphere are too small for exact signs; "
                       "turn the sphere a little");
  morph.first = positionsAt(first, morph.first_places, options.threads);
  morph.second = positionsAt(second, morph.second_places, options.threads);
}

/// The morph of all vertices of both meshes and the crossings of their edges.
void morphOnOverlay(const SphereSurface& first, const SphereSurface& second,
                    const Positions& sphere, const Indexed<Index>& partner, int threads,
                    MorphResult& morph) {
  const internal::SphereOverlay overlay = internal::overlaySpheres(
      first.sphere(), first.triangles(), sphere, second.triangles(), partner);
  morph.first = positionsAt(first, overlay.first, threads);
  morph.second = positionsAt(second, overlay.second, threads);
  morph.triangles = triangulateFaces(overlay, first, second, morph);
  const std::vector<Index> used = internal::compact(morph.triangles, overlay.directions.cols());
  morph.first = Positions(morph.first(Eigen::all, used));
  morph.second = Positions(morph.second(Eigen::all, used));
  morph.sphere = overlay.directions(Eigen::all, used);
  for (const Index v : used) {
    morph.first_places.push_back(overlay.first[v]);
    morph.second_places.push_back(overlay.second[v]);
  }
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
    landmarks.push_back({pair.second, first.sphere().col(pair.first), {}});
  const internal::SphereWarp warp =
      internal::moveLandmarks(sphere, second.triangles(), landmarks, options.threads, report);
  if (warp.is_flipped)
    throw ComputeError("morphSurfaces: the second map has triangles that rounding flips when it "
                       "is rotated; use a map of less distortion, or align = false");
  morph.worst_pair = warp.worst;

  Indexed<Index> partner(internal::columnCount(sphere), -1);
  std::vector<Vector3d> places;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i].fault.empty()) {
      partner[choice.pairs[i].second] = choice.pairs[i].first;
      places.push_back(landmarks[i].target);
      continue;
    }
    for (const std::size_t number : choice.numbers[i])
      morph.impossible.push_back({number, landmarks[i].fault});
  }
  std::sort(morph.impossible.begin(), morph.impossible.end(),
            [](const auto& one, const auto& other) { return one.pair < other.pair; });

  if (options.connectivity == MorphConnectivity::AllVertices) {
    joinVertices(first, second.triangles(), sphere, partner);
    internal::reportFraction(report, 0.0);
    morphOnOverlay(first, second, sphere, partner, options.threads, morph);
  } else {
    morphOnGrid(first, second, sphere, options, places, morph);
  }
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
