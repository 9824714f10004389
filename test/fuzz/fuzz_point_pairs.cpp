// Pairs of points, which pcl_spherical_param_morph reads, of two clouds.

#include "common/cloud_reconstruction.h"
#include "common/errors.h"
#include "common/point_pairs.h"
#include "fuzz_file.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

namespace {

using namespace spherical_param::tools;
using stress::require;

/// The mesh of a cloud on a sphere, one point of it twice and one not finite: these are no vertices
/// of their own.
CloudReconstruction meshedSphere(int count) {
  std::ostringstream points;
  for (int i = 0; i <= count; ++i) {
    const double z = 1.0 - (2.0 * (i % count) + 1.0) / count;
    const double radius = std::sqrt(1.0 - z * z);
    const double angle = 2.4 * (i % count);
    points << radius * std::cos(angle) << ' ' << radius * std::sin(angle) << ' ' << z << '\n';
  }
  points << "nan 0 0\n";
  const std::string text = points.str();
  stress::FuzzFile file(".xyz");
  file.fill(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  Console console(false);
  CloudReconstruction cloud;
  reconstructCloud(file.path(), {}, console, cloud);
  return cloud;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static stress::FuzzFile file(".txt");
  static const CloudReconstruction first = meshedSphere(60);
  static const CloudReconstruction second = meshedSphere(40);
  file.fill(bytes, size);
  try {
    for (const FilePair& pair : readPointPairs(file.path(), first, second)) {
      require(pair.line > 0, "a pair has its line");
      for (std::size_t side = 0; side < 2; ++side) {
        const CloudReconstruction& cloud = side == 0 ? first : second;
        const auto points = static_cast<int>(cloud.data.points.size());
        require(pair.points[side] >= 0 && pair.points[side] < points, "the point is one");
        require(pair.vertices[side] >= -1 &&
                    pair.vertices[side] < static_cast<int>(cloud.result.vertexCount()),
                "the vertex is one, or none");
      }
    }
  } catch (const ToolError& error) {
    require(!error.remedy().empty(), "a refusal has its remedy");
  }
  return 0;
}
