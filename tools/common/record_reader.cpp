#include "common/record_reader.h"

#include "common/input_file.h"
#include "common/point_table.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

constexpr const char* broken = "it is broken or not complete";

/// No list is longer: the number of its bytes must not overflow.
constexpr double list_limit = 1e15;

/// What a field of 32 bits is whose meaning is not a number: rgb.
double bitsOf(double value, char type) {
  if (type != 'F') {
    return value < 0.0 ? value + 4294967296.0 : value;
  }
  const auto number = static_cast<float>(value);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  return bits;
}

/// Unpacks the next bytes of a file, as LibLZF (M. Lehmann) packs them.
///
/// \param packed_size bytes of the file. \param size what they should make.
/// \return none if they are broken, or make another number of bytes.
std::optional<std::string> unpackLzf(InputFile& file, std::uint64_t packed_size, std::size_t size) {
  std::string bytes;
  bytes.reserve(size);
  const auto take = [&](std::size_t count) {
    const char* const taken = count <= packed_size ? file.take(count) : nullptr;
    packed_size -= taken != nullptr ? count : 0;
    return taken;
  };
  while (packed_size > 0) {
    const char* next = take(1);
    if (next == nullptr) {
      return std::nullopt;
    }
    const auto control = static_cast<std::uint8_t>(*next);
    constexpr std::uint8_t first_reference = 32;
    if (control < first_reference) {
      const std::size_t count = std::size_t{control} + 1;
      next = take(count);
      if (next == nullptr || count > size - bytes.size()) {
        return std::nullopt;
      }
      bytes.append(next, count);
      continue;
    }
    // Three bits of length, five and eight of distance; the longest length has another byte.
    std::size_t length = (std::size_t{control} >> 5U) + 2;
    constexpr std::size_t longest = 9;
    const std::size_t more = length == longest ? 2 : 1;
    next = take(more);
    if (next == nullptr) {
      return std::nullopt;
    }
    length += more == 2 ? static_cast<std::uint8_t>(next[0]) : 0U;
    const std::size_t distance =
        ((std::size_t{control} & 0x1fU) << 8U) + static_cast<std::uint8_t>(next[more - 1]) + 1;
    if (distance > bytes.size() || length > size - bytes.size()) {
      return std::nullopt;
    }
    // It may reach into what it makes.
    for (std::size_t i = 0; i < length; ++i) {
      bytes += bytes[bytes.size() - distance];
    }
  }
  return bytes.size() == size ? std::optional(std::move(bytes)) : std::nullopt;
}

class RecordReader {
public:
  RecordReader(InputFile& file, const RecordLayout& layout) : file_(file), layout_(layout) {}

  PointData read() {
    PointData data;
    for (const RecordElement& element : layout_.elements) {
      if (element.name == "vertex") {
        data = readPoints(element);
      } else if (!data.points.empty() && element.name == "face") {
        noteUnused(element, data);
        break;
      } else if (!canSkip(element)) {
        if (data.points.empty()) {
          failContent(file_.path(), problem_);
        }
        break;
      }
    }
    return data;
  }

private:
  bool isText() const { return layout_.storage == RecordStorage::Text; }
  bool isPacked() const { return layout_.storage == RecordStorage::Packed; }

