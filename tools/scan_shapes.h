#pragma once

#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// Parts of the command line tools that do not belong to the library.
namespace spherical_param::tools {

/// A surface that can be scanned, about 1 unit long and centred near the origin.
struct ShapeInfo {
  std::string name;         ///< lower case
  std::string description;  ///< one line without a full stop
};

/// A shape and a number of points that stand for a scan of Table 1 of the paper.
struct ScanPreset {
  std::string name;        ///< name of the paper's scan, lower case
  std::string shape;       ///< the generated stand-in
  std::size_t points = 0;  ///< number of points in the paper
};

const std::vector<ShapeInfo>& allShapes();

/// By ascending number of points.
const std::vector<ScanPreset>& allPresets();

/// What to scan, and how.
struct ScanOptions {
  std::string shape = "head";  ///< name of a shape
  std::size_t points = 5000;   ///< number of points; 4 ... 100,000,000
  /// Half the width of the uniform noise along the normal, relative to a point's mean distance to
  /// its 25 nearest neighbours (section 4.2 of the paper); 0 ... 100, 0 = points on the surface.
  double noise = 0.0;
  std::uint64_t seed = 1;  ///< any value; the same seed gives the same scan
};

/// A generated scan.
struct Scan {
  Positions points;   ///< 3 x n, column i = point i; no two are equal, not even as float
  Positions normals;  ///< 3 x n, unit, outward: normal of the surface where point i was taken
};

/// The surface a scan was taken from.
struct TruthMesh {
  Positions vertices;   ///< 3 x v, on the surface
  Triangles triangles;  ///< 3 x t, counter-clockwise seen from outside
};

/// Samples a shape: exactly options.points points, spread evenly over the surface with random
/// (blue noise) placement. Scans that differ in their noise only move the same points of the
/// surface.
///
/// The arithmetic uses nothing but the operations that IEEE 754 rounds correctly, so the scan is
/// the same on every platform that does not contract products and sums.
///
/// \throw InvalidInput if an option is out of its range. Cost: O(n), with noise O(n log n).
Scan generateScan(const ScanOptions& options);

/// Triangulates a shape finely. The mesh is manifold and oriented, with the handles, pieces and
/// openings of the shape.
///
/// \param triangle_count about how many triangles are wanted, 1 ... 20,000,000. A shape with fine
///        features gets as many as it needs to be meshed correctly, if that is more.
/// \throw InvalidInput if an argument is out of its range. Cost: O(triangles).
TruthMesh referenceMesh(const std::string& shape, std::size_t triangle_count);

}  // namespace spherical_param::tools
