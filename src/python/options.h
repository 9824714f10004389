#pragma once

#include "spherical_param/options.h"

#include <pybind11/pybind11.h>

namespace spherical_param::python {

/// The rows of optionTable() as the package in Python needs them.
pybind11::list optionRows();

/// \throw InvalidInput for a value that is out of range, or of another type.
Options toOptions(const pybind11::dict& values);

}  // namespace spherical_param::python
