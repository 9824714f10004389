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
  const Indexed<Index> set = Partition(sets).of;
  Indexed<Index> piece_of_set(graph.size(), -1);
  Indexed<Index> number(graph.size());  // of each node in its piece
  Indexed<Piece> pieces;
  for (const Index v : graph.nodes()) {
    Index& piece = piece_of_set[set[v]];
    if (piece < 0) {
      piece = pieces.count();
      pieces.emplace_back();
    }
    number[v] = pieces[piece].nodes.count();
    pieces[piece].nodes.push_back(v);
  }
  for (Piece& piece : pieces)
    for (const Index v : piece.nodes) {
      for (const std::size_t e : graph.entries(v)) {
        piece.graph.neighbors.push_back(number[graph.neighbors[e]]);
        piece.graph.lengths.push_back(graph.lengths[e]);
      }
      piece.graph.endRow();
    }
  return std::vector<Piece>(pieces.begin(), pieces.end());
}

/// The triangulated sphere of a piece, by the nodes of the whole graph; those in openings are left
/// out.
Triangles sphereOf(const Piece& piece, const FilledCut& all, const Options& options,
                   const Execution& execution, EmbeddingReport& report) {
  const std::vector<Index> nodes(piece.nodes.begin(), piece.nodes.end());
  Embedding embedding = embed(piece.graph, all.filled.points(Eigen::all, nodes), options.embedding,
                              options.seed, execution);
  report = std::move(embedding.report);
  const auto kept = std::lower_bound(nodes.begin(), nodes.end(), all.in_rims) - nodes.begin();
  Triangles triangles =
      triangulateSphere(Positions(embedding.directions.leftCols(kept)), execution);
  for (Index& v : triangles.reshaped())
    v = piece.nodes[v];
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
