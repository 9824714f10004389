#pragma once

#include "open_places.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

#include <optional>
#include <vector>

namespace spherical_param::internal {

/// The openings of a cloud, and which of them the mesh leaves open.
class OpenSurface {
public:
  /// \param points  nodes, must outlive this.
  /// \param graph   of the nodes.
  /// \param found   openings of the graph.
  /// \param is_flat all points are in one plane, where openings cannot be filled.
  /// \param unit    of the nodes' coordinates [unit of the input].
  OpenSurface(const Positions& points, const Graph& graph, Openings found, bool is_flat,
              double unit, const Options& options);

  OpenSurface() = default;  // a closed surface

  bool isOpen() const { return places_.has_value(); }
  /// The openings that stay open; nullptr if the mesh is closed.
  const OpenPlaces* places() const { return places_ ? &*places_ : nullptr; }
  bool isOneSided() const { return embedded_.is_one_sided; }
  /// Whether the mesh fills openings.
  bool fillsPossible() const;
  double unit() const { return unit_; }
  /// The openings that virtual nodes fill while the surface is embedded.
  const Openings& embeddedOpenings() const { return embedded_; }
  /// All openings, with the triangles that fill them.
  ///
  /// \param points, graph as for the constructor.
  /// \param triangles     of the mesh.
  std::vector<Opening> found(const Positions& points, const Graph& graph,
                             const Triangles& triangles) const;

private:
  Openings embedded_;
  std::optional<OpenPlaces> places_;
  double unit_ = 1.0;
};

}  // namespace spherical_param::internal
