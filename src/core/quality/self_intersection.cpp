#include "spherical_param/self_intersection.h"

#include "exact_predicates.h"
#include "parallel.h"
#include "progress.h"
#include "radix_sort.h"
#include "self_intersection_of_fans.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

// Candidates come from a tree of bounding boxes over the triangles in the order of a space-filling
// curve: one for all, or one for each block of a mesh whose triangles are in good order already.
// Nearly all of them are neighbours that a plane separates, which few operations and a bound of
// their error show. Exact arithmetic decides about the rest, straight from the definition.

namespace spherical_param {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using internal::FractionReport;
using internal::kUnitRoundoff;
using internal::orientation2d;
using internal::orientation3d;
using Pairs = std::vector<std::array<Index, 2>>;

// They influence the time only, not the pairs that are found.

/// Triangles this number of times as large as the typical one are large.
constexpr double kMinLarge = 8.0;
/// Blocks of triangles are together up to this number of times the typical size of one; in the
/// order of a space-filling curve, they are 20 to 40 times as large.
constexpr double kMaxBlock = 64.0;
/// Up to this number of large triangles, and one more for each kTypicalPerLarge, do no harm.
constexpr std::size_t kMaxLarge = 16;
constexpr std::size_t kTypicalPerLarge = 10000;

/// A triangle with all that the tests need, in one place of the memory.
struct Face {
  std::array<Vector3d, 3> corners;  ///< scaled, see checkedScale()
  double size;                      ///< at least the longest side of the bounding box
  std::array<Index, 3> vertices;
  Index triangle;
};

// --- The definition, in exact arithmetic ---------------------------------------------------------

/// The axis along which a triangle is projected without losing its area; 3 if it has none.
int projectionAxis(const std::array<Vector3d, 3>& t) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto flat = [&](const Vector3d& p) {
      return Vector2d(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    };
    if (orientation2d(flat(t[0]), flat(t[1]), flat(t[2])) != 0)
      return axis;
  }
  return 3;
}

/// A triangle with area, and its plane seen along an axis.
struct ExactTriangle {
  std::array<Vector3d, 3> corners;
  int axis;  ///< of projectionAxis(), below 3

  Vector2d flat(const Vector3d& p) const { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }
  /// Sign of the side of the plane that p is on.
  int side(const Vector3d& p) const { return orientation3d(corners[0], corners[1], corners[2], p); }
  /// Sign of the side of the line from a to b that c is on; all in the plane.
  int turn(const Vector3d& a, const Vector3d& b, const Vector3d& c) const {
    return orientation2d(flat(a), flat(b), flat(c));
  }
  /// Whether a point of the plane is in the closed triangle.
  bool contains(const Vector3d& p) const {
    const int first = turn(corners[0], corners[1], p);
    const int second = turn(corners[1], corners[2], p);
    const int third = turn(corners[2], corners[0], p);
    return std::min({first, second, third}) >= 0 || std::max({first, second, third}) <= 0;
  }
};

/// Whether two closed segments in the plane of a triangle, both longer than zero, have a point in
/// common, besides an end of the first inside the triangle that the second is a side of.
bool segmentsCross(const ExactTriangle& plane, const Vector3d& p, const Vector3d& q,
                   const Vector3d& a, const Vector3d& b) {
  const int a_side = plane.turn(p, q, a);
  const int b_side = plane.turn(p, q, b);
  const int p_side = plane.turn(a, b, p);
  const int q_side = plane.turn(a, b, q);
  // On one line they overlap only if an end of one is in the other: of the two ends of the first,
  // contains() knows; if those of the second are in the first, so is a corner, and with it a point
  // of another side, which is not on this line.
  return a_side * b_side <= 0 && p_side * q_side <= 0 && (a_side != 0 || b_side != 0);
}

/// Whether a closed segment and a closed triangle have a point in common.
bool segmentMeets(const Vector3d& p, const Vector3d& q, const ExactTriangle& t) {
  const int p_side = t.side(p);
  const int q_side = t.side(q);
  if (p_side * q_side > 0)
    return false;
  if ((p_side == 0 && t.contains(p)) || (q_side == 0 && t.contains(q)))
    return true;
  const auto& [a, b, c] = t.corners;
  if (p_side == 0 && q_side == 0)
    return segmentsCross(t, p, q, a, b) || segmentsCross(t, p, q, b, c) ||
           segmentsCross(t, p, q, c, a);
  if (p_side == 0 || q_side == 0)
    return false;
  const int first = orientation3d(p, q, a, b);
  const int second = orientation3d(p, q, b, c);
  const int third = orientation3d(p, q, c, a);
  return std::min({first, second, third}) >= 0 || std::max({first, second, third}) <= 0;
}

