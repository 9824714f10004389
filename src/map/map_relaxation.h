#pragma once

#include "indexed.h"
#include "rows.h"
#include "spherical_param/types.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spherical_param::internal {

/// A triangle around a vertex: of the vertex, a neighbour, and the neighbour of the next corner.
struct MapCorner {
  Index neighbor;
  float mass;  ///< area in space that the triangle stands for
  /// Cotangents of the angles that it should have at the vertex, the neighbour and the next one.
  float cot_vertex;
  float cot_neighbor;
  float cot_next;
};

/// The triangles around a vertex, counter-clockwise.
using MapRing = Row<MapCorner>;

/// The distortion that is minimised: the weights of its terms, and what areas are measured with.
struct MapEnergy {
  double angle_weight;  ///< of the distortion of angles
  double log_weight;    ///< of the absolute logarithm of the ratio of areas
  double ratio_weight;  ///< of the mean of that ratio and its inverse
  double area_of_mass;  ///< area on the sphere that a unit of mass should have
};

/// The corners around the vertices of a mesh. The vertices are in order of their colours;
/// neighbours have different ones.
struct MapRows {
  Indexed<Index> vertices;
  Indexed<std::uint32_t> begin;     ///< v + 1 positions in `corners`
  std::vector<MapCorner> corners;   ///< of each vertex, counter-clockwise
  std::vector<std::size_t> colors;  ///< where the vertices of each colour begin, and their end

  MapRing around(Index i) const {
    return {corners.data() + begin[i], corners.data() + begin[i + 1]};
  }
};

/// Cotangents of the angles of a triangle. A needle gets those of a wider triangle: its distortion
/// would outweigh all others.
Eigen::Vector3f mapCotangents(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                              const Eigen::Vector3d& c);

/// \param masses of the triangles.
MapRows makeMapRows(const Positions& points, const Triangles& triangles,
                    const Indexed<float>& masses, Index vertex_count, int threads);

/// Whether a point of the sphere makes all triangles counter-clockwise with its ring, for sure.
bool isMapValid(const Positions& sphere, const MapRing& ring, const Eigen::Vector3d& at);

/// Moves a vertex by one step of Newton's method, shortened until the distortion of its triangles
/// falls, and none is flipped.
///
/// \return by how much the energy fell; 0: the vertex was not moved.
double relaxMapVertex(Positions& sphere, Index v, const MapRing& ring, const MapEnergy& energy);

/// relaxMapVertex() for all vertices.
///
/// \return by how much the energy fell.
double sweepMap(Positions& sphere, const MapRows& rows, const MapEnergy& energy, int threads);

/// The energy, a sum over the triangles, each weighted by its mass.
double mapEnergy(const Positions& sphere, const MapRows& rows, const MapEnergy& energy,
                 int threads);

}  // namespace spherical_param::internal
