#include "energy_mesh.h"

#include "optimization_constants.h"
#include "rows.h"
#include "spherical_param/self_intersection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace spherical_param::internal {

namespace tuned = optimization_constants;

EnergyMesh::EnergyMesh(const Positions& points, SphereMesh mesh, const Graph& graph, int threads,
                       const OpenPlaces* openings, const FractionReport& report)
    : points_(&points), graph_(graph), threads_(threadCount(threads, mesh.slotCount())),
      mesh_(std::move(mesh)), facets_(mesh_.slotCount()), is_touched_(mesh_.slotCount()) {
  const double lengths = std::accumulate(graph.lengths.begin(), graph.lengths.end(), 0.0);
  if (lengths > 0.0)
    unit_ = lengths / static_cast<double>(graph.lengths.size());
  energy_.openings = openings;
  updateAll(report);
}

RawFacet EnergyMesh::facetOf(Index a, Index b, Index c) const {
  RawFacet facet(points_->col(a), points_->col(b), points_->col(c));
  if (energy_.openings != nullptr && energy_.openings->isOpen(a, b, c))
    facet.open();
  return facet;
}

double EnergyMesh::energy() const {
  double sum = 0.0;
  for (Index t = 0; t < mesh_.size(); ++t) {
    sum += energy_.cost(facets_[t].radius);
    for (int k = 0; k < 3; ++k) {
      const auto [v, w] = mesh_.side(t, k);
      if (v < w)
        sum += edge(v, w, facets_[t], facets_[mesh_.neighbor(t, k)]);
    }
  }
  return sum / unit_;
}

void EnergyMesh::setPoints(const Positions& points) {
  points_ = &points;
  updateAll();
}

void EnergyMesh::reset(SphereMesh mesh) {
  mesh_ = std::move(mesh);
  updateAll();
}

void EnergyMesh::save(Index t) {
  is_touched_[t] = 1;
  if (!open_.empty())
    old_facets_.emplace_back(t, facets_[t]);
}

void EnergyMesh::update(Index t) {
  save(t);
  const auto& [a, b, c] = mesh_.vertices(t);
  facets_[t] = facetOf(a, b, c).facet();
}

void EnergyMesh::updateAll(const FractionReport& report) {
  forEachIndex(facets_.size(), threads_, report, [&](Index t) { update(t); });
}

double EnergyMesh::flipGain(Index t, int corner, double floor) const {
  // (c, a, b) and (d, b, a) would become (c, a, d) and (c, d, b).
  const Index o = mesh_.neighbor(t, corner);
  const int l = mesh_.oppositeCorner(t, corner);
  const auto [a, b, c, d] = mesh_.diamond(t, corner);
  if (c == d)
    return floor;
  const Facet& cab = facets_[t];
  const Facet& dba = facets_[o];
  const Facet& bc = facets_[mesh_.neighbor(t, (corner + 1) % 3)];
  const Facet& ca = facets_[mesh_.neighbor(t, (corner + 2) % 3)];
  const Facet& ad = facets_[mesh_.neighbor(o, (l + 1) % 3)];
  const Facet& db = facets_[mesh_.neighbor(o, (l + 2) % 3)];
  const double before = energy_.cost(cab.radius) + energy_.cost(dba.radius) + edge(a, b, cab, dba) +
                        edge(b, c, cab, bc) + edge(c, a, cab, ca) + edge(a, d, dba, ad) +
                        edge(d, b, dba, db);
  // No term is negative, and rounding is monotone: if some terms leave at most the floor, so do all
  // of them, to the last bit.
  const RawFacet raw_cad = facetOf(c, a, d);
  const RawFacet raw_cdb = facetOf(c, d, b);
  double after = energy_.cost(raw_cad.radius) + energy_.cost(raw_cdb.radius);
  if (before - after <= floor)
    return floor;
  const Facet cad = raw_cad.facet();
  const Facet cdb = raw_cdb.facet();
  after += edge(c, d, cad, cdb) + edge(b, c, cdb, bc) + edge(c, a, cad, ca) + edge(a, d, cad, ad) +
           edge(d, b, cdb, db);
  // Fewer than 16 terms, none negative, are added. A difference below their roundings is no gain:
  // the flip could be made and undone forever. It matters where the terms exceed some 300,000 mean
  // lengths.
  constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
  const double gain = std::abs(before - after) > rounding * before ? before - after : 0.0;
  // Beyond the range of double the difference is NaN, which is no gain.
  return gain > floor ? gain : floor;
}

bool EnergyMesh::flip(Index t, int corner, double gain) {
  const Index o = mesh_.neighbor(t, corner);
  if ((may_flip_ && !may_flip_(mesh_.diamond(t, corner))) || !mesh_.flip(t, corner))
    return false;
  update(t);
  update(o);
  change_ -= gain;
  return true;
}

