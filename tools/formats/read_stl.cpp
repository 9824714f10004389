#include "formats/formats.h"
#include "formats/text_lines.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <unordered_set>

namespace spherical_param::tools {

/// STL, text or binary: the corners of the triangles, each place once.
PointData readStl(InputFile& file, const std::vector<std::string>& /*columns*/) {
  constexpr std::size_t header_size = 84;  // a title, and the number of triangles
  constexpr std::size_t record_size = 50;  // a normal, three corners, and two bytes
  const std::string header(file.peek(header_size));
  std::uint32_t triangles = 0;
  if (header.size() == header_size) {
    std::memcpy(&triangles, &header[header_size - sizeof triangles], sizeof triangles);
  }
  const std::uint64_t size = header_size + record_size * std::uint64_t{triangles};
  PointData data;
  const auto hash = [](const Point& point) {
    return std::hash<std::string_view>()({reinterpret_cast<const char*>(&point), sizeof point});
  };
  const auto are_same = [](const Point& a, const Point& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
  };
  std::unordered_set<Point, decltype(hash), decltype(are_same)> known(0, hash, are_same);
  std::size_t corners = 0;
  const auto add = [&](Point corner) {
    ++corners;
    for (double& coordinate : corner) {
      coordinate += 0.0;  // -0 is 0
    }
    if (known.insert(corner).second) {
      data.points.push_back(corner);
    }
  };
  // The title of a binary file may begin as text does.
  if (lowerCase(header.substr(0, 5)) == "solid" && size != file.size()) {
    Words words;
    for (std::string_view line; file.nextLine(line);) {
      split(line, " \t\r", words);
      if (!words.empty() && lowerCase(words[0]) == "vertex") {
        add(requireThreeNumbers(file, words));
      }
    }
  } else {
    requireBytes(file, static_cast<double>(size));
    file.skip(header_size);
    for (std::uint32_t t = 0; t < triangles; ++t) {
      const char* const record = file.take(record_size);
      if (record == nullptr) {
        failContent(file.path(), "it is shorter than its header says");
      }
      std::array<float, 12> numbers{};
      std::memcpy(numbers.data(), record, sizeof numbers);
      for (std::size_t c = 3; c < numbers.size(); c += 3) {
        add({numbers[c], numbers[c + 1], numbers[c + 2]});
      }
    }
  }
  if (corners == 0 || corners % 3 != 0) {
    failContent(file.path(),
                corners == 0 ? "it has no points" : "its last triangle is not complete");
  }
  return data;
}

}  // namespace spherical_param::tools
