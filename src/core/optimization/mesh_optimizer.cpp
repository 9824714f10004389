#include "mesh_optimizer.h"

#include "bit_mixing.h"
#include "exact_predicates.h"
#include "median.h"
#include "optimization_constants.h"
#include "parallel.h"
#include "power_of_two.h"
#include "self_intersection_of_fans.h"
#include "spherical_param/self_intersection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace spherical_param::internal {
namespace {

namespace tuned = optimization_constants;

/// Candidates of flips between reports.
constexpr std::size_t kReportedCandidates = std::size_t{1} << 16U;

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

MeshOptimizer::MeshOptimizer(const Positions& points, const Triangles& triangles,
                             const Graph& graph, int threads, const FractionReport& report,
                             const OpenPlaces* openings)
    : points_(&points), graph_(graph), openings_(openings),
      threads_(
          threadCount(threads, static_cast<std::size_t>(triangles.cols()), kParallelThreshold)),
      mesh_(triangles, static_cast<std::size_t>(points.cols()), threads_),
      facets_(static_cast<std::size_t>(triangles.cols())), changes_(facets_.size(), 0),
      stamps_(3 * facets_.size(), 0), seen_triangles_(facets_.size(), 0),
      seen_vertices_(static_cast<std::size_t>(points.cols()), 0) {
  reportFraction(report, 0.0);
  double lengths = 0.0;
  for (const double length : graph_.lengths)
    lengths += length;
  if (lengths > 0.0)
    unit_ = lengths / static_cast<double>(graph_.lengths.size());
  scale_ = scaleToUnit(points.cwiseAbs().maxCoeff());
  recomputeFacets(report);
}

void MeshOptimizer::recomputeFacets(const FractionReport& report) {
  are_flips_settled_ = false;
  has_typical_angles_ = false;
  forEachBlock(facets_.size(), threads_, report,
               [&](std::size_t, std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   const auto t = static_cast<Index>(i);
                   facets_[i] = facet(mesh_.vertex(t, 0), mesh_.vertex(t, 1), mesh_.vertex(t, 2));
                 }
               });
}

void MeshOptimizer::reset(const Triangles& triangles) {
  mesh_ = SphereMesh(triangles, seen_vertices_.size(), threads_);
  recomputeFacets();
  energy_ = recomputedEnergy();
}

void MeshOptimizer::setEnergy(const SurfaceEnergy& energy) {
  terms_ = energy;
  terms_.openings = openings_;
  energy_ = recomputedEnergy();
}

void MeshOptimizer::setPoints(const Positions& points) {
  points_ = &points;
  checked_ = {};
  recomputeFacets();
  energy_ = recomputedEnergy();
}

double MeshOptimizer::recomputedEnergy() const {
  return sumOfBlocks(facets_.size(), threads_, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto t = static_cast<Index>(i);
      sum += cost(facets_[i]);
      for (int k = 0; k < 3; ++k) {
        const Index other = mesh_.neighbor(t, k);
        if (t < other)
          sum += edge(mesh_.vertex(t, (k + 1) % 3), mesh_.vertex(t, (k + 2) % 3), facets_[i],
                      facetOf(other));
      }
    }
    return sum;
  });
}

void MeshOptimizer::setFacet(Index t) {
  if (!open_.empty())
    old_facets_.emplace_back(t, facetOf(t));
  changes_[at(t)] = kChangedSinceFlips | kChangedSinceAngles;
  facets_[at(t)] = facet(mesh_.vertex(t, 0), mesh_.vertex(t, 1), mesh_.vertex(t, 2));
}

double MeshOptimizer::flipGain(Index t, int k, double floor) const {
  // (c, a, b) and (d, b, a) would become (c, a, d) and (c, d, b).
  const Index o = mesh_.neighbor(t, k);
  const int l = mesh_.oppositeCorner(t, k);
  const Index c = mesh_.vertex(t, k);
  const Index a = mesh_.vertex(t, (k + 1) % 3);
  const Index b = mesh_.vertex(t, (k + 2) % 3);
  const Index d = mesh_.vertex(o, l);
  if (c == d)
    return floor;
  const Facet& cab = facetOf(t);
  const Facet& dba = facetOf(o);
  const Facet& bc = facetOf(mesh_.neighbor(t, (k + 1) % 3));
  const Facet& ca = facetOf(mesh_.neighbor(t, (k + 2) % 3));
  const Facet& ad = facetOf(mesh_.neighbor(o, (l + 1) % 3));
  const Facet& db = facetOf(mesh_.neighbor(o, (l + 2) % 3));
  const double before = cost(cab) + cost(dba) + edge(a, b, cab, dba) + edge(b, c, cab, bc) +
                        edge(c, a, cab, ca) + edge(a, d, dba, ad) + edge(d, b, dba, db);
  // No term is negative, and rounding is monotone: once some of them leave no more than the floor,
  // all of them leave no more either, to the last bit.
  const RawFacet raw_cad = rawFacet(c, a, d);
  const RawFacet raw_cdb = rawFacet(c, d, b);
  double after = terms_.cost(raw_cad.radius) + terms_.cost(raw_cdb.radius);
  if (before - after <= floor)
    return floor;
  const Facet cad = raw_cad.facet();
  const Facet cdb = raw_cdb.facet();
  after += edge(c, d, cad, cdb);
  after += edge(b, c, cdb, bc);
  after += edge(c, a, cad, ca);
  after += edge(a, d, cad, ad);
  after += edge(d, b, cdb, db);
  const double gain = std::abs(before - after) > tuned::kRounding * before ? before - after : 0.0;
  // Beyond the range of double the difference is no number, and no gain.
  return gain > floor ? gain : floor;
}

