#include "common/record_reader.h"
#include "formats/formats.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <regex>

namespace spherical_param::tools {

/// OFF as text: the vertices, with colours (COFF) and normals (NOFF).
PointData readOff(InputFile& file, const std::vector<std::string>& /*columns*/) {
  constexpr std::size_t longest_header = 1024;
  // "OFF490 518 0" is common, too.
  static const std::regex pattern("(?:#[^\\n]*\\n\\s*)*(?:ST)?(C?)(N?)OFF\\s*(?:#[^\\n]*\\n\\s*)*("
                                  "\\d+)\\s+(\\d+)[^\\n]*\\n\\s*");
  const std::string beginning(file.peek(longest_header));
  std::smatch header;
  if (!std::regex_search(beginning, header, pattern, std::regex_constants::match_continuous)) {
    failReading(file.path(), "it does not begin as OFF does that is text, of points in space",
                "save it as PLY where it was made");
  }
  const auto count = [&](std::size_t group, const char* what) {
    return static_cast<std::uint64_t>(requireCount(file, header[group].str(), what));
  };
  RecordElement vertices{"vertex", count(3, "points"), {}};
  std::vector<const char*> names = {"x", "y", "z"};
  if (header.length(2) > 0) {
    names.insert(names.end(), {"nx", "ny", "nz"});
  }
  if (header.length(1) > 0) {
    names.insert(names.end(), {"red", "green", "blue"});
  }
  for (const char* name : names) {
    vertices.fields.push_back({name, 'F', 8});
  }
  const RecordElement faces{"face", count(4, "faces"), {{"vertex_indices", 'I', 4, 1, 4}}};
  const auto values = static_cast<double>(vertices.count * vertices.fields.size() + faces.count);
  std::string_view line;
  for (auto lines = std::count(header[0].first, header[0].second, '\n'); lines > 0; --lines) {
    file.nextLine(line);
  }
  requireBytes(file, 2.0 * values - 1.0);
  if (vertices.count == 0) {
    failContent(file.path(), "it has no points");
  }
  if (countLines(file.path(), "") < vertices.count + faces.count) {
    failContent(file.path(), "it has fewer lines than points and faces");
  }
  return readRecords(file, {RecordStorage::Text, 0, {vertices, faces}});
}

}  // namespace spherical_param::tools
