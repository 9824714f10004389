// Clouds in files of any content. FUZZED_EXTENSION says which reader is meant.

#include "common/cloud_reader.h"
#include "common/errors.h"
#include "fuzz_file.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace spherical_param::tools;
using stress::require;

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

std::optional<PointData> readOrRefuse(const std::string& path) {
  double last = 0.0;
  try {
    return readCloud(path, [&last](double share) {
      require(share >= 0.0 && share <= 1.0, "progress is in [0, 1]");
      last = share;
    });
  } catch (const ToolError& error) {
    require(std::strlen(error.what()) > 0 && !error.remedy().empty(), "a refusal has its reason");
    return std::nullopt;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const std::string extension = FUZZED_EXTENSION;
  static stress::FuzzFile file(extension);
  file.fill(bytes, size);
  const std::optional<PointData> data = readOrRefuse(file.path());
  if (!data) {
    return 0;
  }
  const std::size_t count = data->points.size();
  require(count > 0, "there are points");
  require(data->normals.empty() || data->normals.size() == count, "a normal for each point");
  require(data->colors.empty() || data->colors.size() == count, "a colour for each point");
  require(!data->has_alpha || !data->colors.empty(), "no alpha without colours");
  const std::optional<PointData> again = readOrRefuse(file.path());
  require(again && sameBytes(again->points, data->points) &&
              sameBytes(again->normals, data->normals) && sameBytes(again->colors, data->colors),
          "the same file, the same points");
  return 0;
}
