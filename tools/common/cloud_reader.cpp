#include "common/cloud_reader.h"

#include "common/errors.h"
#include "common/file_formats.h"
#include "common/input_file.h"
#include "common/point_table.h"
#include "common/text.h"

namespace spherical_param::tools {

std::vector<std::string> parseColumns(const std::string& text) {
  std::vector<std::string> names;
  for (const std::string_view name : split(text, ", ")) {
    names.emplace_back(name);
  }
  if (!areCoordinatesNamed(names)) {
    throw UsageError("option -columns: " + inQuotes(text) + " has no x, y and z",
                     "name the columns from the first on, e.g. -columns x,y,z,-,red,green,blue");
  }
  return names;
}

PointData readCloud(const std::string& path, const FileProgress& progress,
                    const std::vector<std::string>& columns) {
  const FileFormat format = requireFormat(path, FileUse::ReadCloud);
  InputFile file(path, progress);
  const std::string_view beginning = file.peek(2);
  if (beginning == "\xff\xfe" || beginning == "\xfe\xff") {
    failReading(path, "it is text in UTF-16",
                "convert it: iconv -f UTF-16 -t UTF-8 in.txt > out.txt");
  }
  if (!columns.empty() && format->read_cloud != readText) {
    throw UsageError("-columns names the columns of text, which " + inQuotes(path) + " is not",
                     "leave it out");
  }
  return format->read_cloud(file, columns);
}

}  // namespace spherical_param::tools