/// The definition of the header.
bool intersectExactly(const Face& face_a, const Face& face_b) {
  ExactTriangle a{face_a.corners, projectionAxis(face_a.corners)};
  ExactTriangle b{face_b.corners, projectionAxis(face_b.corners)};
  if (a.axis == 3 || b.axis == 3)
    return false;
  // Common corners to the front, in the same order.
  std::size_t common = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = common; j < 3; ++j)
      if (a.corners[i] == b.corners[j]) {
        std::swap(a.corners[i], a.corners[common]);
        std::swap(b.corners[j], b.corners[common]);
        ++common;
        break;
      }
  switch (common) {
  case 0:
    // Where two triangles meet, a side of one of them meets the other.
    for (std::size_t i = 0; i < 3; ++i)
      if (segmentMeets(a.corners[i], a.corners[(i + 1) % 3], b) ||
          segmentMeets(b.corners[i], b.corners[(i + 1) % 3], a))
        return true;
    return false;
  case 1:
    return segmentMeets(a.corners[1], a.corners[2], b) ||
           segmentMeets(b.corners[1], b.corners[2], a);
  case 2:
    // The cheap question first: in a flat mesh, neighbours lie on different sides.
    return a.turn(a.corners[0], a.corners[1], a.corners[2]) *
                   a.turn(a.corners[0], a.corners[1], b.corners[2]) >
               0 &&
           a.side(b.corners[2]) == 0;
  default:
    return true;
  }
}

// --- Quick tests that only ever say that two triangles do not intersect
// ---------------------------

double largest(const Vector3d& v) {
  return v.cwiseAbs().maxCoeff();
}

/// The plane of a triangle, rounded.
struct Plane {
  Vector3d origin;
  Vector3d normal;
  double error;  ///< bound of that of value(), relative to the distance from the origin

  explicit Plane(const Face& face) : origin(face.corners[0]) {
    const Vector3d u = face.corners[1] - origin;
    const Vector3d v = face.corners[2] - origin;
    normal = u.cross(v);
    // A coordinate of the normal is wrong by up to 8 units of roundoff of |u| |v| (largest
    // coordinates), and at most 2 |u| |v|; each of the three products of the value with a distance
    // d thus by 8 + 2 * 4 units of |u| |v| d. The rest up to 64 covers higher powers.
    error = 64.0 * kUnitRoundoff * largest(u) * largest(v);
  }
  /// Distance of p from the plane, times the length of the normal.
  double value(const Vector3d& p) const { return normal.dot(p - origin); }
  /// Whether all of some values are on one side for sure.
  /// \param reach bound of the coordinates of p - origin.
  template <typename... Values>
  bool isBeside(double reach, Values... values) const {
    const double bound = error * reach;
    return std::min({values...}) > bound || std::max({values...}) < -bound;
  }
};

/// Whether a plane through a common corner v lies between the other corners of two triangles.
///
/// \param reach bound of the coordinates of differences of corners.
bool separatedAt(const Vector3d& v, const Vector3d& a1, const Vector3d& a2, const Vector3d& b1,
                 const Vector3d& b2, double reach) {
  // Any direction will do: it has no error. This one is mostly normal to such a plane.
  const Vector3d direction = (a1 - b1) + (a2 - b2);
  // 4 roundings in each of three products of a coordinate of the direction, up to 2 reach, with a
  // distance.
  const double bound = 32.0 * kUnitRoundoff * reach * reach;
  return std::min(direction.dot(a1 - v), direction.dot(a2 - v)) > bound &&
         std::max(direction.dot(b1 - v), direction.dot(b2 - v)) < -bound;
}

/// Whether a plane across the line between their centres lies between two triangles.
bool separated(const Face& a, const Face& b, double reach) {
  const auto& [a0, a1, a2] = a.corners;
  const auto& [b0, b1, b2] = b.corners;
  const Vector3d direction = (a0 - b0) + (a1 - b1) + (a2 - b2);
  const double least = std::min({0.0, direction.dot(a1 - a0), direction.dot(a2 - a0)});
  const double most =
      std::max({direction.dot(b0 - a0), direction.dot(b1 - a0), direction.dot(b2 - a0)});
  // As above, for two distances and a direction up to 3 reach.
  return least - most > 128.0 * kUnitRoundoff * reach * reach;
}

/// Whether two triangles whose boxes overlap evidently do not intersect.
///
/// \param plane_a of a.
bool evidentlyApart(const Face& a, const Plane& plane_a, const Face& b) {
  // How many corners they have in common, and the sums of the numbers of these in either.
  unsigned common = 0;
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j)
      common += a.vertices[i] == b.vertices[j] ? 1U + (i << 8U) + (j << 16U) : 0U;
  const std::size_t of_a = common >> 8U & 0xffU;
  const std::size_t of_b = common >> 16U;
  const double reach = a.size + b.size;
  // A triangle that names a vertex twice makes nonsense of the sums, but it has no area. Corners
  // that are equal but not named alike do no harm: nothing separates them.
  constexpr std::array<std::size_t, 4> next{1, 2, 0, 1};
  switch (common & 0xffU) {
  case 0:
    return separated(a, b, reach) ||
           plane_a.isBeside(reach, plane_a.value(b.corners[0]), plane_a.value(b.corners[1]),
                            plane_a.value(b.corners[2]));
  case 1: {
    const Vector3d& b1 = b.corners[next[of_b]];
    const Vector3d& b2 = b.corners[next[of_b + 1]];
    return separatedAt(a.corners[of_a], a.corners[next[of_a]], a.corners[next[of_a + 1]], b1, b2,
                       reach) ||
           plane_a.isBeside(reach, plane_a.value(b1), plane_a.value(b2));
  }
  case 2:
    return of_b <= 3 && plane_a.isBeside(reach, plane_a.value(b.corners[3 - of_b]));
  default:
    return false;
  }
}

