#include "part_numbers.h"

#include "graph_building.h"
#include "surface_distance.h"

#include <algorithm>
#include <cstddef>

namespace spherical_param::internal {

std::vector<Index> partOfNodes(const Positions& points, const Graph& agreed, int min_points,
                               const InStarsOf& in_stars_of) {
  UnionFind components = connectedComponents(agreed);
  std::vector<Index> part = representatives(components, agreed.size());
  std::vector<int> sizes(part.size(), 0);
  for (const Index component : part)
    ++sizes[static_cast<std::size_t>(component)];
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
  const std::vector<char> in_star = in_stars_of(in_part);
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
