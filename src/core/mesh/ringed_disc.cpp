#include "ringed_disc.h"

#include "pi.h"

#include <cmath>
#include <cstddef>

namespace spherical_param::internal {
namespace {

/// Vertices [begin, end) of the disc.
struct Ring {
  std::size_t begin;
  std::size_t end;

  std::size_t size() const { return end - begin; }
  Index vertex(std::size_t i) const { return static_cast<Index>(begin + i % size()); }
  /// Angle of vertex i, which may be one turn further.
  double angle(const RingedDisc& disc, std::size_t i) const {
    return i < size() ? disc.angles[begin + i] : disc.angles[begin + i - size()] + 2.0 * kPi;
  }
};

Ring addRingInside(const Ring& outer, RingedDisc& disc) {
  const auto m = static_cast<double>(outer.size());
  // With much smaller rings more starts of the embedding collapse.
  const auto size = static_cast<std::size_t>(std::ceil(0.7 * m));
  const double half_edge = kPi / static_cast<double>(size);
  const double radius = disc.radii[outer.begin] * (1.0 - kPi / m) / (1.0 + half_edge);
  for (std::size_t j = 0; j < size; ++j) {
    disc.angles.push_back(2.0 * half_edge * static_cast<double>(j));
    disc.radii.push_back(radius);
  }
  return {outer.end, outer.end + size};
}

}  // namespace

double RingedDisc::distance(Index a, Index b) const {
  const double sine = std::sin(0.5 * (angles[a] - angles[b]));
  return std::sqrt((radii[a] - radii[b]) * (radii[a] - radii[b]) +
                   4.0 * radii[a] * radii[b] * sine * sine);
}

RingedDisc ringedDisc(const std::vector<double>& boundary) {
  RingedDisc disc;
  disc.angles.assign(boundary.begin(), boundary.end());
  disc.radii.assign(boundary.size(), 1.0);
  std::vector<Index> corners;
  const auto add = [&](Index a, Index b, Index c) { corners.insert(corners.end(), {a, b, c}); };
  Ring outer{0, boundary.size()};
  while (outer.size() > 9) {
    const Ring inner = addRingInside(outer, disc);
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < outer.size() || j < inner.size()) {
      if (j == inner.size() ||
          (i < outer.size() && outer.angle(disc, i + 1) <= inner.angle(disc, j + 1))) {
        add(outer.vertex(i + 1), outer.vertex(i), inner.vertex(j));
        ++i;
      } else {
        add(outer.vertex(i), inner.vertex(j), inner.vertex(j + 1));
        ++j;
      }
    }
    outer = inner;
  }
  const auto pole = static_cast<Index>(outer.end);
  disc.angles.push_back(0.0);
  disc.radii.push_back(0.0);
  for (std::size_t i = 0; i < outer.size(); ++i)
    add(outer.vertex(i + 1), outer.vertex(i), pole);
  disc.triangles =
      Eigen::Map<const Triangles>(corners.data(), 3, static_cast<Eigen::Index>(corners.size() / 3));
  return disc;
}

}  // namespace spherical_param::internal