/// For what is left after evidentlyApart(a, plane_a, b).
bool intersectCarefully(const Face& a, const Face& b) {
  return !evidentlyApart(b, Plane(b), a) && intersectExactly(a, b);
}

// --- The tree of boxes ---------------------------------------------------------------------------

struct Box {
  Vector3d lower;
  Vector3d upper;

  double size() const { return (upper - lower).maxCoeff(); }
  bool overlaps(const Box& other) const {
    return (lower.array() <= other.upper.array()).all() &&
           (other.lower.array() <= upper.array()).all();
  }
};

Box boxOf(const std::array<Vector3d, 3>& corners) {
  const auto& [a, b, c] = corners;
  return {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
}

/// Whether a box lies on one side of a plane.
bool clears(const Plane& plane, const Box& box) {
  const Vector3d center = 0.5 * (box.lower + box.upper) - plane.origin;
  const Vector3d half = 0.5 * (box.upper - box.lower);
  const double reach = plane.normal.cwiseAbs().dot(half);
  const double bound = plane.error * (largest(center) + largest(half));
  return std::abs(plane.normal.dot(center)) > reach + 2.0 * bound;
}

constexpr std::size_t kWidth = 8;  ///< boxes of a group: as wide as several processors' registers
constexpr unsigned kWidthBits = 3;

/// A box that contains one of doubles: half the memory, and twice as many in a register.
struct WideBox {
  std::array<float, 3> lower;
  std::array<float, 3> upper;

  explicit WideBox(const Box& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto low = static_cast<float>(box.lower[static_cast<Eigen::Index>(axis)]);
      const auto high = static_cast<float>(box.upper[static_cast<Eigen::Index>(axis)]);
      lower[axis] = low - margin(low);
      upper[axis] = high + margin(high);
    }
  }
  WideBox(const std::array<float, 3>& low, const std::array<float, 3>& high)
      : lower(low), upper(high) {}

  Box box() const { return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}}; }
  float size() const {
    return std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  }

private:
  /// More than what rounding to a float has taken, and that of adding the margin.
  static float margin(float value) { return std::abs(value) * 3e-7F + 1e-37F; }
};

/// Boxes side by side, so that one is compared with all of them at once.
struct BoxGroup {
  std::array<std::array<float, kWidth>, 3> lower;
  std::array<std::array<float, kWidth>, 3> upper;

  BoxGroup() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis].fill(std::numeric_limits<float>::infinity());
      upper[axis].fill(-std::numeric_limits<float>::infinity());
    }
  }
  void set(std::size_t lane, const WideBox& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis][lane] = box.lower[axis];
      upper[axis][lane] = box.upper[axis];
    }
  }
  WideBox at(std::size_t lane) const {
    return {{lower[0][lane], lower[1][lane], lower[2][lane]},
            {upper[0][lane], upper[1][lane], upper[2][lane]}};
  }
  WideBox all() const {
    WideBox box = at(0);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t lane = 1; lane < kWidth; ++lane) {
        box.lower[axis] = std::min(box.lower[axis], lower[axis][lane]);
        box.upper[axis] = std::max(box.upper[axis], upper[axis][lane]);
      }
    return box;
  }
};

