#pragma once

#include "embedding.h"
#include "graph.h"
#include "mesh_optimization.h"
#include "spherical_param/result.h"

#include <vector>

namespace spherical_param::internal {

/// Results of the stages. Vertices are nodes, in the unit of the nodes.
struct MeshedCloud {
  NeighborGraph graph;
  std::vector<HandleLoop> handles;  ///< that were found
  Embedding embedding;              ///< without directions if the mesh has handles
  MeshOptimization optimization;
  bool has_certain_triangles_only = false;  ///< see Surface
  bool is_one_sided = false;                ///< the surface of the graph is
  SmoothedMesh smoothed;                    ///< empty without smoothing

  bool isSmoothed() const { return smoothed.points.cols() > 0; }
  Triangles& triangles() { return isSmoothed() ? smoothed.triangles : optimization.triangles; }
};

}  // namespace spherical_param::internal
