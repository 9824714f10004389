// The meshes of all generated shapes, and of a folder of models: the same bytes for 1, 2 and 4
// threads. With --digests: a line for each cloud and stage, for compare_builds.py.
//
//   torture_meshes [--quick] [--models FOLDER] [--digests]
//
// Models are .ply files that begin with vertices of three floats in binary.

#include "mixed_jobs.h"
#include "torture_row.h"

#include "scan_shapes.h"
#include "search/kd_tree.h"

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param;
using torture::bytesOf;

struct Cloud {
  std::string name;
  Positions points;
};

std::optional<Positions> readModel(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::vector<std::string> properties;
  Eigen::Index count = -1;
  bool is_binary = false;
  while (std::getline(file, line) && line != "end_header") {
    std::istringstream words(line);
    std::string first;
    std::string second;
    words >> first >> second;
    if (first == "format")
      is_binary = second == "binary_little_endian";
    else if (first == "element" && count < 0 && second == "vertex")
      words >> count;
    else if (first == "element")
      break;  // faces may follow; then the end of the header is looked for below
    else if (first == "property")
      properties.push_back(line);
  }
  while (line != "end_header" && std::getline(file, line)) {
  }
  const std::vector<std::string> expected{"property float x", "property float y",
                                          "property float z"};
  if (!file || !is_binary || count < 0 || properties != expected)
    return {};
  Eigen::Matrix3Xf points(3, count);
  file.read(reinterpret_cast<char*>(points.data()),
            static_cast<std::streamsize>(sizeof(float)) * points.size());
  if (!file)
    return {};
  return points.cast<double>();
}

NeighborSearchFactory kdTreeSearch() {
  return [](const Positions& points, const std::vector<Index>&) -> NeighborSearch {
    return [tree = std::make_shared<const internal::KdTree<double>>(points)](
               const std::vector<Index>& queries, int count) {
      const std::size_t size = std::min(static_cast<std::size_t>(count), tree->size() - 1) + 1;
      NeighborLists lists;
      lists.indices.resize(queries.size() * size);
      lists.offsets.resize(queries.size() + 1);
      for (std::size_t i = 0; i < lists.offsets.size(); ++i)
        lists.offsets[i] = i * size;
      tree->find(queries.data(), queries.size(), size, lists.indices.data());
      return lists;
    };
  };
}

/// What came out, in the order of the work.
using Stages = std::vector<std::pair<std::string, std::string>>;

Stages stagesOf(const Positions& points, Options options, int threads) {
  options.threads = threads;
  // The lists by themselves, too: the result does not have them.
  const NeighborSearch search = kdTreeSearch()(points, {});
  std::vector<Index> all(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = static_cast<Index>(i);
  const Result result = reconstruct(points, kdTreeSearch(), options);
  Positions vertices(3, result.sphere.cols());
  for (std::size_t v = 0; v < result.vertexCount(); ++v)
    vertices.col(static_cast<Eigen::Index>(v)) = points.col(result.input_of_vertex[v]);
  SphereMapOptions map_options;
  map_options.threads = threads;
  const SphereMap map = computeSphereMap(vertices, result.triangles, result.sphere, map_options);
  return {
      {"points", bytesOf(points)},
      {"neighbors", bytesOf(search(all, neighborsToSearch(options)).indices)},
      {"graph",
       bytesOf(result.graph.edges, result.graph.components, result.graph.without_tangent_plane,
               result.graph.searched_again, result.graph.uncertified, result.graph.weak)},
      {"embedding", bytesOf(result.sphere)},
      {"triangles", bytesOf(result.triangles, result.vertex_of_input)},
      {"smoothed", bytesOf(result.smoothed)},
      {"result", bytesOf(result)},
      {"map", bytesOf(map.sphere)},
  };
}

std::vector<Cloud> shapes(const std::vector<std::size_t>& sizes, std::size_t most_shapes) {
  std::vector<Cloud> clouds;
  for (const std::size_t size : sizes) {
    std::size_t number = 0;
    for (const tools::ShapeInfo& info : tools::allShapes()) {
      if (number++ == most_shapes)
        break;
      tools::ScanOptions options;
      options.shape = info.shape;
      options.points = size;
      options.noise = number % 2 == 0 ? 0.5 : 0.0;
      clouds.push_back({std::string(info.name) + "-" + std::to_string(size),
                        tools::generateScan(options).points});
    }
  }
  return clouds;
}

std::uint64_t digest(const std::string& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a
  for (const char byte : bytes)
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  return hash;
}

}  // namespace