/// Lanes of a group whose boxes overlap a box.
class Overlaps {
public:
  Overlaps(const BoxGroup& group, const WideBox& box) {
    // Lanes of one width, and no branches: a few instructions for all of them.
    std::array<float, kWidth> gaps;
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      const float x =
          std::max(group.lower[0][lane] - box.upper[0], box.lower[0] - group.upper[0][lane]);
      const float y =
          std::max(group.lower[1][lane] - box.upper[1], box.lower[1] - group.upper[1][lane]);
      const float z =
          std::max(group.lower[2][lane] - box.upper[2], box.lower[2] - group.upper[2][lane]);
      gaps[lane] = std::max(std::max(x, y), z);
    }
    // Boxes are wider than what they contain: where it touches, gaps are below 0. Their signs to
    // places of their own, and these together, half by half.
    std::array<std::int32_t, kWidth> signs;
    static_assert(sizeof(signs) == sizeof(gaps), "a sign for each gap");
    std::memcpy(signs.data(), gaps.data(), sizeof(gaps));
    std::array<std::int32_t, kWidth / 2> halves;
    for (std::size_t lane = 0; lane < kWidth / 2; ++lane)
      halves[lane] = (signs[lane] < 0 ? kBits[lane] : 0) |
                     (signs[lane + kWidth / 2] < 0 ? kBits[lane + kWidth / 2] : 0);
    bits_ = static_cast<std::uint32_t>((halves[0] | halves[1]) | (halves[2] | halves[3]));
  }

  class Iterator {
  public:
    explicit Iterator(std::uint32_t bits) : bits_(bits) {}
    std::size_t operator*() const { return kLowestBits[bits_]; }
    Iterator& operator++() {
      bits_ &= bits_ - 1U;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return bits_ != other.bits_; }

  private:
    std::uint32_t bits_;
  };
  Iterator begin() const { return Iterator(bits_); }
  Iterator end() const { return Iterator(0); }

private:
  static constexpr std::array<std::uint8_t, 1U << kWidth> lowestBits() {
    std::array<std::uint8_t, 1U << kWidth> lowest{};
    for (std::size_t bits = 1; bits < lowest.size(); ++bits)
      lowest[bits] =
          bits % 2 != 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(lowest[bits / 2] + 1);
    return lowest;
  }
  static const std::array<std::uint8_t, 1U << kWidth> kLowestBits;
  static constexpr std::array<std::int32_t, kWidth> kBits{1, 2, 4, 8, 16, 32, 64, 128};

  std::uint32_t bits_ = 0;
};

constexpr std::array<std::uint8_t, 1U << kWidth> Overlaps::kLowestBits = Overlaps::lowestBits();

/// Moves the lowest 10 bits of x to every third bit.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16U) & 0x030000ffU;
  x = (x | x << 8U) & 0x0300f00fU;
  x = (x | x << 4U) & 0x030c30c3U;
  x = (x | x << 2U) & 0x09249249U;
  return x;
}

/// A triangle's place in the order.
struct Place {
  std::uint32_t key;
  Index triangle;
  bool operator<(const Place& other) const {
    return key != other.key ? key < other.key : triangle < other.triangle;
  }
};

/// A mesh as the tests want it.
class Mesh {
public:
  /// \param scale a power of two; coordinates times it are at most 1.
  /// \param fans for each point, whether it is known that the triangles around it do not
  /// intersect; none: nothing is known.
  Mesh(const Positions& points, const Triangles& triangles, double scale,
       const std::vector<std::uint8_t>& fans)
      : points_(points), triangles_(triangles), scale_(scale), fans_(fans) {}

  std::size_t size() const { return static_cast<std::size_t>(triangles_.cols()); }

  Box box(Index triangle) const { return boxOf(corners(triangle)); }
  std::array<Index, 3> vertices(Index triangle) const {
    return {triangles_(0, triangle), triangles_(1, triangle), triangles_(2, triangle)};
  }
  /// \param size of Face.
  Face face(Index triangle, double size) const {
    return {corners(triangle), size, vertices(triangle), triangle};
  }
  /// The triangle's vertices whose triangles are known not to intersect, and -1 for the others.
  std::array<Index, 3> centersOfFans(Index triangle) const {
    std::array<Index, 3> centers = vertices(triangle);
    for (Index& v : centers)
      if (fans_.empty() || fans_[static_cast<std::size_t>(v)] == 0)
        v = -1;
    return centers;
  }

private:
  std::array<Vector3d, 3> corners(Index triangle) const {
    return {points_.col(triangles_(0, triangle)) * scale_,
            points_.col(triangles_(1, triangle)) * scale_,
            points_.col(triangles_(2, triangle)) * scale_};
  }

  const Positions& points_;
  const Triangles& triangles_;
  double scale_;
  const std::vector<std::uint8_t>& fans_;
};

constexpr unsigned kCurveBits = 10;         ///< an axis
constexpr std::uint32_t kMaxSizeClass = 3;  ///< what is left of the 32 bits of a key

/// Sorts triangles with the same key along the curve in the bounding cube of their own centres, and
/// so on: however unevenly the mesh is sampled, triangles that follow each other are near.
void refine(const Mesh& mesh, Place* begin, Place* end) {
  const auto center = [&](const Place& place) {
    const Box box = mesh.box(place.triangle);
    return Vector3d(0.5 * (box.lower + box.upper));
  };
  Vector3d low = center(*begin);
  Vector3d high = low;
  for (const Place* place = begin; place != end; ++place) {
    low = low.cwiseMin(center(*place));
    high = high.cwiseMax(center(*place));
  }
  const double extent = (high - low).maxCoeff();
  if (extent < 1e-290)  // below that, the scale overflows
    return;
  const double scale = ((1U << kCurveBits) - 1U) / extent;
  for (Place* place = begin; place != end; ++place) {
    const Vector3d cell = (center(*place) - low) * scale;
    place->key = spread(static_cast<std::uint32_t>(cell.x())) |
                 spread(static_cast<std::uint32_t>(cell.y())) << 1U |
                 spread(static_cast<std::uint32_t>(cell.z())) << 2U;
  }
  std::sort(begin, end);
  for (Place* crowd = begin; crowd != end;) {
    const std::uint32_t key = crowd->key;
    Place* rest = std::find_if(crowd, end, [&](const Place& place) { return place.key != key; });
    if (rest - crowd > static_cast<std::ptrdiff_t>(kWidth))
      refine(mesh, crowd, rest);
    crowd = rest;
  }
}

