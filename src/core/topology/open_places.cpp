#include "open_places.h"

#include <algorithm>
#include <utility>

namespace spherical_param::internal {

OpenPlaces::OpenPlaces(const Positions& points, const Graph& graph, const Openings& openings)
    : points_(&points), nearest_(graph.size(), -1), is_in_loop_(graph.size(), 0),
      spacing_(openings.spacing) {
  std::vector<Index> ring;
  const auto add = [&](Index v, Index opening) {
    if (nearest_[v] >= 0)
      return;
    nearest_[v] = opening;
    ring.push_back(v);
  };
  for (std::size_t o = 0; o < openings.openings.size(); ++o) {
    const std::vector<Index>& loop = openings.openings[o].loop;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Index v = loop[i];
      const Index w = loop[i + 1 < loop.size() ? i + 1 : 0];
      boundary_edges_.push_back({std::min(v, w), std::max(v, w)});
      is_in_loop_[v] = 1;
      add(v, static_cast<Index>(o));
    }
  }
  sortUnique(boundary_edges_);
  for (int step = 0; step < 2; ++step) {
    const std::vector<Index> last = std::move(ring);
    ring.clear();
    for (const Index v : last)
      for (const Index w : graph.row(v))
        add(w, nearest_[v]);
  }
}

std::optional<std::size_t> OpenPlaces::openingOver(Index a, Index b, Index c) const {
  if (!isOpen(a, b, c))
    return std::nullopt;
  return static_cast<std::size_t>(nearest_[b] == nearest_[c] ? nearest_[b] : nearest_[a]);
}

bool OpenPlaces::isLong(Index a, Index b) const {
  const double longest = 1.6 * std::max(spacing_[a], spacing_[b]);
  return (points_->col(a) - points_->col(b)).squaredNorm() > longest * longest;
}

bool OpenPlaces::close(const std::vector<Index>& vertices) {
  bool has_changed = false;
  for (const Index v : vertices)
    if (nearest_[v] >= 0 && is_in_loop_[v] == 0) {
      nearest_[v] = -1;
      has_changed = true;
    }
  return has_changed;
}

bool OpenPlaces::isBoundary(Index a, Index b) const {
  const std::array<Index, 2> edge{std::min(a, b), std::max(a, b)};
  return std::binary_search(boundary_edges_.begin(), boundary_edges_.end(), edge);
}

std::vector<Index> trianglesWithoutLoop(const SphereMesh& mesh, const OpenPlaces& openings) {
  const auto is_open = [&](Index t) { return openings.isOpen(mesh.vertices(t)); };
  std::vector<Index> found;
  IndexSet seen(mesh.slotCount());
  for (Index first = 0; first < mesh.size(); ++first) {
    if (!is_open(first) || !seen.insert(first))
      continue;
    std::vector<Index> piece{first};
    bool has_loop = false;
    for (std::size_t head = 0; head < piece.size(); ++head)
      for (int k = 0; k < 3; ++k) {
        const Index t = piece[head];
        const Index next = mesh.neighbor(t, k);
        const auto [v, w] = mesh.side(t, k);
        has_loop = has_loop || openings.isBoundary(v, w);
        if (is_open(next) && seen.insert(next))
          piece.push_back(next);
      }
    if (!has_loop)
      found.insert(found.end(), piece.begin(), piece.end());
  }
  return found;
}

}  // namespace spherical_param::internal