void MeshOptimizer::queueFlip(Index t, int k) {
  const double floor = tuned::kMinGain * unit_;
  const double gain = flipGain(t, k, floor);
  if (gain <= floor)
    return;
  queue_.push_back(
      {gain, t, stamps_[3 * at(t) + static_cast<std::size_t>(k)], static_cast<std::uint8_t>(k)});
}

void MeshOptimizer::queueSides(Index t) {
  for (int k = 0; k < 3; ++k) {
    const Index o = mesh_.neighbor(t, k);
    if (t > o && seen_triangles_[at(o)] == pass_)
      continue;  // that triangle's turn
    // Each side has its place in the queue with the lower of its triangles.
    const Index low = std::min(t, o);
    const int corner = t < o ? k : mesh_.oppositeCorner(t, k);
    ++stamps_[3 * at(low) + static_cast<std::size_t>(corner)];
    const std::size_t size = queue_.size();
    queueFlip(low, corner);
    if (queue_.size() > size)
      std::push_heap(queue_.begin(), queue_.end());
  }
}

bool MeshOptimizer::flip(Index t, int k, double gain) {
  const Index o = mesh_.neighbor(t, k);
  if (!mesh_.flip(t, k))
    return false;
  setFacet(t);
  setFacet(o);
  energy_ -= gain;
  return true;
}

std::size_t MeshOptimizer::flipQueued(const FractionReport& report) {
  refused_.clear();
  std::size_t flips = 0;
  double fraction = 0.0;
  for (std::size_t taken = 1; !queue_.empty(); ++taken) {
    if (report && taken % kReportedCandidates == 0) {
      // What is in the queue by now puts in less than it takes out.
      fraction = std::max(fraction,
                          static_cast<double>(taken) / static_cast<double>(taken + queue_.size()));
      report(fraction);
    }
    const Candidate best = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end());
    queue_.pop_back();
    const Index t = best.triangle;
    if (stamps_[3 * at(t) + best.corner] != best.stamp)
      continue;
    const Index o = mesh_.neighbor(t, best.corner);
    if (!flip(t, best.corner, best.gain)) {
      refused_.push_back(t);
      continue;
    }
    ++flips;
    // All sides whose gain depends on one of the two triangles: theirs, and their neighbours'.
    std::array<Index, 6> affected{t,
                                  o,
                                  mesh_.neighbor(t, 0),
                                  mesh_.neighbor(t, 2),
                                  mesh_.neighbor(o, 0),
                                  mesh_.neighbor(o, 1)};
    ++pass_;
    for (const Index i : affected) {
      seen_triangles_[at(i)] = pass_;
      for (std::size_t k = 0; k < 3; ++k)
        ++stamps_[3 * at(i) + k];
    }
    std::sort(affected.begin(), affected.end());
    const auto* end = std::unique(affected.begin(), affected.end());
    for (const auto* i = affected.begin(); i != end; ++i)
      queueSides(*i);
  }
  return flips;
}

void MeshOptimizer::flipAround(const std::vector<Index>& triangles) {
  queue_.clear();
  ++pass_;
  for (const Index t : triangles)
    seen_triangles_[at(t)] = pass_;
  for (const Index t : triangles)
    queueSides(t);
  flipQueued();
}

bool MeshOptimizer::isNearChange(Index t, std::uint8_t change) const {
  return ((changes_[at(t)] | changes_[at(mesh_.neighbor(t, 0))] |
           changes_[at(mesh_.neighbor(t, 1))] | changes_[at(mesh_.neighbor(t, 2))]) &
          change) != 0;
}