/// The typical size of a triangle: the median of a sample.
double usualSize(const Mesh& mesh, const std::vector<Index>& subset) {
  constexpr std::size_t sample = 1000;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < subset.size(); i += 1 + subset.size() / sample)
    sizes.push_back(mesh.box(subset[i]).size());
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

/// The triangles by size, then along a space-filling curve (G. M. Morton, 1966). Large ones have a
/// part of the tree for themselves: among small ones they would make large boxes of all above them.
///
/// \param usual size of a triangle.
std::vector<Index> orderedAnew(const Mesh& mesh, const std::vector<Index>& subset, double usual,
                               int threads) {
  std::vector<Place> places(subset.size());
  // Coordinates are in [-1, 1].
  constexpr double scale = ((1U << kCurveBits) - 1U) / 2.0;
  internal::forEachBlock(
      subset.size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Box box = mesh.box(subset[i]);
          std::uint32_t size_class = 0;
          for (double size = box.size() / kMinLarge; size > usual && size_class < kMaxSizeClass;
               size /= kMinLarge)
            ++size_class;
          const Vector3d cell = (0.5 * (box.lower + box.upper) + Vector3d::Ones()) * scale;
          places[i] = {spread(static_cast<std::uint32_t>(cell.x())) |
                           spread(static_cast<std::uint32_t>(cell.y())) << 1U |
                           spread(static_cast<std::uint32_t>(cell.z())) << 2U |
                           size_class << 3U * kCurveBits,
                       subset[i]};
        }
      });
  internal::radixSort(places);
  for (std::size_t begin = 0; begin < places.size();) {
    std::size_t end = begin + 1;
    while (end < places.size() && places[end].key == places[begin].key)
      ++end;
    if (end - begin > kWidth)
      refine(mesh, places.data() + begin, places.data() + end);
    begin = end;
  }
  std::vector<Index> order(places.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = places[i].triangle;
  return order;
}

constexpr unsigned kCellBits = 5;  ///< an axis, of a block: some two cells a triangle
constexpr std::size_t kCells = std::size_t{1} << kCellBits;

/// The places of 32 x 32 cells along a Hilbert curve (D. Hilbert, 1891).
constexpr std::array<std::uint16_t, kCells * kCells> hilbertPlaces() {
  std::array<std::uint16_t, kCells * kCells> places{};
  for (std::size_t cell = 0; cell < places.size(); ++cell) {
    std::size_t x = cell / kCells;
    std::size_t y = cell % kCells;
    std::size_t place = 0;
    for (std::size_t half = kCells / 2; half > 0; half /= 2) {
      const std::size_t right = (x & half) != 0 ? 1 : 0;
      const std::size_t upper = (y & half) != 0 ? 1 : 0;
      place += half * half * ((3 * right) ^ upper);
      // The attitude of the curve in this quarter.
      if (upper == 0) {
        if (right == 1) {
          x = kCells - 1 - x;
          y = kCells - 1 - y;
        }
        const std::size_t swapped = x;
        x = y;
        y = swapped;
      }
    }
    places[cell] = static_cast<std::uint16_t>(place);
  }
  return places;
}
constexpr std::array<std::uint16_t, kCells* kCells> kHilbertPlaces = hilbertPlaces();

using BlockCenters = std::array<std::array<float, 3>, internal::kBlockSize>;

/// Sorts a block of triangles along a Hilbert curve, as seen along the shortest axis of the box of
/// their centres: a part of a surface is mostly flat.
void sortBlock(const BlockCenters& centers, const Index* block, std::size_t count, Index* sorted) {
  std::array<float, 3> low = centers[0];
  std::array<float, 3> high = low;
  for (std::size_t i = 1; i < count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], centers[i][axis]);
      high[axis] = std::max(high[axis], centers[i][axis]);
    }
  std::size_t shortest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (high[axis] - low[axis] < high[shortest] - low[shortest])
      shortest = axis;
  const std::size_t x = (shortest + 1) % 3;
  const std::size_t y = (shortest + 2) % 3;
  const float extent = std::max(high[x] - low[x], high[y] - low[y]);
  if (!(extent > 1e-30F)) {  // below that, the scale overflows
    std::copy(block, block + count, sorted);
    return;
  }
  const float scale = (static_cast<float>(kCells) - 0.5F) / extent;
  std::array<std::uint16_t, internal::kBlockSize> places;
  std::array<std::uint16_t, kCells * kCells + 1> begins{};
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<std::size_t>((centers[i][x] - low[x]) * scale);
    const auto row = static_cast<std::size_t>((centers[i][y] - low[y]) * scale);
    places[i] = kHilbertPlaces[column * kCells + row];
    ++begins[places[i] + 1U];
  }
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  for (std::size_t i = 0; i < count; ++i)
    sorted[begins[places[i]]++] = block[i];
}

