#pragma once

#include "open_surface.h"
#include "smoothed_mesh.h"
#include "spherical_param/reconstruct.h"

namespace spherical_param::internal {

/// What the stages made of a cloud. Vertices are nodes, in units of the nodes.
struct MeshedCloud {
  NeighborGraph graph;
  Embedding embedding;
  TriangulationReport triangulation;
  MeshOptimization optimization;
  SmoothedMesh smoothed;  ///< empty without smoothing

  bool isSmoothed() const { return smoothed.points.cols() > 0; }
  Triangles& triangles() { return isSmoothed() ? smoothed.triangles : optimization.triangles; }
};

/// Measures, checks and diagnoses a mesh, and moves it and its reports to the result, which is on
/// nodes and in their unit; \see toInput.
Result judge(const Positions& points, MeshedCloud mesh, const OpenSurface& openings,
             const Options& options);

}  // namespace spherical_param::internal
