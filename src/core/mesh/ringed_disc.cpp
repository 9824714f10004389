#include "ringed_disc.h"

#include "pi.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace spherical_param::internal {
namespace {

/// Vertices [begin, end) of the disc.
struct Ring {
  std::size_t begin;
  std::size_t end;

  std::size_t size() const { return end - begin; }
  Index vertex(std::size_t i) const { return static_cast<Index>(begin + i % size()); }
};

class Builder {
public:
  explicit Builder(const std::vector<double>& rim) {
    disc_.angles.assign(rim.begin(), rim.end());
    disc_.radii.assign(rim.size(), 1.0);
    Ring ring{0, rim.size()};
    while (ring.size() > 9) {
      const Ring inner = addRingInside(ring);
      join(ring, inner);
      ring = inner;
    }
    const auto pole = static_cast<Index>(ring.end);
    disc_.angles.push_back(0.0);
    disc_.radii.push_back(0.0);
    for (std::size_t i = 0; i < ring.size(); ++i)
      add(ring.vertex(i + 1), ring.vertex(i), pole);
  }

  RingedDisc take() {
    disc_.triangles = Eigen::Map<const Triangles>(corners_.data(), 3,
                                                  static_cast<Eigen::Index>(corners_.size() / 3));
    return std::move(disc_);
  }

private:
  Ring addRingInside(const Ring& outer) {
    const auto m = static_cast<double>(outer.size());
    // With half as many, twice as many starts of the embedding of 14 single views collapse, which
    // takes twice the time of the whole run.
    const auto size = static_cast<std::size_t>(std::ceil(0.7 * m));
    const double half_edge = kPi / static_cast<double>(size);
    const double radius = disc_.radii[outer.begin] * (1.0 - kPi / m) / (1.0 + half_edge);
    for (std::size_t j = 0; j < size; ++j) {
      disc_.angles.push_back(2.0 * half_edge * static_cast<double>(j));
      disc_.radii.push_back(radius);
    }
    return {outer.end, outer.end + size};
  }

  /// Of vertex i of a ring, which may be one turn further.
  double angle(const Ring& ring, std::size_t i) const {
    return i < ring.size() ? disc_.angles[ring.begin + i]
                           : disc_.angles[ring.begin + i - ring.size()] + 2.0 * kPi;
  }

  void join(const Ring& outer, const Ring& inner) {
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < outer.size() || j < inner.size()) {
      if (j == inner.size() || (i < outer.size() && angle(outer, i + 1) <= angle(inner, j + 1))) {
        add(outer.vertex(i + 1), outer.vertex(i), inner.vertex(j));
        ++i;
      } else {
        add(outer.vertex(i), inner.vertex(j), inner.vertex(j + 1));
        ++j;
      }
    }
  }

  void add(Index a, Index b, Index c) { corners_.insert(corners_.end(), {a, b, c}); }

  RingedDisc disc_;
  std::vector<Index> corners_;
};

}  // namespace

double RingedDisc::distance(Index a, Index b) const {
  const double sine = std::sin(0.5 * (angles[a] - angles[b]));
  return std::sqrt((radii[a] - radii[b]) * (radii[a] - radii[b]) +
                   4.0 * radii[a] * radii[b] * sine * sine);
}

RingedDisc ringedDisc(const std::vector<double>& rim) {
  return Builder(rim).take();
}

}  // namespace spherical_param::internal
