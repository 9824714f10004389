#include "python/files.h"

#include "common/cloud_reader.h"
#include "common/cloud_reconstruction.h"
#include "common/file_formats.h"
#include "common/html_report.h"
#include "common/mesh_view.h"
#include "common/mesh_writer.h"
#include "common/output_file.h"
#include "common/reconstruction_report.h"
#include "common/report_page.h"
#include "python/listener.h"
#include "python/names.h"
#include "python/options.h"
#include "spherical_param/version.h"

#include <memory>
#include <utility>
#include <vector>

namespace spherical_param::python {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

constexpr Names<PartsMode, 3> kPartsNames = {{
    {"all", PartsMode::All},
    {"largest", PartsMode::Largest},
    {"each", PartsMode::Each},
}};

tools::PointData toPointData(const DoubleArray& points, const std::optional<DoubleArray>& normals,
                             const std::optional<ByteArray>& colors) {
  tools::PointData data;
  data.points = tools::toPoints(toPositions(points));
  if (normals)
    data.normals = tools::toNormals(toPositions(*normals));
  if (colors) {
    const auto rows = colors->unchecked<2>();
    for (py::ssize_t i = 0; i < rows.shape(0); ++i)
      data.colors.push_back({rows(i, 0), rows(i, 1), rows(i, 2), 255});
  }
  return data;
}

/// What the tools make of their command line.
tools::ReconstructionSettings toSettings(const py::dict& keywords) {
  tools::ReconstructionSettings settings;
  py::dict table;
  for (const auto& [key, value] : keywords) {
    const auto name = key.cast<std::string>();
    if (name == "parts")
      settings.parts = valueOf("parts", value.cast<std::string>(), kPartsNames);
    else if (name == "min_points")
      settings.min_points = value.cast<int>();
    else if (name != "outliers")
      table[key] = value;
    else if (py::isinstance<py::str>(value))
      settings.outliers = tools::OutlierChoice{};
    else if (!value.is_none())
      settings.outliers = tools::OutlierChoice{value.cast<double>()};
  }
  settings.options = toOptions(table);
  tools::keepForHtmlReport(settings);
  return settings;
}

std::vector<Index> toIndices(const IndexArray& array) {
  return {array.data(), array.data() + array.size()};
}

tools::Json reportOf(const tools::ReconstructionSettings& settings, const std::string& input,
                     const tools::CloudReconstruction& cloud) {
  tools::Json json;
  json["version"] = SPHERICAL_PARAM_VERSION;
  json["input"] = input;
  json["options"] = tools::reconstructionOptionsToJson(settings);
  json.update(tools::cloudToJson(settings, cloud));
  tools::addMesh(settings, cloud, json);
  return json;
}

}  // namespace

py::dict readCloudFile(const std::string& path, const py::object& progress) {
  Listener listener(progress);
  const tools::PointData data = listener.run([&] {
    tools::requireFormat(path, tools::FileUse::ReadCloud);
    return tools::readCloud(path, [&](double fraction) { listener.step("read", fraction); });
  });
  return py::dict("points"_a = toArray(data.points),
                  "normals"_a = data.normals.empty() ? py::object(py::none())
                                                     : py::object(toArray(data.normals)),
                  "colors"_a = data.colors.empty() ? py::object(py::none())
                                                   : py::object(toArray(data.colors)));
}

void writeMeshFile(const std::string& path, const DoubleArray& points, const IndexArray& triangles,
                   const std::optional<DoubleArray>& normals,
                   const std::optional<ByteArray>& colors) {
  const Triangles faces = toTriangles(triangles);
  const tools::FileFormat format = tools::requireFormat(
      path, faces.cols() > 0 ? tools::FileUse::WriteMesh : tools::FileUse::WriteCloud);
  const tools::PointData data = toPointData(points, normals, colors);
  const py::gil_scoped_release others_may_run;
  tools::OutputFile file(path);
  tools::writeMesh(file, tools::MeshView(data, faces), format, tools::Encoding::Binary, {});
  file.commit();
}

bool hasReportPage() {
  return !tools::reportPage().empty();
}

void writeReportFile(const std::string& path, const DoubleArray& points,
                     const std::optional<ByteArray>& colors, const std::optional<IndexArray>& rows,
                     const std::optional<IndexArray>& outliers,
                     const std::optional<IndexArray>& left_out, const py::dict& keywords,
                     const std::string& input, const std::string& command,
                     const py::object& progress) {
  Listener listener(progress);
  tools::ReconstructionSettings settings = toSettings(keywords);
  static_cast<Execution&>(settings.options) =
      listener.execution(settings.options.threads, settings.options.time_limit);
  FinitePoints finite(points, rows);
  tools::CloudReconstruction cloud;
  cloud.data = std::make_shared<tools::PointData>(toPointData(points, std::nullopt, colors));
  cloud.ignored = finite.ignored;
  if (outliers)
    cloud.outliers = tools::OutlierRemoval{std::nullopt, toIndices(*outliers)};
  if (left_out)
    cloud.parts = Parts{{}, toIndices(*left_out)};
  cloud.meshed = std::move(finite.rows);
  listener.run([&] {
    cloud.result = reconstruct(finite.points, settings.options);
    cloud.stages = cloud.result.stages;
    for (const Index point : cloud.result.input_of_vertex)
      cloud.point_of_vertex.push_back(cloud.meshed[static_cast<std::size_t>(point)]);
    tools::OutputFile file(path);
    tools::writeHtmlReport(file, tools::reportPage(),
                           {"spherical_param", command, reportOf(settings, input, cloud), &cloud,
                            settings.options.threads});
    file.commit();
  });
}

}  // namespace spherical_param::python
