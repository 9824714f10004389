#include "python/files.h"

#include "common/cloud_reader.h"
#include "common/cloud_reconstruction.h"
#include "common/file_formats.h"
#include "common/html_report.h"
#include "common/mesh_view.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "common/point_table.h"
#include "common/reconstruction_report.h"
#include "python/arrays.h"
#include "python/conversions.h"
#include "spherical_param/version.h"

#include <pybind11/stl.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace spherical_param::python {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

/// Further numbers of each point, by their names.
using ScalarArrays = std::map<std::string, Array<double>>;

tools::PointData toPointData(const Positions& points, const std::optional<Positions>& normals,
                             const std::optional<Array<std::uint8_t>>& colors,
                             const ScalarArrays& scalars = {}) {
  tools::PointData data;
  data.points = tools::toPoints(points);
  if (normals)
    data.normals = tools::toNormals(*normals);
  if (colors) {
    const auto rows = colors->unchecked<2>();
    for (py::ssize_t i = 0; i < rows.shape(0); ++i)
      data.colors.push_back({rows(i, 0), rows(i, 1), rows(i, 2), 255});
  }
  for (const auto& [name, values] : scalars)
    data.scalars.push_back(tools::makeScalar(name, {values.data(), values.data() + values.size()}));
  return data;
}

tools::Json reportOf(tools::ReconstructionSettings settings, const std::string& input,
                     const tools::CloudReconstruction& cloud, const Surface& surface) {
  tools::Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = input;
  json["options"] = tools::optionsToJson(tools::reconstructionOptions(settings));
  json["points"] = cloud.data->points.size();
  json["left_out"] = tools::toJson(cloud.result.left_out);
  json["stages"] = tools::toJson(cloud.stages);
  json.update(tools::toJson(surface));
  return json;
}

/// `points` (n, 3), `normals` (n, 3) or None, `colors` (n, 3) or None, `scalars` and others.
/// \param columns of a text, or None
py::dict readCloudFile(const std::string& path, const std::optional<std::string>& columns,
                       const py::object& progress) {
  Listener listener(progress);
  const tools::PointData data = listener.run([&] {
    return tools::readCloud(
        path, [&](double fraction) { listener.step("read", fraction); },
        columns ? tools::parseColumns(*columns) : std::vector<std::string>());
  });
  py::dict scalars;
  for (const tools::Scalar& scalar : data.scalars)
    scalars[py::str(scalar.name)] = toArray(scalar.values);
  return py::dict(
      "points"_a = toArray(data.points),
      "normals"_a = data.normals.empty() ? py::object(py::none())
                                         : py::object(firstColumns<double, 3>(data.normals)),
      "colors"_a = data.colors.empty() ? py::object(py::none())
                                       : py::object(firstColumns<std::uint8_t, 3>(data.colors)),
      "scalars"_a = scalars, "unused"_a = toArray(data.unused), "viewpoint"_a = data.viewpoint);
}

/// \param added  a mark of each vertex, or None
/// \param offset None: what the format needs. \return what was subtracted from the points
tools::Point writeMeshFile(const std::string& path, const Positions& points,
                           const Triangles& triangles, const std::optional<Positions>& normals,
                           const std::optional<Array<std::uint8_t>>& colors,
                           const std::optional<Array<std::uint8_t>>& added,
                           const ScalarArrays& scalars, const std::optional<tools::Point>& offset) {
  const tools::FileFormat format = tools::requireFormat(path, tools::FileUse::WriteMesh);
  const tools::PointData data = toPointData(points, normals, colors, scalars);
  tools::MeshView mesh(data, triangles);
  const tools::Point taken_off =
      offset ? *offset : tools::offsetFor(data, format, tools::Encoding::Binary);
  mesh.shiftBy(taken_off);
  if (added)
    mesh.markAdded({added->data(), added->data() + added->size()});
  const py::gil_scoped_release others_may_run;
  tools::OutputFile file(path);
  tools::writeMesh(file, mesh, format, tools::Encoding::Binary, {});
  file.commit();
  return taken_off;
}

/// Meshes a cloud once more, with all that the page of one of its surfaces shows.
///
/// \param values  options, \see toOptions; `info`, \see toCloudInfo
/// \param part    of the surfaces, that is shown.
/// \param input   name of the cloud.
/// \param command that does the same again.
void writeReportFile(const std::string& path, const Positions& points,
                     const std::optional<Array<std::uint8_t>>& colors, const py::dict& values,
                     const py::dict& info, std::size_t part, const std::string& input,
                     const std::string& command, const py::object& progress) {
  Listener listener(progress);
  tools::ReconstructionSettings settings;
  settings.options = toOptions(values, listener);
  tools::keepForHtmlReport(settings);
  tools::CloudReconstruction cloud;
  cloud.data = std::make_shared<tools::PointData>(toPointData(points, std::nullopt, colors));
  const CloudInfo cloud_info = toCloudInfo(info);
  listener.run([&] {
    cloud.result = reconstruct(points, settings.options, {}, cloud_info);
    cloud.stages = cloud.result.stages;
    const Surface& surface = cloud.result.surfaces.at(part);
    tools::OutputFile file(path);
    tools::writeHtmlReport(file, {"spherical_param", command,
                                  reportOf(settings, input, cloud, surface), &cloud, &surface});
    file.commit();
  });
}

}  // namespace

void addFiles(py::module_& module) {
  module.attr("has_report") = !tools::reportPage().empty();
  module.def("read_cloud", &readCloudFile, "path"_a, py::kw_only(), "columns"_a, "progress"_a);
  module.def("write_mesh", &writeMeshFile);
  module.def("write_report", &writeReportFile, "path"_a, "points"_a, "colors"_a, "options"_a,
             py::kw_only(), "info"_a, "part"_a, "input"_a, "command"_a, "progress"_a);
}

}  // namespace spherical_param::python