void MeshOptimizer::unmark(std::uint8_t change) {
  for (std::uint8_t& marks : changes_)
    marks &= static_cast<std::uint8_t>(~change);
}

std::size_t MeshOptimizer::flipAll(const FractionReport& report) {
  // The gain of a side depends on its two triangles and their neighbours alone.
  const bool are_most_settled = are_flips_settled_ && settled_terms_ == terms_;
  const auto is_due = [&](Index t) {
    return !are_most_settled || isNearChange(t, kChangedSinceFlips);
  };
  std::vector<std::vector<Candidate>> found((facets_.size() + kBlockSize - 1) / kBlockSize);
  const double floor = tuned::kMinGain * unit_;
  forEachBlock(facets_.size(), threads_, report,
               [&](std::size_t block, std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   const auto t = static_cast<Index>(i);
                   if (!is_due(t))
                     continue;
                   for (int k = 0; k < 3; ++k) {
                     const Index o = mesh_.neighbor(t, k);
                     if (t > o && is_due(o))
                       continue;  // that triangle's turn
                     const Index low = std::min(t, o);
                     const int corner = t < o ? k : mesh_.oppositeCorner(t, k);
                     const double gain = flipGain(low, corner, floor);
                     if (gain > floor)
                       found[block].push_back(
                           {gain, low, stamps_[3 * at(low) + static_cast<std::size_t>(corner)],
                            static_cast<std::uint8_t>(corner)});
                   }
                 }
               });
  queue_.clear();
  for (const auto& part : found)
    queue_.insert(queue_.end(), part.begin(), part.end());
  std::make_heap(queue_.begin(), queue_.end());
  const std::size_t flips = flipQueued(report);
  unmark(kChangedSinceFlips);
  // These would gain, and may not be refused again.
  for (const Index t : refused_)
    changes_[at(t)] |= kChangedSinceFlips;
  are_flips_settled_ = true;
  settled_terms_ = terms_;
  return flips;
}

double MeshOptimizer::splitCost(Index t, Index v, double ceiling) const {
  const Index a = mesh_.vertex(t, 0);
  const Index b = mesh_.vertex(t, 1);
  const Index c = mesh_.vertex(t, 2);
  const Facet& abc = facetOf(t);
  const Facet& bc = facetOf(mesh_.neighbor(t, 0));
  const Facet& ca = facetOf(mesh_.neighbor(t, 1));
  const Facet& ab = facetOf(mesh_.neighbor(t, 2));
  const double before = cost(abc) + edge(b, c, abc, bc) + edge(c, a, abc, ca) + edge(a, b, abc, ab);
  // As in flipGain(): the rest only adds to it.
  const RawFacet raw_vbc = rawFacet(v, b, c);
  const RawFacet raw_vca = rawFacet(v, c, a);
  const RawFacet raw_vab = rawFacet(v, a, b);
  double after =
      terms_.cost(raw_vbc.radius) + terms_.cost(raw_vca.radius) + terms_.cost(raw_vab.radius);
  if (after - before >= ceiling)
    return ceiling;
  const Facet vbc = raw_vbc.facet();
  const Facet vca = raw_vca.facet();
  const Facet vab = raw_vab.facet();
  after += edge(b, c, vbc, bc);
  after += edge(c, a, vca, ca);
  after += edge(a, b, vab, ab);
  after += edge(v, a, vca, vab);
  after += edge(v, b, vab, vbc);
  after += edge(v, c, vbc, vca);
  return after - before;
}

bool MeshOptimizer::remove(Index v) {
  while (mesh_.degree(v) > 3) {
    // Of the flips that take an edge from the vertex, the one that costs least.
    double best = -std::numeric_limits<double>::infinity();
    Index triangle = -1;
    int corner = 0;
    mesh_.forEachAround(v, [&](Index t, int corner_of_v) {
      const int k = (corner_of_v + 1) % 3;
      const Index c = mesh_.vertex(t, k);
      const Index d = mesh_.vertex(mesh_.neighbor(t, k), mesh_.oppositeCorner(t, k));
      if (c == d || mesh_.areJoined(c, d))
        return;
      const double gain = flipGain(t, k, best);
      if (gain > best) {
        best = gain;
        triangle = t;
        corner = k;
      }
    });
    if (triangle < 0 || !flip(triangle, corner, best))
      return false;
  }
  std::array<Index, 3> fan{};
  std::size_t count = 0;
  mesh_.forEachAround(v, [&](Index t, int) { fan[count++] = t; });
  const Index t = mesh_.merge(v);
  if (t < 0)
    return false;
  for (const Index old : fan)
    if (!open_.empty() && old != t)
      old_facets_.emplace_back(old, facetOf(old));
  setFacet(t);
  energy_ -= splitCost(t, v, std::numeric_limits<double>::infinity());
  return true;
}

