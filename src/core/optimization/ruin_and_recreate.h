#pragma once

#include "energy_mesh.h"
#include "flips.h"
#include "indexed.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace spherical_param::internal {

/// Ruin and recreate (Schrimpf et al. 2000): takes vertices out of a mesh and puts them back where
/// they cost least.
class RuinAndRecreate {
public:
  /// Whether a change of the energy is accepted [EnergyMesh::unit()].
  using Accept = std::function<bool(double)>;

  /// \param mesh must outlive this.
  RuinAndRecreate(EnergyMesh& mesh, Flips& flips, std::uint64_t seed);

  /// Takes vertices out, puts them back in random order, each into a triangle around its neighbours
  /// in mesh and graph, and flips edges there. Commits if `accept` returns true, or rolls back.
  /// Returns which.
  bool recreate(const std::vector<Index>& vertices, const Accept& accept);

  /// `count` vertices, or all, that spread randomly from the seeds over the edges of mesh and
  /// graph.
  std::vector<Index> spread(const std::vector<Index>& seeds, std::size_t count);

private:
  bool remove(Index v);
  bool insert(Index v, const std::vector<Index>& neighbors);
  /// A random number below `end`.
  std::size_t random(std::size_t end);

  EnergyMesh& mesh_;
  Flips& flips_;
  std::uint64_t random_;
  IndexSet seen_triangles_;  ///< working memory of insert()
  IndexSet seen_vertices_;   ///< working memory of spread()
};

}  // namespace spherical_param::internal
