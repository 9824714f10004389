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
namespace {

/// Cuts a surface along handles, and along necks.
class SurfaceCutter {
public:
  /// \param openings of the graph, which virtual nodes fill.
  SurfaceCutter(const Positions& points, const Graph& graph, const RotationSystem& rotation,
                const Openings& openings)
      : points_(points), graph_(graph), rotation_(rotation), openings_(openings) {}

  /// Empty if there is nothing to cut.
  SurfaceCut along(std::vector<CutLoop> handles) const {
    SurfaceCut result;
    Necks necks = findNecks(points_, graph_, rotation_, openings_, handles);
    // As the measured squeeze is the predicted one to the power of 1.5 to 2, this is the range of
    // double.
    constexpr double max_squeeze = 15.0;
    result.has_sphere = handles.empty() && necks.squeeze <= max_squeeze;
    if (!necks.loops.empty()) {
      necks.loops.insert(necks.loops.begin(), handles.begin(), handles.end());
      result.graphs.push_back(cutAlong(points_, graph_, rotation_, necks.loops));
    }
    if (!handles.empty())
      result.graphs.push_back(cutAlong(points_, graph_, rotation_, handles));
    result.handles = std::move(handles);
    return result;
  }

private:
  const Positions& points_;
  const Graph& graph_;
  const RotationSystem& rotation_;
  const Openings& openings_;
};

/// The cuts of a surface. \see SurfaceTopology
std::vector<SurfaceCut> cutsOf(const SurfaceCutter& cutter, std::vector<CutLoop> handles) {
  std::vector<SurfaceCut> cuts;
  const auto add = [&](std::vector<CutLoop> loops) {
    SurfaceCut cut = cutter.along(std::move(loops));
    if (!cut.graphs.empty())
      cuts.push_back(std::move(cut));
  };
  std::vector<CutLoop> certain;
  std::copy_if(handles.begin(), handles.end(), std::back_inserter(certain),
               [](const CutLoop& loop) { return loop.certainty >= 1.0; });
  const bool are_all_certain = certain.size() == handles.size();
  if (!handles.empty())
    add(std::move(handles));
  if (!certain.empty() && !are_all_certain)
    add(std::move(certain));
  add({});
  return cuts;
}

}  // namespace

SurfaceTopology findTopology(const Positions& points, const Graph& graph, bool is_flat, double unit,
                             const Options& options, const Execution& execution) {
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
    return {std::move(surface), {}};
  // Without false edges, but for those that keep it in one piece.
  const Openings& filled = surface.embeddedOpenings();
  const bool has_false = !handles.loops.empty() || !filled.openings.empty();
  const Graph without_false =
      has_false ? withoutVirtualNodes(fillOpenings(points, graph, filled), graph.size()) : Graph();
  std::vector<SurfaceCut> cuts = cutsOf(
      {points, has_false ? without_false : graph, rotation, filled}, std::move(handles.loops));
  return {std::move(surface), std::move(cuts)};
}

}  // namespace spherical_param::internal