/// The triangles in an order in which neighbours are near.
///
/// \param subset triangles, ascending; at least one.
std::vector<Index> ordered(const Mesh& mesh, const std::vector<Index>& subset, int threads,
                           const FractionReport& report) {
  const double usual = usualSize(mesh, subset);
  // Most meshes come in blocks that are small, and of triangles of about one size: then it is
  // enough to sort within these.
  struct Blocks {
    double size = 0.0;
    std::size_t large = 0;
    Blocks& operator+=(const Blocks& other) {
      size += other.size;
      large += other.large;
      return *this;
    }
  };
  std::vector<Index> order(subset.size());
  const Blocks blocks = internal::sumOfBlocks(
      subset.size(), threads, Blocks{},
      [&](std::size_t begin, std::size_t end) {
        BlockCenters centers;
        Blocks block;
        Box all = mesh.box(subset[begin]);
        for (std::size_t i = begin; i < end; ++i) {
          const Box box = mesh.box(subset[i]);
          all.lower = all.lower.cwiseMin(box.lower);
          all.upper = all.upper.cwiseMax(box.upper);
          const Eigen::Vector3f center = (0.5 * (box.lower + box.upper)).cast<float>();
          centers[i - begin] = {center.x(), center.y(), center.z()};
          block.large += box.size() > kMinLarge * usual ? 1 : 0;
        }
        block.size = all.size();
        sortBlock(centers, subset.data() + begin, end - begin, order.data() + begin);
        return block;
      },
      report);
  const std::size_t count = (subset.size() + internal::kBlockSize - 1) / internal::kBlockSize;
  if (blocks.size > kMaxBlock * usual * static_cast<double>(count) ||
      blocks.large > kMaxLarge + subset.size() / kTypicalPerLarge)
    return orderedAnew(mesh, subset, usual, threads);
  return order;
}

/// Triangles with a tree of their bounding boxes: group i of a level holds the boxes of the groups
/// 8 i ... 8 i + 7 of the level below, and of triangles on the lowest level (I. Kamel and C.
/// Faloutsos, "On packing R-trees", 1993).
class Tree {
public:
  /// \param subset triangles, ascending; at least one. The mesh must outlive this.
  Tree(const Mesh& mesh, const std::vector<Index>& subset, int threads,
       const FractionReport& report);

  /// Triangles of a bunch: those of a group of leaves.
  static constexpr std::size_t kBunch = kWidth * kWidth;

  std::size_t size() const { return order_.size(); }
  /// Bounding box of all.
  Box box() const { return levels_.back().front().all().box(); }

  /// Appends the intersecting pairs of a triangle of this bunch and one of the same or a later one.
  void findPairs(std::size_t bunch, Pairs& pairs) const;
  /// Appends the intersecting pairs of a triangle that is not in the tree and one that is.
  void findPairs(const Face& face, const Box& box, Pairs& pairs) const;

private:
  /// Calls visit(group, its box) for the groups of a level, from the group `first` on, that overlap
  /// a box.
  template <typename Visit>
  void visitGroups(std::size_t level, const WideBox& box, std::size_t first,
                   const Visit& visit) const;

  static bool haveCommon(const std::array<Index, 3>& a, const std::array<Index, 3>& b) {
    // Without branches: it depends on chance how many are equal.
    unsigned equal = 0;
    for (const Index v : a)
      for (const Index w : b)
        equal |= static_cast<unsigned>(v == w);
    return equal != 0;
  }
  static void append(const Face& a, const Face& b, Pairs& pairs) {
    pairs.push_back({std::min(a.triangle, b.triangle), std::max(a.triangle, b.triangle)});
  }

  const Mesh& mesh_;
  std::vector<Index> order_;
  std::vector<std::vector<BoxGroup>> levels_;  ///< from the leaves to the root
};

