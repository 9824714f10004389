#pragma once

#include "face_mesh.h"
#include "graph.h"
#include "open_surface.h"
#include "rotation_system.h"
#include "spherical_param/options.h"
#include "stage_clock.h"

#include <optional>

namespace spherical_param::internal {

/// What is known of a surface before it is meshed: its openings, and a mesh of the faces of its
/// graph.
class SurfacePlan {
public:
  /// A closed surface without known faces.
  SurfacePlan() = default;
  /// \param points  nodes; must outlive this, as must the graph.
  /// \param is_flat all points are in one plane, where openings cannot be filled.
  /// \param unit    of the nodes' coordinates [unit of the input].
  SurfacePlan(const Positions& points, const Graph& graph, bool is_flat, double unit,
              const Options& options, StageClock& clock);

  const OpenSurface& openings() const { return openings_; }
  /// The mesh of the faces, \see meshFaces; nullptr if there is none.
  const SphereMesh* faces();
  /// Whether the points sample a surface at all. \see spreadOf
  bool samplesSurface() const { return samples_surface_; }
  void setNoSurface() { samples_surface_ = false; }

private:
  const Positions* points_ = nullptr;
  const Graph* graph_ = nullptr;
  OpenSurface openings_;
  bool samples_surface_ = true;
  std::optional<RotationSystem> rotation_;  ///< until the faces are made
  std::optional<SphereMesh> faces_;
};

}  // namespace spherical_param::internal
