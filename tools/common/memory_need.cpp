#include "common/memory_need.h"

#include "common/block_reader.h"
#include "common/console.h"
#include "common/errors.h"
#include "common/file_formats.h"
#include "common/header_checks.h"
#include "common/input_file.h"
#include "common/numbers.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <fstream>
#include <string_view>

namespace spherical_param::tools {
namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;
/// The program, its libraries and what does not grow with the cloud.
constexpr std::uint64_t fixed_need = 64 * mebibyte;

/// What an option adds for each point [bytes], and for each neighbour of a point.
struct Need {
  std::uint64_t point;
  std::uint64_t neighbor;
};
constexpr Need delaunay_need = {768, 8};
constexpr Need nearest_need = {512, 32};
constexpr Need newton_need = {1024, 48};
constexpr Need qhull_need = {640, 0};

/// The lines of a file that begin so. Keeps none of them: what is no text may be one line.
std::uint64_t linesOf(const std::string& path, std::string_view beginning) {
  BlockReader reader(path, 0, {});
  std::uint64_t count = 0;
  std::size_t matched = 0;  // of the beginning, in this line
  bool is_decided = false;
  for (std::string_view block = reader.takeSome(); !block.empty(); block = reader.takeSome()) {
    while (!block.empty()) {
      while (!is_decided && matched < beginning.size() && !block.empty()) {
        is_decided = block.front() != beginning[matched];
        if (!is_decided) {
          ++matched;
          block.remove_prefix(1);
        }
      }
      if (!is_decided && matched == beginning.size()) {
        ++count;
        is_decided = true;
      }
      const std::size_t end = block.find('\n');
      if (end == std::string_view::npos) {
        break;
      }
      block.remove_prefix(end + 1);
      matched = 0;
      is_decided = false;
    }
  }
  return count;
}

/// The number in a file of the kernel's, none for "max".
std::optional<std::uint64_t> numberIn(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  return file >> number ? std::optional(number) : std::nullopt;
}

std::optional<std::uint64_t> availableMemory() {
  std::ifstream file("/proc/meminfo");
  for (std::string word; file >> word;) {
    std::uint64_t kibibytes = 0;
    if (word == "MemAvailable:" && file >> kibibytes) {
      return kibibytes * 1024;
    }
  }
  return std::nullopt;
}

/// The least that a control group of this program allows.
std::optional<std::uint64_t> groupLimit() {
  std::optional<std::uint64_t> limit = numberIn("/sys/fs/cgroup/memory/memory.limit_in_bytes");
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (line.rfind("0::", 0) != 0) {
      continue;
    }
    std::string group = line.substr(3);
    for (;;) {
      const std::optional<std::uint64_t> found = numberIn("/sys/fs/cgroup" + group + "/memory.max");
      if (found) {
        limit = std::min(*found, limit.value_or(*found));
      }
      const std::size_t slash = group.rfind('/');
      if (slash == std::string::npos) {
        break;
      }
      group.erase(slash);
    }
  }
  return limit;
}

}  // namespace

std::optional<std::uint64_t> pointCountOf(const std::string& path) {
  const std::optional<FileFormat> format = formatOf(path);
  if (!format) {
    return std::nullopt;
  }
  try {
    const std::uint64_t size = checkInputFile(path);
    switch (*format) {
    case FileFormat::Pcd:
      return checkPcdHeader(path, size).points;
    case FileFormat::Ply:
      return checkPlyHeader(path, size).points;
    case FileFormat::Vtk:
      return mostVtkPoints(path, size);
    case FileFormat::Xyz:
      return linesOf(path, "");
    case FileFormat::Obj:
      return linesOf(path, "v ");
    case FileFormat::Stl:
    case FileFormat::Off:
      return std::nullopt;
    }
  } catch (const std::exception&) {
    // Whoever reads it for its points says what is wrong.
    return std::nullopt;
  }
  return std::nullopt;
}

std::uint64_t memoryNeed(std::uint64_t points, const ReconstructionSettings& settings) {
  const Options& options = settings.options;
  const auto neighbors = static_cast<std::uint64_t>(neighborsToSearch(options));
  std::uint64_t each = 0;
  const auto add = [&each, neighbors](bool is_used, const Need& need) {
    each += is_used ? need.point + need.neighbor * neighbors : 0;
  };
  add(options.graph == GraphMethod::LocalDelaunay, delaunay_need);
  add(options.graph == GraphMethod::NearestNeighbors, nearest_need);
  add(options.tolerance && !isIterative(options), newton_need);
  add(options.hull == TriangulationMethod::Qhull, qhull_need);
  // A cloud has fewer than 2^30 points, and none has more neighbours than there are others.
  return fixed_need + points * each;
}

std::optional<std::uint64_t> memoryToSpare() {
  const std::optional<std::uint64_t> available = availableMemory();
  const std::optional<std::uint64_t> limit = groupLimit();
  if (!available && !limit) {
    return std::nullopt;
  }
  return std::min(available.value_or(*limit), limit.value_or(*available)) / 5 * 4;
}

std::uint64_t parseBytes(const std::string& option, const std::string& text) {
  constexpr std::string_view units = "kmgt";
  std::string number = lowerCase(text);
  if (number.size() > 2 && number.compare(number.size() - 2, 2, "ib") == 0) {
    number.resize(number.size() - 2);
  } else if (number.size() > 1 && number.back() == 'b') {
    number.pop_back();
  }
  const std::size_t unit = number.empty() ? std::string_view::npos : units.find(number.back());
  double factor = 1.0;
  if (unit != std::string_view::npos) {
    factor = std::pow(1024.0, static_cast<double>(unit + 1));
    number.pop_back();
  }
  const std::optional<double> value = toReal(number);
  if (!value || !(*value * factor >= 1.0) || *value * factor > 1e18) {
    throw UsageError("option -" + option + ": " + inQuotes(text) + " is no size",
                     "give -" + option + " 800M, 4G or a number of bytes");
  }
  return static_cast<std::uint64_t>(*value * factor);
}

std::string inBytes(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> units = {" bytes", " KB", " MB", " GB", " TB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 999.5 && unit + 1 < units.size()) {
    value /= 1024.0;
    ++unit;
  }
  return formatted(value, 3) + units[unit];
}

}  // namespace spherical_param::tools
