#pragma once

#include "spherical_param/map/sphere_map.h"
#include "spherical_param/result.h"

#include <pybind11/pybind11.h>

/// Results of the core as dictionaries, whose keys are the names of the fields of the classes that
/// the package makes of them.
namespace spherical_param::python {

/// Structs in it are dictionaries, lists of structs and of arrays are tuples.
pybind11::dict toDict(const Result& result);

/// The structs of a surface, those that others consist of first: name, help and fields, each of
/// which has a name, a type in Python, a help and the name of the struct that it consists of.
pybind11::list resultTable();

pybind11::dict toDict(const MapDistortion& distortion);
pybind11::dict toDict(const SphereMap& map);

}  // namespace spherical_param::python
