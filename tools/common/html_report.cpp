#include "common/html_report.h"

#include "common/errors.h"
#include "common/packed_array.h"
#include "common/report_mesh.h"
#include "common/report_page.h"
#include "common/text.h"
#include "spherical_param/embedding_history.h"
#include "spherical_param/sphere_triangulation.h"
#include "spherical_param/version.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace spherical_param::tools {
namespace {

constexpr std::string_view marker = "<!--DATA-->";

/// Ways of vertices in the history at most, and states.
constexpr Index most_history_vertices = 5000;
constexpr int most_history_frames = 40;
/// Of small meshes fewer, so that the history is not larger than the mesh: one for so many
/// vertices, but so many anyhow.
constexpr std::size_t vertices_for_history = 23;
constexpr std::size_t least_history_vertices = 1000;

/// Points of the cloud that are shown beside a mesh at most.
constexpr std::size_t most_cloud_points = 150000;

/// Entries of lists of points in the report that a page repeats at most: nobody reads more.
constexpr std::size_t most_listed = 1000;

/// Residuals of a page at most: more than its curve has pixels.
constexpr std::size_t most_residuals = 2000;

/// Shares of vertices that are darker or brighter than all colours.
constexpr double clamped_share = 0.01;

const std::array<std::pair<EmbeddingStep, const char*>, 5> step_names = {{
    {EmbeddingStep::Start, "start"},
    {EmbeddingStep::Sweeps, "sweep"},
    {EmbeddingStep::Newton, "newton"},
    {EmbeddingStep::Iteration, "iteration"},
    {EmbeddingStep::End, "end"},
}};

std::string nameOfStep(EmbeddingStep step) {
  const auto found = std::find_if(step_names.begin(), step_names.end(),
                                  [step](const auto& entry) { return entry.first == step; });
  return found->second;
}

std::vector<double> numbersOf(const Positions& points) {
  return {points.data(), points.data() + points.size()};
}

PackedArray integers(const std::string& name, PackedType type, std::size_t components,
                     std::vector<std::uint32_t> values) {
  PackedArray array;
  array.name = name;
  array.type = type;
  array.components = components;
  array.values = std::move(values);
  return array;
}

PackedArray integers(const std::string& name, const Triangles& triangles) {
  std::vector<std::uint32_t> values;
  values.reserve(static_cast<std::size_t>(triangles.size()));
  for (Eigen::Index i = 0; i < triangles.size(); ++i) {
    values.push_back(static_cast<std::uint32_t>(triangles.data()[i]));
  }
  return integers(name, PackedType::U32, 3, std::move(values));
}

/// The bounds between which all but a few values are.
std::pair<double, double> robustRange(std::vector<double> values) {
  if (values.empty()) {
    return {0.0, 0.0};
  }
  const auto cut =
      static_cast<std::ptrdiff_t>(clamped_share * static_cast<double>(values.size() - 1));
  const auto low = values.begin() + cut;
  std::nth_element(values.begin(), low, values.end());
  const double min = *low;
  const auto high = values.end() - 1 - cut;
  std::nth_element(values.begin(), high, values.end());
  return {min, *high};
}

PackedArray attribute(const std::string& name, const std::vector<double>& values) {
  const auto [min, max] = robustRange(values);
  return quantized(name, PackedType::U8, values, min, max);
}

/// Powers of two of area: the colours of each side of 0 have the whole of it, and of a long range
/// (limbs are squeezed by many powers of two) 8 bits leave few steps for the shorter side.
PackedArray areaDistortion(const std::vector<double>& values) {
  const auto [min, max] = robustRange(values);
  constexpr double least_steps = 32.0;
  const double shorter = std::min(min < 0.0 ? -min : max - min, max > 0.0 ? max : max - min);
  const bool is_long = 255.0 * shorter < least_steps * (max - min);
  return quantized("area_distortion", is_long ? PackedType::U16 : PackedType::U8, values, min, max);
}

/// Ratios from 1 to that which one vertex of a hundred exceeds. Their logarithm has the colours: of
/// a long range 8 bits leave few steps for what is near 1.
PackedArray angleDistortion(const std::vector<double>& values) {
  const double max = std::max(1.0, robustRange(values).second);
  constexpr double long_range = 5.0;
  return quantized("angle_distortion", max > long_range ? PackedType::U16 : PackedType::U8, values,
                   1.0, max);
}

/// Bits of a number with two between each and the next.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32U) & 0x00ff00000000ffffU;
  bits = (bits | bits << 16U) & 0x00ff0000ff0000ffU;
  bits = (bits | bits << 8U) & 0xf00f00f00f00f00fU;
  bits = (bits | bits << 4U) & 0x30c30c30c30c30c3U;
  bits = (bits | bits << 2U) & 0x9249249249249249U;
  return bits;
}

