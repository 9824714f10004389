#include "spherical_param/self_intersection.h"

#include "box_tree.h"
#include "corner_table.h"
#include "intersecting_pairs.h"
#include "ordered_points.h"
#include "power_of_two.h"
#include "progress.h"
#include "radix_sort.h"
#include "rows.h"
#include "space_filling_curve.h"
#include "spherical_param/errors.h"
#include "spherical_param/result.h"
#include "triangle_pair.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
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
using internal::Indexed;
using internal::Plane;
using Pairs = std::vector<std::array<Index, 2>>;

/// Items between two reports: in a tangled mesh, a block takes a tenth of a second.
constexpr std::size_t kTangledItems = 8 * internal::kBlockSize;

/// No limit of the number of intersecting triangles.
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// A mesh, scaled for the tests.
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
  Box box;
  double size = 0.0;

  Extent& operator+=(const Extent& other) {
    box.extend(other.box);
    size += other.size;
    return *this;
  }
};

/// Triangles of a mesh with a tree of their boxes.
class TriangleTree {
public:
  /// \param subset triangles, ascending; at least one. The mesh must outlive this.
  TriangleTree(const Mesh& mesh, const Indexed<Index>& subset, int threads,
               const FractionReport& report);

  /// Appends the intersecting pairs of the triangles in [begin, end) of the order, whole groups of
  /// the tree, with later ones. Ends early and returns false beyond `most` intersecting triangles.
  bool findLaterPairs(Index begin, Index end, std::size_t most, Pairs& pairs) const;
  /// Appends the intersecting pairs of a triangle and those in the tree from place `first` on.
  void findPairs(const Face& face, Index first, Pairs& pairs) const;

private:
  void sort(const Indexed<Index>& subset, const Box& box, int threads);
  FloatBox rounded(const Box& box) const { return box.translated(-origin_).cast<float>(); }
  /// A box that contains the one that was rounded.
  Box widened(const FloatBox& rounded) const {
    const Box box = rounded.cast<double>();
    // Half a unit in the last place of a float is 6e-8; those of doubles are of numbers up to 2.
    const Vector3d margin =
        (1e-7 * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs())).array() + 1e-15;
    return {box.min() - margin + origin_, box.max() + margin + origin_};
  }
  void appendIfIntersecting(const Face& a, const Plane& plane_of_a, Index t, Pairs& pairs) const {
    const Face b = mesh_.face(t);
    if (intersect(a, plane_of_a, b))
      pairs.push_back({std::min(a.triangle, t), std::max(a.triangle, t)});
  }

  const Mesh& mesh_;
  Vector3d origin_;  ///< of the boxes in the tree, since floats are coarse far from 0
  Indexed<Index> order_;
  double large_;  ///< size above which a triangle is large: 8 times the mean
  BoxTree tree_;
};

TriangleTree::TriangleTree(const Mesh& mesh, const Indexed<Index>& subset, int threads,
                           const FractionReport& report)
    : mesh_(mesh) {
  const Extent extent = internal::accumulate(
      subset.size(), threads, Extent{},
      [&](Index i, Extent& sum) {
        const Box box = mesh.box(subset[i]);
        sum += Extent{box, box.sizes().maxCoeff()};
      },
      report);
  origin_ = extent.box.min();
  large_ = 8.0 * extent.size / static_cast<double>(subset.size());
  sort(subset, extent.box, threads);
  tree_ = BoxTree(order_.size(), threads, report,
                  [&](Index i) { return rounded(mesh.box(order_[i])); });
}

/// Orders the triangles by size, large ones first, then along a space-filling curve: a large
/// triangle among small ones would enlarge all boxes above it.
void TriangleTree::sort(const Indexed<Index>& subset, const Box& all, int threads) {
  const internal::MortonCurve curve(all.min(), all.max());
  // Sizes in classes of a factor of 8; the last one has those that are not large.
  const auto key_of = [&](Index i) {
    const Box box = mesh_.box(subset[i]);
    std::uint64_t size_class = 7;
    for (double size = box.sizes().maxCoeff(); size > large_ && size_class > 0; size /= 8.0)
      --size_class;
    return size_class << 61U | curve.key(box.center()) >> 2U;
  };
  order_.reserve(subset.size());
  for (const auto& [key, i] : internal::sortedPlaces(subset.size(), threads, key_of))
    order_.push_back(subset[i]);
}

bool TriangleTree::findLaterPairs(Index begin, Index end, std::size_t most, Pairs& pairs) const {
  std::size_t next_count = most;
  // The faces and planes of a group, which all its tests share.
  Indexed<std::pair<Face, Plane>> own;
  for (Index first = begin; first < end; first += BoxGroup::kSize) {
    own.clear();
    for (Index i = first; i < std::min(first + BoxGroup::kSize, end); ++i) {
      const Face face = mesh_.face(order_[i]);
      own.emplace_back(face, Plane(face));
    }
    if (own[0].first.size > large_)
      for (const Index i : internal::indicesOf(own))
        findPairs(own[i].first, first + i + 1, pairs);
    else
      tree_.forEachPair(first / BoxGroup::kSize, [&](Index i, Index j) {
        const auto& [face, plane] = own[i - first];
        appendIfIntersecting(face, plane, order_[j], pairs);
      });
    if (pairs.size() < next_count)
      continue;
    if (countTriangles(pairs) > most)
      return false;
    next_count = 2 * pairs.size();
  }
  return true;
}

