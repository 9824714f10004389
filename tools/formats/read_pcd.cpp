#include "common/record_reader.h"
#include "formats/formats.h"
#include "formats/text_lines.h"
#include "spherical_param/reconstruct.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <utility>

namespace spherical_param::tools {
namespace {

using Entries = std::map<std::string, std::vector<std::string>>;

/// The entries of a header and the words of each, up to DATA.
Entries readEntries(InputFile& file) {
  static const std::array known = {"VERSION", "FIELDS", "SIZE",   "TYPE", "COUNT",
                                   "WIDTH",   "HEIGHT", "POINTS", "DATA", "VIEWPOINT"};
  Entries entries;
  Words words;
  while (entries.count("DATA") == 0) {
    if (!nextWords(file, words)) {
      failContent(file.path(), "it has no PCD header");
    }
    if (words.empty() || words[0][0] == '#') {
      continue;
    }
    const std::string name(words[0] == "COLUMNS" ? "FIELDS" : words[0]);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      failContent(file.path(), "its header has the unknown entry " + inQuotes(words[0]));
    }
    entries[name] = std::vector<std::string>(words.begin() + 1, words.end());
  }
  // What PCL takes if it is not said.
  const std::size_t fields = entries["FIELDS"].size();
  for (const auto& [name, value] : {std::pair("SIZE", "4"), {"TYPE", "F"}, {"COUNT", "1"}}) {
    if (entries[name].empty()) {
      entries[name].assign(fields, value);
    }
  }
  if (entries["HEIGHT"].empty()) {
    entries["HEIGHT"] = {"1"};
  }
  for (const char* name : {"FIELDS", "DATA"}) {
    if (entries[name].empty()) {
      failContent(file.path(), std::string("its header has no ") + name);
    }
  }
  return entries;
}

/// One field. \throw Failure if it is no number.
RecordField makeField(const InputFile& file, const std::string& name, const std::string& type,
                      const std::string& size, const std::string& count_text) {
  const bool is_number = type == "F"
                             ? size == "4" || size == "8"
                             : (type == "I" || type == "U") &&
                                   (size == "1" || size == "2" || size == "4" || size == "8");
  if (!is_number) {
    failContent(file.path(),
                "field " + inQuotes(name) + " has the unknown type " + inQuotes(type + " " + size));
  }
  const std::int64_t count = requireCount(file, count_text, "values in a field");
  if (count < 1) {
    failContent(file.path(), "field " + inQuotes(name) + " has no number");
  }
  RecordField field;
  field.name = name;
  field.type = type[0];
  field.size = static_cast<std::size_t>(size[0] - '0');
  field.count = static_cast<std::size_t>(count);
  return field;
}

/// All fields of a point, padding included. The last ones may lack a type: only that of colours in
/// binary is known.
std::vector<RecordField> makeFields(const InputFile& file, Entries& entries) {
  std::vector<std::string> names = entries["FIELDS"];
  const std::vector<std::string>& counts = entries["COUNT"];
  for (std::size_t f = entries["TYPE"].size(); f < names.size(); ++f) {
    const bool is_color = names[f] == "rgb" || names[f] == "rgba";
    entries["TYPE"].emplace_back("U");
    names[f] = is_color && lowerCase(entries["DATA"][0]) == "binary" ? names[f] : "_";
  }
  if (entries["SIZE"].size() != names.size() || entries["TYPE"].size() != names.size() ||
      counts.size() != names.size()) {
    failContent(file.path(), "FIELDS, SIZE, TYPE and COUNT of its header differ in length");
  }
  std::vector<RecordField> fields;
  for (std::size_t f = 0; f < names.size(); ++f) {
    fields.push_back(makeField(file, names[f], entries["TYPE"][f], entries["SIZE"][f], counts[f]));
  }
  return fields;
}

std::int64_t pointCount(const InputFile& file, Entries& entries) {
  const auto count = [&](const char* name, const char* what) {
    return entries[name].empty() ? -1 : requireCount(file, entries[name][0], what);
  };
  const std::int64_t given = count("WIDTH", "columns");
  const std::int64_t height = count("HEIGHT", "rows");
  const std::int64_t all = count("POINTS", "points");
  if (all < 0 && given < 0) {
    failContent(file.path(), "its header has neither WIDTH nor POINTS");
  }
  const std::int64_t width = given < 0 ? all / std::max<std::int64_t>(height, 1) : given;
  const std::int64_t points =
      all < 0 ? requireCount(file, std::to_string(width * height), "points") : all;
  if (points == 0) {
    failContent(file.path(), "it has no points");
  }
  if (width * height != points) {
    failContent(file.path(), "POINTS of its header is " + std::to_string(points) + ", not WIDTH " +
                                 std::to_string(width) + " times HEIGHT " + std::to_string(height));
  }
  return points;
}

/// Takes the two sizes before compressed data. \return the compressed one.
std::uint32_t packedSize(InputFile& file, double bytes) {
  std::array<std::uint32_t, 2> sizes{};  // compressed, uncompressed
  const char* const taken = file.take(sizeof sizes);
  if (taken == nullptr) {
    failContent(file.path(), "it is shorter than its header says");
  }
  std::memcpy(sizes.data(), taken, sizeof sizes);
  requireBytes(file, static_cast<double>(sizes[0]));
  if (static_cast<double>(sizes[1]) != bytes) {
    failContent(file.path(), "its compressed data does not hold the points of its header");
  }
  // Three bytes stand for 264 at most.
  if (static_cast<double>(sizes[1]) > 88.0 * static_cast<double>(sizes[0])) {
    failContent(file.path(), "its compressed data is too short for the points of its header");
  }
  return sizes[0];
}

RecordLayout layoutOf(InputFile& file, Entries& entries) {
  const std::string storage = lowerCase(entries["DATA"][0]);
  const bool is_packed = storage == "binary_compressed";
  RecordLayout layout;
  double bytes = 0.0;   // of all points
  double values = 0.0;  // of all points
  RecordElement element{"vertex", 0, {}};
  const std::vector<RecordField> fields = makeFields(file, entries);
  element.count = static_cast<std::uint64_t>(pointCount(file, entries));
  const auto points = static_cast<double>(element.count);
  for (const RecordField& field : fields) {
    if (is_packed && field.name == "_") {
      continue;  // PCL leaves padding out of what it packs
    }
    element.fields.push_back(field);
    bytes += points * static_cast<double>(field.count) * static_cast<double>(field.size);
    values += points * static_cast<double>(field.count);
  }
  if (storage == "ascii") {
    // A value needs a digit and a separator, the last one no separator.
    requireBytes(file, 2.0 * values - 1.0);
  } else if (storage == "binary") {
    requireBytes(file, bytes);
    layout.storage = RecordStorage::LittleEndian;
  } else if (is_packed) {
    layout.storage = RecordStorage::Packed;
    layout.packed_size = packedSize(file, bytes);
  } else {
    failContent(file.path(), "its data is stored as " + inQuotes(storage));
  }
  layout.elements.push_back(std::move(element));
  return layout;
}

}  // namespace

PointData readPcd(InputFile& file, const std::vector<std::string>& /*columns*/) {
  Entries entries = readEntries(file);
  PointData data = readRecords(file, layoutOf(file, entries));
  data.rows = static_cast<std::size_t>(requireCount(file, entries["HEIGHT"][0], "rows"));
  Point sensor{};
  for (std::size_t axis = 0; axis < std::min<std::size_t>(3, entries["VIEWPOINT"].size()); ++axis) {
    sensor[axis] = toReal(entries["VIEWPOINT"][axis]).value_or(0.0);
  }
  if (viewpointOf(positionsOf(data), Eigen::Map<const Eigen::Vector3d>(sensor.data()),
                  data.rows != 1)) {
    data.viewpoint = sensor;
  }
  return data;
}

}  // namespace spherical_param::tools