int main(int argc, char** argv) {
  bool quick = false;
  bool only_digests = false;
  std::string folder;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--quick") {
      quick = true;
    } else if (argument == "--digests") {
      only_digests = true;
    } else if (argument == "--models" && i + 1 < argc) {
      folder = argv[++i];
    } else {
      std::fprintf(stderr, "usage: %s [--quick] [--models FOLDER] [--digests]\n", argv[0]);
      return 2;
    }
  }

  // From 4096 points on the work is shared out, from 50000 on all of it.
  std::vector<Cloud> clouds =
      quick ? shapes({4500}, 3) : shapes({500, 5000, 12000}, tools::allShapes().size());
  if (!quick)
    for (Cloud& cloud : shapes({60000}, 2))
      clouds.push_back(std::move(cloud));
  std::size_t unread = 0;
  if (!folder.empty()) {
    std::vector<std::filesystem::path> paths;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
      if (entry.path().extension() == ".ply")
        paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    for (const std::filesystem::path& path : paths) {
      auto points = readModel(path);
      if (points)
        clouds.push_back({path.stem().string(), std::move(*points)});
      else
        std::printf("%s: not of the kind that is read here\n", path.c_str());
      unread += points ? 0 : 1;
    }
    if (paths.empty()) {
      std::printf("no .ply file in '%s'\n", folder.c_str());
      ++unread;
    }
  }

  Options paper;
  paper.graph = GraphMethod::NearestNeighbors;
  paper.solver = EmbeddingMethod::Iterative;
  paper.hull = TriangulationMethod::Qhull;
  paper.optimization = OptimizationMethod::Flips;
  paper.max_iterations = 300;
  Options smoothed;
  smoothed.smoothing_steps = 3;
  smoothed.details = true;

  std::size_t meshes = 0;
  std::size_t different = 0;
  for (const Cloud& cloud : clouds) {
    std::vector<std::pair<std::string, Options>> kinds{{"defaults", Options()}};
    if (cloud.points.cols() < 15000 && !quick) {
      kinds.emplace_back("paper", paper);
      kinds.emplace_back("smoothed", smoothed);
    }
    for (const auto& [kind, options] : kinds) {
      ++meshes;
      const Stages one = stagesOf(cloud.points, options, only_digests ? 2 : 1);
      if (only_digests) {
        for (const auto& [stage, bytes] : one)
          std::printf("%s %s %s %016" PRIx64 "\n", cloud.name.c_str(), kind.c_str(), stage.c_str(),
                      digest(bytes));
        std::fflush(stdout);
        continue;
      }
      for (const int threads : {2, 4}) {
        const Stages several = stagesOf(cloud.points, options, threads);
        for (std::size_t i = 0; i < one.size(); ++i)
          if (one[i] != several[i]) {
            ++different;
            std::printf("%s, %s: with %d threads other %s than with one\n", cloud.name.c_str(),
                        kind.c_str(), threads, one[i].first.c_str());
            break;
          }
      }
    }
  }
  if (only_digests)
    return unread > 0 ? 1 : 0;
  torture::Row row;
  row.part = "determinism";
  row.load = std::to_string(clouds.size()) + " clouds, " + std::to_string(meshes) +
             " meshes and maps, each with 1, 2 and 4 threads: same bytes";
  row.tried = 3 * meshes;
  row.found = different + unread;
  return torture::print(row);
}
