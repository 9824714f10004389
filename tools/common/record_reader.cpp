#include "common/record_reader.h"

#include "common/input_file.h"
#include "common/lzf.h"
#include "common/numbers.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

using Fields = std::vector<RecordField>;

/// A word as a number without sign; too large if it is none.
std::uint64_t toCount(std::string_view word) {
  const double number = toReal(word).value_or(-1.0);
  return number >= 0.0 && number < 1e15 ? static_cast<std::uint64_t>(number)
                                        : std::numeric_limits<std::uint64_t>::max();
}

[[noreturn]] void failBroken(const std::string& path) {
  failContent(path, "it is broken or not complete");
}

const RecordField* findField(const Fields& fields, const std::string& name) {
  const auto found = std::find_if(fields.begin(), fields.end(),
                                  [&](const RecordField& field) { return field.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

/// Three fields of real numbers.
using RealFields = std::array<const RecordField*, 3>;

std::optional<RealFields> findReals(const Fields& fields, const std::array<const char*, 3>& names) {
  RealFields reals{};
  for (std::size_t d = 0; d < 3; ++d) {
    reals[d] = findField(fields, names[d]);
    if (reals[d] == nullptr || reals[d]->type != 'F') {
      return std::nullopt;
    }
  }
  return reals;
}

/// A point as the file has it: bytes, or the numbers of a line.
class Record {
public:
  explicit Record(RecordStorage storage) : storage_(storage) {}

  void setBytes(const char* bytes) { bytes_ = bytes; }
  std::vector<double>& numbers() { return numbers_; }

  double real(const RecordField& field) const {
    if (storage_ == RecordStorage::Text) {
      const double value = numbers_[field.column];
      return field.size == 4 ? static_cast<double>(static_cast<float>(value)) : value;
    }
    return field.size == 8 ? load<double>(field) : static_cast<double>(load<float>(field));
  }
  std::array<double, 3> reals(const RealFields& fields) const {
    return {real(*fields[0]), real(*fields[1]), real(*fields[2])};
  }
  std::uint8_t byte(const RecordField& field) const {
    return storage_ == RecordStorage::Text
               ? static_cast<std::uint8_t>(toInteger(numbers_[field.column]))
               : load<std::uint8_t>(field);
  }
  /// 32 bits, whatever their meaning.
  std::uint32_t word(const RecordField& field) const {
    if (storage_ != RecordStorage::Text) {
      return load<std::uint32_t>(field);
    }
    if (field.type != 'F') {
      return static_cast<std::uint32_t>(toInteger(numbers_[field.column]));
    }
    const auto value = static_cast<float>(numbers_[field.column]);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
  }

private:
  static std::int64_t toInteger(double number) {
    constexpr double largest = 4294967295.0;
    // The comparison also sorts out what is not a number.
    return number >= -largest && number <= largest ? static_cast<std::int64_t>(number) : 0;
  }

  template <typename Number>
  Number load(const RecordField& field) const {
    std::array<char, sizeof(Number)> bytes{};
    std::memcpy(bytes.data(), bytes_ + field.offset, bytes.size());
    if (storage_ == RecordStorage::BigEndian) {
      std::reverse(bytes.begin(), bytes.end());
    }
    Number value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  RecordStorage storage_;
  const char* bytes_ = nullptr;
  std::vector<double> numbers_;
};

/// The colours of points: PLY has a byte for each channel, PCD all in one number.
class ColorFields {
public:
  explicit ColorFields(const RecordLayout& layout) {
    const auto is_byte = [](const RecordField* field) {
      return field != nullptr && field->type == 'U' && field->size == 1 && field->count == 1;
    };
    for (const std::string prefix : {"", "diffuse_"}) {
      const std::array<const RecordField*, 3> found = {findField(layout.fields, prefix + "red"),
                                                       findField(layout.fields, prefix + "green"),
                                                       findField(layout.fields, prefix + "blue")};
      if (channels_[0] == nullptr && std::all_of(found.begin(), found.end(), is_byte)) {
        std::copy(found.begin(), found.end(), channels_.begin());
      }
    }
    if (channels_[0] != nullptr) {
      const RecordField* const alpha = findField(layout.fields, "alpha");
      channels_[3] = is_byte(alpha) ? alpha : nullptr;
      has_alpha_ = channels_[3] != nullptr;
      return;
    }
    packed_ = findField(layout.fields, "rgba");
    has_alpha_ = packed_ != nullptr;
    if (packed_ == nullptr) {
      packed_ = findField(layout.fields, "rgb");
    }
    if (packed_ != nullptr && packed_->size != 4) {
      packed_ = nullptr;
      has_alpha_ = false;
    }
  }

  bool any() const { return channels_[0] != nullptr || packed_ != nullptr; }
  bool hasAlpha() const { return has_alpha_; }

  Color of(const Record& record) const {
    if (packed_ != nullptr) {
      const std::uint32_t packed = record.word(*packed_);
      return {static_cast<std::uint8_t>(packed >> 16U), static_cast<std::uint8_t>(packed >> 8U),
              static_cast<std::uint8_t>(packed),
              static_cast<std::uint8_t>(has_alpha_ ? packed >> 24U : 255U)};
    }
    return {record.byte(*channels_[0]), record.byte(*channels_[1]), record.byte(*channels_[2]),
            has_alpha_ ? record.byte(*channels_[3]) : std::uint8_t{255}};
  }

private:
  std::array<const RecordField*, 4> channels_{};
  const RecordField* packed_ = nullptr;
  bool has_alpha_ = false;
};

class RecordReader {
public:
  RecordReader(const std::string& path, const RecordLayout& layout, const FileProgress& progress)
      : path_(path), layout_(layout), reader_(path, layout.body, progress),
        line_number_(layout.body_line) {}

  PointData read() {
    for (const SkippedElement& element : layout_.before) {
      isText() ? skipLines(element.count) : skipBytes(element);
    }
    if (isPacked()) {
      unpack();
    }
    PointData data = readPoints();
    noteUnused(data);
    return data;
  }

private:
  bool isText() const { return layout_.storage == RecordStorage::Text; }
  bool isPacked() const { return layout_.storage == RecordStorage::Packed; }

  PointData readPoints() {
    const auto coordinates = findReals(layout_.fields, {"x", "y", "z"});
    if (!coordinates) {
      failContent(path_, "it has no points with x, y and z");
    }
    auto normals = findReals(layout_.fields, {"normal_x", "normal_y", "normal_z"});
    if (!normals) {
      normals = findReals(layout_.fields, {"nx", "ny", "nz"});
    }
    const ColorFields colors(layout_);
    const auto count = static_cast<std::size_t>(layout_.points);
    PointData data;
    data.has_alpha = colors.hasAlpha();
    data.points.reserve(count);
    data.normals.reserve(normals ? count : 0);
    data.colors.reserve(colors.any() ? count : 0);
    Record record(layout_.storage);
    for (std::size_t i = 0; i < count; ++i) {
      isText() ? readNumbers(record) : readBytes(record);
      data.points.push_back(record.reals(*coordinates));
      if (normals) {
        data.normals.push_back(toFloat(record.reals(*normals)));
      }
      if (colors.any()) {
        data.colors.push_back(colors.of(record));
      }
    }
    return data;
  }

  void readBytes(Record& record) {
    const char* const bytes = isPacked() ? gathered() : reader_.take(layout_.record_size);
    if (bytes == nullptr) {
      failBroken(path_);
    }
    record.setBytes(bytes);
  }

  void unpack() {
    std::size_t size = 0;
    const auto count = static_cast<std::size_t>(layout_.points);
    for (const RecordField& field : layout_.fields) {
      size += count * field.size * field.count;
    }
    std::optional<std::string> bytes = unpackLzf(reader_, layout_.packed_size, size);
    if (!bytes) {
      failBroken(path_);
    }
    unpacked_ = std::move(*bytes);
    gathered_.assign(layout_.record_size, '\0');
  }

  /// The next record, from the columns that were unpacked.
  const char* gathered() {
    const auto count = static_cast<std::size_t>(layout_.points);
    std::size_t column = 0;
    for (const RecordField& field : layout_.fields) {
      const std::size_t size = field.size * field.count;
      std::memcpy(&gathered_[field.offset], &unpacked_[column + next_record_ * size], size);
      column += count * size;
    }
    ++next_record_;
    return gathered_.data();
  }

  /// The words of the next line that has any.
  bool nextWords() {
    std::string_view line;
    while (reader_.nextLine(line)) {
      ++line_number_;
      split(line, " \t\r", words_);
      if (!words_.empty()) {
        return true;
      }
    }
    return false;
  }

  void readNumbers(Record& record) {
    if (!nextWords()) {
      failContent(path_, "it has fewer points than its header says");
    }
    std::vector<double>& numbers = record.numbers();
    numbers.clear();
    for (std::size_t i = 0; i < std::min(words_.size(), layout_.columns); ++i) {
      const std::optional<double> number = toReal(words_[i]);
      if (!number) {
        break;
      }
      numbers.push_back(*number);
    }
    if (numbers.size() < layout_.columns) {
      failContent(path_, "line " + std::to_string(line_number_) + " has no " +
                             std::to_string(layout_.columns) + " numbers");
    }
  }

  void skipLines(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      if (!nextWords()) {
        failContent(path_, "it has fewer points than its header says");
      }
    }
  }

  void skipBytes(const SkippedElement& element) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!visitBytes(element, [](std::uint64_t) {})) {
        failBroken(path_);
      }
    }
  }

  /// The next bytes as a number without sign. \return false if the file has fewer
  bool takeInteger(std::size_t size, std::uint64_t& number) {
    const char* const bytes = reader_.take(size);
    number = 0;
    for (std::size_t b = 0; bytes != nullptr && b < size; ++b) {
      const std::size_t place = layout_.storage == RecordStorage::BigEndian ? size - 1 - b : b;
      number |= std::uint64_t{static_cast<std::uint8_t>(bytes[place])} << (8 * b);
    }
    return bytes != nullptr;
  }

  /// Passes a record by, and calls a function for each corner. \return false if the file ends
  template <typename Visit>
  bool visitBytes(const SkippedElement& element, const Visit& visit) {
    for (const SkippedElement::Property& property : element.properties) {
      std::uint64_t values = 1;
      if (property.length_size > 0 && !takeInteger(property.length_size, values)) {
        return false;
      }
      for (std::uint64_t corner = 0; property.are_corners && values > 0; --values) {
        if (!takeInteger(property.size, corner)) {
          return false;
        }
        visit(corner);
      }
      if (!reader_.skip(values * property.size)) {
        return false;
      }
    }
    return true;
  }

  template <typename Visit>
  bool visitWords(const SkippedElement& element, const Visit& visit) {
    if (!nextWords()) {
      return false;
    }
    std::size_t word = 0;
    for (const SkippedElement::Property& property : element.properties) {
      std::uint64_t values = 1;
      if (property.length_size > 0) {
        values = word < words_.size() ? toCount(words_[word++]) : 0;
      }
      for (; values > 0 && word < words_.size(); --values, ++word) {
        if (property.are_corners) {
          visit(toCount(words_[word]));
        }
      }
      if (values > 0) {
        return false;
      }
    }
    return true;
  }

  /// Notes points of a mesh that no face uses. Faces that cannot be read, or have other points, say
  /// nothing.
  void noteUnused(PointData& data) {
    std::vector<bool> used(data.points.size(), false);
    bool is_mesh = false;
    bool is_sound = true;
    const auto visit = [&](std::uint64_t corner) {
      is_mesh = true;
      is_sound = is_sound && corner < used.size();
      if (is_sound) {
        used[corner] = true;
      }
    };
    for (const SkippedElement& element : layout_.after) {
      for (std::uint64_t i = 0; is_sound && i < element.count; ++i) {
        const bool is_there = isText() ? visitWords(element, visit) : visitBytes(element, visit);
        is_sound = is_sound && is_there;
      }
    }
    for (std::size_t i = 0; is_mesh && is_sound && i < used.size(); ++i) {
      if (!used[i]) {
        data.unused.push_back(static_cast<Index>(i));
      }
    }
  }

  const std::string& path_;
  const RecordLayout& layout_;
  BlockReader reader_;
  std::size_t line_number_;
  std::vector<std::string_view> words_;
  std::string unpacked_;  ///< all values of a field, then those of the next
  std::string gathered_;  ///< those of one point
  std::size_t next_record_ = 0;
};

}  // namespace

PointData readRecords(const std::string& path, const RecordLayout& layout,
                      const FileProgress& progress) {
  return RecordReader(path, layout, progress).read();
}

}  // namespace spherical_param::tools