/// Moves removed points that are farther from the middle of the others' box than that box is long
/// to this distance, in the same direction: one point far off would leave no steps for the object.
///
/// \param points indices into `is_removed`. \param numbers coordinates of each of these.
void bringNear(const std::vector<std::size_t>& points, const std::vector<bool>& is_removed,
               std::vector<double>& numbers) {
  const auto place = [&](std::size_t i) {
    return Eigen::Map<Eigen::Vector3d>(numbers.data() + 3 * i);
  };
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_removed[points[i]]) {
      box.extend(place(i));
    }
  }
  if (box.isEmpty()) {
    return;
  }
  const Eigen::Vector3d middle = box.center();
  const double most = box.diagonal().norm();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d off = place(i) - middle;
    const double distance = off.norm();
    if (is_removed[points[i]] && distance > most) {
      place(i) = middle + most / distance * off;
    }
  }
}

/// The cloud, where the mesh does not show it: its points along a space-filling curve.
void addCloud(const CloudReconstruction& cloud, std::vector<PackedArray>& arrays) {
  const bool has_outliers = cloud.outliers && !cloud.outliers->indices.empty();
  if (cloud.result().smoothed.cols() == 0 && !has_outliers) {
    return;
  }
  std::vector<bool> is_removed(cloud.data.points.size(), false);
  std::size_t removed = 0;
  if (has_outliers) {
    for (const int i : cloud.outliers->indices) {
      is_removed[static_cast<std::size_t>(i)] = true;
    }
    removed = cloud.outliers->indices.size();
  }
  std::vector<std::size_t> points;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < cloud.data.points.size(); ++i) {
    const Point& point = cloud.data.points[i];
    if (std::all_of(point.begin(), point.end(), [](float x) { return std::isfinite(x); })) {
      points.push_back(i);
      numbers.insert(numbers.end(), point.begin(), point.end());
    }
  }
  bringNear(points, is_removed, numbers);
  const PackedArray all = quantized("cloud", PackedType::U16, 3, numbers);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  order.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    order.emplace_back(spread(all.values[3 * i]) | spread(all.values[3 * i + 1]) << 1U |
                           spread(all.values[3 * i + 2]) << 2U,
                       static_cast<std::uint32_t>(i));
  }
  std::sort(order.begin(), order.end());
  // Outliers are few and the point of it: all of them, and every so-manieth of the others.
  const auto every = [](std::size_t count, std::size_t most) {
    return std::max<std::size_t>(1, (count + most - 1) / most);
  };
  const std::size_t step_removed = every(removed, most_cloud_points / 2);
  const std::size_t step =
      every(points.size() - std::min(removed, points.size()), most_cloud_points / 2);
  PackedArray shown;
  shown.name = all.name;
  shown.type = all.type;
  shown.components = all.components;
  shown.min = all.min;
  shown.max = all.max;
  std::vector<std::uint32_t> flags;
  std::size_t seen = 0;
  std::size_t seen_removed = 0;
  for (const auto& [key, i] : order) {
    const bool is_out = is_removed[points[i]];
    if (is_out ? seen_removed++ % step_removed != 0 : seen++ % step != 0) {
      continue;
    }
    shown.values.insert(shown.values.end(),
                        {all.values[3 * i], all.values[3 * i + 1], all.values[3 * i + 2]});
    flags.push_back(is_out ? 1 : 0);
  }
  arrays.push_back(std::move(shown));
  if (has_outliers) {
    arrays.push_back(integers("cloud_removed", PackedType::U8, 1, std::move(flags)));
  }
}

void addMesh(const ReportMesh& mesh, std::vector<PackedArray>& arrays) {
  arrays.push_back(quantized("positions", PackedType::U16, 3, numbersOf(mesh.positions)));
  arrays.push_back(quantized("sphere", PackedType::U16, numbersOf(mesh.sphere), -1.0, 1.0, 3));
  arrays.push_back(integers("triangles", mesh.triangles));
  if (!mesh.colors.empty()) {
    std::vector<std::uint32_t> colors;
    for (const Color& color : mesh.colors) {
      colors.insert(colors.end(), color.begin(), color.begin() + 3);
    }
    arrays.push_back(integers("colors", PackedType::U8, 3, std::move(colors)));
  }
  arrays.push_back(areaDistortion(mesh.area_distortion));
  arrays.push_back(angleDistortion(mesh.angle_distortion));
  arrays.push_back(attribute("residual", mesh.residual));
  arrays.push_back(
      integers("suspicious", PackedType::U8, 1, {mesh.marks.begin(), mesh.marks.end()}));
}

