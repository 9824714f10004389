#include "common/vtk_clouds.h"

#include "common/header_checks.h"
#include "common/input_file.h"
#include "common/numbers.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

/// How an array of numbers is stored.
struct NumberType {
  std::string_view name;
  char kind;         ///< F real, I signed, U unsigned
  std::size_t size;  ///< bytes in a binary file
};

constexpr std::array<NumberType, 15> number_types = {{{"float", 'F', 4},
                                                      {"double", 'F', 8},
                                                      {"char", 'I', 1},
                                                      {"signed_char", 'I', 1},
                                                      {"unsigned_char", 'U', 1},
                                                      {"short", 'I', 2},
                                                      {"unsigned_short", 'U', 2},
                                                      {"int", 'I', 4},
                                                      {"unsigned_int", 'U', 4},
                                                      {"long", 'I', 8},
                                                      {"unsigned_long", 'U', 8},
                                                      {"vtktypeint64", 'I', 8},
                                                      {"vtktypeuint64", 'U', 8},
                                                      {"vtkidtype", 'I', 4},
                                                      {"long_long", 'I', 8}}};
constexpr NumberType byte_type = {"unsigned_char", 'U', 1};
constexpr NumberType int_type = {"int", 'I', 4};
constexpr NumberType float_type = {"float", 'F', 4};

/// Takes the numbers of one tuple of an array.
using TakeTuple = std::function<void(std::size_t tuple, const std::vector<double>& numbers)>;

