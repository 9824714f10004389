#pragma once

#include "python/arrays.h"

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

/// Files and the page of a report, by the readers and writers of the tools.
namespace spherical_param::python {

/// `points` (n, 3), `normals` (n, 3) or None, `colors` (n, 3) or None.
pybind11::dict readCloudFile(const std::string& path, const pybind11::object& progress);

/// A mesh, or a plain cloud without triangles.
void writeMeshFile(const std::string& path, const DoubleArray& points, const IndexArray& triangles,
                   const std::optional<DoubleArray>& normals,
                   const std::optional<ByteArray>& colors);

/// Whether the module was built with the page.
bool hasReportPage();

/// Meshes a cloud once more, with all that the page shows.
///
/// \param rows     of the points that are meshed; none: all of them.
/// \param outliers rows that were left out, and
/// \param left_out those of other parts; none: not looked for.
/// \param keywords of reconstruct() in Python.
/// \param input    name of the cloud.
/// \param command  that does the same again.
void writeReportFile(const std::string& path, const DoubleArray& points,
                     const std::optional<ByteArray>& colors, const std::optional<IndexArray>& rows,
                     const std::optional<IndexArray>& outliers,
                     const std::optional<IndexArray>& left_out, const pybind11::dict& keywords,
                     const std::string& input, const std::string& command,
                     const pybind11::object& progress);

}  // namespace spherical_param::python
