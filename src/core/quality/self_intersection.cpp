#include "spherical_param/self_intersection.h"

#include "box_tree.h"
#include "parallel.h"
#include "power_of_two.h"
#include "progress.h"
#include "radix_sort.h"
#include "space_filling_curve.h"
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

// Candidates are the pairs of overlapping boxes of a tree. \see triangle_pair.h for how two
// triangles are tested.

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using internal::Box;
using internal::BoxGroup;
using internal::boxOf;
using internal::BoxTree;
using internal::Face;
using internal::FloatBox;
using internal::FractionReport;
using internal::Plane;
using Pairs = std::vector<std::array<Index, 2>>;

/// A mesh as the tests want it.
class Mesh {
public:
  /// \param scale a power of two; coordinates times it are at most 1.
  Mesh(const Positions& points, const Triangles& triangles, double scale)
      : points_(points), triangles_(triangles), scale_(scale) {}

  std::size_t size() const { return static_cast<std::size_t>(triangles_.cols()); }

  Box box(Index triangle) const { return boxOf(corners(triangle)); }
  Face face(Index triangle) const {
    const std::array<Vector3d, 3> at = corners(triangle);
    return {at, boxOf(at).size(), vertices(triangle), triangle};
  }

private:
  std::array<Index, 3> vertices(Index triangle) const {
    return {triangles_(0, triangle), triangles_(1, triangle), triangles_(2, triangle)};
  }
  std::array<Vector3d, 3> corners(Index triangle) const {
    return {points_.col(triangles_(0, triangle)) * scale_,
            points_.col(triangles_(1, triangle)) * scale_,
            points_.col(triangles_(2, triangle)) * scale_};
  }

  const Positions& points_;
  const Triangles& triangles_;
  double scale_;
};

/// The box of some triangles, and the sum of their sizes.
struct Extent {
  Vector3d low = Vector3d::Constant(1.0);
  Vector3d high = Vector3d::Constant(-1.0);
  double size = 0.0;

  Extent& operator+=(const Extent& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
    size += other.size;
    return *this;
  }
};

/// Triangles of a mesh with a tree of their boxes.
class TriangleTree {
public:
  /// \param subset triangles, ascending; at least one. The mesh must outlive this.
  TriangleTree(const Mesh& mesh, const std::vector<Index>& subset, int threads,
               const FractionReport& report);

  std::size_t size() const { return order_.size(); }

  /// Appends the intersecting pairs of a triangle of this block and one of the same or a later one.
  void findPairs(std::size_t block, Pairs& pairs) const;
  /// Appends the intersecting pairs of a triangle and one in the tree, from the place `first` on.
  void findPairs(const Face& face, std::size_t first, Pairs& pairs) const;

private:
  void sort(const std::vector<Index>& subset, const Extent& extent, int threads);
  FloatBox rounded(const Box& box) const {
    return FloatBox(Box{box.lower - origin_, box.upper - origin_});
  }
  /// A box that contains the one that was rounded.
  Box widened(const FloatBox& box) const {
    const Vector3d low = box.lower.matrix().cast<double>();
    const Vector3d high = box.upper.matrix().cast<double>();
    // Half a unit in the last place of a float is 6e-8; those of doubles are of numbers up to 2.
    const Vector3d margin = (1e-7 * low.cwiseAbs().cwiseMax(high.cwiseAbs())).array() + 1e-15;
    return {low - margin + origin_, high + margin + origin_};
  }
  static void append(const Face& a, const Face& b, Pairs& pairs) {
    pairs.push_back({std::min(a.triangle, b.triangle), std::max(a.triangle, b.triangle)});
  }

  const Mesh& mesh_;
  Vector3d origin_;  ///< of the boxes in the tree: far from 0, floats are coarse
  std::vector<Index> order_;
  std::size_t large_ = 0;  ///< number of large triangles, the first ones
  BoxTree tree_;
};

TriangleTree::TriangleTree(const Mesh& mesh, const std::vector<Index>& subset, int threads,
                           const FractionReport& report)
    : mesh_(mesh) {
  const Extent extent = internal::sumOfBlocks(
      subset.size(), threads, Extent{},
      [&](std::size_t begin, std::size_t end) {
        Extent block;
        for (std::size_t i = begin; i < end; ++i) {
          const Box box = mesh.box(subset[i]);
          block += Extent{box.lower, box.upper, box.size()};
        }
        return block;
      },
      report);
  origin_ = extent.low;
  sort(subset, extent, threads);
  std::vector<BoxGroup> groups((order_.size() + BoxGroup::kSize - 1) / BoxGroup::kSize);
  internal::forEachBlock(
      order_.size(), threads, report, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          groups[i / BoxGroup::kSize].set(i % BoxGroup::kSize, rounded(mesh.box(order_[i])));
      });
  tree_ = BoxTree(std::move(groups), threads);
}

