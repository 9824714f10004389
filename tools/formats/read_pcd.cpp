#include "common/record_reader.h"
#include "formats/formats.h"
#include "formats/header_lines.h"
#include "spherical_param/reconstruct.h"

#include <array>
#include <cstring>
#include <map>

namespace spherical_param::tools {
namespace {

using Entries = std::map<std::string, std::vector<std::string>>;

/// The entries of a header and the words of each, up to DATA.
Entries readEntries(const std::string& path, Lines& lines) {
  static const std::array known = {"VERSION", "FIELDS", "SIZE",   "TYPE", "COUNT",
                                   "WIDTH",   "HEIGHT", "POINTS", "DATA", "VIEWPOINT"};
  Entries entries;
  while (entries.count("DATA") == 0) {
    if (!lines.next()) {
      failContent(path, "it has no PCD header");
    }
    const auto& words = lines.words();
    if (words.empty() || words[0][0] == '#') {
      continue;
    }
    const std::string name(words[0] == "COLUMNS" ? "FIELDS" : words[0]);
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
  return entries;
}

/// One field. \throw Failure if it is no number, or a coordinate of another type than float.
RecordField makeField(const std::string& path, const std::string& name, const std::string& type,
                      const std::string& size, const std::string& count_text) {
  const bool is_number = type == "F"
                             ? size == "4" || size == "8"
                             : (type == "I" || type == "U") &&
                                   (size == "1" || size == "2" || size == "4" || size == "8");
  if (!is_number) {
    failContent(path,
                "field " + inQuotes(name) + " has the unknown type " + inQuotes(type + " " + size));
  }
  const std::int64_t count = requireCount(path, count_text, "values in a field");
  const bool is_coordinate = name == "x" || name == "y" || name == "z";
  if (count < 1 || (is_coordinate && (count != 1 || type != "F"))) {
    failContent(path, "field " + inQuotes(name) + " does not hold one number a point");
  }
  RecordField field;
  field.name = name;
  field.type = type[0];
  field.size = static_cast<std::size_t>(size[0] - '0');
  field.count = static_cast<std::size_t>(count);
  return field;
}

/// All fields of a point, padding included.
std::vector<RecordField> makeFields(const std::string& path, Entries& entries) {
  const std::vector<std::string>& names = entries["FIELDS"];
  for (const char* name : {"x", "y", "z"}) {
    if (std::count(names.begin(), names.end(), name) != 1) {
      failContent(path, "it has no fields x, y and z");
    }
  }
  std::vector<std::string>& counts = entries["COUNT"];
  if (counts.empty()) {
    counts.assign(names.size(), "1");
  }
  if (entries["SIZE"].size() != names.size() || entries["TYPE"].size() != names.size() ||
      counts.size() != names.size()) {
    failContent(path, "FIELDS, SIZE, TYPE and COUNT of its header differ in length");
  }
  std::vector<RecordField> fields;
  for (std::size_t f = 0; f < names.size(); ++f) {
    fields.push_back(makeField(path, names[f], entries["TYPE"][f], entries["SIZE"][f], counts[f]));
  }
  return fields;
}

std::int64_t pointCount(const std::string& path, Entries& entries) {
  const std::int64_t points = requireCount(path, entries["POINTS"][0], "points");
  const std::int64_t width = requireCount(path, entries["WIDTH"][0], "columns");
  const std::int64_t height = requireCount(path, entries["HEIGHT"][0], "rows");
  if (points == 0) {
    failContent(path, "it has no points");
  }
  if (static_cast<double>(width) * static_cast<double>(height) != static_cast<double>(points)) {
    failContent(path, "POINTS of its header is not WIDTH times HEIGHT");
  }
  return points;
}

/// Where the sensor was.
Point sensorOf(Entries& entries) {
  Point sensor{};
  for (std::size_t axis = 0; axis < std::min<std::size_t>(3, entries["VIEWPOINT"].size()); ++axis) {
    sensor[axis] = toReal(entries["VIEWPOINT"][axis]).value_or(0.0);
  }
  return sensor;
}

/// Checks the two sizes before compressed data. \return the compressed one.
std::uint32_t checkPacked(const std::string& path, std::string_view body, double bytes,
                          std::uint64_t body_size) {
  requireBytes(path, 8.0, body_size);
  std::array<std::uint32_t, 2> sizes{};  // compressed, uncompressed
  if (body.size() < sizeof sizes) {
    failContent(path, "it is shorter than its header says");
  }
  std::memcpy(sizes.data(), body.data(), sizeof sizes);
  requireBytes(path, 8.0 + static_cast<double>(sizes[0]), body_size);
  if (static_cast<double>(sizes[1]) != bytes) {
    failContent(path, "its compressed data does not hold the points of its header");
  }
  // Three bytes stand for 264 at most.
  if (static_cast<double>(sizes[1]) > 88.0 * static_cast<double>(sizes[0])) {
    failContent(path, "its compressed data is too short for the points of its header");
  }
  return sizes[0];
}

RecordLayout checkPcdHeader(const std::string& path, std::uint64_t file_size) {
  const std::string beginning = readBeginning(path, header_limit);
  Lines lines(beginning);
  Entries entries = readEntries(path, lines);
  const std::string& storage = entries["DATA"][0];
  const bool is_packed = storage == "binary_compressed";
  RecordLayout layout;
  double bytes = 0.0;   // of all points
  double values = 0.0;  // of all points
  const std::vector<RecordField> fields = makeFields(path, entries);
  const auto points = static_cast<double>(pointCount(path, entries));
  for (const RecordField& field : fields) {
    if (is_packed && field.name == "_") {
      continue;  // PCL leaves padding out of what it packs
    }
    addField(field, layout);
    bytes += points * static_cast<double>(field.count) * static_cast<double>(field.size);
    values += points * static_cast<double>(field.count);
  }
  const std::uint64_t body = bytesBehind(lines, file_size);
  if (storage == "ascii") {
    // A value needs a digit and a separator, the last one no separator.
    requireBytes(path, 2.0 * values - 1.0, body);
  } else if (storage == "binary") {
    requireBytes(path, bytes, body);
    layout.storage = RecordStorage::LittleEndian;
  } else if (is_packed) {
    layout.storage = RecordStorage::Packed;
    layout.packed_size = checkPacked(
        path, std::string_view(beginning).substr(std::min(lines.position(), beginning.size())),
        bytes, body);
    layout.body = 8;  // both sizes
  } else {
    failContent(path, "its data is stored as " + inQuotes(storage));
  }
  layout.body += lines.position();
  layout.body_line = lines.number();
  layout.points = static_cast<std::uint64_t>(points);
  layout.sensor = sensorOf(entries);
  layout.has_rows = entries["HEIGHT"][0] != "1";
  return layout;
}

}  // namespace

PointData readPcd(const std::string& path, const FileProgress& progress) {
  const RecordLayout layout = checkPcdHeader(path, checkInputFile(path));
  PointData data = readRecords(path, layout, progress);
  const Eigen::Map<const Eigen::Vector3d> sensor(layout.sensor.data());
  if (viewpointOf(positionsOf(data), sensor, layout.has_rows)) {
    data.viewpoint = layout.sensor;
  }
  return data;
}

}  // namespace spherical_param::tools
