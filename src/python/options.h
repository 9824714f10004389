#pragma once

#include "python/listener.h"
#include "spherical_param/options.h"
#include "spherical_param/reconstruct.h"

#include <pybind11/pybind11.h>

namespace spherical_param::python {

/// The rows of optionTable() as the package in Python needs them.
pybind11::list optionRows();

/// Options that report to a listener.
///
/// \throw InvalidInput for a value that is out of range, or of another type.
Options toOptions(const pybind11::dict& values, Listener& listener);

/// `normals` (n, 3), `viewpoint` and `unused` (u,) of a cloud; each may be None.
CloudInfo toCloudInfo(const pybind11::dict& info);

}  // namespace spherical_param::python
