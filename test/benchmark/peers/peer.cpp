#include "peer.h"

#include "common/cloud_reader.h"
#include "common/file_formats.h"
#include "common/json_report.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"

#include <nlohmann/json.hpp>

#include <exception>
#include <iostream>
#include <stdexcept>

namespace spherical_param::benchmark {

int runPeer(int argc, char** argv, const std::string& library,
            const std::map<std::string, PeerResult (*)(const tools::PointData&)>& methods) {
  try {
    if (argc != 4 || methods.count(argv[1]) == 0)
      throw std::runtime_error("the words are not METHOD CLOUD MESH.ply");
    const PeerResult result = methods.at(argv[1])(tools::readCloud(argv[2]));
    if (result.triangles.cols() == 0)
      throw std::runtime_error("no triangles were made");
    tools::PointData vertices;
    vertices.points = tools::toPoints(result.points);
    tools::OutputFile mesh(argv[3]);
    writeMesh(mesh, {vertices, result.triangles}, tools::formatOf(argv[3]),
              tools::Encoding::Binary);
    mesh.finish();
    mesh.commit();
    std::cout << '\n'
              << nlohmann::ordered_json{{"library", library},
                                        {"parameters", result.parameters},
                                        {"peak_memory_bytes", tools::peakMemoryToJson()}};
  } catch (const std::exception& error) {
    std::cerr << library << ": " << error.what() << '\n';
    return 1;
  }
  return 0;
}

}  // namespace spherical_param::benchmark
