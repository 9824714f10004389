#pragma once

#include "ply_file.h"

#include <chrono>
#include <string>
#include <vector>

namespace spherical_param::benchmark {

/// Neighbours along which all libraries orient normals. The 18 to 100 of their manuals connect
/// sheets of the surface that are close to each other, which orients whole parts the wrong way.
constexpr int kOrientationNeighbors = 10;

/// What a method of a library makes of points.
struct PeerResult {
  Mesh mesh;                     ///< vertices without triangles are allowed
  std::string parameters;        ///< all that was set, in one line
  double normals_seconds = 0.0;  ///< to estimate and orient normals, if the method needs them [s]
};

struct PeerMethod {
  std::string name;
  PeerResult (*reconstruct)(const Positions& points) = nullptr;
};

/// Measures wall time.
class Stopwatch {
public:
  /// Time since the construction or the last call [s].
  double lap() {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin_;
    begin_ = std::chrono::steady_clock::now();
    return seconds.count();
  }

private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// The main() of all peers, PROGRAM METHOD POINTS.ply MESH.ply REPORT.json: reads the points,
/// reconstructs, writes the mesh and a report.
///
/// \param library with its version.
int runPeer(int argc, char** argv, const std::string& library,
            const std::vector<PeerMethod>& methods);

}  // namespace spherical_param::benchmark
