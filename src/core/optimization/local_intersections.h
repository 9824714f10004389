#pragma once

#include "box_group.h"
#include "spherical_param/types.h"
#include "triangle_pair.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// Some triangles of a mesh that changes, to count which of them another one intersects.
class LocalIntersections {
public:
  /// Begins without any. Most meshes never ask: until then there is nothing as long as the mesh.
  ///
  /// \param triangles of the mesh; their numbers are below that.
  void begin(std::size_t triangles);
  /// Adds a triangle, or changes it.
  void set(const Face& face);
  void remove(Index triangle);
  bool contains(Index triangle) const { return places_[static_cast<std::size_t>(triangle)] >= 0; }
  const std::vector<Face>& faces() const { return faces_; }
  const Face& face(Index triangle) const {
    return faces_[static_cast<std::size_t>(places_[static_cast<std::size_t>(triangle)])];
  }
  /// Calls with each triangle whose box overlaps another one, and perhaps with a few more, until
  /// that returns false.
  template <typename Work>
  void forEachIn(const Box& box, const Work& work) const {
    const WideBox wide(box);
    for (std::size_t group = 0; group < boxes_.size(); ++group)
      for (const std::size_t lane : Overlaps(boxes_[group], wide))
        if (!work(faces_[group * kGroupSize + lane]))
          return;
  }
  /// How many others intersect one of the triangles. Once asked, the number is kept up to date.
  int countOf(Index triangle);
  /// Appends the triangles that intersect another one, but for that itself.
  void appendIntersecting(const Face& face, std::vector<Index>& triangles) const;
  /// How many triangles intersect another one, without that itself and one more; beyond `most` it
  /// need not count on.
  int count(const Face& face, Index without, int most) const;
  bool intersects(const Face& face) const { return count(face, face.triangle, 0) > 0; }

private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  /// Calls with each triangle that intersects another one, without that itself and one more, until
  /// that returns false.
  template <typename Work>
  void forEachIntersecting(const Face& face, Index without, const Work& work) const {
    const Plane plane(face);
    forEachIn(boxOf(face.corners), [&](const Face& other) {
      return other.triangle == face.triangle || other.triangle == without ||
             !intersect(face, plane, other) || work(other);
    });
  }

  /// Adds to the known numbers of those that a triangle intersects; returns how many these are, if
  /// numbers are kept.
  int addToCounts(const Face& face, int change);

  static constexpr int kUnknown = -1;

  std::vector<Face> faces_;
  std::vector<int> counts_;  ///< of each of faces_, or kUnknown
  bool has_counts_ = false;
  std::vector<BoxGroup> boxes_;
  std::vector<Index> places_;  ///< of each triangle of the mesh in faces_, or -1
};

}  // namespace spherical_param::internal
