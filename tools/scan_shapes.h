#pragma once

#include "scan_distances.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// Parts of the command line tools that do not belong to the library.
namespace spherical_param::tools {

/// A surface that can be scanned, about 1 unit long and centred near the origin.
struct Shape {
  std::string name;         ///< lower case
  std::string description;  ///< one line without a full stop
  Distance distance;
  Distance opening = {};  ///< negative where the surface is cut away; empty: nowhere
};

const std::vector<Shape>& allShapes();

/// \throw InvalidInput if there is none of this name.
const Shape& findShape(const std::string& name);

inline constexpr std::size_t kMaxScanPoints = 10'000'000;

struct ScanOptions {
  std::string shape = "head";  ///< name of a shape, or of a scene
  std::size_t points = 5000;   ///< 4 ... kMaxScanPoints
  /// Half the width of the uniform noise along the normal, relative to a point's mean distance to
  /// its 25 nearest neighbours (section 4.2 of the paper); 0 ... 100. Of scenes and
  /// views, see there.
  double noise = 0.0;
  std::uint64_t seed = 1;
  int views = 0;   ///< cameras of scanFromViews(), 0 ... 100
  int slices = 0;  ///< of sliceShape(), 0 ... 1000
};

struct Scan {
  Positions points;      ///< 3 x n, column i = point i; NaN where a sensor sees nothing
  Positions normals;     ///< 3 x n, unit, outward, without noise; 0 where no ray hits
  std::size_t rows = 1;  ///< of an image; 1: the points have no order
};

/// Points spread evenly over a shape, at random (blue noise). No two are equal, not even as float.
/// Scans that differ in their noise only move the same points. \throw InvalidInput if there is no
/// such shape.
Scan generateScan(const ScanOptions& options);

/// The contours of a shape in planes at right angles to z, as of a tomograph: points where the
/// edges of a fine mesh cross the planes, 1/200 unit apart. \throw InvalidInput
///
/// \param options `slices`: planes, at least 1; points, noise and seed do not matter.
Scan sliceShape(const ScanOptions& options);

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