bool MeshOptimizer::insert(Index v, const std::vector<Index>& neighbors) {
  ++pass_;
  double least = std::numeric_limits<double>::infinity();
  Index best = -1;
  for (const Index w : neighbors) {
    if (mesh_.triangleAt(w) < 0)
      continue;
    mesh_.forEachAround(w, [&](Index t, int) {
      if (seen_triangles_[at(t)] == pass_)
        return;
      seen_triangles_[at(t)] = pass_;
      const double split_cost = splitCost(t, v, least);
      if (split_cost < least) {
        least = split_cost;
        best = t;
      }
    });
  }
  if (best < 0)
    return false;
  const auto parts = mesh_.split(best, v);
  changed_.assign(parts.begin(), parts.end());
  for (const Index t : parts) {
    setFacet(t);
    changed_.push_back(mesh_.neighbor(t, 0));
  }
  energy_ += least;
  flipAround(changed_);
  return true;
}

void MeshOptimizer::appendNeighbors(Index v, std::vector<Index>& neighbors) const {
  mesh_.forEachAround(
      v, [&](Index t, int corner) { neighbors.push_back(mesh_.vertex(t, (corner + 1) % 3)); });
  neighbors.insert(neighbors.end(),
                   graph_.neighbors.begin() + static_cast<std::ptrdiff_t>(graph_.offsets[at(v)]),
                   graph_.neighbors.begin() +
                       static_cast<std::ptrdiff_t>(graph_.offsets[at(v) + 1]));
}

void MeshOptimizer::begin() {
  open_.push_back({mesh_.record(), old_facets_.size(), energy_});
}

void MeshOptimizer::commit() {
  open_.pop_back();
  if (!open_.empty())
    return;
  mesh_.commit();
  old_facets_.clear();
}

void MeshOptimizer::rollBack() {
  const Before& before = open_.back();
  mesh_.rollBack(before.changes);
  for (; old_facets_.size() > before.facets; old_facets_.pop_back())
    facets_[at(old_facets_.back().first)] = old_facets_.back().second;
  energy_ = before.energy;
  open_.pop_back();
  if (!open_.empty())
    mesh_.record();
}

bool MeshOptimizer::isGain(double change) {
  return change < -tuned::kMinGain;
}

bool MeshOptimizer::relocate(Index v) {
  around_.clear();
  appendNeighbors(v, around_);
  begin();
  if (remove(v) && insert(v, around_) && isGain(change())) {
    commit();
    return true;
  }
  rollBack();
  return false;
}

