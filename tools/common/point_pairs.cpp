#include "common/point_pairs.h"

#include "common/errors.h"
#include "common/input_file.h"
#include "common/numbers.h"
#include "common/text.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

namespace spherical_param::tools {
namespace {

/// Larger files are no lists of pairs.
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 26U;

class PairReader {
public:
  PairReader(const std::string& path, const CloudReconstruction& first,
             const CloudReconstruction& second)
      : path_(path), clouds_{&first, &second} {}

  FilePair read(std::size_t line, const std::vector<std::string_view>& words) const {
    FilePair pair;
    pair.line = line;
    if (words.size() != 2 && words.size() != 6) {
      fail(line, counted(words.size(), "word"));
    }
    for (std::size_t side = 0; side < 2; ++side) {
      pair.points[side] = words.size() == 2 ? numberOf(line, words[side], *clouds_[side])
                                            : nearestTo(line, &words[3 * side], *clouds_[side]);
      pair.vertices[side] = clouds_[side]->surface().vertexOf(pair.points[side]);
    }
    return pair;
  }

private:
  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    throw Failure(inQuotes(path_) + ", line " + std::to_string(line) + ": " + what +
                      " make no pair",
                  "give two numbers of points, from 0, or six coordinates");
  }

  int numberOf(std::size_t line, std::string_view word, const CloudReconstruction& cloud) const {
    const std::optional<std::int64_t> number = toInteger(word);
    if (!number) {
      fail(line, "words like " + inQuotes(word));
    }
    const std::size_t count = cloud.data->points.size();
    if (*number < 0 || static_cast<std::uint64_t>(*number) >= count) {
      throw Failure(inQuotes(path_) + ", line " + std::to_string(line) + ": unknown point " +
                        inQuotes(word) + " in a cloud of " + std::to_string(count),
                    "give numbers from 0 to " + std::to_string(count - 1));
    }
    return static_cast<int>(*number);
  }

  /// Of the points that are vertices.
  int nearestTo(std::size_t line, const std::string_view* words,
                const CloudReconstruction& cloud) const {
    Eigen::Vector3d place;
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> value = toReal(words[axis]);
      if (!value || !std::isfinite(*value)) {
        fail(line, "words like " + inQuotes(words[axis]));
      }
      place[axis] = *value;
    }
    int nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const Index index : cloud.surface().input_of_vertex) {
      const double distance =
          (cloud.data->position(static_cast<std::size_t>(index)) - place).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest = index;
      }
    }
    return nearest;
  }

  const std::string& path_;
  std::array<const CloudReconstruction*, 2> clouds_;
};

}  // namespace

std::vector<FilePair> readPointPairs(const std::string& path, const CloudReconstruction& first,
                                     const CloudReconstruction& second) {
  const std::uint64_t size = checkInputFile(path);
  if (size > most_bytes) {
    failContent(path, "it has " + std::to_string(size) + " bytes, which are no list of pairs");
  }
  const PairReader reader(path, first, second);
  std::vector<FilePair> pairs;
  Words words;
  forEachLine(path, {}, [&](std::size_t line, std::string_view content) {
    split(withoutRemark(content), " \t\r,;", words);
    if (!words.empty()) {
      pairs.push_back(reader.read(line, words));
    }
  });
  return pairs;
}

}  // namespace spherical_param::tools
