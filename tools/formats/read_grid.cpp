#include "common/point_table.h"
#include "formats/formats.h"
#include "formats/header_lines.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace spherical_param::tools {

/// A grid of elevations as Esri writes it: a header, and rows from north to south. A point at the
/// middle of each cell that has an elevation.
PointData readGrid(const std::string& path, const std::vector<std::string>& /*columns*/,
                   const FileProgress& progress) {
  const std::string beginning = readBeginning(path, header_limit);
  std::map<std::string, double> header = {{"nodata_value", -9999.0}};
  Lines lines(beginning);
  std::size_t header_lines = 0;
  for (; lines.next() && lines.words().size() == 2 && !toValue(lines.words()[0]); ++header_lines) {
    header[lowerCase(lines.words()[0])] = toValue(lines.words()[1]).value_or(std::nan(""));
  }
  const auto entry = [&](const std::string& name, const std::string& other) {
    const auto found = header.find(header.count(name) > 0 ? name : other);
    if (found == header.end() || !std::isfinite(found->second)) {
      failContent(path, "its header has no " + other);
    }
    return found->second;
  };
  const auto count = [&](const char* name) {
    return requireCount(path, formatted(entry(name, name), 17), name);
  };
  const std::int64_t width = count("ncols");
  const std::int64_t cells = width * count("nrows");
  requireBytes(path, 2.0 * static_cast<double>(cells) - 1.0, checkInputFile(path));
  const double dx = entry("dx", "cellsize");
  const double dy = entry("dy", "cellsize");
  // The middle of the first cell.
  const double x = entry("xllcenter", "xllcorner") + (header.count("xllcenter") > 0 ? 0.0 : dx / 2);
  const double y = entry("yllcenter", "yllcorner") + (header.count("yllcenter") > 0 ? 0.0 : dy / 2);
  if (!(dx > 0.0 && dy > 0.0)) {
    failContent(path, "its cells have no size");
  }
  std::vector<PointColumn> columns = {{"x", false, {}}, {"y", false, {}}, {"z", false, {}}};
  std::int64_t cell = 0;
  Words words;
  forEachLine(path, progress, [&](std::size_t number, std::string_view line) {
    split(number <= header_lines ? "" : line, " \t\r", words);
    for (const std::string_view word : words) {
      const std::optional<double> value = toValue(word);
      if (!value || cell == cells) {
        failContent(path, "line " + std::to_string(number) +
                              (value ? " has more elevations than its header says"
                                     : " has no number, but " + inQuotes(word)));
      }
      if (std::isfinite(*value) && *value != header["nodata_value"]) {
        columns[0].values.push_back(x + dx * static_cast<double>(cell % width));
        columns[1].values.push_back(y + dy * static_cast<double>((cells - 1 - cell) / width));
        columns[2].values.push_back(*value);
      }
      ++cell;
    }
  });
  const std::size_t points = columns[0].values.size();
  if (cell < cells || points == 0) {
    failContent(path,
                points == 0 ? "it has no points" : "it has fewer elevations than its header says");
  }
  const std::vector<double>& z = columns[2].values;
  const auto [low, high] = std::minmax_element(z.begin(), z.end());
  const double extent =
      std::max(dx * static_cast<double>(width), dy * static_cast<double>(cells / width));
  if (std::abs(x) <= 360.0 && std::abs(y) <= 90.0 && extent < std::min(*high - *low, 360.0)) {
    failReading(path, "its cells are degrees, which are not lengths",
                "project it first, e.g. gdalwarp -t_srs EPSG:32632 -of AAIGrid in.asc out.asc");
  }
  PointData data = toPoints(std::move(columns));
  data.contents = "grid of elevations, " + grouped(static_cast<std::size_t>(cells) - points) +
                  " cells without one";
  return data;
}

}  // namespace spherical_param::tools
