#pragma once

#include "common/point_data.h"
#include "spherical_param/types.h"

#include <map>
#include <string>

namespace spherical_param::benchmark {

/// Neighbours along which all libraries orient normals. The 18 to 100 of their manuals connect
/// sheets of the surface that are close to each other, which orients whole parts the wrong way.
constexpr int kOrientationNeighbors = 10;

/// What a method of a library makes of points.
struct PeerResult {
  Positions points;  ///< vertices; those without triangles are allowed
  Triangles triangles;
  std::string parameters;  ///< all that was set, in one line

  /// Sizes it for vertices and triangles.
  void resize(std::size_t vertices, std::size_t count) {
    points.resize(3, static_cast<Eigen::Index>(vertices));
    triangles.resize(3, static_cast<Eigen::Index>(count));
  }
};

/// The main() of all peers, PROGRAM METHOD CLOUD MESH.ply: reads the points, reconstructs,
/// writes the mesh, prints a report in JSON.
///
/// \param library with its version. \param methods by their names.
int runPeer(int argc, char** argv, const std::string& library,
            const std::map<std::string, PeerResult (*)(const tools::PointData&)>& methods);

}  // namespace spherical_param::benchmark
