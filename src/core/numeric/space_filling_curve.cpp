#include "space_filling_curve.h"

#include "bit_mixing.h"
#include "power_of_two.h"
#include "radix_sort.h"

#include <algorithm>

namespace spherical_param::internal {
namespace {

/// Moves the lowest 21 bits of x to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffffU;
  x = (x | x << 32U) & 0x001f00000000ffffULL;
  x = (x | x << 16U) & 0x001f0000ff0000ffULL;
  x = (x | x << 8U) & 0x100f00f00f00f00fULL;
  x = (x | x << 4U) & 0x10c30c30c30c30c3ULL;
  x = (x | x << 2U) & 0x1249249249249249ULL;
  return x;
}

std::vector<Index> orderOf(const Indexed<Place>& places) {
  std::vector<Index> order(places.size());
  std::transform(places.begin(), places.end(), order.begin(),
                 [](const Place& place) { return place.index; });
  return order;
}

/// Sorts points of one cell along the curve of their own box, recursively. Opposite sides of the
/// box lie in different cells, so each cluster is smaller than the one before it.
void refineClusters(const Positions& points, Place* begin, Place* end) {
  constexpr std::ptrdiff_t few = 16;
  for (Place* rest = begin; begin != end; begin = rest) {
    rest = std::find_if(begin, end, [&](const Place& place) { return place.key != begin->key; });
    Eigen::Vector3d low = points.col(begin->index);
    Eigen::Vector3d high = low;
    if (rest - begin <= few)
      continue;
    for (const Place* place = begin; place != rest; ++place) {
      low = low.cwiseMin(points.col(place->index));
      high = high.cwiseMax(points.col(place->index));
    }
    if (low == high)
      continue;
    const MortonCurve curve(low, high);
    for (Place* place = begin; place != rest; ++place)
      place->key = curve.key(points.col(place->index));
    std::sort(begin, rest, [](const Place& a, const Place& b) {
      return a.key != b.key ? a.key < b.key : a.index < b.index;
    });
    refineClusters(points, begin, rest);
  }
}

}  // namespace

MortonCurve::MortonCurve(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
    : half_((high - low).allFinite() ? 1.0 : 0.5), low_(half_ * low),
      exponent_(-exponentOfExtent(low, high)) {
  const double extent = timesPowerOfTwo(half_ * high - low_, exponent_).maxCoeff();
  constexpr double cells = 2097151.0;  // 2^21 - 1
  scale_ = extent > 0.0 ? cells / extent : 0.0;
}

std::uint64_t MortonCurve::key(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d cell = timesPowerOfTwo(half_ * point - low_, exponent_) * scale_;
  return spread(static_cast<std::uint64_t>(cell.x())) |
         spread(static_cast<std::uint64_t>(cell.y())) << 1U |
         spread(static_cast<std::uint64_t>(cell.z())) << 2U;
}

std::vector<Index> mortonOrder(const Positions& points) {
  if (points.cols() == 0)
    return {};
  const MortonCurve curve(points.rowwise().minCoeff(), points.rowwise().maxCoeff());
  return orderOf(
      sortedPlaces(columnCount(points), 1, [&](Index i) { return curve.key(points.col(i)); }));
}

std::vector<Index> insertionOrder(const Positions& directions) {
  const MortonCurve curve(Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Constant(1.0));
  // The first round has at most about 128 points. Each later one has 2^3 - 1 times as many points
  // as all before it. So there are fewer than 16 rounds, which fit in the 4 bits above the
  // curve's 60.
  constexpr unsigned growth_bits = 3;
  unsigned last_round = 0;
  for (Eigen::Index size = directions.cols(); size > 128; size >>= growth_bits)
    ++last_round;
  Indexed<Place> places = sortedPlaces(columnCount(directions), 1, [&](Index i) {
    std::uint64_t round = last_round;
    std::uint64_t bits = splitmix64(static_cast<std::uint64_t>(i) * 0x9e3779b97f4a7c15ULL);
    for (; round > 0 && bits % (1U << growth_bits) == 0; bits >>= growth_bits)
      --round;
    return round << 60U | curve.key(directions.col(i)) >> 3U;
  });
  refineClusters(directions, places.data(), places.data() + places.size());
  return orderOf(places);
}

}  // namespace spherical_param::internal
