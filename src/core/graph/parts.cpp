#include "parts.h"

#include "graph_building.h"
#include "surface_distance.h"

#include <algorithm>

namespace spherical_param::internal {

std::vector<Index> partsOf(const Positions& points, const Graph& agreed, const Stars& stars,
                           std::size_t min_points) {
  UnionFind components = connectedComponents(agreed);
  std::vector<Index> part = representatives(components, agreed.size());
  const std::vector<std::size_t> sizes = setSizes(part);
  std::vector<char> in_part(part.size());
  std::transform(part.begin(), part.end(), in_part.begin(), [&](Index component) {
    return sizes[static_cast<std::size_t>(component)] >= min_points ? 1 : 0;
  });
  const auto in_parts = std::count(in_part.begin(), in_part.end(), 1);
  if (in_parts == 0)
    std::fill(part.begin(), part.end(), Index{-1});
  if (in_parts == 0 || in_parts == static_cast<std::ptrdiff_t>(part.size()))
    return part;

  SurfaceDistance distance(points, agreed);
  distance.setSurfaces(in_part);
  const std::vector<char> in_star = stars.inStarsOf(in_part);
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (in_part[i] != 0)
      continue;
    const auto node = static_cast<Index>(i);
    const bool is_beside = in_star[i] != 0 || distance.beyondNoise(node) == 0.0;
    part[i] = is_beside ? part[static_cast<std::size_t>(distance.nearest(node))] : -1;
  }
  return part;
}

}  // namespace spherical_param::internal
