#include "common/header_checks.h"

#include "common/input_file.h"
#include "common/numbers.h"
#include "common/text.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace spherical_param::tools {
namespace {

/// No header is longer, except in broken files.
constexpr std::size_t header_limit = std::size_t{1} << 20;

/// More points than an index of 32 bits can tell apart.
constexpr std::int64_t count_limit = std::int64_t{1} << 30;

constexpr std::string_view blanks = " \t\r";

/// Goes through the lines of a text.
class Lines {
public:
  explicit Lines(std::string_view text) : text_(text) {}

  /// Moves on to the next line. \return false at the end of the text.
  bool next() {
    if (position_ >= text_.size()) {
      return false;
    }
    const std::size_t end = std::min(text_.find('\n', position_), text_.size());
    words_ = split(text_.substr(position_, end - position_), blanks);
    position_ = std::min(end + 1, text_.size());
    ++number_;
    return true;
  }
  const std::vector<std::string_view>& words() const { return words_; }
  /// Where the next line begins.
  std::size_t position() const { return position_; }
  std::size_t number() const { return number_; }

private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t number_ = 0;
  std::vector<std::string_view> words_;
};

/// Bytes of a file behind a line; none if it was shorter when its size was asked for.
std::uint64_t bytesBehind(const Lines& lines, std::uint64_t file_size) {
  return file_size - std::min<std::uint64_t>(lines.position(), file_size);
}

void addField(RecordField field, RecordLayout& layout) {
  field.offset = layout.record_size;
  field.column = layout.columns;
  layout.record_size += field.size * field.count;
  layout.columns += field.count;
  layout.fields.push_back(std::move(field));
}

/// A number in a header. \throw Failure if it is not a number, or more than points may be.
std::int64_t requireCount(const std::string& path, std::string_view word, const std::string& what) {
  const std::optional<std::int64_t> count = toInteger(word);
  if (!count || *count < 0 || *count > count_limit) {
    failContent(path, "its number of " + what + " is " + inQuotes(word));
  }
  return *count;
}

/// \throw Failure if there are fewer bytes than a header needs.
void requireBytes(const std::string& path, double needed, std::uint64_t available) {
  // Products of counts go through double: they overflow any integer in a broken header.
  if (needed > static_cast<double>(available)) {
    failContent(path, "it is shorter than its header says");
  }
}

}  // namespace

