#pragma once

#include "cut_graph.h"
#include "graph.h"
#include "handles.h"
#include "open_surface.h"
#include "spherical_param/options.h"
#include "stage_clock.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace spherical_param::internal {

/// What is known of a surface before it is meshed.
struct SurfaceTopology {
  OpenSurface openings;
  std::vector<CutLoop> handles;  ///< all that were found
  std::unique_ptr<const RotationSystem>
      rotation;  ///< null: the surface is not to be cut, or it was taken
};

/// Finds the openings and the handles of a surface.
///
/// \param points   nodes, must outlive the result.
/// \param graph    of the nodes.
/// \param is_flat  all points are in one plane: openings cannot be filled.
/// \param unit     of the nodes' coordinates [unit of the input].
SurfaceTopology findTopology(const Positions& points, const Graph& graph, bool is_flat, double unit,
                             const Options& options, StageClock& clock);

/// A way to cut a surface into spheres.
struct SurfaceCut {
  std::vector<CutLoop> handles;
  /// The handles and the necks, if there are any; the handles alone, if that leaves one to be cut.
  std::vector<std::vector<CutLoop>> loops;
  /// Whether one sphere can hold the surface.
  bool has_sphere = false;
};

/// Cuts a surface along handles, and along necks, in one way after the other.
class SurfaceCutter {
public:
  /// \param points, graph, topology must outlive this; the rotation system is taken.
  SurfaceCutter(const Positions& points, const Graph& graph, SurfaceTopology& topology);

  /// Along all handles that were found; then along those that are certain, if not all are; then
  /// along necks alone. Unset: no further way, the surface is a sphere.
  std::optional<SurfaceCut> next();
  CutGraph along(const std::vector<CutLoop>& loops) const;

private:
  const Graph& graph() const { return rest_ ? *rest_ : all_edges_; }

  const Positions& points_;
  const Graph& all_edges_;
  const Openings& openings_;  ///< that virtual nodes fill
  std::unique_ptr<const RotationSystem> rotation_;
  std::optional<Graph> rest_;  ///< without false edges, if there are any
  std::vector<std::vector<CutLoop>> handles_;
  std::size_t next_ = 0;
};

}  // namespace spherical_param::internal
