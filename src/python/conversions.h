#pragma once

#include "python/listener.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/options.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/result.h"

#include <pybind11/pybind11.h>

/// Options of the core from dictionaries, and its results as dictionaries, whose keys are the names
/// of the fields of Result and Results in Python.
namespace spherical_param::python {

/// The rows of optionTable() as the package in Python needs them.
pybind11::list optionRows();

/// Options that report to a listener.
///
/// \throw InvalidInput for a value that is out of range, or of another type.
Options toOptions(const pybind11::dict& values, Listener& listener);

/// `normals` (n, 3), `viewpoint` and `unused` (u,) of a cloud; each may be None.
CloudInfo toCloudInfo(const pybind11::dict& info);

/// The surfaces in it are dictionaries; other structs are objects of the classes that
/// make_types.py writes. Lists of structs and of arrays are tuples.
pybind11::dict toDict(const Result& result);

/// The structs of a result, those that others consist of first: name, help and fields, each of
/// which has a name, a type in Python and a help.
pybind11::list resultTable();

pybind11::dict toDict(const MapDistortion& distortion);
pybind11::dict toDict(const SphereMap& map);

}  // namespace spherical_param::python
