#pragma once

#include "common/cloud_reconstruction.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spherical_param::tools {

/// A mesh as a report shows it, in an order in which neighbours are near each other.
struct ReportMesh {
  std::vector<Index> inputs;  ///< v points of the input
  Positions positions;        ///< 3 x v [unit of the input]
  Positions sphere;           ///< 3 x v, unit vectors; empty without a sphere of all vertices
  Triangles triangles;        ///< 3 x t
  /// v entries each, none without a sphere or of several surfaces: log2 of the fraction of the
  /// sphere around a vertex over that of the surface; sigma_1 / sigma_2 of the map, mean; log10 of
  /// the tangential Laplacian [radius], at least -17.
  Eigen::ArrayXd area_distortion;
  Eigen::ArrayXd angle_distortion;
  Eigen::ArrayXd residual;
  std::vector<std::uint8_t> marks;  ///< t entries, bits of triangle_mark
};

/// Triangles up to which all of a mesh is shown: the page has about 12 bytes for each.
inline constexpr std::size_t kMaxReportTriangles = 1000000;

/// Shows surfaces of a result that was made with Options::details as one mesh. Of large surfaces it
/// has a part of the vertices, spread over the sphere and triangulated there; a surface without a
/// sphere is shown as a whole. Several surfaces have a sphere in common if they are seen from one
/// place.
ReportMesh reportMesh(const CloudReconstruction& cloud, const std::vector<const Surface*>& surfaces,
                      std::size_t max_triangles = kMaxReportTriangles);

}  // namespace spherical_param::tools