RecordLayout checkPcdHeader(const std::string& path, std::uint64_t file_size) {
  const std::string beginning = readBeginning(path, header_limit);
  Lines lines(beginning);
  std::map<std::string, std::vector<std::string>> entries;
  while (entries.count("DATA") == 0) {
    if (!lines.next()) {
      failContent(path, "it has no PCD header");
    }
    const auto& words = lines.words();
    if (words.empty() || words[0][0] == '#') {
      continue;
    }
    const std::string name(words[0] == "COLUMNS" ? "FIELDS" : words[0]);
    static const std::array<const char*, 10> known = {"VERSION", "FIELDS",   "SIZE",   "TYPE",
                                                      "COUNT",   "WIDTH",    "HEIGHT", "POINTS",
                                                      "DATA",    "VIEWPOINT"};
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      failContent(path, "its header has the unknown entry " + inQuotes(words[0]));
    }
    entries[name] = std::vector<std::string>(words.begin() + 1, words.end());
  }
  for (const char* name : {"FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT", "POINTS", "DATA"}) {
    if (entries[name].empty()) {
      failContent(path, std::string("its header has no ") + name);
    }
  }

  const std::vector<std::string>& fields = entries["FIELDS"];
  for (const char* name : {"x", "y", "z"}) {
    if (std::count(fields.begin(), fields.end(), name) != 1) {
      failContent(path, "it has no fields x, y and z");
    }
  }
  std::vector<std::string>& counts = entries["COUNT"];
  if (counts.empty()) {
    counts.assign(fields.size(), "1");
  }
  if (entries["SIZE"].size() != fields.size() || entries["TYPE"].size() != fields.size() ||
      counts.size() != fields.size()) {
    failContent(path, "FIELDS, SIZE, TYPE and COUNT of its header differ in length");
  }
  const std::string& storage = entries["DATA"][0];
  const bool packed = storage == "binary_compressed";
  RecordLayout layout;
  double bytes_per_point = 0.0;
  double values_per_point = 0.0;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const std::string& size = entries["SIZE"][f];
    const std::string& type = entries["TYPE"][f];
    const bool number = type == "F" ? size == "4" || size == "8"
                                    : (type == "I" || type == "U") && (size == "1" || size == "2" ||
                                                                       size == "4" || size == "8");
    if (!number) {
      failContent(path, "field " + inQuotes(fields[f]) + " has the unknown type " +
                            inQuotes(type + " " + size));
    }
    const std::int64_t count = requireCount(path, counts[f], "values in a field");
    const bool coordinate = fields[f] == "x" || fields[f] == "y" || fields[f] == "z";
    if (count < 1 || (coordinate && (count != 1 || type != "F"))) {
      failContent(path, "field " + inQuotes(fields[f]) + " does not hold one number a point");
    }
    if (packed && fields[f] == "_") {
      continue;  // PCL leaves padding out of what it packs
    }
    RecordField field;
    field.name = fields[f];
    field.type = type[0];
    field.size = static_cast<std::size_t>(size[0] - '0');
    field.count = static_cast<std::size_t>(count);
    addField(field, layout);
    bytes_per_point += static_cast<double>(count) * static_cast<double>(size[0] - '0');
    values_per_point += static_cast<double>(count);
  }

  const std::int64_t points = requireCount(path, entries["POINTS"][0], "points");
  const std::int64_t width = requireCount(path, entries["WIDTH"][0], "columns");
  const std::int64_t height = requireCount(path, entries["HEIGHT"][0], "rows");
  if (points == 0) {
    failContent(path, "it has no points");
  }
  if (static_cast<double>(width) * static_cast<double>(height) != static_cast<double>(points)) {
    failContent(path, "POINTS of its header is not WIDTH times HEIGHT");
  }

  const std::uint64_t body = bytesBehind(lines, file_size);
  const auto point_count = static_cast<double>(points);
  if (storage == "ascii") {
    // A value needs a digit and a separator, the last one no separator.
    requireBytes(path, 2.0 * point_count * values_per_point - 1.0, body);
  } else if (storage == "binary") {
    requireBytes(path, point_count * bytes_per_point, body);
    layout.storage = RecordStorage::LittleEndian;
  } else if (packed) {
    requireBytes(path, 8.0, body);
    std::array<std::uint32_t, 2> sizes{};  // compressed, uncompressed
    if (beginning.size() < lines.position() + sizeof sizes) {
      failContent(path, "it is shorter than its header says");
    }
    std::memcpy(sizes.data(), beginning.data() + lines.position(), sizeof sizes);
    requireBytes(path, 8.0 + static_cast<double>(sizes[0]), body);
    if (static_cast<double>(sizes[1]) != point_count * bytes_per_point) {
      failContent(path, "its compressed data does not hold the points of its header");
    }
    // Three bytes stand for 264 at most.
    if (static_cast<double>(sizes[1]) > 88.0 * static_cast<double>(sizes[0])) {
      failContent(path, "its compressed data is too short for the points of its header");
    }
    layout.storage = RecordStorage::Packed;
    layout.packed_size = sizes[0];
    // The body begins behind both sizes.
    layout.body = sizeof sizes;
  } else {
    failContent(path, "its data is stored as " + inQuotes(storage));
  }
  layout.body += lines.position();
  layout.body_line = lines.number();
  layout.points = static_cast<std::uint64_t>(points);
  return layout;
}

