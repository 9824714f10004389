#include "workbench.h"

#include "optimization_constants.h"

namespace spherical_param::internal {

Workbench::Workbench(const Positions& points, const Triangles& triangles, const Graph& graph,
                     const OptimizationOptions& options, const Execution& execution)
    : report(reportOf(execution, "optimization")),
      openings(options.openings != nullptr ? std::optional(*options.openings) : std::nullopt),
      mesh(points, triangles, graph, execution.threads, openings ? &*openings : nullptr, report),
      flips(mesh), ruins(mesh, flips, options.seed), local(mesh) {
  renewWork();
  if (execution.time_limit)
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(*execution.time_limit));
}

OptimizationPhase& Workbench::begin(const char* name) {
  log.phases.push_back({name});
  return log.phases.back();
}

void Workbench::reportItem(std::size_t item, std::size_t items, std::size_t between_reports) const {
  if (item % between_reports == 0)
    reportFraction(report, static_cast<double>(item) / static_cast<double>(items));
}

bool Workbench::isOutOfTime() {
  log.is_out_of_time = log.is_out_of_time || (deadline_ && Clock::now() >= *deadline_);
  return log.is_out_of_time;
}

bool Workbench::mayRepair() {
  return work() < max_work_ && !isOutOfTime();
}

void Workbench::renewWork() {
  namespace tuned = optimization_constants;
  max_work_ = work() + tuned::kMaxWork + tuned::kMaxWorkOfPoint * columnCount(mesh.points());
}

void Workbench::tryPart(const std::vector<Index>& seeds, std::size_t size,
                        const RuinAndRecreate::Accept& accept, OptimizationPhase& phase) {
  if (!mayRepair())
    return;
  const std::vector<Index> part = ruins.spread(seeds, size);
  recreated_ += part.size();
  ++phase.tried;
  phase.moves += ruins.recreate(part, accept) ? 1 : 0;
}

}  // namespace spherical_param::internal
