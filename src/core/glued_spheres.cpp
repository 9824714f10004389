#include "glued_spheres.h"

#include "embedding.h"
#include "glue.h"
#include "graph_building.h"
#include "spherical_param/sphere_triangulation.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// A component of a graph by itself.
struct Piece {
  Indexed<Index> nodes;  ///< its nodes in the whole graph, ascending
  Graph graph;
};

std::vector<Piece> piecesOf(const Graph& graph) {
  UnionFind sets = connectedComponents(graph);
  const NeighborRows nodes = nodesOfParts(Partition(sets).of, graph.size());
  Indexed<Index> number(graph.size());  // of each node in its piece
  std::vector<Piece> pieces;
  for (const Index set : nodes.nodes()) {
    const Row<Index> of_set = nodes.row(set);
    if (of_set.size() == 0)
      continue;
    Piece& piece = pieces.emplace_back();
    for (const Index v : of_set) {
      number[v] = piece.nodes.count();
      piece.nodes.push_back(v);
    }
    for (const Index v : of_set) {
      for (const std::size_t e : graph.entries(v)) {
        piece.graph.neighbors.push_back(number[graph.neighbors[e]]);
        piece.graph.lengths.push_back(graph.lengths[e]);
      }
      piece.graph.endRow();
    }
  }
  return pieces;
}

/// The triangulated sphere of a piece, by the nodes of the whole graph; those in openings are left
/// out.
Triangles sphereOf(const Piece& piece, const FilledCut& all, const Options& options,
                   const Execution& execution, EmbeddingReport& report) {
  const Indexed<Index>& nodes = piece.nodes;
  Embedding embedding = embed(piece.graph, all.filled.points(Eigen::all, nodes), options.embedding,
                              options.seed, execution);
  report = std::move(embedding.report);
  const auto kept = std::lower_bound(nodes.begin(), nodes.end(), all.in_rims) - nodes.begin();
  Triangles triangles =
      triangulateSphere(Positions(embedding.directions.leftCols(kept)), execution);
  for (Index& v : triangles.reshaped())
    v = nodes[v];
  return triangles;
}

}  // namespace

std::optional<GluedMesh> meshGluedSpheres(std::size_t nodes, const CutGraph& cut,
                                          const Openings& openings, const Options& options,
                                          const Execution& execution) {
  // Fewer nodes than these are no sphere with two rims.
  constexpr std::size_t min_nodes = 8;
  FilledCut all = fillCut(cut, openings);
  std::vector<Piece> pieces = piecesOf(all.filled.graph);
  all.filled.graph = {};
  GluedMesh result;
  Triangles spheres(3, 0);
  std::size_t largest = 0;
  for (const Piece& piece : pieces) {
    if (piece.nodes.size() < min_nodes)
      return std::nullopt;
    EmbeddingReport report;
    const Triangles sphere = sphereOf(piece, all, options, execution, report);
    spheres.conservativeResize(3, spheres.cols() + sphere.cols());
    spheres.rightCols(sphere.cols()) = sphere;
    const bool has_collapsed = report.fallback_start && !result.embedding.fallback_start;
    if (has_collapsed || piece.nodes.size() > largest)
      result.embedding = std::move(report);
    largest = std::max(largest, piece.nodes.size());
  }
  std::optional<Triangles> glued = glue(nodes, cut, spheres, pieces.size(), all.in_rims);
  if (!glued)
    return std::nullopt;
  result.triangles = std::move(*glued);
  return result;
}

}  // namespace spherical_param::internal
