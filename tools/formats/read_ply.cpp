#include "common/record_reader.h"
#include "formats/formats.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace spherical_param::tools {
namespace {

/// A field of a type of PLY; of any other type, 'T' without a size.
RecordField fieldOf(std::string_view type) {
  static const std::map<std::string_view, std::pair<char, std::size_t>> types = {
      {"char", {'I', 1}},     {"int8", {'I', 1}},     {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
      {"short", {'I', 2}},    {"int16", {'I', 2}},    {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
      {"int", {'I', 4}},      {"int32", {'I', 4}},    {"uint", {'U', 4}},   {"uint32", {'U', 4}},
      {"long", {'I', 8}},     {"int64", {'I', 8}},    {"ulong", {'U', 8}},  {"uint64", {'U', 8}},
      {"float", {'F', 4}},    {"float32", {'F', 4}},  {"double", {'F', 8}}, {"float64", {'F', 8}},
      {"longlong", {'I', 8}}, {"ulonglong", {'U', 8}}};
  RecordField field;
  const auto found = types.find(type);
  std::tie(field.type, field.size) =
      found == types.end() ? std::pair('T', std::size_t{0}) : found->second;
  return field;
}

/// The property that a line of a header describes.
RecordField parseProperty(const InputFile& file, const Words& words) {
  const bool is_list = words.size() > 1 && words[1] == "list";
  const std::size_t expected = is_list ? 5 : 3;
  if (words.size() != expected) {
    failContent(file.path(), "its header has a broken property");
  }
  RecordField field = fieldOf(words[expected - 2]);
  field.name = words[expected - 1];
  if (is_list) {
    const RecordField length = fieldOf(words[2]);
    if (length.type != 'I' && length.type != 'U') {
      failContent(file.path(), "its header has the unknown type " + inQuotes(words[2]));
    }
    field.length_size = length.size;
  }
  return field;
}

/// The entries of a header, up to its end.
RecordLayout parseHeader(InputFile& file) {
  Words words;
  if (!nextWords(file, words) || words.size() != 1 || words[0] != "ply") {
    failContent(file.path(), "it does not begin as a PLY file does");
  }
  static const std::map<std::string_view, RecordStorage> storages = {
      {"ascii", RecordStorage::Text},
      {"binary_little_endian", RecordStorage::LittleEndian},
      {"binary_big_endian", RecordStorage::BigEndian}};
  RecordLayout layout;
  bool has_storage = false;
  bool has_end = false;
  while (!has_end && nextWords(file, words)) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") {
      continue;
    }
    if (words[0] == "end_header") {
      has_end = true;
    } else if (words[0] == "format" && words.size() == 3 && words[2] == "1.0") {
      const auto storage = storages.find(words[1]);
      has_storage = storage != storages.end();
      layout.storage = has_storage ? storage->second : layout.storage;
    } else if (words[0] == "element" && words.size() == 3) {
      layout.elements.push_back(
          {std::string(words[1]),
           static_cast<std::uint64_t>(requireCount(file, words[2], "elements")),
           {}});
    } else if (words[0] == "property" && !layout.elements.empty()) {
      layout.elements.back().fields.push_back(parseProperty(file, words));
    } else {
      failContent(file.path(), "its header has the unknown entry " + inQuotes(words[0]));
    }
  }
  if (!has_end) {
    failContent(file.path(), "its header has no end");
  }
  if (!has_storage) {
    failContent(file.path(), "its format is neither ascii nor binary 1.0");
  }
  return layout;
}

void checkPoints(const InputFile& file, const std::vector<RecordElement>& elements) {
  int kinds = 0;
  for (const RecordElement& element : elements) {
    if (element.name != "vertex") {
      continue;
    }
    std::set<std::string> names;
    for (const RecordField& field : element.fields) {
      if (!names.insert(field.name).second) {
        failContent(file.path(),
                    "its vertices have the property " + inQuotes(field.name) + " twice");
      }
    }
    ++kinds;
    if (element.count == 0 || element.fields.empty()) {
      failContent(file.path(), "it has no points");
    }
  }
  if (kinds != 1) {
    failContent(file.path(), "it has no vertices");
  }
}

}  // namespace

PointData readPly(InputFile& file, const std::vector<std::string>& /*columns*/) {
  RecordLayout layout = parseHeader(file);
  checkPoints(file, layout.elements);
  const bool is_text = layout.storage == RecordStorage::Text;
  double least_size = is_text ? -1.0 : 0.0;  // the last number needs no separator
  for (const RecordElement& element : layout.elements) {
    for (const RecordField& field : element.fields) {
      if (field.type == 'T' && !is_text) {
        failContent(file.path(), "its header has an unknown type, of " + inQuotes(field.name));
      }
      // The shortest list is its length alone; the shortest text a digit and a separator.
      const std::size_t size = field.length_size > 0 ? field.length_size : field.size;
      least_size += static_cast<double>(element.count) * static_cast<double>(is_text ? 2 : size);
    }
  }
  requireBytes(file, least_size);
  // Without properties there is nothing to read, however many there are.
  const auto is_empty = [](const RecordElement& element) { return element.fields.empty(); };
  layout.elements.erase(std::remove_if(layout.elements.begin(), layout.elements.end(), is_empty),
                        layout.elements.end());
  return readRecords(file, layout);
}

}  // namespace spherical_param::tools
