#include "view_reconstruction.h"

#include "boundary_loops.h"
#include "depth_jumps.h"
#include "judgement.h"
#include "openings.h"
#include "ordered_points.h"
#include "orientation.h"
#include "power_of_two.h"
#include "selection.h"
#include "smooth_fill.h"
#include "spherical_param/errors.h"
#include "union_find.h"
#include "view_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::internal {
namespace {

/// The option that rules out a view; nullptr: none does.
const char* obstacleOf(const Options& options) {
  return options.consolidation == ConsolidationMode::Auto  ? "consolidation"
         : options.smoothing > 0                           ? "smoothing"
         : options.outliers == OutlierMode::Deviation      ? "outliers"
         : options.intersections == IntersectionMode::Keep ? "intersections"
                                                           : nullptr;
}

/// The mesh from the place that the caller gave, or from one that is found.
///
/// \param search among the nodes; is made if it is needed.
std::optional<FoundView> viewOf(const OrderedPoints& nodes, const Options& options,
                                const CloudInfo& info, const Execution& execution,
                                NeighborSearch& search) {
  if (!isGiven(options)) {
    // The search would take longer than to mesh a smaller cloud.
    constexpr Eigen::Index min_points = 1000;
    if (nodes.points.cols() < min_points)
      return std::nullopt;
    search = makeNeighborSearch(nodes.points, execution);
    const Eigen::Vector3d viewpoint = info.viewpoint.value_or(Eigen::Vector3d::Zero());
    return findView(nodes.points, timesPowerOfTwo(viewpoint, -nodes.exponent), search, execution);
  }
  const Eigen::Vector3d place = givenPlace(nodes.points, std::ldexp(1.0, nodes.exponent), options);
  FoundView view{triangulateView(nodes.points, place, reportOf(execution, "view")),
                 options.view == ViewMode::Up ? ViewSource::Above : ViewSource::Given,
                 spacingOf(nodes.points, execution)};
  if (view.mesh.triangles.cols() == 0)
    throw InvalidInput(
        "reconstruct: the view is too far away, or sees the points on one line or few rays; "
        "give another view, or none");
  return view;
}

/// The points without heights, which say nothing about the spacing of an elevation grid.
Positions withoutHeights(const Positions& points) {
  Positions flat = points;
  flat.row(2).setZero();
  return flat;
}

/// The opening within a boundary loop, which is certain.
Opening openingOf(const Positions& points, const Indexed<double>& spacing,
                  std::vector<Index> loop) {
  Opening opening = measured(points, spacing, std::move(loop));
  opening.certainty = 1.0;
  opening.is_flat = false;
  return opening;
}

/// The number of the piece that each node is in, 0 for the largest; -1: none.
Indexed<Index> numberPieces(const Triangles& triangles, std::size_t nodes, const Options& options) {
  const bool is_one = options.parts == PartsMode::All;
  UnionFind sets = internal::piecesOf(triangles, nodes);
  const Partition partition(sets);
  const auto least = is_one ? std::size_t{2} : static_cast<std::size_t>(options.min_points);
  std::vector<Index> pieces;
  for (const Index v : indicesOf(partition.sizes))
    if (partition.sizes[v] >= least)
      pieces.push_back(v);
  std::stable_sort(pieces.begin(), pieces.end(),
                   [&](Index a, Index b) { return partition.sizes[a] > partition.sizes[b]; });
  if (options.parts == PartsMode::Largest && !pieces.empty())
    pieces.resize(1);
  Indexed<Index> number(nodes, -1);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    number[pieces[i]] = is_one ? 0 : static_cast<Index>(i);
  Indexed<Index> piece_of(nodes);
  for (const Index v : indicesOf(piece_of))
    piece_of[v] = number[partition.of[v]];
  return piece_of;
}

/// Makes the surfaces of a mesh that is open at jumps, in the unit and the numbers of the input.
class PieceMaker {
public:
  /// \param spacing of the nodes.
  PieceMaker(const OrderedPoints& nodes, const Indexed<double>& spacing, const ViewMesh& view,
             const SphereMesh& mesh, const Options& options)
      : nodes_(nodes), spacing_(spacing), view_(view), mesh_(mesh), options_(options),
        piece_of_(numberPieces(mesh.surfaceTriangles(), columnCount(nodes.points), options)),
        vertex_of_node_(columnCount(nodes.points), -1), number_of_(mesh.slotCount(), -1) {
    if (!piece_of_.empty())
      pieces_.resize(
          static_cast<std::size_t>(*std::max_element(piece_of_.begin(), piece_of_.end())) + 1);
  }