Tree::Tree(const Mesh& mesh, const std::vector<Index>& subset, int threads,
           const FractionReport& report)
    : mesh_(mesh), order_(ordered(mesh, subset, threads, report)) {
  levels_.emplace_back((order_.size() + kWidth - 1) / kWidth);
  static_assert(internal::kBlockSize % kWidth == 0, "a group is in one block");
  internal::forEachBlock(
      order_.size(), threads, report, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          levels_.front()[i / kWidth].set(i % kWidth, WideBox(mesh.box(order_[i])));
      });
  do {
    const std::vector<BoxGroup>& below = levels_.back();
    std::vector<BoxGroup> level((below.size() + kWidth - 1) / kWidth);
    internal::forEachBlock(below.size(), below.size() >= internal::kParallelThreshold ? threads : 1,
                           [&](std::size_t, std::size_t begin, std::size_t end) {
                             for (std::size_t i = begin; i < end; ++i)
                               level[i / kWidth].set(i % kWidth, below[i].all());
                           });
    levels_.push_back(std::move(level));
  } while (levels_.back().size() > 1);
}

template <typename Visit>
void Tree::visitGroups(std::size_t level, const WideBox& box, std::size_t first,
                       const Visit& visit) const {
  struct Node {
    std::size_t level;
    std::size_t group;
  };
  // At most 7 wait on each level but the last; there are at most 2^31 triangles.
  std::array<Node, kWidth*(31 / kWidthBits + 2)> open;
  std::size_t count = 0;
  if (levels_.size() - 1 == level) {
    visit(std::size_t{0}, levels_.back().front().all());
    return;
  }
  open[count++] = {levels_.size() - 1, 0};
  while (count > 0) {
    const Node node = open[--count];
    const BoxGroup& group = levels_[node.level][node.group];
    const std::size_t least = first >> kWidthBits * (node.level - 1 - level);
    for (const std::size_t lane : Overlaps(group, box)) {
      const std::size_t below = node.group * kWidth + lane;
      if (below < least)
        continue;
      if (node.level - 1 == level)
        visit(below, group.at(lane));
      else
        open[count++] = {node.level - 1, below};
    }
  }
}

void Tree::findPairs(std::size_t bunch, Pairs& pairs) const {
  // What every test of one of the bunch's triangles needs.
  struct Own {
    Face face;
    Plane plane;
    std::array<Index, 3> fans;
  };
  std::vector<Own> own;
  own.reserve(kBunch);
  const BoxGroup& leaves = levels_[1][bunch];
  const std::size_t begin = bunch * kBunch;
  for (std::size_t i = begin; i < std::min(order_.size(), begin + kBunch); ++i) {
    const Index triangle = order_[i];
    const Face face = mesh_.face(triangle, levels_.front()[i / kWidth].at(i % kWidth).size());
    own.push_back({face, Plane(face), mesh_.centersOfFans(triangle)});
  }
  const auto test = [&](const Face& a, const Plane& plane, const Face& b) {
    if (!evidentlyApart(a, plane, b) && intersectCarefully(a, b))
      append(a, b, pairs);
  };
  const auto compare = [&](std::size_t leaf, std::size_t other, const WideBox& other_box) {
    const BoxGroup& group = levels_.front()[leaf];
    const BoxGroup& other_group = levels_.front()[other];
    const double other_size = other_box.size();
    for (const std::size_t lane : Overlaps(group, other_box)) {
      const auto& [a, plane, fans] = own[leaf * kWidth + lane - begin];
      // A triangle that is large beside a leaf is likely to pass it by.
      if (a.size > 2.0 * other_size && clears(plane, other_box.box()))
        continue;
      for (const std::size_t other_lane : Overlaps(other_group, group.at(lane))) {
        if (other == leaf && other_lane <= lane)
          continue;
        const Index triangle = order_[other * kWidth + other_lane];
        // Most are neighbours of which that is known.
        if (haveCommon(fans, mesh_.vertices(triangle)))
          continue;
        const std::size_t place = other * kWidth + other_lane - begin;
        if (place < own.size())
          test(a, plane, own[place].face);
        else
          test(a, plane, mesh_.face(triangle, other_size));
      }
    }
  };
  visitGroups(1, leaves.all(), bunch, [&](std::size_t other_bunch, const WideBox& other_bunch_box) {
    const BoxGroup& other_leaves = levels_[1][other_bunch];
    for (const std::size_t lane : Overlaps(leaves, other_bunch_box)) {
      const std::size_t leaf = bunch * kWidth + lane;
      for (const std::size_t other_lane : Overlaps(other_leaves, leaves.at(lane))) {
        const std::size_t other = other_bunch * kWidth + other_lane;
        if (other >= leaf)
          compare(leaf, other, other_leaves.at(other_lane));
      }
    }
  });
}

void Tree::findPairs(const Face& face, const Box& box, Pairs& pairs) const {
  const Plane plane(face);
  const WideBox wide(box);
  visitGroups(0, wide, 0, [&](std::size_t leaf, const WideBox& leaf_box) {
    const BoxGroup& group = levels_.front()[leaf];
    if (clears(plane, leaf_box.box()))
      return;
    for (const std::size_t lane : Overlaps(group, wide)) {
      const Face other = mesh_.face(order_[leaf * kWidth + lane], group.at(lane).size());
      if (!evidentlyApart(face, plane, other) && intersectCarefully(face, other))
        append(face, other, pairs);
    }
  });
}

