#pragma once

#include "spherical_param/map/sphere_map.h"
#include "spherical_param/reconstruct.h"

#include <pybind11/pybind11.h>

#include <vector>

/// Results of the core as dictionaries, whose keys are the names of the fields of the classes that
/// the package makes of them.
namespace spherical_param::python {

/// \param input_of_kept index in the caller's array of each point that was meshed.
/// \param points_given rows of the caller's array.
pybind11::dict toDict(const Result& result, const std::vector<Index>& input_of_kept,
                      std::size_t points_given);

pybind11::dict toDict(const MapDistortion& distortion);
pybind11::dict toDict(const SphereMap& map);

}  // namespace spherical_param::python
