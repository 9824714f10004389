#include "space_filling_curve.h"

#include "bit_mixing.h"
#include "radix_sort.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

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

/// A point's place on a curve; sorted by key, then by index.
template <typename Key>
struct PlaceOf {
  Key key;
  Index index;
  bool operator<(const PlaceOf& other) const {
    return key != other.key ? key < other.key : index < other.index;
  }
};
using Place = PlaceOf<std::uint32_t>;
using CubePlace = PlaceOf<std::uint64_t>;

/// Sorts places whose indices ascend.
template <typename Key>
void sortPlaces(std::vector<PlaceOf<Key>>& places) {
  constexpr std::size_t few = 1000;
  if (places.size() < few)
    std::sort(places.begin(), places.end());
  else
    radixSort(places);
}

/// One step of the Hilbert curve (D. Hilbert, 1891) in the four attitudes that a square can have:
/// for quadrant 2 x + y, its number along the curve and the attitude within it.
struct HilbertStep {
  std::array<std::uint8_t, 4> digit;
  std::array<std::uint8_t, 4> attitude;
};
constexpr std::array<HilbertStep, 4> kHilbert{{{{0, 1, 3, 2}, {1, 0, 3, 0}},
                                               {{0, 3, 1, 2}, {0, 2, 1, 1}},
                                               {{2, 3, 1, 0}, {2, 1, 2, 3}},
                                               {{2, 1, 3, 0}, {3, 3, 0, 2}}}};

/// Position of a cell along the Hilbert curve over 2^bits x 2^bits cells; bits <= 16.
std::uint32_t hilbertIndex(std::uint32_t x, std::uint32_t y, unsigned bits) {
  std::uint32_t index = 0;
  std::size_t attitude = 0;
  for (unsigned bit = bits; bit-- > 0;) {
    const std::size_t quadrant = (x >> bit & 1U) << 1U | (y >> bit & 1U);
    index = index << 2U | kHilbert[attitude].digit[quadrant];
    attitude = kHilbert[attitude].attitude[quadrant];
  }
  return index;
}

/// Element i of the sequence of splitmix64 from 0.
std::uint64_t hash(std::uint64_t i) {
  return splitmix64(i * 0x9e3779b97f4a7c15ULL);
}

constexpr unsigned kCurveBits = 14;    ///< an axis, for the whole sphere
constexpr unsigned kRefineBits = 16;   ///< an axis, within a cell of the curve
constexpr unsigned kGrowthBits = 3;    ///< each round has 2^3 - 1 times the points before it
constexpr double kFirstRound = 128.0;  ///< points in the first round, about
constexpr std::ptrdiff_t kCrowd = 16;  ///< points in one cell that are worth refining

/// Cell of a direction on the Hilbert curve over the octahedron, unfolded to a square (Z. H.
/// Cigolle et al., "A survey of efficient representations for independent unit vectors", 2014).
std::uint32_t curveIndex(double x, double y, double z) {
  const double scale = 1.0 / (std::abs(x) + std::abs(y) + std::abs(z));
  double u = x * scale;
  double v = y * scale;
  if (z < 0.0) {
    const double folded = std::copysign(1.0 - std::abs(v), u);
    v = std::copysign(1.0 - std::abs(u), v);
    u = folded;
  }
  constexpr double half = 1U << (kCurveBits - 1U);
  const auto cell = [&](double w) {
    return std::min(static_cast<std::uint32_t>(std::max(half + half * w, 0.0)),
                    (1U << kCurveBits) - 1U);
  };
  return hilbertIndex(cell(u), cell(v), kCurveBits);
}

