#pragma once

#include "energy_mesh.h"
#include "indexed.h"
#include "progress.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// Flips edges of an energy mesh, the largest gain first, until none gains.
class Flips {
public:
  /// \param mesh must outlive this.
  explicit Flips(EnergyMesh& mesh);

  /// Whether the flips have to end early.
  using Ends = std::function<bool()>;

  /// Flips any edges, until none gains or `ends` returns true. Returns the number of flips.
  ///
  /// \param report receives an estimate of the fraction done. If it throws, the mesh stays
  ///               consistent.
  std::size_t flipAll(const FractionReport& report = {}, const Ends& ends = {});
  /// Flips sides of some triangles, then sides whose gain has changed by that, until none gains.
  void flipAround(const std::vector<Index>& triangles);

private:
  /// A flip that gains. Void if the stamp of its side has changed.
  struct Candidate {
    double gain;
    Index triangle;
    std::uint32_t stamp;
    std::uint8_t corner;

    bool operator<(const Candidate& other) const {
      return gain != other.gain
                 ? gain < other.gain
                 : std::pair(triangle, corner) > std::pair(other.triangle, other.corner);
    }
  };

  /// Appends the flip of a side to `candidates` if it gains.
  void append(Index t, int corner, std::vector<Candidate>& candidates) const;
  /// Queues the flips of some triangles' sides; voids older entries.
  void queueSides(const std::vector<Index>& triangles);
  std::size_t flipQueued(const FractionReport& report = {}, const Ends& ends = {});

  EnergyMesh& mesh_;
  std::vector<Candidate> queue_;                  ///< a heap
  Indexed<std::array<std::uint32_t, 3>> stamps_;  ///< of each side, at the lower of its triangles
  IndexSet due_;                                  ///< working memory of queueSides()
  std::vector<Index> affected_;                   ///< working memory of flipQueued()
};

}  // namespace spherical_param::internal
