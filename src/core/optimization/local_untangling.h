#pragma once

#include "energy_mesh.h"
#include "local_intersections.h"

#include <cstddef>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Flips edges among a few watched triangles so that fewer of them intersect. Open triangles do not
/// count.
class LocalUntangling {
public:
  /// \param mesh must outlive this.
  explicit LocalUntangling(EnergyMesh& mesh);

  /// Watches the triangles around some vertices.
  void watch(const std::vector<Index>& vertices);
  /// Flips one or two sides of watched triangles at a time, so that fewer triangles intersect; ties
  /// by the least cost. Returns by how many pairs the number falls.
  int flipApart();
  /// The same for triangles changed since EnergyMesh::begin(), which followed watch(). Returns by
  /// how many pairs the number has changed since then; pairs of unwatched triangles count as new.
  int flipChangedApart();

  /// Ends the flips after this much more work.
  void limitWork(std::size_t most) { max_work_ = work_ + most; }
  /// Searches so far [vertices taken out and put back in the same time].
  std::size_t work() const { return work_; }

private:
  /// A flip and its effect: change of the number of intersecting pairs, and of the energy.
  struct Repair {
    Index triangle;
    int corner;
    int pairs;
    double cost;
  };
  /// Up to two flips, one after the other, and their effect.
  struct Repairs {
    std::vector<Repair> flips;
    int pairs = 0;
    double cost = 0.0;
  };

  Face face(Index t, const std::array<Index, 3>& corners) const {
    return faceOf(mesh_.points(), scale_, corners, t);
  }
  Face face(Index t) const { return face(t, mesh_.mesh().vertices(t)); }
  bool intersects(Index t) const { return local_.contains(t) && local_.intersects(face(t)); }
  int flipApart(std::vector<Index> bad);
  /// The flip of a side, unless it is impossible or changes the number of pairs by more than
  /// `most`.
  std::optional<Repair> repairOf(Index t, int corner, int most);
  /// Keeps a flip after those before it in `best` if it is better.
  void consider(Index t, int corner, const Repairs& before, Repairs& best);
  /// The best one or two flips of an intersecting triangle; no flips if none helps.
  Repairs bestRepairs(Index t);
  /// The same, where no single flip helps: the best two, one after the other.
  Repairs bestTwoFlips(Index t);
  std::vector<std::pair<Index, int>> sidesNear(Index t) const;
  /// Number of others that intersect a watched triangle.
  int countOf(Index t);
  void flip(const Repair& repair);
  void update(Index t, Index o) {
    local_.set(face(t));
    local_.set(face(o));
    counts_.clear();
  }

  EnergyMesh& mesh_;
  double scale_;  ///< brings the coordinates to at most 1
  std::size_t work_ = 0;
  std::size_t exact_tests_ = 0;  ///< for flips, of triangles that are not evidently apart
  std::size_t max_work_ = std::numeric_limits<std::size_t>::max();
  LocalIntersections local_;               ///< the watched triangles
  std::unordered_map<Index, int> counts_;  ///< from countOf(), since the last change
};

}  // namespace spherical_param::internal