  /// \param inputs of the nodes, ascending.
  std::vector<Surface> run(const Positions& points, const Positions& normals,
                           const std::vector<Index>& inputs, const std::vector<Gap>& filled,
                           LeftOut& left_out) {
    sortPoints(inputs, left_out);
    makeTriangles();
    makeSphere();
    const std::vector<Indexed<double>> spacing = spacings();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      Surface& mesh = pieces_[i];
      mesh.points = points(Eigen::all, mesh.input_of_vertex);
      if (normals.cols() > 0)
        faceNormals(normals(Eigen::all, mesh.input_of_vertex), mesh);
      for (std::vector<Index>& loop :
           boundaryLoops(mesh.triangles, columnCount(mesh.points), options_.threads))
        mesh.openings.push_back(openingOf(mesh.points, spacing[i], std::move(loop)));
    }
    for (const Gap& gap : filled)
      if (const Index i = piece_of_[gap.loop.front()]; i >= 0)
        addFilled(gap, spacing[static_cast<std::size_t>(i)]);
    return std::move(pieces_);
  }

private:
  Surface& pieceAt(Index node) { return pieces_[static_cast<std::size_t>(piece_of_[node])]; }

  /// Adds each input point to its piece, or to the points that are left out.
  void sortPoints(const std::vector<Index>& inputs, LeftOut& left_out) {
    Indexed<std::uint8_t> has_triangle(piece_of_.size(), 0);
    const Triangles surface = mesh_.surfaceTriangles();
    for (const Index v : surface.reshaped())
      has_triangle[v] = 1;
    const auto reason = [&](Index node) -> std::vector<Index>& {
      return has_triangle[node] != 0                                     ? left_out.other_parts
             : options_.outliers == OutlierMode::Auto && !isHidden(node) ? left_out.outliers
                                                                         : left_out.unmeshed;
    };
    const Indexed<Index> node_of = nodesOfInput(nodes_);
    for (const Index i : indicesOf(node_of)) {
      const Index input = inputs[static_cast<std::size_t>(i)];
      const Index node = node_of[i];
      if (piece_of_[node] < 0) {
        reason(node).push_back(input);
        continue;
      }
      Surface& of = pieceAt(node);
      Index& vertex = vertex_of_node_[node];
      if (vertex < 0) {
        vertex = static_cast<Index>(of.input_of_vertex.size());
        of.input_of_vertex.push_back(input);
      }
      of.inputs.push_back(input);
      of.vertex_of_input.push_back(vertex);
    }
  }

  bool isHidden(Index node) const {
    return std::binary_search(view_.hidden.begin(), view_.hidden.end(), node);
  }

  /// Turns a surface as normals are on three quarters of its area.
  static void faceNormals(const Positions& normals, Surface& mesh) {
    const double agreement = agreementWith(normals.array().isFinite().select(normals, 0.0).eval(),
                                           mesh.points, mesh.triangles);
    if (std::abs(agreement) < 0.5)
      return;
    mesh.faced_by = FacedBy::Normals;
    if (agreement < 0.0)
      flipOrientation(mesh.triangles);
  }

  /// The triangles of the surfaces face the place; those around it outward.
  void makeTriangles() {
    std::vector<std::vector<Index>> corners(pieces_.size());
    for (const Index t : mesh_.surface()) {
      const auto nodes = mesh_.vertices(t);
      if (piece_of_[nodes[0]] < 0)
        continue;
      std::vector<Index>& all = corners[static_cast<std::size_t>(piece_of_[nodes[0]])];
      number_of_[t] = static_cast<Index>(all.size() / 3);
      for (const int k : {0, 2, 1})
        all.push_back(vertex_of_node_[mesh_.vertex(t, k)]);
    }
    const bool is_closed = !mesh_.hasOpen();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      Surface& mesh = pieces_[i];
      mesh.triangles = Eigen::Map<const Triangles>(
          corners[i].data(), 3, static_cast<Eigen::Index>(corners[i].size() / 3));
      mesh.faced_by = is_closed ? FacedBy::Outward : FacedBy::Viewpoint;
      if (is_closed)
        flipOrientation(mesh.triangles);
    }
  }

  void makeSphere() {
    for (Surface& piece : pieces_)
      piece.sphere.resize(3, static_cast<Eigen::Index>(piece.input_of_vertex.size()));
    const Positions directions = directionsFrom(view_.place, nodes_.points);
    for (const Index node : indicesOf(piece_of_))
      if (piece_of_[node] >= 0)
        pieceAt(node).sphere.col(vertex_of_node_[node]) = directions.col(node);
  }

  /// At the vertices of each piece [unit of the input].
  std::vector<Indexed<double>> spacings() const {
    std::vector<Indexed<double>> all;
    for (const Surface& piece : pieces_)
      all.emplace_back(piece.input_of_vertex.size());
    for (const Index node : indicesOf(piece_of_))
      if (piece_of_[node] >= 0)
        all[static_cast<std::size_t>(piece_of_[node])][vertex_of_node_[node]] =
            std::ldexp(spacing_[node], nodes_.exponent);
    return all;
  }

  void addFilled(const Gap& gap, const Indexed<double>& spacing) {
    Surface& mesh = pieceAt(gap.loop.front());
    std::vector<Index> loop;
    for (const Index node : gap.loop)
      loop.push_back(vertex_of_node_[node]);
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    Opening opening = openingOf(mesh.points, spacing, std::move(loop));
    opening.is_filled = true;
    for (const Index t : gap.triangles)
      opening.triangles.push_back(number_of_[t]);
    std::sort(opening.triangles.begin(), opening.triangles.end());
    mesh.openings.push_back(std::move(opening));
  }

  const OrderedPoints& nodes_;
  const Indexed<double>& spacing_;
  const ViewMesh& view_;
  const SphereMesh& mesh_;
  const Options& options_;
  Indexed<Index> piece_of_;
  Indexed<Index> vertex_of_node_;
  Indexed<Index> number_of_;  ///< of each triangle in its piece; -1: in none
  std::vector<Surface> pieces_;
};

