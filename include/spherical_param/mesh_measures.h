#pragma once

#include "spherical_param/types.h"

namespace spherical_param {

/// \addtogroup checks
/// @{

/// Size, place and mass properties of a closed mesh and the solid that it encloses.
struct MeshMeasures {
  double volume = 0.0;  ///< signed, positive if oriented outward [cubed unit of the input]
  double area = 0.0;    ///< [squared unit of the input]
  double mean_edge_length = 0.0;  ///< [unit of the input]
  /// Lower corner of the box along the axes around the vertices of the triangles [unit of the
  /// input].
  Eigen::Vector3d box_min = Eigen::Vector3d::Zero();
  /// Upper corner of that box [unit of the input].
  Eigen::Vector3d box_max = Eigen::Vector3d::Zero();
  /// Centre of mass of the solid, or of the surface if the volume is within rounding [unit of the
  /// input].
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  /// Inertia tensor of the solid at unit density about `centroid`: symmetric, and positive definite
  /// if the volume is positive [unit of the input to the fifth].
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// Measures a closed mesh: exact integrals over the polyhedron, by the divergence theorem (Mirtich
/// 1996: Fast and accurate computation of polyhedral mass properties; in the closed form of Eberly
/// 2002: Polyhedral mass properties (revisited)).
///
/// The integrals are taken about a point of the mesh, so a far origin costs no digits. If the mesh
/// intersects itself, a region counts as often as the mesh winds around it.
///
/// \param points    3 x n; \param triangles 3 x m, consistently oriented, each edge twice.
/// \param threads 0: one for each processor; [0, 1024].
/// \return all zero for a mesh without triangles; the same, bit by bit, for any number of threads.
/// \throw InvalidInput for an index or threads out of range. Cost: O(m).
MeshMeasures measureMesh(const Positions& points, const Triangles& triangles, int threads = 0);

/// Vertex normals of a mesh: normals of the triangles, weighted by area.
///
/// \param points    3 x n; \param triangles 3 x m, indices in [0, n).
/// \return 3 x n: for each vertex the sum of its triangles' normals, each of length twice the area;
/// not unit vectors [squared unit of the input]. Cost: O(n + m).
Positions areaWeightedNormals(const Positions& points, const Triangles& triangles);

/// @}

}  // namespace spherical_param
