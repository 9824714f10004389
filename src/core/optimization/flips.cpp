#include "flips.h"

#include "optimization_constants.h"
#include "parallel.h"

#include <algorithm>

namespace spherical_param::internal {

Flips::Flips(EnergyMesh& mesh)
    : mesh_(mesh), stamps_(mesh.mesh().slotCount(), {0, 0, 0}), due_(stamps_.size()) {}

void Flips::append(Index t, int corner, std::vector<Candidate>& candidates) const {
  const double floor = optimization_constants::kMinGain * mesh_.unit();
  const double gain = mesh_.flipGain(t, corner, floor);
  if (gain > floor)
    candidates.push_back(
        {gain, t, stamps_[t][static_cast<std::size_t>(corner)], static_cast<std::uint8_t>(corner)});
}

void Flips::queueSides(const std::vector<Index>& triangles) {
  const SphereMesh& mesh = mesh_.mesh();
  due_.clear();
  for (const Index t : triangles)
    due_.insert(t);
  for (const Index t : triangles)
    for (int k = 0; k < 3; ++k) {
      const Index o = mesh.neighbor(t, k);
      if (t > o && due_.contains(o))
        continue;  // queued as a side of o
      const Index low = std::min(t, o);
      const int corner = t < o ? k : mesh.oppositeCorner(t, k);
      ++stamps_[low][static_cast<std::size_t>(corner)];
      const std::size_t size = queue_.size();
      append(low, corner, queue_);
      if (queue_.size() > size)
        std::push_heap(queue_.begin(), queue_.end());
    }
}

std::size_t Flips::flipQueued(const FractionReport& report, const Ends& ends) {
  constexpr std::size_t items_per_check = 1024;
  const SphereMesh& mesh = mesh_.mesh();
  std::size_t flips = 0;
  double fraction = 0.0;
  for (std::size_t taken = 1; !queue_.empty(); ++taken) {
    if (ends && taken % items_per_check == 0 && ends()) {
      queue_.clear();
      break;
    }
    if (report && taken % kReportedItems == 0) {
      // An estimate: most candidates from now on are void, or lead to no further ones.
      fraction = std::max(fraction,
                          static_cast<double>(taken) / static_cast<double>(taken + queue_.size()));
      report(fraction);
    }
    const Candidate best = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end());
    queue_.pop_back();
    const Index t = best.triangle;
    if (stamps_[t][best.corner] != best.stamp)
      continue;
    const Index o = mesh.neighbor(t, best.corner);
    if (!mesh_.flip(t, best.corner, best.gain))
      continue;
    ++flips;
    // All sides whose gain depends on one of the two triangles: theirs, and their neighbours'.
    affected_ = {
        t, o, mesh.neighbor(t, 0), mesh.neighbor(t, 2), mesh.neighbor(o, 0), mesh.neighbor(o, 1)};
    // Sides move between triangles: entries of their old places are void, too.
    for (const Index i : affected_)
      for (std::uint32_t& stamp : stamps_[i])
        ++stamp;
    sortUnique(affected_);
    queueSides(affected_);
  }
  return flips;
}

void Flips::flipAround(const std::vector<Index>& triangles) {
  queue_.clear();
  queueSides(triangles);
  flipQueued();
}

std::size_t Flips::flipAll(const FractionReport& report, const Ends& ends) {
  queue_ = collectBlocks<Candidate>(stamps_.size(), mesh_.threads(), report,
                                    [&](Index begin, Index end, std::vector<Candidate>& found) {
                                      for (Index t = begin; t < end; ++t)
                                        for (int k = 0; k < 3; ++k)
                                          if (t < mesh_.mesh().neighbor(t, k))
                                            append(t, k, found);
                                    });
  std::make_heap(queue_.begin(), queue_.end());
  return flipQueued(report, ends);
}

}  // namespace spherical_param::internal