/// Sorts points of one cell along a Hilbert curve over their own bounding box, and so on. The sides
/// of the box lie in different cells: each crowd is smaller than the one before it.
void refine(const Positions& directions, Place* begin, Place* end) {
  Eigen::Index normal = 0;
  directions.col(begin->index).cwiseAbs().maxCoeff(&normal);
  const auto chart = [&](const Place& place) {
    const auto direction = directions.col(place.index);
    return Eigen::Array2d(direction[(normal + 1) % 3], direction[(normal + 2) % 3]);
  };
  Eigen::Array2d low = chart(*begin);
  Eigen::Array2d high = low;
  for (const Place* place = begin; place != end; ++place) {
    low = low.min(chart(*place));
    high = high.max(chart(*place));
  }
  const double extent = (high - low).maxCoeff();
  if (!(extent > 0.0))
    return;
  constexpr double cells = (1U << kRefineBits) - 1U;
  for (Place* place = begin; place != end; ++place) {
    const Eigen::Array2d cell = (chart(*place) - low) / extent * cells;
    place->key = hilbertIndex(static_cast<std::uint32_t>(cell.x()),
                              static_cast<std::uint32_t>(cell.y()), kRefineBits);
  }
  std::sort(begin, end);
  for (Place* crowd = begin; crowd != end;) {
    const std::uint32_t key = crowd->key;
    Place* rest = std::find_if(crowd, end, [&](const Place& place) { return place.key != key; });
    if (rest - crowd > kCrowd)
      refine(directions, crowd, rest);
    crowd = rest;
  }
}

}  // namespace

MortonCurve::MortonCurve(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
    : half_((high - low).allFinite() ? 1.0 : 0.5), low_(half_ * low),
      scaled_(-exponentOfExtent(low, high)) {
  const double extent = scaled_(half_ * high - low_).maxCoeff();
  constexpr double cells = 2097151.0;  // 2^21 - 1
  scale_ = extent > 0.0 ? cells / extent : 0.0;
}

std::uint64_t MortonCurve::key(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d cell = scaled_(half_ * point - low_) * scale_;
  return spread(static_cast<std::uint64_t>(cell.x())) |
         spread(static_cast<std::uint64_t>(cell.y())) << 1U |
         spread(static_cast<std::uint64_t>(cell.z())) << 2U;
}

std::vector<Index> mortonOrder(const Positions& points) {
  const auto n = static_cast<std::size_t>(points.cols());
  std::vector<Index> order(n);
  if (n == 0)
    return order;
  const MortonCurve curve(points.rowwise().minCoeff(), points.rowwise().maxCoeff());
  std::vector<CubePlace> places(n);
  for (std::size_t i = 0; i < n; ++i)
    places[i] = {curve.key(points.col(static_cast<Eigen::Index>(i))), static_cast<Index>(i)};
  sortPlaces(places);
  std::transform(places.begin(), places.end(), order.begin(),
                 [](const CubePlace& place) { return place.index; });
  return order;
}

std::vector<Index> insertionOrder(const Positions& directions) {
  const auto n = static_cast<std::size_t>(directions.cols());
  // A round has as many points as all before it, times 2^kGrowthBits - 1.
  unsigned last_round = 0;
  constexpr unsigned most_rounds = 1U << (32U - 2U * kCurveBits);
  for (double size = static_cast<double>(n); size > kFirstRound && last_round + 1 < most_rounds;
       size /= 1U << kGrowthBits)
    ++last_round;
  std::vector<Place> places(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    unsigned round = last_round;
    for (std::uint64_t bits = hash(i); round > 0 && (bits & ((1U << kGrowthBits) - 1U)) == 0;
         bits >>= kGrowthBits)
      --round;
    places[i] = {round << 2U * kCurveBits | curveIndex(directions(0, column), directions(1, column),
                                                       directions(2, column)),
                 static_cast<Index>(i)};
  }
  sortPlaces(places);
  for (std::size_t begin = 0; begin < n;) {
    std::size_t end = begin + 1;
    while (end < n && places[end].key == places[begin].key)
      ++end;
    if (end - begin > static_cast<std::size_t>(kCrowd))
      refine(directions, places.data() + begin, places.data() + end);
    begin = end;
  }
  std::vector<Index> order(n);
  std::transform(places.begin(), places.end(), order.begin(),
                 [](const Place& place) { return place.index; });
  return order;
}

}  // namespace spherical_param::internal