/// Orders the triangles by size, large ones first, then along a space-filling curve: among small
/// ones, large ones would make large boxes of all above them.
void TriangleTree::sort(const std::vector<Index>& subset, const Extent& extent, int threads) {
  struct Place {
    std::uint64_t key;
    Index triangle;
  };
  std::vector<Place> places(subset.size());
  const internal::MortonCurve curve(extent.low, extent.high);
  // A class of sizes for each factor of 8, up to 8 times the mean in the last one.
  constexpr double factor = 8.0;
  constexpr std::uint64_t last_class = 7;
  const double mean = extent.size / static_cast<double>(subset.size());
  internal::forEachBlock(
      subset.size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Box box = mesh_.box(subset[i]);
          std::uint64_t size_class = last_class;
          for (double size = box.size() / factor; size > mean && size_class > 0; size /= factor)
            --size_class;
          const std::uint64_t cell = curve.key(0.5 * (box.lower + box.upper));
          places[i] = {size_class << 61U | cell >> 2U, subset[i]};
        }
      });
  internal::radixSort(places);
  order_.resize(places.size());
  for (std::size_t i = 0; i < order_.size(); ++i) {
    order_[i] = places[i].triangle;
    large_ += places[i].key >> 61U < last_class ? 1 : 0;
  }
}

void TriangleTree::findPairs(std::size_t block, Pairs& pairs) const {
  // What every test of one of the block's triangles needs.
  struct Own {
    Face face;
    Plane plane;
  };
  std::vector<Own> own;
  own.reserve(BoxTree::kBlock);
  const std::size_t begin = block * BoxTree::kBlock;
  for (std::size_t i = begin; i < std::min(order_.size(), begin + BoxTree::kBlock); ++i) {
    const Face face = mesh_.face(order_[i]);
    own.push_back({face, Plane(face)});
  }
  if (begin < large_) {
    for (std::size_t i = 0; i < own.size(); ++i)
      findPairs(own[i].face, begin + i + 1, pairs);
    return;
  }
  tree_.forEachPair(block, [&](std::size_t i, std::size_t j) {
    const auto& [a, plane] = own[i - begin];
    const Face b = j - begin < own.size() ? own[j - begin].face : mesh_.face(order_[j]);
    if (intersect(a, plane, b))
      append(a, b, pairs);
  });
}

void TriangleTree::findPairs(const Face& face, std::size_t first, Pairs& pairs) const {
  const Plane plane(face);
  // A large triangle is likely to pass by a small box.
  const auto passes = [&](const FloatBox& box) { return clears(plane, widened(box)); };
  tree_.forEachOverlapping(rounded(boxOf(face.corners)), first, passes, [&](std::size_t i) {
    const Face other = mesh_.face(order_[i]);
    if (intersect(face, plane, other))
      append(face, other, pairs);
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

/// Runs find(begin, end, pairs) for the blocks of [0, count) and joins what it appends.
template <typename Find>
Pairs collect(std::size_t count, int threads, const FractionReport& report, const Find& find) {
  // Where the mesh is a tangle, a block takes a tenth of a second.
  constexpr std::size_t items_per_report = 8 * internal::kBlockSize;
  std::vector<Pairs> parts((count + internal::kBlockSize - 1) / internal::kBlockSize);
  internal::forEachBlock(
      count, threads, report,
      [&](std::size_t block, std::size_t begin, std::size_t end) {
        find(begin, end, parts[block]);
      },
      items_per_report);
  Pairs pairs;
  for (const Pairs& part : parts)
    pairs.insert(pairs.end(), part.begin(), part.end());
  return pairs;
}

Pairs pairsWithin(const TriangleTree& tree, int threads, const FractionReport& report) {
  static_assert(internal::kBlockSize == BoxTree::kBlock);
  return collect(tree.size(), threads, report, [&](std::size_t begin, std::size_t, Pairs& pairs) {
    tree.findPairs(begin / BoxTree::kBlock, pairs);
  });
}

}  // namespace

std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles,
                                                        const Execution& execution) {
  internal::checkThreads(execution.threads);
  const Mesh mesh(points, triangles, checkedScale(points, triangles));
  std::vector<Index> all(mesh.size());
  std::iota(all.begin(), all.end(), Index{0});
  if (all.empty())
    return {};
  const int threads = internal::threadCount(execution.threads, all.size());
  const FractionReport report = internal::reportOf(execution, "intersections");
  const TriangleTree tree(mesh, all, threads, report);
  Pairs pairs = pairsWithin(tree, threads, report);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<std::array<Index, 2>> findSelfIntersectionsOf(const Positions& points,
                                                          const Triangles& triangles,
                                                          const std::vector<Index>& of,
                                                          const Execution& execution) {
  internal::checkThreads(execution.threads);
  const Mesh mesh(points, triangles, checkedScale(points, triangles));
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
  const int threads = internal::threadCount(execution.threads, mesh.size());
  const FractionReport report = internal::reportOf(execution, "intersections");
  const TriangleTree tree(mesh, subset, threads, report);
  Pairs pairs = pairsWithin(tree, threads, report);
  const Pairs others =
      collect(mesh.size(), threads, report, [&](std::size_t begin, std::size_t end, Pairs& found) {
        for (std::size_t t = begin; t < end; ++t)
          if (in_set[t] == 0)
            tree.findPairs(mesh.face(static_cast<Index>(t)), 0, found);
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
