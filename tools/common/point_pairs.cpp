#include "common/point_pairs.h"

#include "common/errors.h"
#include "common/input_file.h"
#include "common/text.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace spherical_param::tools {
namespace {

/// Larger files are no lists of pairs.
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 26U;

/// The vertex that is nearest to a place, by its number in the file.
int nearestTo(const Eigen::Vector3d& place, const CloudReconstruction& cloud) {
  const std::vector<Index>& vertices = cloud.surface().input_of_vertex;
  const auto distance = [&](Index vertex) {
    return (cloud.data->position(static_cast<std::size_t>(vertex)) - place).squaredNorm();
  };
  return *std::min_element(vertices.begin(), vertices.end(),
                           [&](Index a, Index b) { return distance(a) < distance(b); });
}

}  // namespace

std::vector<FilePair> readPointPairs(const std::string& path, const CloudReconstruction& first,
                                     const CloudReconstruction& second) {
  InputFile file(path);
  if (file.size() > most_bytes) {
    failContent(path,
                "it has " + std::to_string(file.size()) + " bytes, which are no list of pairs");
  }
  std::vector<FilePair> pairs;
  Words words;
  for (std::string_view line; file.nextLine(line);) {
    split(withoutRemark(line), " \t\r,;", words);
    if (words.empty()) {
      continue;
    }
    const std::string place = inQuotes(path) + ", line " + std::to_string(file.lineNumber()) + ": ";
    const auto require = [&](bool holds, const std::string& what) {
      if (!holds) {
        throw Failure(place + what + " make no pair",
                      "give two numbers of points, from 0, or six coordinates");
      }
    };
    const bool are_numbers = words.size() == 2;
    require(are_numbers || words.size() == 6, counted(words.size(), "word"));
    std::vector<double> values;
    for (const std::string_view word : words) {
      const std::optional<double> value = toReal(word);
      require(value && std::isfinite(*value) && (!are_numbers || toInteger(word)),
              "words like " + inQuotes(word));
      values.push_back(*value);
    }
    FilePair& pair = pairs.emplace_back();
    pair.line = file.lineNumber();
    for (std::size_t side = 0; side < 2; ++side) {
      const CloudReconstruction& cloud = side == 0 ? first : second;
      const std::size_t count = cloud.data->points.size();
      if (are_numbers && !(values[side] >= 0.0 && values[side] < static_cast<double>(count))) {
        throw Failure(place + "unknown point " + inQuotes(words[side]) + " in a cloud of " +
                          std::to_string(count),
                      "give numbers from 0 to " + std::to_string(count - 1));
      }
      pair.points[side] = are_numbers ? static_cast<int>(values[side])
                                      : nearestTo(Eigen::Vector3d(&values[3 * side]), cloud);
      pair.vertices[side] = cloud.surface().vertexOf(pair.points[side]);
    }
  }
  return pairs;
}

}  // namespace spherical_param::tools