namespace {

struct PlyProperty {
  std::string type;
  std::string length_type;  ///< of a list
  std::string name;
  bool list = false;
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

/// Bytes of a PLY number, 0 for an unknown type.
double plyTypeSize(std::string_view type) {
  static const std::map<std::string_view, double> sizes = {
      {"char", 1},   {"int8", 1},    {"uchar", 1},  {"uint8", 1},  {"short", 2}, {"int16", 2},
      {"ushort", 2}, {"uint16", 2},  {"int", 4},    {"int32", 4},  {"uint", 4},  {"uint32", 4},
      {"float", 4},  {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? 0.0 : found->second;
}

bool isRealPlyType(std::string_view type) {
  return type == "float" || type == "float32" || type == "double" || type == "float64";
}

PlyProperty parsePlyProperty(const std::string& path, const std::vector<std::string_view>& words) {
  PlyProperty property;
  property.list = words.size() > 1 && words[1] == "list";
  const std::size_t expected = property.list ? 5 : 3;
  if (words.size() != expected) {
    failContent(path, "its header has a broken property");
  }
  for (std::size_t w = property.list ? 2 : 1; w + 1 < expected; ++w) {
    const bool real_length = property.list && w == 2 && isRealPlyType(words[w]);
    if (plyTypeSize(words[w]) == 0.0 || real_length) {
      failContent(path, "its header has the unknown type " + inQuotes(words[w]));
    }
  }
  property.type = words[expected - 2];
  property.length_type = property.list ? std::string(words[2]) : "";
  property.name = words[expected - 1];
  return property;
}

void checkPlyVertex(const std::string& path, const PlyElement& vertex) {
  std::map<std::string, int> found;
  for (const PlyProperty& property : vertex.properties) {
    if (property.list) {
      failReading(path, "its vertices have the list " + inQuotes(property.name),
                  "save it with plain numbers for each vertex");
    }
    if (++found[property.name] > 1) {
      failContent(path, "its vertices have the property " + inQuotes(property.name) + " twice");
    }
    const bool coordinate = property.name == "x" || property.name == "y" || property.name == "z";
    if (coordinate && !isRealPlyType(property.type)) {
      failReading(path, "its coordinates are whole numbers", "save it with float coordinates");
    }
  }
  if (found["x"] + found["y"] + found["z"] != 3) {
    failContent(path, "its vertices have no x, y and z");
  }
  if (vertex.count == 0) {
    failContent(path, "it has no points");
  }
}

SkippedElement toSkipped(const PlyElement& element) {
  SkippedElement skipped;
  skipped.count = static_cast<std::uint64_t>(element.count);
  for (const PlyProperty& property : element.properties) {
    skipped.properties.push_back(
        {static_cast<std::size_t>(plyTypeSize(property.type)),
         property.list ? static_cast<std::size_t>(plyTypeSize(property.length_type)) : 0});
  }
  return skipped;
}

RecordLayout toLayout(const std::vector<PlyElement>& elements) {
  RecordLayout layout;
  for (const PlyElement& element : elements) {
    if (element.name != "vertex") {
      // Without properties there is nothing to skip, however many there are.
      if (!element.properties.empty()) {
        layout.before.push_back(toSkipped(element));
      }
      continue;
    }
    layout.points = static_cast<std::uint64_t>(element.count);
    for (const PlyProperty& property : element.properties) {
      RecordField field;
      field.name = property.name;
      field.type = property.type[0] == 'f' || property.type[0] == 'd' ? 'F'
                   : property.type[0] == 'u'                          ? 'U'
                                                                      : 'I';
      field.size = static_cast<std::size_t>(plyTypeSize(property.type));
      addField(field, layout);
    }
    break;  // what follows the points is not read
  }
  return layout;
}

}  // namespace

RecordLayout checkPlyHeader(const std::string& path, std::uint64_t file_size) {
  const std::string beginning = readBeginning(path, header_limit);
  Lines lines(beginning);
  if (!lines.next() || lines.words().size() != 1 || lines.words()[0] != "ply") {
    failContent(path, "it does not begin as a PLY file does");
  }
  std::vector<PlyElement> elements;
  bool ascii = false;
  bool big_endian = false;
  bool format_known = false;
  for (;;) {
    if (!lines.next()) {
      failContent(path, "its header has no end");
    }
    const auto& words = lines.words();
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") {
      continue;
    }
    if (words[0] == "end_header") {
      break;
    }
    if (words[0] == "format" && words.size() == 3 && words[2] == "1.0") {
      format_known = words[1] == "ascii" || words[1] == "binary_little_endian" ||
                     words[1] == "binary_big_endian";
      ascii = words[1] == "ascii";
      big_endian = words[1] == "binary_big_endian";
    } else if (words[0] == "element" && words.size() == 3) {
      elements.push_back({std::string(words[1]), requireCount(path, words[2], "elements"), {}});
    } else if (words[0] == "property" && !elements.empty()) {
      elements.back().properties.push_back(parsePlyProperty(path, words));
    } else {
      failContent(path, "its header has the unknown entry " + inQuotes(words[0]));
    }
  }
  if (!format_known) {
    failContent(path, "its format is neither ascii nor binary 1.0");
  }

  int vertex_elements = 0;
  double needed = 0.0;
  for (const PlyElement& element : elements) {
    if (element.name == "vertex") {
      ++vertex_elements;
      checkPlyVertex(path, element);
    }
    double bytes = 0.0;
    for (const PlyProperty& property : element.properties) {
      // The shortest list is its length alone; the shortest text a digit and a separator.
      bytes += ascii ? 2.0 : property.list ? 1.0 : plyTypeSize(property.type);
    }
    needed += bytes * static_cast<double>(element.count);
  }
  if (vertex_elements != 1) {
    failContent(path, "it has no vertices");
  }
  requireBytes(path, needed - (ascii ? 1.0 : 0.0), bytesBehind(lines, file_size));
  RecordLayout layout = toLayout(elements);
  layout.storage = ascii        ? RecordStorage::Text
                   : big_endian ? RecordStorage::BigEndian
                                : RecordStorage::LittleEndian;
  layout.body = lines.position();
  layout.body_line = lines.number();
  return layout;
}

}  // namespace spherical_param::tools
