#pragma once

#include "open_surface.h"
#include "smoothed_mesh.h"
#include "spherical_param/reconstruct.h"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::internal {

/// The options of a run, and what is different from the first.
struct Plan {
  std::string description;
  Options options;
};

/// The plan of run 0, which is what was asked for, or of a retry, which differs in one thing.
Plan planOf(int run, const Options& options);

/// The mesh of one run. Vertices are nodes, in units of the nodes.
struct Candidate {
  NeighborGraph graph;
  Embedding embedding;
  TriangulationReport triangulation;
  MeshOptimization optimization;
  SmoothedMesh smoothed;  ///< empty without smoothing

  bool isSmoothed() const { return smoothed.points.cols() > 0; }
  const Triangles& triangles() const {
    return isSmoothed() ? smoothed.triangles : optimization.triangles;
  }
  Triangles& triangles() { return isSmoothed() ? smoothed.triangles : optimization.triangles; }
  /// Pairs of triangles that intersect, on the smoothed points if there are any.
  std::size_t intersections() const {
    return isSmoothed() ? smoothed.report.self_intersections
                        : optimization.self_intersections.size();
  }
  /// Whether no triangles intersect, or only because of noise: none do on the positions that the
  /// optimisation has smoothed.
  bool isGood() const;
  /// Candidates are compared by this; the smaller is better.
  std::pair<std::size_t, double> badness() const {
    return {intersections(), optimization.report.energy};
  }
};

/// The best mesh of all runs, and the first graph, by which the cloud is judged.
struct BestOfRuns {
  Candidate mesh;
  std::optional<NeighborGraph> first_graph;  ///< empty while it is the graph of the mesh
  std::vector<RunReport> runs;               ///< of all runs, in their order

  const NeighborGraph& graph() const { return first_graph ? *first_graph : mesh.graph; }
  /// Reports a run, and chooses its mesh if it is the first or better than the best so far.
  void add(const std::string& description, Candidate candidate, double seconds);
};

/// Whether retries may find a better mesh: the mesh is bad, and either the cloud looks like a
/// closed surface, or one with the openings that are left open, or few triangles intersect.
bool isWorthRetrying(const Positions& points, const Candidate& mesh, const OpenSurface& surface,
                     const Options& options);

}  // namespace spherical_param::internal
