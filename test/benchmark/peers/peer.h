#pragma once

#include "common/point_data.h"

#include <chrono>
#include <string>
#include <vector>

namespace spherical_param::benchmark {

using Points = std::vector<tools::Point>;

/// Neighbours along which all libraries turn normals to one side. The 18 to 100 of their manuals
/// connect sheets of the surface that are close to each other, and whole parts get turned.
constexpr int orientation_neighbors = 10;

/// What a method of a library makes of points.
struct PeerResult {
  tools::TriangleMesh mesh;      ///< vertices that belong to no triangle are allowed
  std::string parameters;        ///< all that was set, in one line
  double normals_seconds = 0.0;  ///< estimating and orienting them [s], 0 if there are none
};

/// A method of a library, as the benchmark knows it.
struct PeerMethod {
  std::string name;
  std::string label;
  bool through_points = false;  ///< the vertices of the mesh are points of the input
  PeerResult (*reconstruct)(const Points& points) = nullptr;
};

/// A library and its methods.
struct Peer {
  std::string tool;     ///< name of the executable
  std::string library;  ///< with version
  std::vector<PeerMethod> methods;
};

/// Measures wall time.
class Stopwatch {
public:
  /// Time since the construction or the last call [s].
  double lap() {
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double> seconds = now - begin_;
    begin_ = now;
    return seconds.count();
  }

private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point begin_ = Clock::now();
};

/// The main() of all peers: reads the points, reconstructs, writes the mesh, prints the report.
int runPeer(int argc, char** argv, const Peer& peer);

}  // namespace spherical_param::benchmark
