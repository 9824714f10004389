#pragma once

#include "scan_shapes.h"

#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// What one sensor sees.
struct Scene {
  std::string name;         ///< lower case
  std::string description;  ///< one line without a full stop
  std::size_t points;       ///< by default
  /// \param options `points`: about; `noise`: times that of such a sensor, 0 ... 100.
  /// \param truth   what the sensor sees, as fine as its rays; no triangle is seen at less than 4
  ///                degrees. Null: not wanted.
  Scan (*scan)(const ScanOptions& options, TruthMesh* truth);
};

/// A depth camera, a scanner on a tripod, one in the air, and structured light, with their noise:
/// lengths are in metres, of the last in millimetres. The sensor is the origin, and looks along z,
/// with y down; that on the tripod has z up. From the air, coordinates are those of a map, with z
/// up, and the sensor is far above.
const std::vector<Scene>& allScenes();

/// What depth cameras around a shape see, merged: `options.noise` is the standard deviation along
/// the rays, relative to the distance of neighbouring rays; that of the place of each camera is
/// half as much along each axis. \throw InvalidInput if the shape has openings, which are not cut,
/// or no ray hits it.
///
/// \param options `views`: cameras, at least 1; `points`: of all, about.
Scan scanFromViews(const ScanOptions& options);

}  // namespace spherical_param::tools
