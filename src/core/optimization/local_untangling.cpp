#include "local_untangling.h"

#include "power_of_two.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace spherical_param::internal {

LocalUntangling::LocalUntangling(EnergyMesh& mesh)
    : mesh_(mesh), scale_(scaleToUnit(mesh.points().cwiseAbs().maxCoeff())) {}

void LocalUntangling::watch(const std::vector<Index>& vertices) {
  counts_.clear();
  local_.begin(mesh_.mesh().slotCount());
  for (const Index v : vertices)
    mesh_.mesh().forEachAround(v, [&](Index t, int) {
      if (!mesh_.facet(t).is_open && !local_.contains(t))
        local_.set(face(t));
    });
}

int LocalUntangling::flipApart() {
  std::vector<Index> bad;
  for (const Face& face : local_.faces())
    if (intersects(face.triangle))
      bad.push_back(face.triangle);
  return flipApart(std::move(bad));
}

int LocalUntangling::flipChangedApart() {
  const std::vector<Index> changed = mesh_.changed();
  int difference = 0;
  for (const Index t : changed)
    if (local_.contains(t)) {
      difference -= local_.count(local_.face(t), t);
      local_.remove(t);
    }
  std::vector<Index> bad;
  for (const Index t : changed) {
    if (mesh_.facet(t).is_open)
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
  counts_.clear();
  sortUnique(bad);
  return difference - flipApart(std::move(bad));
}

int LocalUntangling::flipApart(std::vector<Index> bad) {
  int fewer = 0;
  for (std::size_t i = 0; i < bad.size(); ++i)
    while (work_ < max_work_ && intersects(bad[i])) {
      const Repairs repairs = bestRepairs(bad[i]);
      if (repairs.flips.empty())
        break;
      fewer -= repairs.pairs;
      for (const Repair& repair : repairs.flips) {
        bad.push_back(repair.triangle);
        bad.push_back(mesh_.mesh().neighbor(repair.triangle, repair.corner));
        flip(repair);
      }
    }
  return fewer;
}

std::optional<LocalUntangling::Repair> LocalUntangling::repairOf(Index t, int corner, int most) {
  const SphereMesh& mesh = mesh_.mesh();
  const Index o = mesh.neighbor(t, corner);
  if (!local_.contains(t) || !local_.contains(o))
    return std::nullopt;
  int before = countOf(t) + countOf(o);
  if (before + most < 0)
    return std::nullopt;
  before -= intersect(local_.face(t), local_.face(o)) ? 1 : 0;
  const auto [a, b, c, d] = mesh.diamond(t, corner);
  if (before + most < 0 || !isFree(mesh, {a, b, c, d}) || mesh_.facetOf(c, a, d).is_open ||
      mesh_.facetOf(c, d, b).is_open)
    return std::nullopt;
  const Face cad = face(t, {c, a, d});
  const Face cdb = face(o, {c, d, b});
  int left = before + most;
  left -= local_.count(cad, o, left, exact_tests_);
  if (left >= 0)
    left -= local_.count(cdb, t, left, exact_tests_);
  if (left >= 0)
    left -= intersect(cad, cdb) ? 1 : 0;
  if (left < 0)
    return std::nullopt;
  return Repair{t, corner, most - left,
                -mesh_.flipGain(t, corner, -std::numeric_limits<double>::infinity())};
}

int LocalUntangling::countOf(Index t) {
  const auto [known, is_new] = counts_.try_emplace(t, 0);
  if (is_new)
    known->second = local_.count(local_.face(t), t);
  return known->second;
}

void LocalUntangling::flip(const Repair& repair) {
  const Index o = mesh_.mesh().neighbor(repair.triangle, repair.corner);
  mesh_.flip(repair.triangle, repair.corner, -repair.cost);
  update(repair.triangle, o);
}

void LocalUntangling::consider(Index t, int corner, const Repairs& before, Repairs& best) {
  const auto repair = repairOf(t, corner, std::min(best.pairs, -1) - before.pairs);
  if (!repair)
    return;
  const int pairs = before.pairs + repair->pairs;
  const double cost = before.cost + repair->cost;
  if (std::tie(pairs, cost) >= std::tie(best.pairs, best.cost))
    return;
  best = {before.flips, pairs, cost};
  best.flips.push_back(*repair);
}

std::vector<std::pair<Index, int>> LocalUntangling::sidesNear(Index t) const {
  const SphereMesh& mesh = mesh_.mesh();
  std::vector<std::pair<Index, int>> sides;
  for (int k = 0; k < 3; ++k) {
    sides.emplace_back(t, k);
    const Index o = mesh.neighbor(t, k);
    for (int l = 0; l < 3; ++l)
      if (mesh.neighbor(o, l) != t)
        sides.emplace_back(o, l);
  }
  return sides;
}

LocalUntangling::Repairs LocalUntangling::bestRepairs(Index t) {
  ++work_;
  Repairs best;
  for (int k = 0; k < 3; ++k)
    consider(t, k, {}, best);
  if (!best.flips.empty())
    return best;
  // This costs as much as taking out and putting back 8 vertices.
  work_ += 8;
  // There are at most 1,900 exact tests unless triangles are degenerate. Then one test takes as
  // long as half a vertex.
  constexpr std::size_t typical_tests = 2000;
  const std::size_t tests_before = exact_tests_;
  best = bestTwoFlips(t);
  const std::size_t tests = exact_tests_ - tests_before;
  work_ += tests > typical_tests ? (tests - typical_tests) / 2 : 0;
  return best;
}

LocalUntangling::Repairs LocalUntangling::bestTwoFlips(Index t) {
  Repairs best;
  for (const auto& [u, k] : sidesNear(t)) {
    const auto first = repairOf(u, k, 1);
    if (!first)
      continue;
    const Index o = mesh_.mesh().neighbor(u, k);
    mesh_.begin();
    flip(*first);
    const Repairs before{{*first}, first->pairs, first->cost};
    for (int l = 0; l < 3; ++l) {
      consider(u, l, before, best);
      consider(o, l, before, best);
      if (t != u && t != o)
        consider(t, l, before, best);
    }
    mesh_.rollBack();
    update(u, o);
  }
  return best;
}

}  // namespace spherical_param::internal