bool MeshOptimizer::recreate(const std::vector<Index>& vertices,
                             const std::function<bool(double)>& accept, std::uint64_t& random) {
  work_ += vertices.size();
  std::vector<std::vector<Index>> neighbors(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    appendNeighbors(vertices[i], neighbors[i]);
  begin();
  std::vector<std::size_t> removed;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (remove(vertices[i]))
      removed.push_back(i);
  for (std::size_t i = removed.size(); i > 1; --i) {
    random = splitmix64(random);
    std::swap(removed[i - 1], removed[random % i]);
  }
  // Vertices none of whose neighbours are back yet wait for them.
  while (!removed.empty()) {
    std::vector<std::size_t> waiting;
    for (const std::size_t i : removed)
      if (!insert(vertices[i], neighbors[i]))
        waiting.push_back(i);
    if (waiting.size() == removed.size())
      break;
    removed = std::move(waiting);
  }
  if (removed.empty() && accept(change())) {
    commit();
    return true;
  }
  rollBack();
  return false;
}

Face MeshOptimizer::face(Index t, Index a, Index b, Index c) const {
  Face face{{scale_ * points_->col(a), scale_ * points_->col(b), scale_ * points_->col(c)},
            0.0,
            {a, b, c},
            t};
  face.size = boxOf(face.corners).size();
  return face;
}

bool MeshOptimizer::findRepair(Index t, int k, int most, Repair& repair) {
  const Index o = mesh_.neighbor(t, k);
  if (!near_.contains(t) || !near_.contains(o))
    return false;
  int before = near_.countOf(t) + near_.countOf(o);
  if (before + most < 0)
    return false;
  before -= intersect(near_.face(t), near_.face(o)) ? 1 : 0;
  const Index c = mesh_.vertex(t, k);
  const Index a = mesh_.vertex(t, (k + 1) % 3);
  const Index b = mesh_.vertex(t, (k + 2) % 3);
  const Index d = mesh_.vertex(o, mesh_.oppositeCorner(t, k));
  if (before + most < 0 || c == d || mesh_.areJoined(c, d) || rawFacet(c, a, d).radius < 0.0 ||
      rawFacet(c, d, b).radius < 0.0)
    return false;
  const Face cad = face(t, c, a, d);
  const Face cdb = face(o, c, d, b);
  int left = before + most;
  left -= near_.count(cad, o, left);
  if (left >= 0)
    left -= near_.count(cdb, t, left);
  if (left >= 0)
    left -= intersect(cad, cdb) ? 1 : 0;
  repair = {most - left, 0.0, t, k};
  return left >= 0;
}

double MeshOptimizer::costOf(const Repair& repair) const {
  return -flipGain(repair.triangle, repair.corner, -std::numeric_limits<double>::infinity());
}

void MeshOptimizer::updateLocally(Index t, Index o) {
  for (const Index changed : {t, o}) {
    local_.set(face(changed));
    near_.set(face(changed));
  }
}

void MeshOptimizer::flipLocally(const Repair& repair) {
  const Index o = mesh_.neighbor(repair.triangle, repair.corner);
  flip(repair.triangle, repair.corner, -repair.cost);
  updateLocally(repair.triangle, o);
}

void MeshOptimizer::gatherNear(Index t) {
  // Two flips change triangles, and ask for those beyond their sides.
  std::vector<Index> ring{t};
  Box box = boxOf(face(t).corners);
  ++pass_;
  seen_triangles_[at(t)] = pass_;
  for (std::size_t i = 0, end = 1, steps = 0; steps < 3; ++steps, end = ring.size())
    for (; i < end; ++i)
      for (int k = 0; k < 3; ++k) {
        const Index o = mesh_.neighbor(ring[i], k);
        if (seen_triangles_[at(o)] == pass_)
          continue;
        seen_triangles_[at(o)] = pass_;
        ring.push_back(o);
        const Box other = boxOf(face(o).corners);
        box.lower = box.lower.cwiseMin(other.lower);
        box.upper = box.upper.cwiseMax(other.upper);
      }
  near_.begin(facets_.size());
  local_.forEachIn(box, [&](const Face& face) {
    near_.set(face);
    return true;
  });
}

int MeshOptimizer::findRepairs(Index t, std::array<Repair, 2>& repairs) {
  gatherNear(t);
  ++work_;
  Repair best{0, 0.0, -1, 0};
  const auto consider = [&](Index u, int k, const Repair* first) {
    const int before = first != nullptr ? first->intersections : 0;
    Repair repair;
    if (!findRepair(u, k, std::min(best.intersections, -1) - before, repair))
      return;
    repair.intersections += before;
    repair.cost = costOf(repair) + (first != nullptr ? first->cost : 0.0);
    if (!repair.isBetterThan(best))
      return;
    best = repair;
    repairs[0] = repair;
    if (first != nullptr) {
      repairs[0] = *first;
      repairs[1] = repair;
      repairs[1].intersections -= first->intersections;
      repairs[1].cost -= first->cost;
    }
  };
  for (int k = 0; k < 3; ++k)
    consider(t, k, nullptr);
  if (best.triangle >= 0)
    return 1;
  work_ += tuned::kWorkOfTwoFlips;
  std::array<std::pair<Index, int>, 9> sides;
  std::size_t count = 0;
  for (int k = 0; k < 3; ++k) {
    sides[count++] = {t, k};
    const Index o = mesh_.neighbor(t, k);
    for (int l = 0; l < 3; ++l)
      if (mesh_.neighbor(o, l) != t)
        sides[count++] = {o, l};
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto [u, k] = sides[i];
    Repair first;
    if (!findRepair(u, k, 1, first))
      continue;
    first.cost = costOf(first);
    const Index o = mesh_.neighbor(u, k);
    begin();
    flipLocally(first);
    for (int l = 0; l < 3; ++l) {
      consider(u, l, &first);
      consider(o, l, &first);
      if (t != u && t != o)
        consider(t, l, &first);
    }
    rollBack();
    updateLocally(u, o);
  }
  return best.triangle >= 0 ? 2 : 0;
}

std::size_t MeshOptimizer::flipApart() {
  std::vector<Index> bad;
  for (const Face& face : local_.faces())
    if (intersects(face.triangle))
      bad.push_back(face.triangle);
  return flipApart(std::move(bad));
}

int MeshOptimizer::flipChangedApart() {
  std::vector<Index> changed;
  for (std::size_t i = open_.back().facets; i < old_facets_.size(); ++i)
    changed.push_back(old_facets_[i].first);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  int difference = 0;
  for (const Index t : changed)
    if (local_.contains(t)) {
      difference -= local_.count(local_.face(t), t, std::numeric_limits<int>::max());
      local_.remove(t);
    }
  std::vector<Index> bad;
  for (const Index t : changed) {
    if (facetOf(t).isOpen())
      continue;
    const Face face_of_t = face(t);
    const std::size_t before = bad.size();
    local_.appendIntersecting(face_of_t, bad);
    if (bad.size() > before) {
      difference += static_cast<int>(bad.size() - before);
      bad.push_back(t);
    }
    local_.set(face_of_t);
  }
  std::sort(bad.begin(), bad.end());
  bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
  return difference - static_cast<int>(flipApart(std::move(bad)));
}

std::size_t MeshOptimizer::flipApart(std::vector<Index> bad) {
  int fewer = 0;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    const Index t = bad[i];
    while (intersects(t)) {
      std::array<Repair, 2> repairs;
      const int count = findRepairs(t, repairs);
      if (count == 0)
        break;
      for (int r = 0; r < count; ++r) {
        const Repair& repair = repairs[static_cast<std::size_t>(r)];
        const Index o = mesh_.neighbor(repair.triangle, repair.corner);
        flipLocally(repair);
        fewer -= repair.intersections;
        bad.push_back(repair.triangle);
        bad.push_back(o);
      }
    }
  }
  return static_cast<std::size_t>(fewer);
}

