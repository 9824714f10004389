#include "surface_topology.h"

#include "filled_graph.h"
#include "necks.h"
#include "openings.h"
#include "progress.h"
#include "rotation_system.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace spherical_param::internal {

SurfaceTopology findTopology(const Positions& points, const Graph& graph, bool is_flat, double unit,
                             const Options& options, StageClock& clock) {
  clock.begin("openings");
  const Execution& execution = clock.execution();
  const FractionReport report = reportOf(execution, "openings");
  const Indexed<double> spacing = nodeSpacings(graph, execution.threads);
  reportFraction(report, 0.1);
  RotationSystem rotation(points, graph, spacing, execution.threads);
  reportFraction(report, 0.4);
  Openings openings = findOpenings(points, graph, spacing, rotation);
  reportFraction(report, 0.5);
  Handles handles;
  if (options.handles == HandleMode::Auto && !openings.is_one_sided) {
    handles = findHandles(rotation, openings.openings, execution);
    openings.is_one_sided = handles.is_one_sided;
  }
  // Only a surface with two sides can be glued.
  const bool may_be_cut = options.handles == HandleMode::Auto && !openings.is_one_sided;
  OpenSurface surface(points, graph, std::move(openings), is_flat, unit, options);
  if (!may_be_cut)
    return {std::move(surface), {}, {}};
  return {std::move(surface), std::move(handles.loops),
          std::make_unique<const RotationSystem>(std::move(rotation))};
}

SurfaceCutter::SurfaceCutter(const Positions& points, const Graph& graph, SurfaceTopology& topology)
    : points_(points), all_edges_(graph), openings_(topology.openings.embeddedOpenings()),
      rotation_(std::move(topology.rotation)) {
  if (!rotation_)
    return;
  const std::vector<CutLoop>& handles = topology.handles;
  // Those of a sphere without openings stay.
  if (!openings_.false_edges.empty() && (!handles.empty() || !openings_.openings.empty()))
    rest_ = withoutFalseEdges(points, graph, openings_.false_edges);
  std::vector<CutLoop> certain;
  std::copy_if(handles.begin(), handles.end(), std::back_inserter(certain),
               [](const CutLoop& loop) { return loop.certainty >= 1.0; });
  if (!handles.empty())
    handles_.push_back(handles);
  if (!certain.empty() && certain.size() < handles.size())
    handles_.push_back(std::move(certain));
  handles_.emplace_back();
}

std::optional<SurfaceCut> SurfaceCutter::next() {
  // As the measured squeeze is the predicted one to the power of 1.5 to 2, this is the range of
  // double.
  constexpr double max_squeeze = 15.0;
  while (next_ < handles_.size()) {
    SurfaceCut cut;
    cut.handles = std::move(handles_[next_++]);
    const Necks necks = findNecks(points_, graph(), *rotation_, openings_, cut.handles);
    cut.has_sphere = cut.handles.empty() && necks.squeeze <= max_squeeze;
    if (!necks.loops.empty()) {
      std::vector<CutLoop>& both = cut.loops.emplace_back(cut.handles);
      both.insert(both.end(), necks.loops.begin(), necks.loops.end());
    }
    if (!cut.handles.empty())
      cut.loops.push_back(cut.handles);
    if (!cut.loops.empty())
      return cut;
  }
  return std::nullopt;
}

CutGraph SurfaceCutter::along(const std::vector<CutLoop>& loops) const {
  return cutAlong(points_, graph(), *rotation_, loops);
}

}  // namespace spherical_param::internal
