#include "spherical_param/self_intersection.h"

#include "box_group.h"
#include "median.h"
#include "parallel.h"
#include "power_of_two.h"
#include "progress.h"
#include "radix_sort.h"
#include "self_intersection_of_fans.h"
#include "spherical_param/errors.h"
#include "triangle_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>

// Candidates come from a tree of bounding boxes over the triangles in the order of a space-filling
// curve: one for all, or one for each block of a mesh whose triangles are in good order already.
// \see triangle_pair.h for how two of them are tested.

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using internal::Box;
using internal::BoxGroup;
using internal::boxOf;
using internal::Face;
using internal::FractionReport;
using internal::kGroupBits;
using internal::kGroupSize;
using internal::Overlaps;
using internal::Plane;
using internal::WideBox;
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
    if (rest - crowd > static_cast<std::ptrdiff_t>(kGroupSize))
      refine(mesh, crowd, rest);
    crowd = rest;
  }
}

/// The typical size of a triangle: the median of a sample.
double typicalSize(const Mesh& mesh, const std::vector<Index>& subset) {
  constexpr std::size_t sample = 1000;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < subset.size(); i += 1 + subset.size() / sample)
    sizes.push_back(mesh.box(subset[i]).size());
  return internal::medianOf(sizes);
}

/// The triangles by size, then along a space-filling curve (G. M. Morton, 1966). Large ones have a
/// part of the tree for themselves: among small ones they would make large boxes of all above them.
///
/// \param typical size of a triangle.
std::vector<Index> orderedAnew(const Mesh& mesh, const std::vector<Index>& subset, double typical,
                               int threads) {
  std::vector<Place> places(subset.size());
  // Coordinates are in [-1, 1].
  constexpr double scale = ((1U << kCurveBits) - 1U) / 2.0;
  internal::forEachBlock(
      subset.size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Box box = mesh.box(subset[i]);
          std::uint32_t size_class = 0;
          for (double size = box.size() / kMinLarge; size > typical && size_class < kMaxSizeClass;
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
    if (end - begin > kGroupSize)
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
  const double typical = typicalSize(mesh, subset);
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
          block.large += box.size() > kMinLarge * typical ? 1 : 0;
        }
        block.size = all.size();
        sortBlock(centers, subset.data() + begin, end - begin, order.data() + begin);
        return block;
      },
      report);
  const std::size_t count = (subset.size() + internal::kBlockSize - 1) / internal::kBlockSize;
  if (blocks.size > kMaxBlock * typical * static_cast<double>(count) ||
      blocks.large > kMaxLarge + subset.size() / kTypicalPerLarge)
    return orderedAnew(mesh, subset, typical, threads);
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
  static constexpr std::size_t kBunch = kGroupSize * kGroupSize;

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
  levels_.emplace_back((order_.size() + kGroupSize - 1) / kGroupSize);
  static_assert(internal::kBlockSize % kGroupSize == 0, "a group is in one block");
  internal::forEachBlock(
      order_.size(), threads, report, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          levels_.front()[i / kGroupSize].set(i % kGroupSize, WideBox(mesh.box(order_[i])));
      });
  do {
    const std::vector<BoxGroup>& below = levels_.back();
    std::vector<BoxGroup> level((below.size() + kGroupSize - 1) / kGroupSize);
    internal::forEachBlock(below.size(), below.size() >= internal::kParallelThreshold ? threads : 1,
                           [&](std::size_t, std::size_t begin, std::size_t end) {
                             for (std::size_t i = begin; i < end; ++i)
                               level[i / kGroupSize].set(i % kGroupSize, below[i].all());
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
  std::array<Node, kGroupSize*(31 / kGroupBits + 2)> open;
  std::size_t count = 0;
  if (levels_.size() - 1 == level) {
    visit(std::size_t{0}, levels_.back().front().all());
    return;
  }
  open[count++] = {levels_.size() - 1, 0};
  while (count > 0) {
    const Node node = open[--count];
    const BoxGroup& group = levels_[node.level][node.group];
    const std::size_t least = first >> kGroupBits * (node.level - 1 - level);
    for (const std::size_t lane : Overlaps(group, box)) {
      const std::size_t below = node.group * kGroupSize + lane;
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
    const Face face =
        mesh_.face(triangle, levels_.front()[i / kGroupSize].at(i % kGroupSize).size());
    own.push_back({face, Plane(face), mesh_.centersOfFans(triangle)});
  }
  const auto test = [&](const Face& a, const Plane& plane, const Face& b) {
    if (intersect(a, plane, b))
      append(a, b, pairs);
  };
  const auto compare = [&](std::size_t leaf, std::size_t other, const WideBox& other_box) {
    const BoxGroup& group = levels_.front()[leaf];
    const BoxGroup& other_group = levels_.front()[other];
    const double other_size = other_box.size();
    for (const std::size_t lane : Overlaps(group, other_box)) {
      const auto& [a, plane, fans] = own[leaf * kGroupSize + lane - begin];
      // A triangle that is large beside a leaf is likely to pass it by.
      if (a.size > 2.0 * other_size && clears(plane, other_box.box()))
        continue;
      for (const std::size_t other_lane : Overlaps(other_group, group.at(lane))) {
        if (other == leaf && other_lane <= lane)
          continue;
        const Index triangle = order_[other * kGroupSize + other_lane];
        // Most are neighbours of which that is known.
        if (haveCommon(fans, mesh_.vertices(triangle)))
          continue;
        const std::size_t place = other * kGroupSize + other_lane - begin;
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
      const std::size_t leaf = bunch * kGroupSize + lane;
      for (const std::size_t other_lane : Overlaps(other_leaves, leaves.at(lane))) {
        const std::size_t other = other_bunch * kGroupSize + other_lane;
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
      const Face other = mesh_.face(order_[leaf * kGroupSize + lane], group.at(lane).size());
      if (intersect(face, plane, other))
        append(face, other, pairs);
    }
  });
}

// --- The functions of the header -----------------------------------------------------------------

[[noreturn]] void refuse(const std::string& message) {
  throw InvalidInput("findSelfIntersections: " + message);
}

/// The scale of the tests, after checks. Throws InvalidInput.
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
  return internal::scaleToUnit(most);
}

/// Runs find(i, pairs) for i in [0, count) and joins what it appends.
template <typename Find>
Pairs collect(std::size_t count, int threads, const FractionReport& report, const Find& find) {
  // Where the mesh is a tangle, a block takes a tenth of a second.
  constexpr std::size_t items_per_report = 8 * internal::kBlockSize;
  std::vector<Pairs> parts((count + internal::kBlockSize - 1) / internal::kBlockSize);
  internal::forEachBlock(
      count, threads, report,
      [&](std::size_t block, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          find(i, parts[block]);
      },
      items_per_report);
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
      internal::threadCount(execution.threads, mesh.size(), internal::kParallelThreshold);
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

std::size_t countTriangles(const Pairs& pairs) {
  std::vector<Index> triangles;
  triangles.reserve(2 * pairs.size());
  for (const auto& pair : pairs)
    triangles.insert(triangles.end(), pair.begin(), pair.end());
  std::sort(triangles.begin(), triangles.end());
  const auto end = std::unique(triangles.begin(), triangles.end());
  return static_cast<std::size_t>(end - triangles.begin());
}

}  // namespace spherical_param
