#pragma once

#include "python/arrays.h"
#include "spherical_param/reconstruct.h"

#include <pybind11/pybind11.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace spherical_param::python {

/// The rows of optionTable() as the package in Python needs them.
pybind11::list optionRows();

/// \throw InvalidInput for a value that is out of range, or of another type.
Options toOptions(const pybind11::dict& values);

/// The rows of an array that are meshed: those that were chosen and are finite.
struct FinitePoints {
  /// \param chosen ascending; none: all rows.
  explicit FinitePoints(const DoubleArray& array,
                        const std::optional<IndexArray>& chosen = std::nullopt);

  Positions points;
  std::vector<Index> rows;  ///< of each point in the array
  std::size_t given = 0;    ///< rows of the array
  std::size_t ignored = 0;  ///< rows that are not finite
};

}  // namespace spherical_param::python
