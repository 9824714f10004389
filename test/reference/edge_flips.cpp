#include "reference/edge_flips.h"

#include "sphere_mesh.h"
#include "surface_energy.h"

#include <array>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace spherical_param::reference {
namespace {

using Side = std::pair<Index, int>;  ///< the lower triangle of an edge, and its corner opposite

class Flips {
public:
  Flips(const Positions& points, const Triangles& triangles, const Graph& graph)
      : points_(points), mesh_(triangles, static_cast<std::size_t>(points.cols())) {
    const double lengths = std::accumulate(graph.lengths.begin(), graph.lengths.end(), 0.0);
    // Less than a billionth of an edge is rounding.
    least_gain_ = 1e-9 * (lengths / static_cast<double>(graph.lengths.size()));
  }

  Triangles run() {
    for (Index t = 0; t < mesh_.size(); ++t)
      judge(t);
    while (!best_.empty()) {
      const auto [negative_gain, t, k] = *best_.begin();
      const Index o = mesh_.neighbor(t, k);
      forget({t, k});
      // Sides change their names with the triangles.
      const std::set<Index> before = around(t, o);
      const SidesOf old = sidesOf(before);
      if (!mesh_.flip(t, k))
        continue;  // not before something near it has changed
      for (const Side& side : old)
        forget(side);
      for (const Index near : around(t, o))
        judge(near);
    }
    return mesh_.triangles();
  }

private:
  using SidesOf = std::set<Side>;

  internal::Facet facet(Index t) const {
    return facet(mesh_.vertex(t, 0), mesh_.vertex(t, 1), mesh_.vertex(t, 2));
  }
  internal::Facet facet(Index a, Index b, Index c) const {
    return internal::RawFacet(points_.col(a), points_.col(b), points_.col(c)).facet();
  }
  double edge(Index v, Index w, const internal::Facet& f, const internal::Facet& g) const {
    return terms_.edge(v, w, points_.col(v), points_.col(w), f, g);
  }
  double cost(const internal::Facet& f) const { return terms_.cost(f.radius); }

  /// What the energy falls by if (c, a, b) and (d, b, a) become (c, a, d) and (c, d, b).
  double gainOf(Index t, int k) const {
    const Index o = mesh_.neighbor(t, k);
    const int l = mesh_.oppositeCorner(t, k);
    const Index c = mesh_.vertex(t, k);
    const Index a = mesh_.vertex(t, (k + 1) % 3);
    const Index b = mesh_.vertex(t, (k + 2) % 3);
    const Index d = mesh_.vertex(o, l);
    if (c == d)
      return 0.0;
    const internal::Facet cab = facet(t);
    const internal::Facet dba = facet(o);
    const internal::Facet bc = facet(mesh_.neighbor(t, (k + 1) % 3));
    const internal::Facet ca = facet(mesh_.neighbor(t, (k + 2) % 3));
    const internal::Facet ad = facet(mesh_.neighbor(o, (l + 1) % 3));
    const internal::Facet db = facet(mesh_.neighbor(o, (l + 2) % 3));
    const internal::Facet cad = facet(c, a, d);
    const internal::Facet cdb = facet(c, d, b);
    const double before = cost(cab) + cost(dba) + edge(a, b, cab, dba) + edge(b, c, cab, bc) +
                          edge(c, a, cab, ca) + edge(a, d, dba, ad) + edge(d, b, dba, db);
    const double after = cost(cad) + cost(cdb) + edge(c, d, cad, cdb) + edge(b, c, cdb, bc) +
                         edge(c, a, cad, ca) + edge(a, d, cad, ad) + edge(d, b, cdb, db);
    return before - after;
  }

  Side sideOf(Index t, int k) const {
    const Index o = mesh_.neighbor(t, k);
    return t < o ? Side(t, k) : Side(o, mesh_.oppositeCorner(t, k));
  }
  /// Two triangles and their neighbours: the gains of their sides depend on the two.
  std::set<Index> around(Index t, Index o) const {
    std::set<Index> result{t, o};
    for (int k = 0; k < 3; ++k) {
      result.insert(mesh_.neighbor(t, k));
      result.insert(mesh_.neighbor(o, k));
    }
    return result;
  }
  SidesOf sidesOf(const std::set<Index>& triangles) const {
    SidesOf result;
    for (const Index t : triangles)
      for (int k = 0; k < 3; ++k)
        result.insert(sideOf(t, k));
    return result;
  }
  void forget(const Side& side) {
    const auto known = gains_.find(side);
    if (known == gains_.end())
      return;
    best_.erase({-known->second, side.first, side.second});
    gains_.erase(known);
  }
  /// Notes the gains of a triangle's sides as they are now.
  void judge(Index t) {
    for (int k = 0; k < 3; ++k) {
      const Side side = sideOf(t, k);
      forget(side);
      const double gain = gainOf(side.first, side.second);
      if (gain <= least_gain_)
        continue;
      best_.insert({-gain, side.first, side.second});
      gains_[side] = gain;
    }
  }

  const Positions& points_;
  internal::SphereMesh mesh_;
  internal::SurfaceEnergy terms_;
  double least_gain_ = 0.0;
  std::set<std::tuple<double, Index, int>> best_;  ///< the largest gain first
  std::map<Side, double> gains_;                   ///< those that are in best_
};

}  // namespace

Triangles flipAll(const Positions& points, const Triangles& triangles, const Graph& graph) {
  return Flips(points, triangles, graph).run();
}

}  // namespace spherical_param::reference
