#include "open_mesh.h"

#include "sphere_mesh.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {
namespace {

std::size_t entry(Index i) {
  return static_cast<std::size_t>(i);
}

class Opener {
public:
  Opener(const Positions& points, const Triangles& triangles, const OpenPlaces& openings)
      : points_(points), openings_(openings),
        mesh_(triangles, static_cast<std::size_t>(points.cols())),
        is_open_(entry(mesh_.size()), 0) {
    for (Index t = 0; t < mesh_.size(); ++t)
      is_open_[entry(t)] =
          openings.isOpen(mesh_.vertex(t, 0), mesh_.vertex(t, 1), mesh_.vertex(t, 2)) ? 1 : 0;
  }

  OpenMesh run() {
    closePiecesWithoutLoop();
    std::vector<Index> due;
    for (Index v = 0; v < static_cast<Index>(points_.cols()); ++v)
      if (isUnsound(v))
        due.push_back(v);
    while (!due.empty()) {
      const Index v = due.back();
      due.pop_back();
      if (!isUnsound(v))
        continue;
      // What is closed may leave other vertices unsound, and this one, too.
      for (const Index w : closeAt(v))
        due.push_back(w);
    }
    return {mesh_.triangles(), std::move(is_open_)};
  }

private:
  bool isOpen(Index t) const { return is_open_[entry(t)] != 0; }

  double distance(Index v, Index w) const { return (points_.col(v) - points_.col(w)).norm(); }

  /// Open triangles that no loop leads to are part of the surface.
  void closePiecesWithoutLoop() {
    std::vector<std::uint8_t> is_seen(is_open_.size(), 0);
    std::vector<Index> piece;
    for (Index first = 0; first < mesh_.size(); ++first) {
      if (!isOpen(first) || is_seen[entry(first)] != 0)
        continue;
      piece.assign(1, first);
      is_seen[entry(first)] = 1;
      bool has_loop = false;
      for (std::size_t head = 0; head < piece.size(); ++head)
        for (int k = 0; k < 3; ++k) {
          const Index t = piece[head];
          const Index next = mesh_.neighbor(t, k);
          has_loop = has_loop ||
                     openings_.isRim(mesh_.vertex(t, (k + 1) % 3), mesh_.vertex(t, (k + 2) % 3));
          if (!isOpen(next) || is_seen[entry(next)] != 0)
            continue;
          is_seen[entry(next)] = 1;
          piece.push_back(next);
        }
      if (!has_loop)
        for (const Index t : piece)
          is_open_[entry(t)] = 0;
    }
  }

  /// Open triangles around a vertex that follow each other, counter-clockwise.
  using Run = std::vector<Index>;

  /// All runs around a vertex; one if all triangles are open.
  std::vector<Run> runsAt(Index v) const {
    std::vector<Index> around;
    mesh_.forEachAround(v, [&](Index t, int) { around.push_back(t); });
    const auto closed =
        std::find_if(around.begin(), around.end(), [&](Index t) { return !isOpen(t); });
    if (closed == around.end())
      return {around};
    std::rotate(around.begin(), closed, around.end());
    std::vector<Run> runs;
    for (std::size_t i = 1; i < around.size(); ++i) {
      if (!isOpen(around[i]))
        continue;
      if (!isOpen(around[i - 1]))
        runs.emplace_back();
      runs.back().push_back(around[i]);
    }
    return runs;
  }

  /// Whether the surface around a vertex is not one fan.
  bool isUnsound(Index v) const {
    Index changes = 0;
    bool is_any_closed = false;
    mesh_.forEachAround(v, [&](Index t, int corner) {
      is_any_closed = is_any_closed || !isOpen(t);
      changes += isOpen(t) != isOpen(mesh_.neighbor(t, (corner + 1) % 3)) ? 1 : 0;
    });
    return !is_any_closed || changes > 2;
  }

  /// Closes the narrowest gap at a vertex. Returns the vertices that this concerns.
  std::vector<Index> closeAt(Index v) {
    std::vector<Run> runs = runsAt(v);
    if (runs.size() == 1)
      return closed({smallestOf(runs.front())});
    const auto narrowest =
        std::min_element(runs.begin(), runs.end(),
                         [&](const Run& a, const Run& b) { return widthAt(v, a) < widthAt(v, b); });
    return closed(trimmed(v, *narrowest));
  }

  /// Distance of the first and the last neighbour of a run.
  double widthAt(Index v, const Run& run) const {
    return distance(mesh_.vertex(run.front(), (mesh_.cornerOf(run.front(), v) + 1) % 3),
                    mesh_.vertex(run.back(), (mesh_.cornerOf(run.back(), v) + 2) % 3));
  }

  Index smallestOf(const Run& run) const {
    return *std::min_element(run.begin(), run.end(),
                             [&](Index t, Index u) { return perimeter(t) < perimeter(u); });
  }

  double perimeter(Index t) const {
    return distance(mesh_.vertex(t, 0), mesh_.vertex(t, 1)) +
           distance(mesh_.vertex(t, 1), mesh_.vertex(t, 2)) +
           distance(mesh_.vertex(t, 2), mesh_.vertex(t, 0));
  }

  /// Flips the edges from a vertex into a run of it, as far as that goes: what is left of the run.
  Run trimmed(Index v, Run run) {
    for (std::size_t i = 0; i + 1 < run.size();) {
      // The edge to the next triangle is opposite to the corner after v.
      if (!mesh_.flip(run[i], (mesh_.cornerOf(run[i], v) + 1) % 3)) {
        ++i;
        continue;
      }
      run.erase(run.begin() + static_cast<std::ptrdiff_t>(i));  // has left the vertex
      i = 0;
    }
    return run;
  }

  /// Makes triangles part of the surface.
  std::vector<Index> closed(const Run& run) {
    std::vector<Index> vertices;
    for (const Index t : run) {
      is_open_[entry(t)] = 0;
      for (int k = 0; k < 3; ++k)
        vertices.push_back(mesh_.vertex(t, k));
    }
    return vertices;
  }

  const Positions& points_;
  const OpenPlaces& openings_;
  SphereMesh mesh_;
  std::vector<std::uint8_t> is_open_;
};

}  // namespace

OpenMesh openMesh(const Positions& points, const Triangles& triangles, const OpenPlaces& openings) {
  return Opener(points, triangles, openings).run();
}

Triangles surfaceOf(const OpenMesh& mesh) {
  Triangles surface(3, std::count(mesh.is_open.begin(), mesh.is_open.end(), std::uint8_t{0}));
  Eigen::Index next = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    if (mesh.is_open[static_cast<std::size_t>(t)] == 0)
      surface.col(next++) = mesh.triangles.col(t);
  return surface;
}

}  // namespace spherical_param::internal
