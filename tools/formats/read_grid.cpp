#include "common/point_table.h"
#include "formats/formats.h"
#include "formats/text_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace spherical_param::tools {

/// A grid of elevations as Esri writes it: a header, and rows from north to south. A point at the
/// middle of each cell that has an elevation.
PointData readGrid(InputFile& file, const std::vector<std::string>& /*columns*/) {
  std::map<std::string, double> header = {{"nodata_value", -9999.0}};
  std::string_view line;
  Words words;
  const auto is_header = [&] {
    split(line, " \t\r,", words);
    return words.size() == 2 && !toValue(words[0]);
  };
  while (file.nextLine(line) && is_header()) {
    header[lowerCase(words[0])] = toValue(words[1]).value_or(std::nan(""));
  }
  const auto entry = [&](const std::string& name, const std::string& other) {
    const auto found = header.find(header.count(name) > 0 ? name : other);
    if (found == header.end() || !std::isfinite(found->second)) {
      failContent(file.path(), "its header has no " + other);
    }
    return found->second;
  };
  const auto count = [&](const char* name) {
    return requireCount(file, formatted(entry(name, name), 17), name);
  };
  const std::int64_t width = count("ncols");
  const std::int64_t cells = width * count("nrows");
  const std::uint64_t taken = file.size() - file.bytesLeft();
  requireBytes(file, 2.0 * static_cast<double>(cells) - 1.0 - static_cast<double>(taken));
  const double dx = entry("dx", "cellsize");
  const double dy = entry("dy", "cellsize");
  // The middle of the first cell.
  const double x = entry("xllcenter", "xllcorner") + (header.count("xllcenter") > 0 ? 0.0 : dx / 2);
  const double y = entry("yllcenter", "yllcorner") + (header.count("yllcenter") > 0 ? 0.0 : dy / 2);
  if (!(dx > 0.0 && dy > 0.0)) {
    failContent(file.path(), "its cells have no size");
  }
  std::vector<PointColumn> columns = {{"x", false, {}}, {"y", false, {}}, {"z", false, {}}};
  std::int64_t cell = 0;
  do {
    split(line, " \t\r", words);
    for (const std::string_view word : words) {
      const std::optional<double> value = toValue(word);
      if (!value || cell == cells) {
        failLine(file, value ? "has more elevations than its header says"
                             : "has no number, but " + inQuotes(word));
      }
      if (std::isfinite(*value) && *value != header["nodata_value"]) {
        columns[0].values.push_back(x + dx * static_cast<double>(cell % width));
        columns[1].values.push_back(y + dy * static_cast<double>((cells - 1 - cell) / width));
        columns[2].values.push_back(*value);
      }
      ++cell;
    }
  } while (file.nextLine(line));
  const std::size_t points = columns[0].values.size();
  if (cell < cells || points == 0) {
    failContent(file.path(),
                points == 0 ? "it has no points" : "it has fewer elevations than its header says");
  }
  const std::vector<double>& z = columns[2].values;
  const auto [low, high] = std::minmax_element(z.begin(), z.end());
  const double extent =
      std::max(dx * static_cast<double>(width), dy * static_cast<double>(cells / width));
  if (std::abs(x) <= 360.0 && std::abs(y) <= 90.0 && extent < std::min(*high - *low, 360.0)) {
    failReading(file.path(), "its cells are degrees, which are not lengths",
                "project it first, e.g. gdalwarp -t_srs EPSG:32632 -of AAIGrid in.asc out.asc");
  }
  PointData data = toPoints(std::move(columns));
  data.contents = "grid of elevations, " + grouped(static_cast<std::size_t>(cells) - points) +
                  " cells without one";
  return data;
}

}  // namespace spherical_param::tools
