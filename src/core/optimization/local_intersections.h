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
  bool contains(Index triangle) const { return places_[static_cast<std::size_t>(triangle)] >= 0; }
  const std::vector<Face>& faces() const { return faces_; }

  /// How many triangles intersect another one, without two of them.
  std::size_t count(const Face& face, Index without, Index and_without) const;

private:
  std::vector<Face> faces_;
  std::vector<BoxGroup> boxes_;
  std::vector<Index> places_;  ///< of each triangle of the mesh in faces_, or -1
};

}  // namespace spherical_param::internal
