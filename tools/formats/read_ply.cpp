#include "common/record_reader.h"
#include "formats/formats.h"
#include "formats/header_lines.h"

#include <map>

namespace spherical_param::tools {
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
         property.list ? static_cast<std::size_t>(plyTypeSize(property.length_type)) : 0,
         element.name == "face" &&
             (property.name == "vertex_indices" || property.name == "vertex_index")});
  }
  return skipped;
}

RecordLayout toLayout(const std::vector<PlyElement>& elements) {
  RecordLayout layout;
  bool is_behind = false;
  for (const PlyElement& element : elements) {
    if (element.name != "vertex") {
      // Without properties there is nothing to skip, however many there are.
      if (!element.properties.empty()) {
        (is_behind ? layout.after : layout.before).push_back(toSkipped(element));
      }
      if (is_behind && element.name == "face") {
        break;  // what follows is not read
      }
      continue;
    }
    is_behind = true;
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
  }
  return layout;
}

/// What a header says.
struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;

  bool isText() const { return format == "ascii"; }
};

PlyHeader parseHeader(const std::string& path, Lines& lines) {
  if (!lines.next() || lines.words().size() != 1 || lines.words()[0] != "ply") {
    failContent(path, "it does not begin as a PLY file does");
  }
  PlyHeader header;
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
      header.format = words[1];
    } else if (words[0] == "element" && words.size() == 3) {
      header.elements.push_back(
          {std::string(words[1]), requireCount(path, words[2], "elements"), {}});
    } else if (words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(parsePlyProperty(path, words));
    } else {
      failContent(path, "its header has the unknown entry " + inQuotes(words[0]));
    }
  }
  if (header.format != "ascii" && header.format != "binary_little_endian" &&
      header.format != "binary_big_endian") {
    failContent(path, "its format is neither ascii nor binary 1.0");
  }
  return header;
}

/// The least size of all elements [bytes].
double leastSize(const PlyHeader& header) {
  double size = header.isText() ? -1.0 : 0.0;  // the last number needs no separator
  for (const PlyElement& element : header.elements) {
    for (const PlyProperty& property : element.properties) {
      // The shortest list is its length alone; the shortest text a digit and a separator.
      size += static_cast<double>(element.count) * (header.isText() ? 2.0
                                                    : property.list ? 1.0
                                                                    : plyTypeSize(property.type));
    }
  }
  return size;
}

RecordLayout checkPlyHeader(const std::string& path, std::uint64_t file_size) {
  const std::string beginning = readBeginning(path, header_limit);
  Lines lines(beginning);
  const PlyHeader header = parseHeader(path, lines);
  int vertex_elements = 0;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      ++vertex_elements;
      checkPlyVertex(path, element);
    }
  }
  if (vertex_elements != 1) {
    failContent(path, "it has no vertices");
  }
  requireBytes(path, leastSize(header), bytesBehind(lines, file_size));
  RecordLayout layout = toLayout(header.elements);
  layout.storage = header.isText()                        ? RecordStorage::Text
                   : header.format == "binary_big_endian" ? RecordStorage::BigEndian
                                                          : RecordStorage::LittleEndian;
  layout.body = lines.position();
  layout.body_line = lines.number();
  return layout;
}

}  // namespace

PointData readPly(const std::string& path, const FileProgress& progress) {
  return readRecords(path, checkPlyHeader(path, checkInputFile(path)), progress);
}

}  // namespace spherical_param::tools