/// Adds the unfolding, and returns what there is to say about it.
Json addHistory(const CloudReconstruction& cloud, std::vector<PackedArray>& arrays) {
  const Result& result = cloud.result();
  const EmbeddingHistory& history = result.history;
  const std::size_t all = history.vertices.size();
  const std::size_t count =
      std::min(all, std::max(least_history_vertices, result.vertexCount() / vertices_for_history));
  if (history.frames.empty() || count < 4) {
    return nullptr;
  }
  std::vector<Index> places(count);  // among the vertices of the history
  for (std::size_t i = 0; i < count; ++i) {
    places[i] = static_cast<Index>(i * all / count);
  }
  const auto picked = [&](const Positions& of_history) {
    Positions points(3, static_cast<Eigen::Index>(count));
    for (std::size_t i = 0; i < count; ++i) {
      points.col(static_cast<Eigen::Index>(i)) = of_history.col(places[i]);
    }
    return points;
  };
  const Triangles unordered = triangulateSphere(picked(history.frames.back().sphere)).triangles;
  const MeshOrder order = traversalOrder(unordered, count);
  std::vector<Index> reordered;
  reordered.reserve(count);
  for (const Index vertex : order.vertices) {
    reordered.push_back(places[static_cast<std::size_t>(vertex)]);
  }
  places = std::move(reordered);

  const Positions vertices = vertexPositions(cloud);
  Positions positions(3, static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    positions.col(static_cast<Eigen::Index>(i)) =
        vertices.col(history.vertices[static_cast<std::size_t>(places[i])]);
  }
  arrays.push_back(integers("history_triangles", order.renumbered));
  arrays.push_back(quantized("history_positions", PackedType::U16, 3, numbersOf(positions)));
  std::vector<double> directions;
  directions.reserve(3 * count * history.frames.size());
  Json frames = Json::array();
  for (const HistoryFrame& frame : history.frames) {
    const Positions shown = picked(frame.sphere);
    directions.insert(directions.end(), shown.data(), shown.data() + shown.size());
    frames.push_back({{"level", frame.level},
                      {"nodes", frame.nodes},
                      {"step", nameOfStep(frame.step)},
                      {"iteration", frame.iteration},
                      {"residual", frame.residual ? Json(*frame.residual) : Json(nullptr)}});
  }
  arrays.push_back(quantized("history_frames", PackedType::U16, directions, -1.0, 1.0, 3));
  return {
      {"vertices", count}, {"triangles", order.renumbered.cols()}, {"frames", std::move(frames)}};
}

Json describe(const std::vector<PackedArray>& arrays) {
  Json json = Json::object();
  for (const PackedArray& array : arrays) {
    Json& entry = json[array.name];
    entry["type"] = "u" + std::to_string(8 * static_cast<int>(array.type));
    entry["components"] = array.components;
    entry["count"] = array.rows();
    if (!array.min.empty()) {
      entry["min"] = array.min;
      entry["max"] = array.max;
    }
  }
  return json;
}

/// Some in even distances of the numbers of a long list, the first and the last among them.
Json thinned(const Json& list) {
  if (!list.is_array() || list.size() <= most_residuals) {
    return list;
  }
  Json some = Json::array();
  for (std::size_t i = 0; i < most_residuals; ++i) {
    some.push_back(list[i * (list.size() - 1) / (most_residuals - 1)]);
  }
  return some;
}

/// The report without the rest of long lists, whose lengths it or the page tells elsewhere.
Json shortened(Json report) {
  const auto shorten = [](Json& list) {
    if (list.is_array() && list.size() > most_listed) {
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(most_listed), list.end());
    }
  };
  if (report.contains("graph")) {
    shorten(report["graph"]["without_tangent_plane"]);
    shorten(report["graph"]["bridges"]);
  }
  if (report.contains("outliers") && report["outliers"].is_object()) {
    shorten(report["outliers"]["indices"]);
  }
  if (report.contains("residuals")) {
    report["residuals"] = thinned(report["residuals"]);
  }
  return report;
}

