#include "common/record_reader.h"
#include "formats/formats.h"
#include "formats/header_lines.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <regex>

namespace spherical_param::tools {

/// OFF as text: the vertices, with colours (COFF) and normals (NOFF).
PointData readOff(const std::string& path, const std::vector<std::string>& /*columns*/,
                  const FileProgress& progress) {
  constexpr std::size_t longest_header = 1024;
  // "OFF490 518 0" is common, too.
  static const std::regex pattern("(?:#[^\\n]*\\n\\s*)*(?:ST)?(C?)(N?)OFF\\s*(?:#[^\\n]*\\n\\s*)*("
                                  "\\d+)\\s+(\\d+)[^\\n]*\\n\\s*");
  const std::uint64_t file_size = checkInputFile(path);
  const std::string beginning = readBeginning(path, longest_header);
  std::smatch header;
  if (!std::regex_search(beginning, header, pattern, std::regex_constants::match_continuous)) {
    failReading(path, "it does not begin as OFF does that is text, of points in space",
                "save it as PLY where it was made");
  }
  const auto count = [&](std::size_t group, const char* what) {
    return static_cast<std::uint64_t>(requireCount(path, header[group].str(), what));
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
  const auto body = static_cast<std::uint64_t>(header.length());
  requireBytes(path, 2.0 * values - 1.0, file_size - std::min(body, file_size));
  if (vertices.count == 0) {
    failContent(path, "it has no points");
  }
  if (countLines(path, "") < vertices.count + faces.count) {
    failContent(path, "it has fewer lines than points and faces");
  }
  const auto lines = std::count(beginning.begin(), beginning.begin() + header.length(), '\n');
  return readRecords(
      path, {RecordStorage::Text, body, static_cast<std::size_t>(lines), 0, {vertices, faces}},
      progress);
}

}  // namespace spherical_param::tools