std::vector<Index> MeshOptimizer::spread(const std::vector<Index>& seeds, std::size_t count,
                                         std::uint64_t& random) {
  ++pass_;
  std::vector<Index> region;
  std::vector<Index> front;
  const auto add = [&](Index v) {
    if (seen_vertices_[at(v)] == pass_)
      return;
    seen_vertices_[at(v)] = pass_;
    front.push_back(v);
  };
  for (const Index v : seeds)
    add(v);
  const std::size_t distinct_seeds = front.size();
  std::vector<Index> neighbors;
  while (!front.empty() && region.size() < count) {
    std::size_t pick = 0;  // the seeds come first
    if (region.size() >= distinct_seeds) {
      random = splitmix64(random);
      pick = random % front.size();
    }
    const Index v = front[pick];
    if (region.size() >= distinct_seeds) {
      front[pick] = front.back();
      front.pop_back();
    } else {
      front.erase(front.begin());
    }
    region.push_back(v);
    neighbors.clear();
    appendNeighbors(v, neighbors);
    for (const Index w : neighbors)
      add(w);
  }
  return region;
}

template <typename Condition>
std::vector<Index> MeshOptimizer::filter(std::size_t count, const Condition& meets,
                                         const FractionReport& report) const {
  std::vector<std::vector<Index>> found((count + kBlockSize - 1) / kBlockSize);
  forEachBlock(count, threads_, report, [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (meets(static_cast<Index>(i)))
        found[block].push_back(static_cast<Index>(i));
  });
  std::vector<Index> all;
  for (const auto& part : found)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::vector<std::pair<Index, Index>> MeshOptimizer::edgesBelow(double cosine) const {
  const auto is_below = [&](Index t, int k) {
    const Index other = mesh_.neighbor(t, k);
    return t < other && Facet::cosine(facetOf(t), facetOf(other)) < cosine;
  };
  std::vector<std::pair<Index, Index>> edges;
  for (const Index t : filter(facets_.size(), [&](Index i) {
         return is_below(i, 0) || is_below(i, 1) || is_below(i, 2);
       }))
    for (int k = 0; k < 3; ++k)
      if (is_below(t, k))
        edges.emplace_back(mesh_.vertex(t, (k + 1) % 3), mesh_.vertex(t, (k + 2) % 3));
  return edges;
}

bool MeshOptimizer::isRough(Index v, double cosine) const {
  bool is_sharp = false;
  mesh_.forEachAround(v, [&](Index t, int corner) {
    const Index next = mesh_.neighbor(t, (corner + 1) % 3);
    is_sharp = is_sharp || Facet::cosine(facetOf(t), facetOf(next)) < cosine;
  });
  if (is_sharp)
    return true;
  // Nearly all neighbours in the graph are around the vertex: that is asked first, and quickly.
  std::array<Index, 16> ring{};
  std::size_t ring_size = 0;
  const bool fits = at(mesh_.degree(v)) <= ring.size();
  if (fits)
    mesh_.forEachAround(
        v, [&](Index t, int corner) { ring[ring_size++] = mesh_.vertex(t, (corner + 1) % 3); });
  const auto is_around = [&](Index w) {
    if (fits)
      return std::find(ring.begin(), ring.begin() + ring_size, w) != ring.begin() + ring_size;
    return mesh_.areJoined(v, w);
  };
  // In a graph of many neighbours, most of them are far.
  double near = -1.0;
  const auto is_far = [&](double length) {
    if (near < 0.0) {
      double lengths = 0.0;
      mesh_.forEachAround(v, [&](Index t, int corner) {
        lengths += (points_->col(v) - points_->col(mesh_.vertex(t, (corner + 1) % 3))).norm();
      });
      near = tuned::kMaxNearNeighbor * lengths / mesh_.degree(v);
    }
    return length > near;
  };
  for (std::size_t e = graph_.offsets[at(v)]; e < graph_.offsets[at(v) + 1]; ++e) {
    const Index w = graph_.neighbors[e];
    if (is_around(w) || is_far(graph_.lengths[e]))
      continue;
    bool is_near = false;
    mesh_.forEachAround(w, [&](Index t, int corner) {
      is_near = is_near || is_around(mesh_.vertex(t, (corner + 1) % 3));
    });
    if (!is_near)
      return true;
  }
  return false;
}

std::vector<Index> MeshOptimizer::roughVertices(double cosine, const FractionReport& report) const {
  return filter(
      seen_vertices_.size(), [&](Index v) { return isRough(v, cosine); }, report);
}

void MeshOptimizer::gatherCosines(Index v, std::vector<double>& cosines) const {
  cosines.clear();
  mesh_.forEachAround(v, [&](Index t, int corner) {
    for (const int k : {corner, (corner + 1) % 3})
      cosines.push_back(Facet::cosine(facetOf(t), facetOf(mesh_.neighbor(t, k))));
  });
}

std::vector<double> MeshOptimizer::medianAngles() const {
  std::vector<double> medians(seen_vertices_.size());
  forEachBlock(medians.size(), threads_, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::vector<double> cosines;
    for (std::size_t v = begin; v < end; ++v) {
      gatherCosines(static_cast<Index>(v), cosines);
      medians[v] = fastAcos(medianOf(cosines));
    }
  });
  return medians;
}

