#include "common/point_table.h"

#include "common/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <utility>

namespace spherical_param::tools {
namespace {

using Columns = std::vector<PointColumn>;

/// Moves the values of columns out of the table, point by point.
template <typename Value, std::size_t Count, typename Convert>
std::vector<Value> gathered(const std::vector<PointColumn*>& columns, const Convert& convert) {
  std::vector<Value> result(columns.empty() ? 0 : columns.front()->values.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    std::array<double, Count> values{};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      values[c] = columns[c]->values[i];
    }
    result[i] = convert(values);
  }
  for (PointColumn* column : columns) {
    *column = {};
  }
  return result;
}

/// What a colour is multiplied with to be in 0 ... 255.
double colorScale(const std::vector<PointColumn*>& columns) {
  double largest = 0.0;
  for (const PointColumn* column : columns) {
    if (column->is_byte) {
      return 1.0;
    }
    for (const double value : column->values) {
      largest = std::max(largest, std::isfinite(value) ? value : 0.0);
    }
  }
  return largest <= 1.0 ? 255.0 : largest <= 255.0 ? 1.0 : 1.0 / 257.0;
}

void takeColors(Columns& columns, PointData& data) {
  std::vector<PointColumn*> channels = findColumns(columns, {"red", "green", "blue"});
  if (!channels.empty()) {
    const std::vector<PointColumn*> alpha = findColumns(columns, {"alpha"});
    channels.insert(channels.end(), alpha.begin(), alpha.end());
    data.has_alpha = !alpha.empty();
    const double scale = colorScale(channels);
    data.colors = gathered<Color, 4>(channels, [&](const std::array<double, 4>& values) {
      const auto channel = [&](double value) {
        // The comparison also sorts out what is not a number.
        const double byte = value >= 0.0 ? std::min(value * scale, 255.0) : 0.0;
        return static_cast<std::uint8_t>(std::lround(byte));
      };
      return Color{channel(values[0]), channel(values[1]), channel(values[2]),
                   data.has_alpha ? channel(values[3]) : std::uint8_t{255}};
    });
    return;
  }
  for (const std::string name : {"rgba", "rgb"}) {
    const std::vector<PointColumn*> packed = findColumns(columns, {name});
    if (packed.empty()) {
      continue;
    }
    data.has_alpha = name == "rgba";
    data.colors = gathered<Color, 1>(packed, [&](const std::array<double, 1>& value) {
      const bool fits = value[0] >= 0.0 && value[0] <= 4294967295.0;
      const auto bits = fits ? static_cast<std::uint32_t>(value[0]) : 0U;
      return Color{static_cast<std::uint8_t>(bits >> 16U), static_cast<std::uint8_t>(bits >> 8U),
                   static_cast<std::uint8_t>(bits),
                   static_cast<std::uint8_t>(data.has_alpha ? bits >> 24U : 255U)};
    });
    return;
  }
}

void takeNormals(Columns& columns, PointData& data) {
  const std::vector<PointColumn*> found = findColumns(columns, {"nx", "ny", "nz"});
  if (found.empty()) {
    return;
  }
  data.normals =
      gathered<Normal, 3>(found, [](const std::array<double, 3>& v) { return toFloat(v); });
  const auto is_null = [](const Normal& normal) {
    const double length = std::hypot(normal[0], normal[1], normal[2]);
    return !(length > 0.0) || !std::isfinite(length);
  };
  if (std::all_of(data.normals.begin(), data.normals.end(), is_null)) {
    data.normals.clear();
    data.has_null_normals = true;
  }
}

constexpr std::string_view around_names = " \t\r\"'/#%!";

/// A name in lower case without its unit, cut to a length that is safe for regular expressions.
std::string plainName(std::string_view name) {
  constexpr std::size_t longest = 100;
  return lowerCase(
      trimmed(name.substr(0, std::min(longest, name.find_first_of("[("))), around_names));
}

/// The axis of a name that maps and surveys use, as "x" of "Easting", "POINT_X" and "X_UTM"; empty
/// for others.
std::string axisOf(std::string_view name) {
  static const std::regex pattern(
      "(east(?:ing)?)|(north(?:ing)?)|(elev(?:ation)?|height|alt(?:itude)?)|"
      "(?:utm|coord|point|pos|position)_?([xyz])|([xyz])_?(?:utm|coord|pos|position)");
  std::smatch match;
  const std::string plain = plainName(name);
  if (!std::regex_match(plain, match, pattern)) {
    return "";
  }
  return match[1].matched   ? "x"
         : match[2].matched ? "y"
         : match[3].matched ? "z"
                            : match[4].str() + match[5].str();
}

/// The columns by their names and those of maps, if each is the only one of its axis; empty if not.
std::vector<PointColumn*> columnsOfMap(Columns& columns, const std::vector<std::string>& names) {
  std::vector<PointColumn*> found(names.size(), nullptr);
  for (PointColumn& column : columns) {
    if (plainName(column.name) == "width") {
      return {};  // that height is no axis
    }
    const std::string axis = axisOf(column.name);
    const auto place =
        std::find(names.begin(), names.end(), axis.empty() ? commonName(column.name) : axis);
    if (place == names.end()) {
      continue;
    }
    PointColumn*& of_axis = found[static_cast<std::size_t>(place - names.begin())];
    if (of_axis != nullptr) {
      return {};
    }
    of_axis = &column;
  }
  return std::count(found.begin(), found.end(), nullptr) == 0 ? found : std::vector<PointColumn*>();
}

}  // namespace