  PointData readPoints(const RecordElement& element) {
    std::vector<PointColumn> columns;
    std::vector<int> column_of_field;
    std::vector<bool> are_bits;
    RecordElement points = element;
    for (RecordField& field : points.fields) {
      const bool is_column =
          field.count == 1 && field.length_size == 0 && field.type != 'T' && field.name != "_";
      column_of_field.push_back(is_column ? static_cast<int>(columns.size()) : -1);
      if (!is_column) {
        continue;
      }
      const std::string name = commonName(field.name);
      are_bits.push_back(field.size == 4 && (name == "rgb" || name == "rgba"));
      // Bits that are no number would not outlive the way through one.
      field.type = are_bits.back() && !isText() ? 'U' : field.type;
      columns.push_back({field.name, field.type == 'U' && field.size == 1, {}});
      columns.back().values.reserve(static_cast<std::size_t>(element.count));
    }
    if (findColumns(columns, {"x", "y", "z"}).empty()) {
      failContent(file_.path(), "it has no points with x, y and z");
    }
    unpack(element);
    const auto take = [&](std::size_t field, double value) {
      const auto column = static_cast<std::size_t>(column_of_field[field]);
      columns[column].values.push_back(are_bits[column] ? bitsOf(value, points.fields[field].type)
                                                        : value);
    };
    const auto is_wanted = [&](std::size_t field) { return column_of_field[field] >= 0; };
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!next(points, is_wanted, take)) {
        failContent(file_.path(), problem_);
      }
    }
    return toPoints(std::move(columns));
  }

  bool canSkip(const RecordElement& element) {
    std::uint64_t left = element.count;
    const auto is_wanted = [](std::size_t) { return false; };
    while (left > 0 && next(element, is_wanted, [](std::size_t, double) {})) {
      --left;
    }
    return left == 0;
  }

  /// Notes points of a mesh that no face uses. Faces that cannot be read, or have other points, say
  /// nothing.
  void noteUnused(const RecordElement& faces, PointData& data) {
    std::vector<bool> used(data.points.size(), false);
    bool is_mesh = false;
    bool is_sound = true;
    const auto is_corner = [&](std::size_t field) {
      const std::string& name = faces.fields[field].name;
      return name == "vertex_indices" || name == "vertex_index";
    };
    const auto take = [&](std::size_t /*field*/, double corner) {
      is_mesh = true;
      is_sound = is_sound && corner >= 0.0 && corner < static_cast<double>(used.size());
      if (is_sound) {
        used[static_cast<std::size_t>(corner)] = true;
      }
    };
    for (std::uint64_t i = 0; is_sound && i < faces.count; ++i) {
      is_sound = next(faces, is_corner, take) && is_sound;
    }
    for (std::size_t i = 0; is_mesh && is_sound && i < used.size(); ++i) {
      if (!used[i]) {
        data.unused.push_back(static_cast<Index>(i));
      }
    }
  }

  /// Reads the next record of an element and hands over the numbers of fields. \return false, with
  /// the problem, if it is not there.
  template <typename IsWanted, typename Take>
  bool next(const RecordElement& element, const IsWanted& is_wanted, const Take& take) {
    if (isText() && !nextWords(element)) {
      return fail("it has fewer points than its header says");
    }
    std::size_t word = 0;
    for (std::size_t f = 0; f < element.fields.size(); ++f) {
      const RecordField& field = element.fields[f];
      std::uint64_t count = field.count;
      if (field.length_size > 0) {
        const RecordField length{"", 'U', field.length_size};
        const std::optional<double> value = nextValue(length, word, f);
        if (!value || !(*value >= 0.0 && *value <= list_limit)) {
          return fail(broken);
        }
        count = static_cast<std::uint64_t>(*value);
      }
      if (!is_wanted(f)) {
        word += isText() ? static_cast<std::size_t>(count) : 0;
        if (!isText() && !isPacked() && !file_.skip(count * field.size)) {
          return fail(broken);
        }
        continue;
      }
      for (; count > 0; --count) {
        const std::optional<double> value = nextValue(field, word, f);
        if (!value) {
          return fail(isText() ? "line " + std::to_string(file_.lineNumber()) +
                                     " has no number for " + inQuotes(field.name)
                               : broken);
        }
        take(f, *value);
      }
    }
    ++next_record_;
    return word <= words_.size() || fail(broken);
  }

  bool fail(const std::string& problem) {
    problem_ = problem;
    return false;
  }

  std::optional<double> nextValue(const RecordField& field, std::size_t& word, std::size_t f) {
    if (isText()) {
      const std::optional<double> value =
          word < words_.size() ? toValue(words_[word]) : std::nullopt;
      ++word;
      return value && field.type == 'F' && field.size == 4 ? static_cast<float>(*value) : value;
    }
    const char* const bytes = isPacked()
                                  ? &unpacked_[begin_of_field_[f] + next_record_ * field.size]
                                  : file_.take(field.size);
    return bytes == nullptr ? std::nullopt : std::optional(valueOf(field, bytes));
  }

  double valueOf(const RecordField& field, const char* bytes) const {
    if (field.type == 'F') {
      return field.size == 8 ? load<double>(bytes) : load<float>(bytes);
    }
    const bool is_signed = field.type == 'I';
    return field.size == 1   ? integer<std::int8_t>(bytes, is_signed)
           : field.size == 2 ? integer<std::int16_t>(bytes, is_signed)
           : field.size == 4 ? integer<std::int32_t>(bytes, is_signed)
                             : integer<std::int64_t>(bytes, is_signed);
  }

  template <typename Signed>
  double integer(const char* bytes, bool is_signed) const {
    return is_signed ? static_cast<double>(load<Signed>(bytes))
                     : static_cast<double>(load<std::make_unsigned_t<Signed>>(bytes));
  }

  template <typename Number>
  Number load(const char* from) const {
    std::array<char, sizeof(Number)> bytes{};
    std::memcpy(bytes.data(), from, bytes.size());
    if (layout_.storage == RecordStorage::BigEndian) {
      std::reverse(bytes.begin(), bytes.end());
    }
    Number value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  void unpack(const RecordElement& element) {
    if (!isPacked()) {
      return;
    }
    std::size_t size = 0;
    for (const RecordField& field : element.fields) {
      begin_of_field_.push_back(size);
      size += static_cast<std::size_t>(element.count) * field.size * field.count;
    }
    std::optional<std::string> bytes = unpackLzf(file_, layout_.packed_size, size);
    if (!bytes) {
      failContent(file_.path(), broken);
    }
    unpacked_ = std::move(*bytes);
  }

  /// The words of the next line that has any. Commas may be in numbers, or separate them.
  bool nextWords(const RecordElement& element) {
    std::string_view line;
    do {
      if (!file_.nextLine(line)) {
        return false;
      }
      split(line, " \t\r", words_);
    } while (words_.empty() || words_[0][0] == '#');
    if (line.find(',') == std::string_view::npos) {
      return true;
    }
    std::size_t least = 0;
    for (const RecordField& field : element.fields) {
      least += field.count;
    }
    if (words_.size() < least) {
      split(line, " \t\r,", words_);
      words_.resize(words_.size() == least ? least : 0);
    }
    for (std::string_view& word : words_) {
      word.remove_suffix(word.size() > 1 && word.back() == ',' ? 1 : 0);
    }
    return true;
  }

  InputFile& file_;
  const RecordLayout& layout_;
  std::vector<std::string_view> words_;
  std::string problem_;   ///< of the record that could not be read
  std::string unpacked_;  ///< all values of a field, then those of the next
  std::vector<std::size_t> begin_of_field_;
  std::size_t next_record_ = 0;
};

}  // namespace

PointData readRecords(InputFile& file, const RecordLayout& layout) {
  return RecordReader(file, layout).read();
}

}  // namespace spherical_param::tools
