#include "open_places.h"

#include "optimization_constants.h"

#include <algorithm>

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;

/// Steps from a loop of the graph to where triangles may be open.
constexpr int kNearSteps = 2;

}  // namespace

OpenPlaces::OpenPlaces(const Positions& points, const Graph& graph, const Openings& openings)
    : points_(points), is_near_(graph.size(), 0), nearest_(graph.size(), 0),
      spacing_(openings.spacing.begin(), openings.spacing.end()) {
  std::vector<Index> ring;
  const auto add = [&](Index v, std::uint8_t mark, Index opening) {
    std::uint8_t& is_near = is_near_[v];
    if (is_near != 0)
      return;
    is_near = mark;
    nearest_[v] = opening;
    ring.push_back(v);
  };
  for (std::size_t o = 0; o < openings.openings.size(); ++o) {
    const std::vector<Index>& loop = openings.openings[o].loop;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Index v = loop[i];
      const Index w = loop[i + 1 < loop.size() ? i + 1 : 0];
      rim_edges_.push_back({std::min(v, w), std::max(v, w)});
      add(v, kLoop, static_cast<Index>(o));
    }
  }
  sortUnique(rim_edges_);
  for (int step = 0; step < kNearSteps; ++step) {
    const std::vector<Index> last = std::move(ring);
    ring.clear();
    for (const Index v : last)
      for (const Index w : graph.row(v))
        add(w, kNear, nearest_[v]);
  }
}

std::optional<std::size_t> OpenPlaces::openingOver(Index a, Index b, Index c) const {
  if (!isOpen(a, b, c))
    return std::nullopt;
  const Index of_a = nearest_[a];
  const Index of_b = nearest_[b];
  const Index of_c = nearest_[c];
  return static_cast<std::size_t>(of_b == of_c ? of_b : of_a);
}

bool OpenPlaces::isLong(Index a, Index b) const {
  const double longest = tuned::kMaxSurfaceEdge * std::max(spacing_[a], spacing_[b]);
  return (points_.col(a) - points_.col(b)).squaredNorm() > longest * longest;
}

bool OpenPlaces::close(const std::vector<Index>& vertices) {
  bool has_changed = false;
  for (const Index v : vertices)
    if (is_near_[v] == kNear) {
      is_near_[v] = 0;
      has_changed = true;
    }
  return has_changed;
}

bool OpenPlaces::isRim(Index a, Index b) const {
  const std::array<Index, 2> edge{std::min(a, b), std::max(a, b)};
  return std::binary_search(rim_edges_.begin(), rim_edges_.end(), edge);
}

}  // namespace spherical_param::internal
