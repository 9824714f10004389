#pragma once

#include "embedding.h"
#include "graph.h"
#include "open_surface.h"
#include "smoothed_mesh.h"
#include "spherical_param/options.h"
#include "spherical_param/result.h"

namespace spherical_param::internal {

/// Results of the stages. Vertices are nodes, in the unit of the nodes.
struct MeshedCloud {
  NeighborGraph graph;
  Embedding embedding;
  MeshOptimization optimization;
  SmoothedMesh smoothed;  ///< empty without smoothing

  bool isSmoothed() const { return smoothed.points.cols() > 0; }
  Triangles& triangles() { return isSmoothed() ? smoothed.triangles : optimization.triangles; }
};

/// Measures, checks and diagnoses a mesh. The result is on nodes and in their unit, \see toInput.
Surface judge(const Positions& points, MeshedCloud mesh, const OpenSurface& openings,
              const Options& options, const Execution& execution);

}  // namespace spherical_param::internal
