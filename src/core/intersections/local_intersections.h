#pragma once

#include "box_tree.h"
#include "indexed.h"
#include "spherical_param/types.h"
#include "triangle_pair.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace spherical_param::internal {

/// A changing set of triangles of a mesh, which counts the intersections of a triangle with them.
class LocalIntersections {
public:
  /// Replaces the set. Only this allocates memory in proportion to the mesh.
  ///
  /// \param triangles number of triangles of the mesh.
  /// \param faces     the set; faster if consecutive faces are near each other.
  void begin(std::size_t triangles, Indexed<Face> faces = {});
  /// Adds or changes a triangle.
  void set(const Face& face);
  void remove(Index triangle);
  bool contains(Index triangle) const {
    return places_[triangle] >= 0 && is_in_[places_[triangle]] != 0;
  }
  /// The set, and removed faces, which keep their place.
  const std::vector<Face>& faces() const { return faces_; }
  const Face& face(Index triangle) const { return faces_[places_[triangle]]; }
  /// Appends the triangles that intersect another one, without itself.
  void appendIntersecting(const Face& face, std::vector<Index>& triangles) const;
  /// Appends the triangles whose boxes overlap `box`.
  void appendWithin(const FloatBox& box, std::vector<Index>& triangles) const {
    boxes_.forEachOverlapping(
        box, 0, [](const FloatBox&) { return false; },
        [&](Index place) { triangles.push_back(faces_[place].triangle); });
  }
  /// Number of triangles that intersect another one, without itself and `without`; counting may
  /// stop beyond `most`.
  int count(const Face& face, Index without, int most = std::numeric_limits<int>::max() - 1) const;
  /// The same. Adds the number of triangles that are not evidently apart to `exact_tests`.
  int count(const Face& face, Index without, int most, std::size_t& exact_tests) const;
  bool intersects(const Face& face) const { return count(face, face.triangle, 0) > 0; }

private:
  /// Calls work(other) for each triangle that intersects `face`, without itself and `without`,
  /// until it returns false.
  template <typename Work>
  void forEachIntersecting(const Face& face, Index without, std::size_t& exact_tests,
                           const Work& work) const {
    const Plane plane(face);
    const auto meets = [&](const Face& other) {
      if (other.triangle == face.triangle || other.triangle == without ||
          evidentlyApartByBoth(face, plane, other))
        return false;
      ++exact_tests;
      return intersectExactly(face, other);
    };
    bool is_done = false;
    boxes_.forEachOverlapping(
        boxOf(face.corners).cast<float>(), 0, [&](const FloatBox&) { return is_done; },
        [&](Index place) {
          const Face& other = faces_[place];
          is_done = is_done || (meets(other) && !work(other));
        });
  }

  Indexed<Face> faces_;
  Indexed<char> is_in_;    ///< 0: the face was removed
  BoxTree boxes_;          ///< of faces_; those of removed faces are empty
  Indexed<Index> places_;  ///< place in faces_ of each triangle of the mesh, or -1
};

}  // namespace spherical_param::internal
