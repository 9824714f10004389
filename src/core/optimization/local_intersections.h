#pragma once

#include "box_tree.h"
#include "spherical_param/types.h"
#include "triangle_pair.h"

#include <cstddef>
#include <vector>

namespace spherical_param::internal {

/// A changing set of triangles of a mesh, for counts of intersections.
class LocalIntersections {
public:
  /// Begins with a set. Memory in proportion to the mesh is allocated only here.
  ///
  /// \param triangles number of triangles of the mesh.
  /// \param faces     the set; faster if faces that follow each other are near.
  void begin(std::size_t triangles, std::vector<Face> faces = {});
  /// Adds or changes a triangle.
  void set(const Face& face);
  void remove(Index triangle);
  bool contains(Index triangle) const { return places_[static_cast<std::size_t>(triangle)] >= 0; }
  const std::vector<Face>& faces() const { return faces_; }
  const Face& face(Index triangle) const {
    return faces_[static_cast<std::size_t>(places_[static_cast<std::size_t>(triangle)])];
  }
  /// Calls work(face) for each triangle whose box overlaps a box, and perhaps a few more, until it
  /// returns false.
  template <typename Work>
  void forEachIn(const Box& box, const Work& work) const {
    bool is_done = false;
    boxes_.forEachOverlapping(
        FloatBox(box), 0, [&](const FloatBox&) { return is_done; },
        [&](std::size_t place) { is_done = !work(faces_[place]); });
  }
  /// Number of others that intersect one of the triangles. From the first call on, it is kept up to
  /// date.
  int countOf(Index triangle);
  /// Appends the triangles that intersect a triangle, without itself.
  void appendIntersecting(const Face& face, std::vector<Index>& triangles) const;
  /// Number of triangles that intersect a triangle, without itself and `without`; counting may stop
  /// beyond `most`.
  int count(const Face& face, Index without, int most) const;
  bool intersects(const Face& face) const { return count(face, face.triangle, 0) > 0; }

private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  /// Calls work(face) for each triangle that intersects `face`, without itself and `without`, until
  /// it returns false.
  template <typename Work>
  void forEachIntersecting(const Face& face, Index without, const Work& work) const {
    const Plane plane(face);
    forEachIn(boxOf(face.corners), [&](const Face& other) {
      return other.triangle == face.triangle || other.triangle == without ||
             !intersect(face, plane, other) || work(other);
    });
  }

  /// Adds `change` to the known counts of triangles that intersect `face`; returns their number, if
  /// counts are kept.
  int addToCounts(const Face& face, int change);

  static constexpr int kUnknown = -1;

  std::vector<Face> faces_;
  std::vector<int> counts_;  ///< of each of faces_, or kUnknown
  bool has_counts_ = false;
  BoxTree boxes_;              ///< of each of faces_
  std::vector<Index> places_;  ///< of each triangle of the mesh in faces_, or -1
};

}  // namespace spherical_param::internal
