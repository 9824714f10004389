#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// Parts of the command line tools that do not belong to the library.
namespace spherical_param::tools {

/// Negative inside; near the surface, about the signed distance to it.
using Distance = std::function<double(const Eigen::Vector3d&)>;

/// A surface that can be scanned, about 1 unit long and centred near the origin.
struct Shape {
  std::string name;         ///< lower case
  std::string description;  ///< one line without a full stop
  Distance distance;
  /// Negative where the surface is cut away.
  Distance opening = [](const Eigen::Vector3d&) { return 1.0; };
};

const std::vector<Shape>& allShapes();

/// A desk with objects on it, in a room, which a depth camera at the origin sees: it looks along z,
/// y points down, lengths are in metres. No surface to scan all around, so not one of allShapes().
const Shape& deskScene();

inline constexpr std::size_t kMaxScanPoints = 10'000'000;

struct ScanOptions {
  std::string shape = "head";  ///< name of a shape, or of the scene
  std::size_t points = 5000;   ///< 4 ... kMaxScanPoints
  /// Half the width of the uniform noise along the normal, relative to a point's mean distance to
  /// its 25 nearest neighbours (section 4.2 of the paper); 0 ... 100. Of the scene: along the ray,
  /// relative to the distance of neighbouring rays at the point.
  double noise = 0.0;
  std::uint64_t seed = 1;
};

struct Scan {
  Positions points;   ///< 3 x n, column i = point i; no two are equal, not even as float
  Positions normals;  ///< 3 x n, unit, outward, without noise
};

/// Points spread evenly over a shape, at random (blue noise), or those of a depth image of the
/// scene: one for each ray, row by row, on an even grid of 4 x 3. Scans that differ in their noise
/// only move the same points. \throw InvalidInput if there is no such shape.
Scan generateScan(const ScanOptions& options);

/// The surface a scan is taken from.
struct TruthMesh {
  Positions vertices;   ///< 3 x v, on the surface
  Triangles triangles;  ///< 3 x t, counter-clockwise seen from outside
};

/// Triangulates a shape, with its handles, pieces and openings. With 256 cells, the mesh is
/// manifold and oriented, with a vertex about every 1/200 unit. \throw InvalidInput
///
/// \param cells of a lattice along each axis: 128 or 256.
TruthMesh referenceMesh(const std::string& shape, int cells = 256);

}  // namespace spherical_param::tools
