#pragma once

#include "python/arrays.h"

#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

/// Files and the page of a report, by the readers and writers of the tools.
namespace spherical_param::python {

/// Further numbers of each point, by their names.
using ScalarArrays = std::map<std::string, Array<double>>;

/// `points` (n, 3), `normals` (n, 3) or None, `colors` (n, 3) or None, `scalars` and others.
/// \param columns of a text, or None
pybind11::dict readCloudFile(const std::string& path, const std::optional<std::string>& columns,
                             const pybind11::object& progress);

/// A mesh, or a plain cloud without triangles.
///
/// \param added  a mark of each vertex, or None
/// \param offset None: what the format needs. \return what was subtracted from the points
std::array<double, 3> writeMeshFile(const std::string& path, const Positions& points,
                                    const Triangles& triangles,
                                    const std::optional<Positions>& normals,
                                    const std::optional<Array<std::uint8_t>>& colors,
                                    const std::optional<Array<std::uint8_t>>& added,
                                    const ScalarArrays& scalars,
                                    const std::optional<std::array<double, 3>>& offset);

/// Whether the module was built with the page.
bool hasReportPage();

/// Meshes a cloud once more, with all that the page of one of its surfaces shows.
///
/// \param values  options, \see toOptions; `info`, \see toCloudInfo
/// \param part    of the surfaces, that is shown.
/// \param input   name of the cloud.
/// \param command that does the same again.
void writeReportFile(const std::string& path, const Positions& points,
                     const std::optional<Array<std::uint8_t>>& colors, const pybind11::dict& values,
                     const pybind11::dict& info, std::size_t part, const std::string& input,
                     const std::string& command, const pybind11::object& progress);

}  // namespace spherical_param::python
