#include "peer.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>

namespace spherical_param::benchmark {
namespace {

/// Largest resident memory of this process [bytes]. Not by getrusage(): on Linux that starts with
/// the memory of the parent.
std::size_t peakMemory() {
  std::ifstream status("/proc/self/status");
  std::size_t kib = 0;
  for (std::string word; status >> word;)
    if (word == "VmHWM:")
      status >> kib;
  return 1024 * kib;
}

}  // namespace

int runPeer(int argc, char** argv, const std::string& library,
            const std::vector<PeerMethod>& methods) {
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    const auto method = std::find_if(methods.begin(), methods.end(), [&](const PeerMethod& one) {
      return words.size() == 4 && one.name == words[0];
    });
    if (method == methods.end())
      throw std::runtime_error("the words are not METHOD POINTS.ply MESH.ply REPORT.json");
    Stopwatch stopwatch;
    const Positions points = readPly(words[1]).points;
    stopwatch.lap();
    const PeerResult result = method->reconstruct(points);
    const double seconds = stopwatch.lap() - result.normals_seconds;
    if (result.mesh.triangles.cols() == 0)
      throw std::runtime_error("no triangles were made");
    writePly(words[2], result.mesh);
    const nlohmann::ordered_json report = {{"library", library},
                                           {"parameters", result.parameters},
                                           {"normals_seconds", result.normals_seconds},
                                           {"reconstruction_seconds", seconds},
                                           {"peak_memory_bytes", peakMemory()}};
    std::ofstream file(words[3]);
    file << report.dump(2) << '\n';
    if (!file.flush())
      throw std::runtime_error("cannot write '" + words[3] + "'");
  } catch (const std::exception& error) {
    std::cerr << library << ": " << error.what() << '\n';
    return 1;
  }
  return 0;
}

}  // namespace spherical_param::benchmark