std::array<double, 3> triple(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

class VtkReader {
public:
  VtkReader(const std::string& path, const FileProgress& progress)
      : path_(path), reader_(path, 0, progress) {}

  PointData read() {
    readHeader();
    std::string word;
    while (nextKeyword(word)) {
      readSection(word);
    }
    if (data_.points.empty()) {
      failContent(path_, "it has no points");
    }
    if (grid_points_ && *grid_points_ != static_cast<double>(data_.points.size())) {
      fail();
    }
    data_.colors = std::move(colors_.values);
    data_.has_alpha = !data_.colors.empty() && colors_.has_alpha;
    return std::move(data_);
  }

private:
  /// Colours that were found, and how much they are what is looked for.
  struct FoundColors {
    int rank = 0;  ///< 0: none
    bool has_alpha = false;
    std::vector<Color> values;
  };

  [[noreturn]] void fail() const { failContent(path_, "it is broken or not complete"); }

  // --- words and bytes ---

  bool nextLine() {
    std::string_view line;
    next_word_ = 0;
    words_.clear();
    if (!reader_.nextLine(line)) {
      return false;
    }
    split(line, " \t\r", words_);
    return true;
  }

  bool findWord() {
    while (next_word_ >= words_.size()) {
      if (!nextLine()) {
        return false;
      }
    }
    return true;
  }

  /// The next word, until the next call of anything.
  std::string_view word() {
    if (!findWord()) {
      fail();
    }
    return words_[next_word_++];
  }

  bool nextKeyword(std::string& keyword) {
    if (!findWord()) {
      return false;
    }
    keyword = lowerCase(words_[next_word_++]);
    return true;
  }

  std::uint64_t count() {
    constexpr std::int64_t limit = std::int64_t{1} << 40;
    const std::optional<std::int64_t> number = toInteger(word());
    if (!number || *number < 0 || *number > limit) {
      fail();
    }
    return static_cast<std::uint64_t>(*number);
  }

  std::size_t components() {
    const std::uint64_t number = count();
    if (number > 65536) {
      fail();
    }
    return static_cast<std::size_t>(number);
  }

  /// Bytes of the words of this line that are left.
  std::uint64_t lengthOfWords() const {
    std::uint64_t length = 0;
    for (std::size_t i = next_word_; i < words_.size(); ++i) {
      length += words_[i].size() + 1;
    }
    return length;
  }

  /// What is behind a keyword is text; bytes begin on the line after it.
  void endLine() { next_word_ = words_.size(); }

  // --- arrays ---

  double numberOf(const char* bytes, const NumberType& type) const {
    // The most significant byte comes first. What is before it is filled as it has to be of a
    // negative number.
    const bool is_negative = type.kind == 'I' && (static_cast<std::uint8_t>(bytes[0]) & 0x80U) != 0;
    std::uint64_t bits = is_negative ? ~std::uint64_t{0} : std::uint64_t{0};
    for (std::size_t b = 0; b < type.size; ++b) {
      bits = bits << 8U | static_cast<std::uint8_t>(bytes[b]);
    }
    if (type.kind == 'F' && type.size == 8) {
      double value = 0.0;
      std::memcpy(&value, &bits, sizeof value);
      return value;
    }
    if (type.kind == 'F') {
      const auto low = static_cast<std::uint32_t>(bits);
      float value = 0.0F;
      std::memcpy(&value, &low, sizeof value);
      return static_cast<double>(value);
    }
    if (type.kind == 'U') {
      return static_cast<double>(bits);
    }
    std::int64_t value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return static_cast<double>(value);
  }

  double numberOf(std::string_view text, const NumberType& type) const {
    const std::optional<double> value = toReal(text);
    if (!value) {
      fail();
    }
    return type.kind == 'F' && type.size == 4 ? static_cast<double>(static_cast<float>(*value))
                                              : *value;
  }

  void skipNumbers(const NumberType& type, std::uint64_t values) {
    if (is_binary_) {
      endLine();
      if (!reader_.skip(values * type.size)) {
        fail();
      }
      return;
    }
    for (std::uint64_t i = 0; i < values; ++i) {
      numberOf(word(), type);
    }
  }

  void readNumbers(const NumberType& type, std::uint64_t tuples, std::size_t components,
                   const TakeTuple& take) {
    std::vector<double> numbers(components);
    if (is_binary_) {
      endLine();
    }
    for (std::uint64_t i = 0; i < tuples; ++i) {
      const char* const bytes = is_binary_ ? reader_.take(components * type.size) : nullptr;
      if (is_binary_ && bytes == nullptr) {
        fail();
      }
      for (std::size_t c = 0; c < components; ++c) {
        numbers[c] = is_binary_ ? numberOf(bytes + c * type.size, type) : numberOf(word(), type);
      }
      take(static_cast<std::size_t>(i), numbers);
    }
  }

  std::optional<NumberType> findType(const std::string& name) const {
    const auto* const found =
        std::find_if(number_types.begin(), number_types.end(),
                     [&](const NumberType& type) { return type.name == name; });
    return found == number_types.end() ? std::nullopt : std::optional(*found);
  }

  NumberType numberType() {
    const std::optional<NumberType> type = findType(lowerCase(word()));
    if (!type) {
      fail();
    }
    return *type;
  }

  void skipStrings(std::uint64_t values) {
    endLine();
    for (std::uint64_t i = 0; i < values; ++i) {
      if (!is_binary_) {
        if (!nextLine()) {
          fail();
        }
        endLine();
        continue;
      }
      // The two highest bits tell how many bytes the length has: 8, 4, 2 or 1.
      const char* bytes = reader_.take(1);
      if (bytes == nullptr) {
        fail();
      }
      const auto first = static_cast<std::uint8_t>(*bytes);
      std::uint64_t length = first & 0x3fU;
      const std::size_t more = (std::size_t{8} >> (first >> 6U)) - 1;
      bytes = reader_.take(more);
      if (bytes == nullptr) {
        fail();
      }
      for (std::size_t b = 0; b < more; ++b) {
        length = length << 8U | static_cast<std::uint8_t>(bytes[b]);
      }
      if (!reader_.skip(length)) {
        fail();
      }
    }
  }

  void skipArray(const std::string& type, std::uint64_t values) {
    if (type == "bit") {
      // Bytes are filled, text has a digit for each.
      skipNumbers(byte_type, is_binary_ ? (values + 7) / 8 : values);
    } else if (type == "string" || type == "utf8_string") {
      skipStrings(values);
    } else if (const std::optional<NumberType> known = findType(type)) {
      skipNumbers(*known, values);
    } else {
      fail();
    }
  }

  /// Names and units, up to an empty line.
  void skipMetadata() {
    endLine();
    while (nextLine() && !words_.empty()) {
    }
    endLine();
  }

  // --- sections ---

  void readHeader() {
    // checkVtkHeader() has seen these lines: "# vtk DataFile Version 5.1", a title, the storage.
    if (!nextLine() || words_.size() < 5) {
      fail();
    }
    const std::optional<double> version = toReal(words_[4]);
    if (!version || !(*version >= 1.0 && *version < 6.0)) {
      failReading(path_, "its version is " + inQuotes(words_[4]),
                  "save it as version 5.1 or before");
    }
    major_version_ = static_cast<int>(*version);
    if (!nextLine() || !nextLine()) {
      fail();
    }
    is_binary_ = lowerCase(word()) == "binary";
    endLine();
  }

  void readSection(const std::string& keyword) {
    if (keyword == "dataset") {
      const std::string kind = lowerCase(word());
      if (has_dataset_ ||
          (kind != "polydata" && kind != "unstructured_grid" && kind != "structured_grid")) {
        fail();
      }
      has_dataset_ = true;
    } else if (keyword == "metadata") {
      skipMetadata();
    } else if (keyword == "field") {
      readFields();
    } else if (!has_dataset_) {
      fail();
    } else if (keyword == "dimensions") {
      const std::array<std::uint64_t, 3> sides = {count(), count(), count()};
      grid_points_ = static_cast<double>(sides[0]) * static_cast<double>(sides[1]) *
                     static_cast<double>(sides[2]);
    } else if (keyword == "points") {
      readPoints();
    } else if (keyword == "vertices" || keyword == "lines" || keyword == "polygons" ||
               keyword == "triangle_strips" || keyword == "cells") {
      skipCells();
    } else if (keyword == "cell_types") {
      skipNumbers(int_type, count());
    } else if (keyword == "point_data") {
      tuples_ = count();
      of_points_ = true;
      if (tuples_ != data_.points.size()) {
        fail();
      }
    } else if (keyword == "cell_data") {
      tuples_ = count();
      of_points_ = false;
    } else if (tuples_) {
      readAttribute(keyword);
    } else {
      fail();
    }
  }

  void readPoints() {
    const std::int64_t points = requireCount(path_, word(), "points");
    const std::string name = lowerCase(word());
    if (!data_.points.empty()) {
      fail();
    }
    if (points == 0) {
      failContent(path_, "it has no points");
    }
    const std::optional<NumberType> type = findType(name);
    if (!type || type->kind != 'F') {
      failReading(path_, "its points are of type " + inQuotes(name),
                  "save them as float or double");
    }
    // A digit and what separates it from the next, which the last one lacks, or bytes.
    const double each = is_binary_ ? static_cast<double>(type->size) : 2.0;
    requireBytes(path_, 3.0 * each * static_cast<double>(points) - (is_binary_ ? 0.0 : 1.0),
                 reader_.left() + (is_binary_ ? 0 : lengthOfWords()));
    data_.points.reserve(static_cast<std::size_t>(points));
    readNumbers(*type, static_cast<std::uint64_t>(points), 3,
                [this](std::size_t, const std::vector<double>& numbers) {
                  data_.addPoint(triple(numbers));
                });
  }

  /// Up to version 4: the number of cells, then that of the integers, which follow. From 5 on:
  /// those of two arrays, each with a title of its own.
  void skipCells() {
    const std::uint64_t first = count();
    const std::uint64_t second = count();
    if (major_version_ < 5) {
      skipNumbers(int_type, second);
      return;
    }
    if (first == 0) {
      return;
    }
    for (const auto& [title, values] :
         {std::pair<std::string_view, std::uint64_t>{"offsets", first}, {"connectivity", second}}) {
      if (lowerCase(word()) != title) {
        fail();
      }
      skipArray(lowerCase(word()), values);
    }
  }

  void readAttribute(const std::string& keyword) {
    if (keyword == "scalars") {
      readScalars();
      return;
    }
    const std::string name(word());
    if (keyword == "color_scalars") {
      // Text has shares of 1.
      readColors(components(), is_binary_ ? byte_type : float_type, is_binary_ ? 1.0 : 255.0, 4);
    } else if (keyword == "lookup_table") {
      skipNumbers(is_binary_ ? byte_type : float_type, 4 * count());
    } else if (keyword == "normals") {
      readNormals();
    } else if (keyword == "texture_coordinates") {
      const std::uint64_t dimension = components();
      skipArray(lowerCase(word()), *tuples_ * dimension);
    } else {
      static constexpr std::array<std::pair<std::string_view, std::uint64_t>, 6> others = {
          {{"vectors", 3},
           {"tensors", 9},
           {"tensors6", 6},
           {"global_ids", 1},
           {"pedigree_ids", 1},
           {"edge_flags", 1}}};
      const auto* const found = std::find_if(
          others.begin(), others.end(), [&](const auto& other) { return other.first == keyword; });
      if (found == others.end()) {
        fail();
      }
      skipArray(lowerCase(word()), *tuples_ * found->second);
    }
  }

  void readScalars() {
    word();
    const std::string type = lowerCase(word());
    std::size_t each = 1;
    if (next_word_ < words_.size()) {
      each = components();
    }
    if (lowerCase(word()) != "lookup_table") {
      fail();
    }
    word();
    if (type == byte_type.name) {
      readColors(each, byte_type, 1.0, 4);
    } else {
      skipArray(type, *tuples_ * each);
    }
  }

  void readNormals() {
    const NumberType type = numberType();
    if (!of_points_ || !data_.normals.empty()) {
      skipNumbers(type, 3 * *tuples_);
      return;
    }
    data_.normals.reserve(data_.points.size());
    readNumbers(type, *tuples_, 3, [this](std::size_t, const std::vector<double>& numbers) {
      data_.normals.push_back(toPoint(triple(numbers)));
    });
  }

  /// Takes an array of 3 or 4 channels for the colours if those found before have a lower rank.
  void readColors(std::size_t channels, const NumberType& type, double scale, int rank) {
    if (!of_points_ || (channels != 3 && channels != 4) || rank <= colors_.rank) {
      skipNumbers(type, *tuples_ * channels);
      return;
    }
    colors_.rank = rank;
    colors_.has_alpha = channels == 4;
    colors_.values.assign(data_.points.size(), {0, 0, 0, 255});
    readNumbers(
        type, *tuples_, channels, [&](std::size_t tuple, const std::vector<double>& numbers) {
          for (std::size_t c = 0; c < channels; ++c) {
            // The comparison also sorts out what is not a number.
            const double value = numbers[c] >= 0.0 ? std::min(numbers[c] * scale, 255.0) : 0.0;
            colors_.values[tuple][c] = static_cast<std::uint8_t>(std::lround(value));
          }
        });
  }

  void readFields() {
    word();
    const std::uint64_t arrays = count();
    std::string name;
    for (std::uint64_t i = 0; i < arrays; ++i) {
      name = word();
      if (lowerCase(name) == "metadata") {
        skipMetadata();
        name = word();
      }
      if (name == "NULL_ARRAY") {
        continue;
      }
      const std::size_t each = components();
      const std::uint64_t tuples = count();
      const std::string type = lowerCase(word());
      const int rank = name == "Colors" ? 3 : name == "RGB" ? 2 : name == "RGBA" ? 1 : 0;
      if (tuples_ && of_points_ && tuples == *tuples_ && rank > 0 && type == byte_type.name) {
        readColors(each, byte_type, 1.0, rank);
      } else {
        skipArray(type, tuples * each);
      }
    }
  }

  const std::string& path_;
  BlockReader reader_;
  std::vector<std::string_view> words_;
  std::size_t next_word_ = 0;
  int major_version_ = 0;
  bool is_binary_ = false;
  bool has_dataset_ = false;
  bool of_points_ = false;
  std::optional<double> grid_points_;
  std::optional<std::uint64_t> tuples_;  ///< of the data of points or cells, once there are any
  PointData data_;
  FoundColors colors_;
};

}  // namespace

PointData readVtk(const std::string& path, const FileProgress& progress) {
  checkVtkHeader(path);
  return VtkReader(path, progress).read();
}

}  // namespace spherical_param::tools
