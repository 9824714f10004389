#include "spherical_param/self_intersection.h"

#include "box_tree.h"
#include "corner_table.h"
#include "power_of_two.h"
#include "progress.h"
#include "radix_sort.h"
#include "rows.h"
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
using internal::boxOf;
using internal::BoxTree;
using internal::Face;
using internal::FloatBox;
using internal::FractionReport;
using internal::Plane;
using Pairs = std::vector<std::array<Index, 2>>;

/// A mesh as the tests want it.
struct Mesh {
  const Positions& points;
  const Triangles& triangles;
  double scale;  ///< a power of two; coordinates times it are at most 1

  std::size_t size() const { return internal::columnCount(triangles); }
  Face face(Index t) const {
    return internal::faceOf(points, scale, {triangles(0, t), triangles(1, t), triangles(2, t)}, t);
  }
  Box box(Index t) const { return boxOf(face(t).corners); }
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
  TriangleTree(const Mesh& mesh, const internal::Indexed<Index>& subset, int threads,
               const FractionReport& report);

  /// Appends the intersecting pairs of a triangle of the block from `begin` on and one of the same
  /// or a later one.
  void findPairsOfBlock(Index begin, Pairs& pairs) const;
  /// Appends the intersecting pairs of a triangle and one in the tree, from the place `first` on.
  void findPairs(const Face& face, Index first, Pairs& pairs) const;

private:
  void sort(const internal::Indexed<Index>& subset, const Extent& extent, int threads);
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
  internal::Indexed<Index> order_;
  Index large_ = 0;  ///< number of large triangles, the first ones
  BoxTree tree_;
};

TriangleTree::TriangleTree(const Mesh& mesh, const internal::Indexed<Index>& subset, int threads,
                           const FractionReport& report)
    : mesh_(mesh) {
  const Extent extent = internal::accumulate(
      subset.size(), threads, Extent{},
      [&](Index i, Extent& sum) {
        const Box box = mesh.box(subset[i]);
        sum += Extent{box.lower, box.upper, box.size()};
      },
      report);
  origin_ = extent.low;
  sort(subset, extent, threads);
  tree_ = BoxTree(order_.size(), threads, report,
                  [&](Index i) { return rounded(mesh.box(order_[i])); });
}

/// Orders the triangles by size, large ones first, then along a space-filling curve: among small
/// ones, large ones would make large boxes of all above them.
void TriangleTree::sort(const internal::Indexed<Index>& subset, const Extent& extent, int threads) {
  struct Place {
    std::uint64_t key;
    Index triangle;
  };
  internal::Indexed<Place> places(subset.size());
  const internal::MortonCurve curve(extent.low, extent.high);
  // A class of sizes for each factor of 8, up to 8 times the mean in the last one.
  constexpr double factor = 8.0;
  constexpr std::uint64_t last_class = 7;
  const double mean = extent.size / static_cast<double>(subset.size());
  internal::forEachIndex(subset.size(), threads, {}, [&](Index i) {
    const Box box = mesh_.box(subset[i]);
    std::uint64_t size_class = last_class;
    for (double size = box.size() / factor; size > mean && size_class > 0; size /= factor)
      --size_class;
    const std::uint64_t cell = curve.key(0.5 * (box.lower + box.upper));
    places[i] = {size_class << 61U | cell >> 2U, subset[i]};
  });
  internal::radixSort(places);
  order_.reserve(places.size());
  for (const auto& [key, triangle] : places) {
    order_.push_back(triangle);
    large_ += key >> 61U < last_class ? 1 : 0;
  }
}

void TriangleTree::findPairsOfBlock(Index begin, Pairs& pairs) const {
  // What every test of one of the block's triangles needs.
  struct Own {
    Face face;
    Plane plane;
  };
  internal::Indexed<Own> own;
  own.reserve(internal::kBlockSize);
  for (Index i = begin; i < order_.count() && own.size() < internal::kBlockSize; ++i) {
    const Face face = mesh_.face(order_[i]);
    own.push_back({face, Plane(face)});
  }
  if (begin < large_) {
    for (Index i = 0; i < own.count(); ++i)
      findPairs(own[i].face, begin + i + 1, pairs);
    return;
  }
  tree_.forEachPair(begin, [&](Index i, Index j) {
    const auto& [a, plane] = own[i - begin];
    const Face b = j - begin < own.count() ? own[j - begin].face : mesh_.face(order_[j]);
    if (intersect(a, plane, b))
      append(a, b, pairs);
  });
}

void TriangleTree::findPairs(const Face& face, Index first, Pairs& pairs) const {
  const Plane plane(face);
  // A large triangle is likely to pass by a small box.
  const auto passes = [&](const FloatBox& box) { return clears(plane, widened(box)); };
  tree_.forEachOverlapping(rounded(boxOf(face.corners)), first, passes, [&](Index i) {
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
  internal::checkTriangles("findSelfIntersections", triangles, points.cols());
  return internal::scaleToUnit(most);
}

/// The intersecting pairs of a triangle of a subset and any other.
///
/// \param subset ascending.
Pairs pairsOf(const Mesh& mesh, const internal::Indexed<Index>& subset,
              const Execution& execution) {
  if (subset.empty())
    return {};
  const int threads = internal::threadCount(execution.threads, mesh.size());
  const FractionReport report = internal::reportOf(execution, "intersections");
  const TriangleTree tree(mesh, subset, threads, report);
  const auto collect = [&](std::size_t count, const auto& find) {
    // Where the mesh is a tangle, a block takes a tenth of a second.
    return internal::collectBlocks<std::array<Index, 2>>(count, threads, report, find,
                                                         8 * internal::kBlockSize);
  };
  Pairs pairs = collect(subset.size(), [&](Index begin, Index, Pairs& found) {
    tree.findPairsOfBlock(begin, found);
  });
  if (subset.size() < mesh.size()) {
    const Pairs others = collect(mesh.size(), [&](Index begin, Index end, Pairs& found) {
      auto next = std::lower_bound(subset.begin(), subset.end(), begin);
      for (Index t = begin; t < end; ++t)
        if (next != subset.end() && *next == t)
          ++next;
        else
          tree.findPairs(mesh.face(t), 0, found);
    });
    pairs.insert(pairs.end(), others.begin(), others.end());
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles,
                                                        const Execution& execution) {
  internal::checkThreads(execution.threads);
  const Mesh mesh{points, triangles, checkedScale(points, triangles)};
  internal::Indexed<Index> all(mesh.size());
  std::iota(all.begin(), all.end(), Index{0});
  return pairsOf(mesh, all, execution);
}

std::vector<std::array<Index, 2>> findSelfIntersectionsOf(const Positions& points,
                                                          const Triangles& triangles,
                                                          const std::vector<Index>& of,
                                                          const Execution& execution) {
  internal::checkThreads(execution.threads);
  const Mesh mesh{points, triangles, checkedScale(points, triangles)};
  for (const Index t : of)
    if (t < 0 || static_cast<std::size_t>(t) >= mesh.size())
      refuse("triangle " + std::to_string(t) + " is asked for, but there are " +
             std::to_string(mesh.size()));
  internal::Indexed<Index> subset(of.begin(), of.end());
  internal::sortUnique(subset);
  return pairsOf(mesh, subset, execution);
}

std::size_t countTriangles(const Pairs& pairs) {
  std::vector<Index> triangles;
  triangles.reserve(2 * pairs.size());
  for (const auto& pair : pairs)
    triangles.insert(triangles.end(), pair.begin(), pair.end());
  internal::sortUnique(triangles);
  return triangles.size();
}

}  // namespace spherical_param
