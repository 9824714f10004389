// Every way in which the tools read a file, of any content. FUZZED_EXTENSION says which: a cloud,
// or pairs of points of two clouds (.txt).

#include "common/cloud_reader.h"
#include "common/cloud_reconstruction.h"
#include "common/errors.h"
#include "common/point_pairs.h"
#include "fuzz_input.h"

#include <sys/mman.h>
#include <unistd.h>

#include <sstream>

namespace {

using namespace spherical_param::tools;
using fuzz::require;

/// A file in memory with a name that the tools take for one of theirs: a link in $TMPDIR.
class MemoryFile {
public:
  explicit MemoryFile(const std::string& extension) : descriptor_(memfd_create("input", 0)) {
    const char* const directory = std::getenv("TMPDIR");
    const std::string process = std::to_string(getpid());
    path_ = std::string(directory == nullptr ? "/tmp" : directory) + "/fuzz_" + process + extension;
    unlink(path_.c_str());
    const std::string file = "/proc/" + process + "/fd/" + std::to_string(descriptor_);
    require(descriptor_ >= 0 && symlink(file.c_str(), path_.c_str()) == 0, "a file can be made");
  }
  ~MemoryFile() {
    unlink(path_.c_str());
    close(descriptor_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& path() const { return path_; }
  void fill(const void* bytes, std::size_t size) {
    require(ftruncate(descriptor_, 0) == 0 &&
                pwrite(descriptor_, bytes, size, 0) == static_cast<ssize_t>(size),
            "a file can be filled");
  }

private:
  int descriptor_;
  std::string path_;
};

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
  MemoryFile file(".xyz");
  file.fill(points.str().data(), points.str().size());
  Console console(Detail::Nothing);
  CloudReconstruction cloud;
  reconstructCloud(file.path(), {}, console, cloud);
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
  static MemoryFile file(extension);
  file.fill(bytes, size);
  try {
    if (extension == ".txt")
      readAsPointPairs(file.path());
    else
      readAsCloud(file.path());
  } catch (const ToolError& error) {
    require(std::strlen(error.what()) > 0 && !error.remedy().empty(),
            "an error has its cause and its remedy");
  }
  return 0;
}
