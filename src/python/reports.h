#pragma once

#include "python/options.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/reconstruct.h"

#include <pybind11/pybind11.h>

/// Results of the core as dictionaries, whose keys are the names of the fields of the classes that
/// the package makes of them.
namespace spherical_param::python {

/// Indices of points are those of the caller's array.
pybind11::dict toDict(const Surface& result, const FinitePoints& finite);

pybind11::dict toDict(const MapDistortion& distortion);
pybind11::dict toDict(const SphereMap& map);

}  // namespace spherical_param::python