// --- The functions of the header -----------------------------------------------------------------

[[noreturn]] void refuse(const std::string& message) {
  throw InvalidInput("findSelfIntersections: " + message);
}

/// A power of two that brings the largest coordinate to 1/2 ... 1: the predicates multiply three
/// differences. Throws InvalidInput.
double checkedScale(const Positions& points, const Triangles& triangles) {
  if (!points.allFinite())
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      if (!points.col(i).allFinite())
        refuse("point " + std::to_string(i) + " is not finite; remove such points first");
  const double most = points.cols() > 0 ? points.cwiseAbs().maxCoeff() : 0.0;
  if (triangles.cols() > 0 && (triangles.minCoeff() < 0 || triangles.maxCoeff() >= points.cols()))
    for (Eigen::Index t = 0; t < triangles.cols(); ++t)
      for (int k = 0; k < 3; ++k)
        if (triangles(k, t) < 0 || triangles(k, t) >= points.cols())
          refuse("triangle " + std::to_string(t) + " names vertex " +
                 std::to_string(triangles(k, t)) + ", but there are " +
                 std::to_string(points.cols()) + " points");
  int exponent = 0;
  std::frexp(most, &exponent);
  return std::ldexp(1.0, std::min(-exponent, 1000));
}

/// Runs find(i, pairs) for i in [0, count) and joins what it appends.
template <typename Find>
Pairs collect(std::size_t count, int threads, const FractionReport& report, const Find& find) {
  std::vector<Pairs> parts((count + internal::kBlockSize - 1) / internal::kBlockSize);
  internal::forEachBlock(count, threads, report,
                         [&](std::size_t block, std::size_t begin, std::size_t end) {
                           for (std::size_t i = begin; i < end; ++i)
                             find(i, parts[block]);
                         });
  Pairs pairs;
  for (const Pairs& part : parts)
    pairs.insert(pairs.end(), part.begin(), part.end());
  return pairs;
}

Pairs pairsWithin(const Tree& tree, int threads, const FractionReport& report) {
  return collect(tree.size(), threads, report, [&](std::size_t i, Pairs& pairs) {
    if (i % Tree::kBunch == 0)
      tree.findPairs(i / Tree::kBunch, pairs);
  });
}

}  // namespace

std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles,
                                                        const Execution& execution) {
  return internal::findSelfIntersections(points, triangles, {}, execution.threads,
                                         internal::reportOf(execution, "intersections"));
}

std::vector<std::array<Index, 2>>
internal::findSelfIntersections(const Positions& points, const Triangles& triangles,
                                const std::vector<std::uint8_t>& fans, int requested_threads,
                                const FractionReport& report) {
  checkThreads(requested_threads);
  const Mesh mesh(points, triangles, checkedScale(points, triangles), fans);
  std::vector<Index> all(mesh.size());
  std::iota(all.begin(), all.end(), Index{0});
  if (all.empty())
    return {};
  const int threads =
      internal::threadCount(requested_threads, all.size(), internal::kParallelThreshold);
  const Tree tree(mesh, all, threads, report);
  Pairs pairs = pairsWithin(tree, threads, report);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<std::array<Index, 2>> findSelfIntersectionsOf(const Positions& points,
                                                          const Triangles& triangles,
                                                          const std::vector<Index>& of,
                                                          const Execution& execution) {
  internal::checkThreads(execution.threads);
  const std::vector<std::uint8_t> no_fans;
  const Mesh mesh(points, triangles, checkedScale(points, triangles), no_fans);
  std::vector<char> in_set(mesh.size(), 0);
  for (const Index t : of) {
    if (t < 0 || static_cast<std::size_t>(t) >= mesh.size())
      refuse("triangle " + std::to_string(t) + " is asked for, but there are " +
             std::to_string(mesh.size()));
    in_set[static_cast<std::size_t>(t)] = 1;
  }
  std::vector<Index> subset;
  for (std::size_t t = 0; t < in_set.size(); ++t)
    if (in_set[t] != 0)
      subset.push_back(static_cast<Index>(t));
  if (subset.empty())
    return {};
  const int threads =
      internal::threadCount(execution.threads, mesh.size(), internal::kShortPassThreshold);
  const FractionReport report = internal::reportOf(execution, "intersections");
  const Tree tree(mesh, subset, threads, report);
  Pairs pairs = pairsWithin(tree, threads, report);
  const Box bounds = tree.box();
  const Pairs others = collect(mesh.size(), threads, report, [&](std::size_t t, Pairs& found) {
    if (in_set[t] != 0)
      return;
    const auto triangle = static_cast<Index>(t);
    const Box box = mesh.box(triangle);
    if (box.overlaps(bounds))
      tree.findPairs(mesh.face(triangle, box.size()), box, found);
  });
  pairs.insert(pairs.end(), others.begin(), others.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace spherical_param