/// JSON that does not end the element that holds it.
std::string scriptText(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    // Only strings have it.
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

/// A word as a POSIX shell takes it.
std::string shellWord(const std::string& word) {
  constexpr std::string_view harmless =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!word.empty() && word.find_first_not_of(harmless) == std::string::npos) {
    return word;
  }
  std::string quoted = "'";
  for (const char c : word) {
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted + "'";
}

}  // namespace

std::vector<OptionInfo> htmlReportOptions() {
  return {{"report", "FILE", "write a page (.html) to look at: mesh, sphere, unfolding, verdict"}};
}

std::string parseHtmlReport(const CommandLine& command_line) {
  if (!command_line.has("report")) {
    return {};
  }
  std::string file = command_line.value("report", "");
  const std::string extension = ".html";
  if (file.size() <= extension.size() ||
      lowerCase(file.substr(file.size() - extension.size())) != extension) {
    throw UsageError("option -report: " + inQuotes(file) + " is no name of a page",
                     "give a name that ends in .html; -json writes numbers");
  }
  if (reportPage().empty()) {
    throw UsageError("option -report: this program was built without the page of the report",
                     "install npm and build again, or use -json");
  }
  return file;
}

void keepForHtmlReport(ReconstructionSettings& settings) {
  settings.options.history.vertices = most_history_vertices;
  settings.options.history.frames = most_history_frames;
  settings.options.details = true;
}

std::string repeatedCommand(const std::string& tool, const CommandLine& command_line,
                            const std::vector<OptionInfo>& options,
                            const std::vector<std::string>& files,
                            const ReconstructionSettings& settings) {
  std::string command = tool;
  const Json seed = reconstructionOptionsToJson(settings)["seed"];
  const bool has_dashes = std::any_of(files.begin(), files.end(), [](const std::string& file) {
    return !file.empty() && file[0] == '-';
  });
  std::string words;
  for (const std::string& file : files) {
    words += " " + shellWord(file);
  }
  if (!has_dashes) {
    command += words;
  }
  for (const OptionInfo& option : options) {
    if (!command_line.has(option.name)) {
      if (option.name == "seed" && seed.is_number()) {
        command += " -seed " + seed.dump();
      }
      continue;
    }
    const std::string value = command_line.value(option.name, "");
    command += " -" + option.name;
    if (!option.argument.empty()) {
      // A value that looks like an option has to be joined to its own.
      command += (value.empty() || value[0] == '-' ? "=" : " ") + shellWord(value);
    }
  }
  return has_dashes ? command + " --" + words : command;
}

void writeHtmlReport(OutputFile& file, std::string_view page, const HtmlReportInput& input,
                     std::size_t most_triangles) {
  const std::size_t place = page.find(marker);
  if (place == std::string_view::npos) {
    throw Failure("the page of the report has no place for its data",
                  "this should not happen: please report it");
  }
  const CloudReconstruction& cloud = *input.cloud;
  std::vector<PackedArray> arrays;
  const ReportMesh mesh = reportMesh(cloud, most_triangles, input.threads);
  addMesh(mesh, arrays);
  addCloud(cloud, arrays);
  Json json;
  json["format"] = 1;
  json["tool"] = {{"name", input.tool}, {"version", SPHERICAL_PARAM_VERSION}};
  json["command"] = input.command;
  json["report"] = shortened(input.report);
  if (input.report.contains("residuals")) {
    json["residual_count"] = input.report["residuals"].size();
  }
  json["mesh"] = {{"vertices", cloud.result().vertexCount()},
                  {"triangles", cloud.result().triangles.cols()},
                  {"shown_vertices", mesh.positions.cols()},
                  {"shown_triangles", mesh.triangles.cols()},
                  {"decimated", mesh.decimated},
                  {"sphere_of", "embedding"}};
  json["history"] = addHistory(cloud, arrays);
  json["arrays"] = describe(arrays);

  file.write(page.substr(0, place));
  file.write("<script type=\"application/json\" id=\"report-data\">");
  file.write(scriptText(json));
  file.write("</script>\n");
  for (const PackedArray& array : arrays) {
    file.write("<script type=\"text/plain\" id=\"array-" + array.name + "\">");
    file.write(textOf(array));
    file.write("</script>\n");
  }
  file.write(page.substr(place + marker.size()));
}

}  // namespace spherical_param::tools
