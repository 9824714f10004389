#pragma once

#include "common/cloud_reconstruction.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace spherical_param::tools {

/// A mesh as a report shows it, in an order in which neighbours are near each other.
struct ReportMesh {
  std::vector<Index> vertices;  ///< v vertices of the result
  Positions positions;          ///< 3 x v [unit of the input]
  Positions sphere;             ///< 3 x v, unit vectors; empty if the result has no sphere
  Triangles triangles;          ///< 3 x t
  /// v entries each, none without a sphere: log2 of the fraction of the sphere around a vertex over
  /// that of the surface; sigma_1 / sigma_2 of the map, mean; log10 of the tangential Laplacian
  /// [radius], at least -17.
  std::vector<double> area_distortion;
  std::vector<double> angle_distortion;
  std::vector<double> residual;
  std::vector<std::uint8_t> marks;  ///< t entries, bits of triangle_mark
};

/// The entries of a list, or columns of points, at some indices.
std::vector<double> picked(const std::vector<double>& values, const std::vector<Index>& indices);
Positions picked(const Positions& points, const std::vector<Index>& indices);

/// The indices of points along a curve that fills their box: neighbours are near each other in this
/// order.
std::vector<Index> orderAlongCurve(const Positions& points);

/// Shows a result that was made with Options::details by a limited number of triangles: of a larger
/// mesh a part of the vertices, spread over the sphere and triangulated there. A mesh without a
/// sphere is shown as a whole.
ReportMesh reportMesh(const CloudReconstruction& cloud, const Surface& surface,
                      std::size_t max_triangles, int threads);

}  // namespace spherical_param::tools
