#include "ruin_and_recreate.h"

#include "bit_mixing.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace spherical_param::internal {

RuinAndRecreate::RuinAndRecreate(EnergyMesh& mesh, Flips& flips, std::uint64_t seed)
    : mesh_(mesh), flips_(flips), random_(seed), seen_triangles_(mesh.mesh().slotCount()),
      seen_vertices_(columnCount(mesh.points())) {}

std::size_t RuinAndRecreate::random(std::size_t end) {
  random_ = splitmix64(random_);
  return random_ % end;
}

bool RuinAndRecreate::remove(Index v) {
  const SphereMesh& mesh = mesh_.mesh();
  while (mesh.degree(v) > 3) {
    // Of the flips that take an edge from the vertex, the one that costs least.
    double best = -std::numeric_limits<double>::infinity();
    Index triangle = -1;
    int corner = 0;
    mesh.forEachAround(v, [&](Index t, int corner_of_v) {
      const int k = (corner_of_v + 1) % 3;
      if (!isFree(mesh, mesh.diamond(t, k)))
        return;
      const double gain = mesh_.flipGain(t, k, best);
      if (gain > best) {
        best = gain;
        triangle = t;
        corner = k;
      }
    });
    if (triangle < 0 || !mesh_.flip(triangle, corner, best))
      return false;
  }
  return mesh_.merge(v);
}

bool RuinAndRecreate::insert(Index v, const std::vector<Index>& neighbors) {
  const SphereMesh& mesh = mesh_.mesh();
  seen_triangles_.clear();
  double least = std::numeric_limits<double>::infinity();
  Index best = -1;
  for (const Index w : neighbors) {
    if (mesh.triangleAt(w) < 0)
      continue;
    mesh.forEachAround(w, [&](Index t, int) {
      if (!seen_triangles_.insert(t))
        return;
      const double cost = mesh_.splitCost(t, v, least);
      if (cost < least) {
        least = cost;
        best = t;
      }
    });
  }
  if (best < 0)
    return false;
  std::vector<Index> changed;
  for (const Index t : mesh_.split(best, v, least)) {
    changed.push_back(t);
    changed.push_back(mesh.neighbor(t, 0));
  }
  flips_.flipAround(changed);
  return true;
}

bool RuinAndRecreate::recreate(const std::vector<Index>& vertices, const Accept& accept) {
  struct Removed {
    Index vertex;
    std::vector<Index> neighbors;
  };
  std::vector<Removed> out;
  for (const Index v : vertices) {
    out.push_back({v, {}});
    appendNeighbors(mesh_, v, out.back().neighbors);
  }
  const auto erase_if = [&](const auto& is) {
    out.erase(std::remove_if(out.begin(), out.end(), is), out.end());
  };
  mesh_.begin();
  erase_if([&](const Removed& vertex) { return !remove(vertex.vertex); });
  for (std::size_t i = out.size(); i > 1; --i)
    std::swap(out[i - 1], out[random(i)]);
  // Vertices none of whose neighbours are back yet wait for them.
  for (std::size_t before = 0; before != out.size();) {
    before = out.size();
    erase_if([&](const Removed& vertex) { return insert(vertex.vertex, vertex.neighbors); });
  }
  const bool is_accepted = out.empty() && accept(mesh_.change());
  if (is_accepted)
    mesh_.commit();
  else
    mesh_.rollBack();
  return is_accepted;
}

std::vector<Index> RuinAndRecreate::spread(const std::vector<Index>& seeds, std::size_t count) {
  seen_vertices_.clear();
  std::vector<Index> front;
  const auto add = [&](Index v) {
    if (seen_vertices_.insert(v))
      front.push_back(v);
  };
  std::vector<Index> neighbors;
  const auto add_neighbors = [&](Index v) {
    neighbors.clear();
    appendNeighbors(mesh_, v, neighbors);
    std::for_each(neighbors.begin(), neighbors.end(), add);
  };
  // The seeds come first, in their order.
  std::for_each(seeds.begin(), seeds.end(), add);
  std::vector<Index> region = std::exchange(front, {});
  region.resize(std::min(region.size(), count));
  std::for_each(region.begin(), region.end(), add_neighbors);
  while (!front.empty() && region.size() < count) {
    const std::size_t pick = random(front.size());
    const Index v = front[pick];
    front[pick] = front.back();
    front.pop_back();
    region.push_back(v);
    add_neighbors(v);
  }
  return region;
}

}  // namespace spherical_param::internal