void TriangleTree::findPairs(const Face& face, Index first, Pairs& pairs) const {
  const Plane plane(face);
  // The box of a large triangle overlaps many small ones that its plane does not meet.
  const auto passes = [&](const FloatBox& box) { return clears(plane, widened(box)); };
  tree_.forEachOverlapping(rounded(boxOf(face.corners)), first, passes,
                           [&](Index i) { appendIfIntersecting(face, plane, order_[i], pairs); });
}

// --- The functions of the header -----------------------------------------------------------------

/// A mesh, after checks. Throws InvalidInput.
Mesh checkedMesh(const Positions& points, const Triangles& triangles, const Execution& execution) {
  internal::checkThreads(execution.threads);
  internal::checkFinite("findSelfIntersections", points);
  const double most = points.cols() > 0 ? points.cwiseAbs().maxCoeff() : 0.0;
  internal::checkTriangles("findSelfIntersections", triangles, points.cols());
  return {points, triangles, internal::scaleToUnit(most)};
}

}  // namespace

internal::IntersectingPairs internal::findPairsUpTo(std::size_t most, const Positions& points,
                                                    const Triangles& triangles,
                                                    const Execution& execution) {
  const Mesh mesh = checkedMesh(points, triangles, execution);
  IntersectingPairs found;
  if (mesh.size() == 0)
    return found;
  const int threads = threadCount(execution.threads, mesh.size());
  const FractionReport report = reportOf(execution, "intersections");
  const TriangleTree tree(mesh, firstIndices(mesh.size()), threads, report);
  IndexSet intersecting(mesh.size());
  std::size_t count = 0;
  // Rounds of at least 8 blocks of triangles: every step-th block, then the blocks after these, ...
  const std::size_t blocks = (mesh.size() + kBlockSize - 1) / kBlockSize;
  const std::size_t step = most == kAll ? 1 : std::clamp<std::size_t>(blocks / 8, 1, 128);
  std::atomic<bool> is_complete{true};
  for (std::size_t first = 0; first < step && count <= most; ++first) {
    const std::size_t size = (blocks - first + step - 1) / step * kBlockSize;
    const Pairs more = collectBlocks<std::array<Index, 2>>(
        size, threads, report,
        [&](Index begin, Index, Pairs& pairs) {
          const std::size_t block = static_cast<std::size_t>(begin) / kBlockSize * step + first;
          const std::size_t end = std::min((block + 1) * kBlockSize, mesh.size());
          if (!tree.findLaterPairs(static_cast<Index>(block * kBlockSize), static_cast<Index>(end),
                                   most, pairs))
            is_complete = false;
        },
        kTangledItems);
    for (const auto& pair : more)
      for (const Index t : pair)
        count += intersecting.insert(t) ? 1 : 0;
    found.pairs.insert(found.pairs.end(), more.begin(), more.end());
    if (count > most && first + 1 < step)
      is_complete = false;
  }
  found.is_sample = !is_complete;
  std::sort(found.pairs.begin(), found.pairs.end());
  return found;
}

internal::IntersectingPairs internal::findPairsUpTo(std::size_t most, const Positions& points,
                                                    const Triangles& triangles,
                                                    const std::vector<Index>& some,
                                                    const Execution& execution) {
  IntersectingPairs found =
      findPairsUpTo(most, points, Triangles(triangles(Eigen::all, some)), execution);
  for (auto& pair : found.pairs)
    for (Index& t : pair)
      t = some[static_cast<std::size_t>(t)];
  return found;
}

std::vector<std::array<Index, 2>> findSelfIntersections(const Positions& points,
                                                        const Triangles& triangles,
                                                        const Execution& execution) {
  return internal::findPairsUpTo(kAll, points, triangles, execution).pairs;
}

std::vector<std::array<Index, 2>> findSelfIntersectionsOf(const Positions& points,
                                                          const Triangles& triangles,
                                                          const std::vector<Index>& of,
                                                          const Execution& execution) {
  const Mesh mesh = checkedMesh(points, triangles, execution);
  for (const Index t : of)
    if (t < 0 || static_cast<std::size_t>(t) >= mesh.size())
      throw InvalidInput("findSelfIntersections: triangle " + std::to_string(t) +
                         " is asked for, but there are " + std::to_string(mesh.size()));
  if (of.empty())
    return {};
  Indexed<Index> subset(of.begin(), of.end());
  internal::sortUnique(subset);
  const int threads = internal::threadCount(execution.threads, mesh.size());
  const FractionReport report = internal::reportOf(execution, "intersections");
  const TriangleTree tree(mesh, subset, threads, report);
  const auto collect = [&](std::size_t count, const auto& find) {
    return internal::collectBlocks<std::array<Index, 2>>(count, threads, report, find,
                                                         kTangledItems);
  };
  Pairs pairs = collect(subset.size(), [&](Index begin, Index end, Pairs& found) {
    tree.findLaterPairs(begin, end, kAll, found);
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

std::size_t countTriangles(const Pairs& pairs) {
  std::vector<Index> triangles;
  triangles.reserve(2 * pairs.size());
  for (const auto& pair : pairs)
    triangles.insert(triangles.end(), pair.begin(), pair.end());
  internal::sortUnique(triangles);
  return triangles.size();
}

void markSelfIntersections(const Pairs& pairs, std::vector<std::uint8_t>& marks) {
  for (std::uint8_t& mark : marks)
    mark &= static_cast<std::uint8_t>(~triangle_mark::self_intersection);
  for (const auto& pair : pairs)
    for (const Index t : pair)
      if (!marks.empty())
        marks[static_cast<std::size_t>(t)] |= triangle_mark::self_intersection;
}

}  // namespace spherical_param
