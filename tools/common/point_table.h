#pragma once

#include "common/point_data.h"

#include <string>
#include <string_view>
#include <vector>

namespace spherical_param::tools {

/// A column of a file, with a value for each point.
struct PointColumn {
  std::string name;      ///< as the file has it; empty: the column is left out
  bool is_byte = false;  ///< its values are 0 ... 255, even if none is above 1
  std::vector<double> values;
};

/// The common name of a column, in lower case: "x" of "X", "//X", "x [mm]" and "Points:0", "nx" of
/// "normal_x", "red" of "R"; names that are not known stay as they are.
std::string commonName(std::string_view name);

/// The columns of a common name, in the order of the names; x, y and z may also be easting,
/// northing and elevation. Empty if one is missing.
std::vector<PointColumn*> findColumns(std::vector<PointColumn>& columns,
                                      const std::vector<std::string>& names);

/// Whether x, y and z are among the names of columns.
bool areCoordinatesNamed(const std::vector<std::string>& names);

/// A scalar with a name that all programs take.
Scalar makeScalar(std::string_view name, std::vector<double> values);

/// Makes points of the columns of a file:
///
/// - x, y and z, which must be there, nx, ny and nz, red, green, blue and alpha, or rgb or rgba, a
///   number of 32 bits, by their common names;
/// - the others are scalars.
///
/// Colours of other types than bytes go up to 1, 255 or 65535, whichever holds the largest. Normals
/// are left out if all of them are zero or not finite.
PointData toPoints(std::vector<PointColumn> columns);

}  // namespace spherical_param::tools
