#pragma once

#include "ply_file.h"
#include "spherical_param/types.h"

#include <cstdint>
#include <optional>
#include <vector>

/// A referee for meshes, whichever program made them. It judges the library too, so that it shares
/// nothing with it but the types and the exact test for self-intersections.
///
/// A triangle is degenerate if two of its indices are equal. A vertex is used if a triangle that is
/// not degenerate has its index.
namespace spherical_param::benchmark {

/// Whether a mesh is one closed manifold surface with the topology of a sphere and has no
/// degenerate triangle. Vertices at the same place are different vertices. Its triangles need not
/// be oriented the same way.
bool isClosedManifoldGenus0(const Mesh& mesh);

/// Finite points of a cloud at whose place, in single precision, the mesh has a used vertex [%].
double pointsUsedPercent(const Mesh& mesh, const Positions& cloud);

/// Edges of the true mesh that the mesh has between the same places, in single precision [%]. None
/// unless 99 % of the vertices of the true mesh are points of the cloud.
std::optional<double> edgesReproducedPercent(const Mesh& mesh, const Mesh& truth,
                                             const Positions& cloud);

/// The smallest angle of each triangle; 0 where a side has no length.
struct TriangleShapes {
  double min_angle_mean = 0.0;    ///< [degrees]
  double below_10_percent = 0.0;  ///< triangles with an angle below 10 degrees [%]
};

TriangleShapes measureTriangleShapes(const Mesh& mesh);

/// Distance of each point to the nearest point of a mesh that has a triangle that is no needle.
std::vector<double> distancesTo(const Mesh& mesh, const Positions& points);

/// Distances to the nearest point of the other mesh, in both directions, and angles between the
/// normals there.
struct Distances {
  double hausdorff = 0.0;         ///< largest over samples and vertices [percent of the diagonal]
  double rms = 0.0;               ///< over the samples [percent of the diagonal]
  double normal_deviation = 0.0;  ///< mean over the samples, the sign ignored [degrees], [0, 90]
};

/// Percentages are of the diagonal of the bounding box of the truth.
///
/// \param samples of each mesh, one in each part of equal area; 1 and up.
/// \return none if all triangles of one of the meshes are needles.
std::optional<Distances> measureDistances(const Mesh& mesh, const Mesh& truth, int samples,
                                          std::uint64_t seed = 1);

/// Distortion of the linear maps from the triangles in space to the flat triangles between the same
/// vertices on the sphere (M. Floater and K. Hormann, "Surface Parameterization: a Tutorial and
/// Survey", 2005). With singular values s1 >= s2, the angle distortion is s1 / s2, 1 for a
/// conformal map; the area distortion is the fraction of the sphere's area over the fraction of the
/// surface's area, here as log2. Means and percentiles are weighted by area in space.
///
/// Files in single precision round the positions on the sphere. A triangle whose orientation this
/// rounding can change is collapsed; it is left out of the distortion.
struct MapDistortion {
  double angle_mean = 1.0;
  double angle_p95 = 1.0;
  double area_rms_log2 = 0.0;
  std::int64_t collapsed_triangles = 0;
  /// Others, whose orientation on the sphere differs from that of the mesh.
  std::int64_t inverted_triangles = 0;
};

/// \param sphere 3 x n, a direction for each vertex of the mesh; of any length but 0.
MapDistortion measureMapDistortion(const Mesh& mesh, const Positions& sphere);

}  // namespace spherical_param::benchmark
