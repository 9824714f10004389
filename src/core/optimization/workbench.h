#pragma once

#include "energy_mesh.h"
#include "flips.h"
#include "local_untangling.h"
#include "mesh_optimization.h"
#include "open_places.h"
#include "progress.h"
#include "ruin_and_recreate.h"
#include "spherical_param/execution.h"

#include <chrono>
#include <cstddef>
#include <optional>

namespace spherical_param::internal {

/// What the phases of an optimisation share: the mesh, its moves, the limits, the report.
class Workbench {
public:
  Workbench(const Positions& points, const Triangles& triangles, const Graph& graph,
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

  /// Adds a phase to the log.
  OptimizationPhase& begin(const char* name);
  /// Reports the fraction of a phase's items that are done.
  void reportItem(std::size_t item, std::size_t items, std::size_t between_reports) const;
  /// Notes in the log that the time is over.
  bool isOutOfTime();
  /// Whether work and time are left for repairs.
  bool mayRepair();
  /// Allows as much work again as at the beginning.
  void renewWork();
  /// Ruins and recreates a part around some vertices, if work is left.
  void tryPart(const std::vector<Index>& seeds, std::size_t size,
               const RuinAndRecreate::Accept& accept, OptimizationPhase& phase);

private:
  using Clock = std::chrono::steady_clock;

  std::size_t work() const { return recreated_ + local.work(); }

  std::size_t recreated_ = 0;  ///< vertices taken out by tryPart()
  std::size_t max_work_ = 0;
  std::optional<Clock::time_point> deadline_;
};

}  // namespace spherical_param::internal