/// Fills the openings of surfaces, and judges them.
void finish(const Options& options, StageClock& clock, std::vector<Surface>& surfaces) {
  if (options.fill == FillMode::Smooth) {
    clock.begin("fill");
    for (Surface& surface : surfaces) {
      fillSmoothly(clock.limited(), surface);
      if (surface.added_vertices > 0)
        surface.sphere.resize(3, 0);
    }
  }
  clock.begin("quality");
  for (Surface& surface : surfaces)
    judge(options, surface);
}

}  // namespace

bool reconstructView(const Positions& points, const Options& given, const CloudInfo& info,
                     StageClock& clock, Result& result, std::optional<SearchedNodes>& known) {
  Options options = withTopology(given);
  // A closed mesh is made by the general method, from the directions.
  if (options.view == ViewMode::None || options.surface == SurfaceMode::Closed)
    return false;
  if (const char* const obstacle = obstacleOf(options)) {
    if (isGiven(options))
      throw InvalidInput(std::string("reconstruct: ") + obstacle +
                         " cannot be used with a view; leave one of them out");
    return false;
  }
  clock.begin("view");
  LeftOut left_out;
  const std::vector<Index> inputs = usableInputs(points, info, left_out);
  if (inputs.size() < 4)
    return false;  // the general method rejects it
  known =
      SearchedNodes{orderCheckedPoints(Positions(points(Eigen::all, inputs)), options.threads), {}};
  const OrderedPoints& nodes = known->nodes;
  std::optional<FoundView> view = viewOf(nodes, options, info, clock.execution(), known->search);
  if (!view)
    return false;
  known->search = {};  // frees its tree
  // If there are too few points for a part, all of them are one, as without a view.
  if (given.parts == PartsMode::AsTopology &&
      inputs.size() < static_cast<std::size_t>(options.min_points))
    options.parts = PartsMode::All;
  clock.begin("optimization");
  clock.keep(options.fill == FillMode::Smooth ? kTimeForFill : 0.0);
  flipInView(nodes.points, view->mesh, clock.execution(),
             [&] { return clock.remaining() == std::optional(0.0); });
  clock.keep(0.0);
  clock.begin("openings");
  const bool is_grid = view->source == ViewSource::Above && isElevationGrid(nodes.points);
  const Positions flat = is_grid ? withoutHeights(nodes.points) : Positions();
  const Positions& measured = is_grid ? flat : nodes.points;
  const Indexed<double> spacing =
      is_grid ? spacingOf(measured, clock.execution()) : std::move(view->spacing);
  SphereMesh mesh =
      openJumps(measured, spacing, view->mesh, static_cast<std::size_t>(options.min_points));
  // Most openings of depth images are noise of at most this size.
  constexpr std::size_t small_gap = 8;
  const GapLimits limits{options.surface == SurfaceMode::Open ? 0 : small_gap,
                         static_cast<std::size_t>(options.fill_holes)};
  const std::vector<Gap> filled = fillGaps(nodes.points, spacing, view->mesh, limits, mesh);
  std::vector<Surface> pieces = PieceMaker(nodes, spacing, view->mesh, mesh, options)
                                    .run(points, info.normals, inputs, filled, left_out);
  std::size_t meshed = 0;
  for (const Surface& piece : pieces)
    meshed += piece.inputs.size();
  // A view that shows less of the cloud is not used.
  const bool is_small = options.parts == PartsMode::Each && 10 * meshed < 9 * inputs.size();
  if (!isGiven(options) && (pieces.empty() || is_small))
    return false;
  if (pieces.empty())
    throw InvalidInput(
        "reconstruct: no part has min_points = " + std::to_string(options.min_points) +
        " points; give a lower min_points, or parts = all");
  finish(options, clock, pieces);
  result.surfaces = std::move(pieces);
  result.left_out = std::move(left_out);
  result.view = View{timesPowerOfTwo(view->mesh.place, nodes.exponent), view->source};
  return true;
}

}  // namespace spherical_param::internal