void MeshOptimizer::updateUsualAngles(double factor, double least) {
  const bool is_new = !has_typical_angles_ || factor != typical_factor_ || least != min_typical_;
  typical_angles_.resize(seen_vertices_.size());
  // A median depends on the triangles around the vertex and their neighbours alone.
  std::vector<std::uint8_t> is_due(typical_angles_.size(), is_new ? 1 : 0);
  if (!is_new)
    for (const Index t :
         filter(facets_.size(), [&](Index i) { return isNearChange(i, kChangedSinceAngles); }))
      for (int k = 0; k < 3; ++k)
        is_due[at(mesh_.vertex(t, k))] = 1;
  const double flat = SurfaceEnergy::flatFrom(least / factor);
  std::vector<std::vector<Index>> changed((is_due.size() + kBlockSize - 1) / kBlockSize);
  forEachBlock(is_due.size(), threads_, [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::vector<double> cosines;
    for (std::size_t i = begin; i < end; ++i) {
      if (is_due[i] == 0)
        continue;
      gatherCosines(static_cast<Index>(i), cosines);
      // At flat places, which are most of them, it is enough to know that they are.
      std::size_t bent = 0;
      for (const double cosine : cosines)
        bent += cosine >= flat ? 0 : 1;
      const double angle = bent <= cosines.size() / 2
                               ? least
                               : std::max(factor * fastAcos(medianOf(cosines)), least);
      if (!is_new && angle != typical_angles_[i])
        changed[block].push_back(static_cast<Index>(i));
      typical_angles_[i] = angle;
    }
  });
  for (const std::vector<Index>& part : changed)
    for (const Index v : part)
      mesh_.forEachAround(v, [&](Index t, int) { changes_[at(t)] |= kChangedSinceFlips; });
  unmark(kChangedSinceAngles);
  if (is_new)
    are_flips_settled_ = false;
  has_typical_angles_ = true;
  typical_factor_ = factor;
  min_typical_ = least;
}

void MeshOptimizer::setExcessEnergy(double mu, double factor, double least) {
  updateUsualAngles(factor, least);
  SurfaceEnergy energy;
  energy.bend = SurfaceEnergy::Bend::Excess;
  energy.mu = mu;
  energy.typical_angle = typical_angles_.data();
  energy.flat_cosine = SurfaceEnergy::flatFrom(least);
  setEnergy(energy);
}