std::string commonName(std::string_view name) {
  static const std::map<std::string, std::string> known = {{"r", "red"},
                                                           {"g", "green"},
                                                           {"b", "blue"},
                                                           {"a", "alpha"},
                                                           {"diffuse_red", "red"},
                                                           {"diffuse_green", "green"},
                                                           {"rf", "red"},
                                                           {"gf", "green"},
                                                           {"bf", "blue"},
                                                           {"normal_x", "nx"},
                                                           {"normal_y", "ny"},
                                                           {"normal_z", "nz"},
                                                           {"diffuse_blue", "blue"}};
  const std::string lower = plainName(name);
  static const std::regex numbered("(point|normal).*:([012])");  // "points_m_xyz:0" of ParaView's
  std::smatch match;
  if (std::regex_match(lower, match, numbered)) {
    return (match[1] == "normal" ? "n" : "") + std::string(1, "xyz"[match[2].str()[0] - '0']);
  }
  const auto found = known.find(lower);
  return found == known.end() ? lower : found->second;
}

std::vector<PointColumn*> findColumns(Columns& columns, const std::vector<std::string>& names) {
  std::vector<PointColumn*> found;
  for (const std::string& name : names) {
    auto column = std::find_if(columns.begin(), columns.end(), [&](const PointColumn& other) {
      return lowerCase(other.name) == name;
    });
    if (column == columns.end()) {
      column = std::find_if(columns.begin(), columns.end(), [&](const PointColumn& other) {
        return commonName(other.name) == name;
      });
    }
    if (column == columns.end()) {
      return columnsOfMap(columns, names);
    }
    found.push_back(&*column);
  }
  return found;
}

bool areCoordinatesNamed(const std::vector<std::string>& names) {
  Columns columns;
  for (const std::string& name : names) {
    columns.push_back({name, false, {}});
  }
  return !findColumns(columns, {"x", "y", "z"}).empty();
}

Scalar makeScalar(std::string_view name, std::vector<double> values) {
  Scalar scalar{std::string(trimmed(name, around_names)), std::move(values)};
  std::replace_if(
      scalar.name.begin(), scalar.name.end(),
      [](char c) { return static_cast<unsigned char>(c) <= ' '; }, '_');
  scalar.is_double = std::any_of(scalar.values.begin(), scalar.values.end(), [](double value) {
    return std::isfinite(value) && static_cast<double>(static_cast<float>(value)) != value;
  });
  return scalar;
}

PointData toPoints(Columns columns) {
  PointData data;
  data.points = gathered<Point, 3>(findColumns(columns, {"x", "y", "z"}),
                                   [](const Point& point) { return point; });
  takeColors(columns, data);
  takeNormals(columns, data);
  std::set<std::string> taken = {"",    "x",     "y",    "z",     "nx",  "ny",   "nz",
                                 "red", "green", "blue", "alpha", "rgb", "rgba", "added"};
  for (PointColumn& column : columns) {
    if (!column.values.empty() && taken.insert(commonName(column.name)).second) {
      data.scalars.push_back(makeScalar(column.name, std::move(column.values)));
    }
  }
  return data;
}

}  // namespace spherical_param::tools
