#include "parts.h"

#include "graph_building.h"
#include "surface_distance.h"

#include <algorithm>

namespace spherical_param::internal {

Indexed<Index> partsOf(const Positions& points, const Graph& agreed, const Stars& stars,
                       std::size_t min_points) {
  UnionFind components = connectedComponents(agreed);
  Indexed<Index> part = representatives(components, agreed.size());
  const Indexed<std::size_t> sizes = setSizes(part);
  Indexed<char> in_part(part.size());
  std::transform(part.begin(), part.end(), in_part.begin(),
                 [&](Index component) { return sizes[component] >= min_points ? 1 : 0; });
  const auto [least, most] = std::minmax_element(in_part.begin(), in_part.end());
  if (*most == 0)
    std::fill(part.begin(), part.end(), Index{-1});
  if (*least == *most)
    return part;

  SurfaceDistance distance(points, agreed);
  distance.setSurfaces(in_part);
  const Indexed<char> in_star = stars.inStarsOf(in_part);
  for (const Index i : indicesOf(part)) {
    if (in_part[i] != 0)
      continue;
    const bool is_beside = in_star[i] != 0 || distance.beyondNoise(i) == 0.0;
    part[i] = is_beside ? part[distance.nearest(i)] : -1;
  }
  return part;
}

}  // namespace spherical_param::internal