double EnergyMesh::splitCost(Index t, Index v, double ceiling) const {
  const auto& [a, b, c] = mesh_.vertices(t);
  const Facet& abc = facets_[t];
  const Facet& bc = facets_[mesh_.neighbor(t, 0)];
  const Facet& ca = facets_[mesh_.neighbor(t, 1)];
  const Facet& ab = facets_[mesh_.neighbor(t, 2)];
  const double before =
      energy_.cost(abc.radius) + edge(b, c, abc, bc) + edge(c, a, abc, ca) + edge(a, b, abc, ab);
  // As in flipGain(): further terms only add to it.
  const RawFacet raw_vbc = facetOf(v, b, c);
  const RawFacet raw_vca = facetOf(v, c, a);
  const RawFacet raw_vab = facetOf(v, a, b);
  double after =
      energy_.cost(raw_vbc.radius) + energy_.cost(raw_vca.radius) + energy_.cost(raw_vab.radius);
  if (after - before >= ceiling)
    return ceiling;
  const Facet vbc = raw_vbc.facet();
  const Facet vca = raw_vca.facet();
  const Facet vab = raw_vab.facet();
  after += edge(b, c, vbc, bc) + edge(c, a, vca, ca) + edge(a, b, vab, ab) + edge(v, a, vca, vab) +
           edge(v, b, vab, vbc) + edge(v, c, vbc, vca);
  return std::min(after - before, ceiling);
}

std::array<Index, 3> EnergyMesh::split(Index t, Index v, double cost) {
  const std::array<Index, 3> parts = mesh_.split(t, v);
  for (const Index part : parts)
    update(part);
  change_ += cost;
  return parts;
}

bool EnergyMesh::merge(Index v) {
  mesh_.forEachAround(v, [&](Index t, int) { save(t); });
  const Index merged = mesh_.merge(v);
  if (merged < 0)
    return false;
  update(merged);
  change_ -= splitCost(merged, v, std::numeric_limits<double>::infinity());
  return true;
}

void EnergyMesh::begin() {
  if (open_.empty())
    change_ = 0.0;
  open_.push_back({mesh_.journal().record(), old_facets_.size(), change_});
}

void EnergyMesh::commit() {
  open_.pop_back();
  if (!open_.empty())
    return;
  mesh_.journal().commit();
  old_facets_.clear();
}

void EnergyMesh::rollBack() {
  const Before& before = open_.back();
  mesh_.journal().rollBack(before.moves);
  for (; old_facets_.size() > before.facets; old_facets_.pop_back())
    facets_[old_facets_.back().first] = old_facets_.back().second;
  change_ = before.change;
  open_.pop_back();
  if (!open_.empty())
    mesh_.journal().record();
}

std::vector<Index> EnergyMesh::changed() const {
  std::vector<Index> changed;
  for (std::size_t i = open_.back().facets; i < old_facets_.size(); ++i)
    changed.push_back(old_facets_[i].first);
  sortUnique(changed);
  return changed;
}

std::vector<Index> EnergyMesh::takeTouched() {
  std::vector<Index> touched;
  for (const Index t : indicesOf(is_touched_))
    if (std::exchange(is_touched_[t], 0) != 0)
      touched.push_back(t);
  return touched;
}

void appendNeighbors(const EnergyMesh& of, Index v, std::vector<Index>& neighbors) {
  of.mesh().forEachAround(
      v, [&](Index t, int corner) { neighbors.push_back(of.mesh().vertex(t, (corner + 1) % 3)); });
  const Row<Index> row = of.graph().row(v);
  neighbors.insert(neighbors.end(), row.begin(), row.end());
}

IntersectingPairs findIntersections(const EnergyMesh& mesh, std::size_t most,
                                    const FractionReport& report) {
  std::vector<Index> surface;
  for (Index t = 0; t < mesh.mesh().size(); ++t)
    if (!mesh.facet(t).is_open)
      surface.push_back(t);
  Execution execution;
  execution.threads = mesh.threads();
  if (report)
    execution.progress = [&](const Progress& progress) {
      report(progress.fraction);
      return true;
    };
  return findPairsUpTo(most, mesh.points(), mesh.mesh().triangles(), surface, execution);
}

void updateIntersections(const EnergyMesh& mesh, const std::vector<Index>& touched,
                         IntersectingPairs& found) {
  auto& pairs = found.pairs;
  const auto erase_if = [&](const auto& is) {
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is), pairs.end());
  };
  erase_if([&](const auto& pair) {
    return std::any_of(pair.begin(), pair.end(), [&](Index t) {
      return std::binary_search(touched.begin(), touched.end(), t);
    });
  });
  const auto more =
      findSelfIntersectionsOf(mesh.points(), mesh.mesh().triangles(), touched, {mesh.threads()});
  pairs.insert(pairs.end(), more.begin(), more.end());
  erase_if(
      [&](const auto& pair) { return mesh.facet(pair[0]).is_open || mesh.facet(pair[1]).is_open; });
  std::sort(pairs.begin(), pairs.end());
}

bool isGain(double change) {
  return change < -tuned::kMinGain;
}

}  // namespace spherical_param::internal
