// Every way in which the tools read a file, of any content. FUZZED_EXTENSION says which: a cloud,
// or pairs of points of two clouds (.txt).

#include "common/cloud_reader.h"
#include "common/cloud_reconstruction.h"
#include "common/errors.h"
#include "common/point_pairs.h"
#include "fuzz_input.h"

#include <unistd.h>

#include <fstream>
#include <sstream>

namespace {

using namespace spherical_param::tools;
using fuzz::require;

/// Writes a file of this process in $TMPDIR, with a name that the tools take for one of theirs.
std::string fileOf(const void* bytes, std::size_t size, const std::string& extension) {
  const char* const directory = std::getenv("TMPDIR");
  const std::string path = std::string(directory == nullptr ? "/tmp" : directory) + "/fuzz_" +
                           std::to_string(getpid()) + extension;
  unlink(path.c_str());  // to overwrite a file waits for the disk
  std::ofstream file(path, std::ios::binary);
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  require(file.flush().good(), "a file can be written");
  return path;
}

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void readAsCloud(const std::string& path) {
  const auto read = [&] {
    return readCloud(path, [](double fraction) {
      require(fraction >= 0.0 && fraction <= 1.0, "progress is in [0, 1]");
    });
  };
  const PointData data = read();
  const std::size_t count = data.points.size();
  require(count > 0, "there are points");
  require(data.normals.empty() || data.normals.size() == count, "each point has a normal");
  require(data.colors.empty() || data.colors.size() == count, "each point has a colour");
  require(!data.has_alpha || !data.colors.empty(), "there is no alpha without colours");
  const PointData again = read();
  require(sameBytes(again.points, data.points) && sameBytes(again.normals, data.normals) &&
              sameBytes(again.colors, data.colors),
          "the same file gives the same points");
}

/// The mesh of a cloud on a sphere, one point of it twice and one not finite: these are no vertices
/// of their own.
CloudReconstruction meshedSphere(int count) {
  const spherical_param::Positions sphere = spherical_param::test::spiralSphere(count);
  std::ostringstream points;
  points << sphere.transpose() << '\n' << sphere.col(0).transpose() << "\nnan 0 0\n";
  const std::string file = fileOf(points.str().data(), points.str().size(), ".xyz");
  Console console(Detail::Nothing);
  CloudReconstruction cloud;
  reconstructCloud(file, {}, console, cloud);
  return cloud;
}

void readAsPointPairs(const std::string& path) {
  static const CloudReconstruction first = meshedSphere(60);
  static const CloudReconstruction second = meshedSphere(40);
  for (const FilePair& pair : readPointPairs(path, first, second)) {
    require(pair.line > 0, "a pair has its line");
    for (std::size_t side = 0; side < 2; ++side) {
      const CloudReconstruction& cloud = side == 0 ? first : second;
      require(pair.points[side] >= 0 &&
                  pair.points[side] < static_cast<int>(cloud.data->points.size()),
              "a pair is of points");
      require(pair.vertices[side] >= -1 &&
                  pair.vertices[side] < static_cast<int>(cloud.result.surface().vertexCount()),
              "a point is a vertex or none");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const std::string extension = FUZZED_EXTENSION;
  const std::string file = fileOf(bytes, size, extension);
  try {
    if (extension == ".txt")
      readAsPointPairs(file);
    else
      readAsCloud(file);
  } catch (const ToolError& error) {
    require(std::strlen(error.what()) > 0 && !error.remedy().empty(),
            "an error has its cause and its remedy");
  }
  return 0;
}