bool MeshOptimizer::isPlainFan(Index v) const {
  Eigen::Index axis = 0;
  facetOf(mesh_.triangleAt(v)).normal.cwiseAbs().maxCoeff(&axis);
  const Eigen::Index x_axis = (axis + 1) % 3;
  const Eigen::Index y_axis = (axis + 2) % 3;
  struct Spoke {
    double x;
    double y;
  };
  const auto spoke = [&](Index t, int corner) {
    const auto end = points_->col(mesh_.vertex(t, (corner + 1) % 3));
    return Spoke{end[x_axis] - (*points_)(x_axis, v), end[y_axis] - (*points_)(y_axis, v)};
  };
  const Index first = mesh_.triangleAt(v);
  const Spoke begin = spoke(first, mesh_.cornerOf(first, v));
  Spoke last = begin;
  // The angle between spokes that follow each other is below pi, and always to the same side for
  // sure. The sign of a difference is that of the rounded one: so is the number of times that they
  // pass to the left, which is how often they go around.
  int left_turns = 0;
  int right_turns = 0;
  int passes = 0;
  int sides = 0;
  const auto pass = [&](const Spoke& from, const Spoke& to) {
    const double first_product = from.x * to.y;
    const double second_product = from.y * to.x;
    const double turn = first_product - second_product;
    // Each product is of two rounded differences, and rounded, and so is what is left; the last
    // term is for products that underflow.
    const double bound =
        8.0 * kUnitRoundoff * (std::abs(first_product) + std::abs(second_product)) + kUnderflow;
    left_turns += turn > bound ? 1 : 0;
    right_turns += turn < -bound ? 1 : 0;
    passes += (from.x < 0.0) != (to.x < 0.0) ? 1 : 0;
    ++sides;
  };
  mesh_.forEachAround(v, [&](Index t, int corner) {
    if (t == first)
      return;
    const Spoke next = spoke(t, corner);
    pass(last, next);
    last = next;
  });
  pass(last, begin);
  return (left_turns == sides || right_turns == sides) && passes == 2;
}

std::vector<std::uint8_t> MeshOptimizer::plainFans(const FractionReport& report) const {
  std::vector<std::uint8_t> fans(seen_vertices_.size());
  forEachBlock(fans.size(), threads_, report, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      fans[v] = isPlainFan(static_cast<Index>(v)) ? 1 : 0;
  });
  return fans;
}

Triangles MeshOptimizer::trianglesAt(const std::vector<Index>& places) const {
  Triangles triangles(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    for (int k = 0; k < 3; ++k)
      triangles(k, static_cast<Eigen::Index>(i)) = mesh_.vertex(places[i], k);
  return triangles;
}

MeshOptimizer::Pairs MeshOptimizer::intersections(const FractionReport& report) {
  Triangles triangles = mesh_.triangles();
  const auto is_changed = [&](Index t) { return triangles.col(t) != checked_.triangles.col(t); };
  // With more than this fraction of the triangles, all are looked at.
  constexpr std::size_t few = 8;
  std::vector<Index> changed;
  const bool was_checked = checked_.triangles.cols() == triangles.cols();
  if (was_checked)
    changed = filter(facets_.size(), is_changed);
  if (was_checked && changed.size() < facets_.size() / few) {
    Pairs pairs;
    for (const auto& pair : checked_.pairs)
      if (!is_changed(pair[0]) && !is_changed(pair[1]))
        pairs.push_back(pair);
    Execution execution;
    execution.threads = threads_;
    for (const auto& pair : findSelfIntersectionsOf(*points_, triangles, changed, execution))
      if (!facetOf(pair[0]).isOpen() && !facetOf(pair[1]).isOpen())
        pairs.push_back(pair);
    std::sort(pairs.begin(), pairs.end());
    checked_.pairs = std::move(pairs);
  } else {
    checked_.pairs = allIntersections(triangles, report);
  }
  checked_.triangles = std::move(triangles);
  return checked_.pairs;
}

MeshOptimizer::Pairs MeshOptimizer::allIntersections(const Triangles& triangles,
                                                     const FractionReport& report) const {
  const std::vector<std::uint8_t> fans = plainFans(report);
  if (openings_ == nullptr)
    return findSelfIntersections(*points_, triangles, fans, threads_, report);
  const std::vector<Index> surface =
      filter(facets_.size(), [&](Index t) { return !facetOf(t).isOpen(); });
  Pairs pairs = findSelfIntersections(*points_, trianglesAt(surface), fans, threads_, report);
  for (auto& [t, u] : pairs) {
    t = surface[at(t)];
    u = surface[at(u)];
  }
  return pairs;
}

void MeshOptimizer::watch(const std::vector<Index>& vertices) {
  local_.begin(facets_.size());
  for (const Index v : vertices)
    mesh_.forEachAround(v, [&](Index t, int) {
      if (!facetOf(t).isOpen() && !local_.contains(t))
        local_.set(face(t));
    });
}

}  // namespace spherical_param::internal
