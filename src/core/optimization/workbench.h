#pragma once

#include "energy_mesh.h"
#include "flips.h"
#include "local_untangling.h"
#include "mesh_optimization.h"
#include "open_places.h"
#include "progress.h"
#include "ruin_and_recreate.h"
#include "spherical_param/execution.h"
#include "time_left.h"

#include <cstddef>
#include <optional>

namespace spherical_param::internal {

/// What the phases of an optimisation share: the mesh, its moves, the limits.
class Workbench {
public:
  Workbench(const Positions& points, SphereMesh start, const Graph& graph,
            const OptimizationOptions& options, const Execution& execution);
  Workbench(const Workbench&) = delete;
  Workbench& operator=(const Workbench&) = delete;

  FractionReport report;  ///< of the fraction done
  std::optional<OpenPlaces> openings;
  EnergyMesh mesh;
  Flips flips;
  RuinAndRecreate ruins;
  LocalUntangling local;
  OptimizationReport log;

  /// Reports the fraction of a phase's items that are done.
  void reportItem(std::size_t item, std::size_t items, std::size_t between_reports) const;
  /// Pairs of triangles that intersect: a sample if they are too many to repair or, after the time
  /// limit, if the mesh is not usable.
  IntersectingPairs findIntersections();
  /// Notes in the log that the time is over.
  bool isOutOfTime();
  /// Whether even the first flips have to end.
  bool isOverdue() const { return !has_no_time_ && time_left_(-kGrace) == 0.0; }
  /// Whether time is left for repairs, and some of a fraction of their work.
  bool mayRepair(double fraction = 1.0);
  /// Allows as much work again as at the beginning.
  void renewWork();
  /// Ruins and recreates a part around some vertices, if work is left. Returns whether it was
  /// committed.
  bool tryPart(const std::vector<Index>& seeds, std::size_t size,
               const RuinAndRecreate::Accept& accept);

private:
  std::size_t work() const { return log.recreated + local.work(); }

  /// Time by which the first flips may exceed the limit [s]: those of small clouds end before.
  static constexpr double kGrace = 0.1;

  bool has_no_time_;  ///< the limit is 0: all of the first flips are made, on any machine
  TimeLeft time_left_;
  IntersectingPairs known_;     ///< when the mesh was last searched
  std::size_t first_work_ = 0;  ///< before renewWork()
  std::size_t max_work_ = 0;    ///< since then
};

}  // namespace spherical_param::internal
