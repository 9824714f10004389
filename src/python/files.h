#pragma once

#include <pybind11/pybind11.h>

namespace spherical_param::python {

/// Adds what reads and writes files, and the page of a report, by the readers and writers of the
/// tools.
void addFiles(pybind11::module_& module);

}  // namespace spherical_param::python
