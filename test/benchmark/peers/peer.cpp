#include "peer.h"

#include "common/cloud_reader.h"
#include "common/command_line.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "common/peak_memory.h"
#include "common/run_tool.h"
#include "common/text.h"
#include "library_output.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iterator>
#include <new>
#include <optional>

namespace spherical_param::benchmark {
namespace {

using namespace spherical_param::tools;
using Json = nlohmann::ordered_json;

const std::vector<OptionInfo> option_table = {
    {"list", "", "print the methods as JSON"},
};

std::string helpText(const Peer& peer) {
  std::string text = "Usage: " + peer.tool +
                     " METHOD input.ply output.ply\n\nReconstructs a surface with " + peer.library +
                     " and prints a report as JSON.\nMethods:\n";
  for (const PeerMethod& method : peer.methods) {
    text += "  " + method.name + ": " + method.label + "\n";
  }
  return text + "\nOptions:\n" + describeOptions(option_table) +
         "\nExit code: 0 done, 1 failed, 2 wrong usage.\n";
}

Json methodsToJson(const Peer& peer) {
  Json json = Json::array();
  for (const PeerMethod& method : peer.methods) {
    json.push_back({{"method", method.name},
                    {"label", method.label},
                    {"through_points", method.through_points}});
  }
  return json;
}

const PeerMethod& findMethod(const Peer& peer, const std::string& name) {
  const auto found = std::find_if(peer.methods.begin(), peer.methods.end(),
                                  [&](const PeerMethod& method) { return method.name == name; });
  if (found == peer.methods.end()) {
    throw UsageError("there is no method " + inQuotes(name),
                     "run '" + peer.tool + " -list' for the methods");
  }
  return *found;
}

/// The points without those that no library takes. Normals of the file are not used: all get the
/// points alone.
Points finitePoints(const PointData& data) {
  Points points;
  points.reserve(data.points.size());
  std::copy_if(data.points.begin(), data.points.end(), std::back_inserter(points),
               [](const Point& point) {
                 return std::all_of(point.begin(), point.end(),
                                    [](float value) { return std::isfinite(value); });
               });
  return points;
}

/// Tells whether all points lie in one plane, as far as single precision can tell.
bool areInOnePlane(const Points& points) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    positions.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3f(points[i].data()).cast<double>();
  }
  const Eigen::Vector3d centroid = positions.rowwise().mean();
  positions.colwise() -= centroid;
  const Eigen::Matrix3d covariance = positions * positions.transpose();
  const Eigen::Vector3d eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues();
  constexpr double relative_thickness = 1e-6;
  return eigenvalues[0] <= relative_thickness * relative_thickness * eigenvalues[2];
}

Points readPoints(const std::string& path) {
  Points points = finitePoints(readCloud(path));
  if (points.size() < 4 || areInOnePlane(points)) {  // some libraries crash on these
    throw Failure("there are fewer than 4 finite points, or all are in one plane",
                  "give points that cover a surface");
  }
  return points;
}

PeerResult reconstruct(const Peer& peer, const PeerMethod& method, const Points& points) {
  PeerResult result;
  std::string trouble;
  {
    const LibraryOutputSilencer silencer;
    try {
      result = method.reconstruct(points);
    } catch (const std::bad_alloc&) {
      trouble = "not enough memory";
    } catch (const std::exception& error) {
      trouble = error.what();
    }
  }
  if (trouble.empty() && result.mesh.triangles.empty()) {
    trouble = "it made no triangles";
  }
  if (!trouble.empty()) {
    throw Failure(method.name + " of " + peer.library + " failed: " + trouble,
                  "use another method, or points that cover a surface");
  }
  return result;
}

/// The mesh with the vertices that its triangles use, in their order.
TriangleMesh withUsedVertices(const TriangleMesh& mesh) {
  std::vector<std::int32_t> new_index(mesh.vertices.points.size(), -1);
  for (const auto& triangle : mesh.triangles) {
    for (const std::int32_t corner : triangle) {
      new_index[static_cast<std::size_t>(corner)] = 0;
    }
  }
  TriangleMesh used;
  for (std::size_t v = 0; v < new_index.size(); ++v) {
    if (new_index[v] == 0) {
      new_index[v] = static_cast<std::int32_t>(used.vertices.points.size());
      used.vertices.points.push_back(mesh.vertices.points[v]);
    }
  }
  used.triangles = mesh.triangles;
  for (auto& triangle : used.triangles) {
    for (std::int32_t& corner : triangle) {
      corner = new_index[static_cast<std::size_t>(corner)];
    }
  }
  return used;
}

void run(const Peer& peer, const std::vector<std::string>& words) {
  const CommandLine command_line(words, option_table);
  if (answerHelpOrVersion(command_line, peer.tool, helpText(peer))) {
    return;
  }
  if (command_line.has("list")) {
    printAll(methodsToJson(peer).dump(2) + "\n");
    return;
  }
  const std::vector<std::string>& others = command_line.others();
  if (others.size() != 3) {
    throw UsageError("there are " + std::to_string(others.size()) + " words instead of 3",
                     "run '" + peer.tool + " METHOD input.ply output.ply'");
  }
  const PeerMethod& method = findMethod(peer, others[0]);
  const std::string& input = others[1];
  const std::string& output = others[2];
  const FileFormat format = requireFormat(output, FileUse::WriteMesh);
  if (isSameFile(input, output)) {
    throw UsageError(inQuotes(output) + " would overwrite the input",
                     "give the output a name of its own");
  }
  checkOutputPath(output);

  Stopwatch stopwatch;
  const Points points = readPoints(input);
  const double read_seconds = stopwatch.lap();
  const PeerResult result = reconstruct(peer, method, points);
  const double reconstruction_seconds = stopwatch.lap() - result.normals_seconds;
  const TriangleMesh mesh = withUsedVertices(result.mesh);
  OutputFile file(output);
  writeMesh(file, mesh, format, Encoding::Binary);
  file.finish();
  const double write_seconds = stopwatch.lap();

  const std::optional<std::uint64_t> peak_memory = peakMemory();
  const Json report = {{"library", peer.library},
                       {"method", method.name},
                       {"parameters", result.parameters},
                       {"points", points.size()},
                       {"vertices", mesh.vertices.points.size()},
                       {"triangles", mesh.triangles.size()},
                       {"seconds",
                        {{"read", read_seconds},
                         {"normals", result.normals_seconds},
                         {"reconstruction", reconstruction_seconds},
                         {"write", write_seconds}}},
                       {"peak_memory_bytes", peak_memory ? Json(*peak_memory) : Json()}};
  printAll(report.dump(2) + "\n");
  file.commit();
}

}  // namespace

int runPeer(int argc, char** argv, const Peer& peer) {
  return runTool(peer.tool, argc, argv,
                 [&](const std::vector<std::string>& words) { run(peer, words); });
}

}  // namespace spherical_param::benchmark
