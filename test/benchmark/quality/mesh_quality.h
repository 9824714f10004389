#pragma once

#include "spherical_param/types.h"

#include <cstdint>
#include <optional>

/// A referee for meshes, wherever they come from. It judges the library too, so that it shares
/// nothing with it but the types and the exact test for self-intersections.
///
/// Everywhere: points are finite, triangles name vertices in [0, n). A triangle that names a vertex
/// twice is degenerate. A vertex is used if a triangle that is not degenerate names it.
namespace spherical_param::benchmark {

/// A number of things.
using Count = std::int64_t;

/// Any set of triangles: it need not be closed, manifold or oriented.
struct Mesh {
  Positions points;
  Triangles triangles;
};

/// What the indices alone tell, as they are stored: vertices at the same place stay apart.
/// Degenerate triangles are counted and left out.
struct Connectivity {
  Count vertices = 0;  ///< used ones
  Count unreferenced_vertices = 0;
  Count triangles = 0;
  Count degenerate_triangles = 0;
  Count edges = 0;
  Count boundary_edges = 0;        ///< with one triangle
  Count boundary_loops = 0;        ///< connected sets of boundary edges
  Count nonmanifold_edges = 0;     ///< with three triangles or more
  Count nonmanifold_vertices = 0;  ///< whose triangles are not one fan across manifold edges
  Count components = 0;            ///< sets of vertices that edges connect
  Count euler_characteristic = 0;  ///< vertices - edges + triangles
  bool closed = false;             ///< triangles, and two at each edge
  bool oriented = false;           ///< no two triangles run along an edge in the same direction
  bool orientable = false;         ///< oriented after turning triangles over
  /// Sum of the genera of all components; none unless closed, manifold and orientable.
  std::optional<Count> genus;

  bool edgeManifold() const { return nonmanifold_edges == 0; }
  bool vertexManifold() const { return nonmanifold_vertices == 0; }
  /// One closed manifold surface with the topology of a sphere. Its triangles need not be turned
  /// the same way, see `oriented`.
  bool closedManifoldGenus0() const { return genus == Count{0} && components == 1; }
};

Connectivity measureConnectivity(const Mesh& mesh);

/// Used vertices less the places where they are.
Count countRepeatedVertices(const Mesh& mesh);

/// How a mesh goes through a cloud. Places are compared in single precision, which is that of the
/// files of clouds: a point is used if a used vertex is at exactly its place.
struct CloudCoverage {
  Count points = 0;  ///< of the cloud that are finite
  Count points_used = 0;
  Count extra_vertices = 0;  ///< used vertices that are at no point of the cloud
};

/// \param cloud 3 x n, finite or not.
CloudCoverage measureCloudCoverage(const Mesh& mesh, const Positions& cloud);

/// Whether all but 1 % of the used vertices of a mesh are points of a cloud. Only then it makes
/// sense to look for the mesh's edges in another mesh over that cloud.
bool isOverCloud(const Mesh& mesh, const Positions& cloud);

/// Edges that two meshes have in common: between the same places, in single precision.
struct EdgeAgreement {
  double reproduced = 0.0;  ///< share of the truth's edges that the mesh has, [0, 1]
  double precision = 0.0;   ///< share of the mesh's edges that the truth has, [0, 1]
};

EdgeAgreement compareEdges(const Mesh& mesh, const Mesh& truth);

/// The least angle of each triangle; 0 where a side has no length. [degrees]
struct TriangleShapes {
  double min_angle_mean = 0.0;
  double min_angle_p05 = 0.0;   ///< 5th percentile
  double share_below_10 = 0.0;  ///< [0, 1]
  double share_below_1 = 0.0;   ///< [0, 1]
  Count zero_area_triangles = 0;
};

/// \param mesh with a triangle at least.
TriangleShapes measureTriangleShapes(const Mesh& mesh);

struct SelfIntersectionCount {
  Count pairs = 0;
  Count triangles = 0;  ///< in at least one pair
};

/// In exact arithmetic, see findSelfIntersections(): vertices at the same place count as the same
/// one, and triangles without area intersect nothing.
SelfIntersectionCount countSelfIntersections(const Mesh& mesh);

double surfaceArea(const Mesh& mesh);

/// Volume to the inner side of the triangles; of an open mesh, that of the cone to a point.
double signedVolume(const Mesh& mesh, const Eigen::Vector3d& apex);

/// Bounding box of all points.
struct Bounds {
  Eigen::Vector3d low;
  Eigen::Vector3d high;

  Eigen::Vector3d center() const { return 0.5 * (low + high); }
  double diagonal() const { return (high - low).norm(); }
};

Bounds boundsOf(const Mesh& mesh);

struct DistanceOptions {
  Count samples = 200000;  ///< on each of the two meshes; 1 and up
  std::uint64_t seed = 1;
};

/// Distances to the nearest point of the other mesh [unit of the points], and angles between the
/// normals there [degrees].
struct Distances {
  struct Directions {
    double mesh_to_truth = 0.0;
    double truth_to_mesh = 0.0;
  };
  Directions hausdorff;           ///< largest of samples and corners: the true one at most
  Directions rms;                 ///< over the samples
  double both_rms = 0.0;          ///< over the samples of both directions
  double both_mean = 0.0;         ///< over the same
  double normal_deviation = 0.0;  ///< mean over the same; inside out is no deviation: up to 90
  double normal_deviation_over_30 = 0.0;  ///< share of the same, [0, 1]

  double bothHausdorff() const;
};

/// Samples are spread evenly over the area, one in each part of equal area. None if no triangle of
/// a mesh has an area worth mentioning.
std::optional<Distances> measureDistances(const Mesh& mesh, const Mesh& truth,
                                          const DistanceOptions& options = {});

/// The distortion of the linear maps from the triangles in space to the flat triangles between the
/// same vertices on the sphere (M. Floater and K. Hormann, "Surface Parameterization: a Tutorial
/// and Survey", 2005). With singular values s1 >= s2, the angle distortion is s1 / s2, 1 for a
/// conformal map; the area distortion is the share of the sphere's area over the share of the
/// surface's, here as log2.
///
/// All means and percentiles are weighted by area in space, and over triangles that are neither
/// collapsed nor without area in space.
///
/// These numbers are for files in single precision. They round the positions on the sphere, and
/// what is smaller than that there, such as the tips of long limbs, has no shape or orientation any
/// more, although the positions that were rounded had. Such triangles are collapsed.
struct MapDistortion {
  double angle_mean = 1.0;
  double angle_median = 1.0;
  double angle_p95 = 1.0;
  double area_rms_log2 = 0.0;
  double area_p05_log2 = 0.0;
  double area_p95_log2 = 0.0;
  /// Triangles so thin on the sphere that the rounding to float alone could turn them over.
  Count collapsed_triangles = 0;
  /// Others that are seen clockwise from outside the sphere, while the mesh is oriented outward; or
  /// the other way round, if it is oriented inward.
  Count inverted_triangles = 0;
};

/// \param on_sphere 3 x n, a direction for each vertex of the mesh; any length but 0.
MapDistortion measureMapDistortion(const Mesh& mesh, const Positions& on_sphere);

}  // namespace spherical_param::benchmark
