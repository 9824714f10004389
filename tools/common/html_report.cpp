#include "common/html_report.h"

#include "common/errors.h"
#include "common/report_mesh.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <Eigen/Geometry>

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <new>
#include <utility>

namespace spherical_param::tools {
namespace {

constexpr std::string_view marker = "<!--DATA-->";

/// Points left out that are shown at most.
constexpr std::size_t max_left_out = 75000;

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  // The best level takes several times as long for a hundredth of the size.
  constexpr int level = 6;
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                level) != Z_OK) {
    throw std::bad_alloc();
  }
  packed.resize(size);
  return packed;
}

/// RFC 4648, section 4.
std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? digits[(bits >> (18 - 6 * k)) & 63U] : '=';
    }
  }
  return text;
}

/// An element that holds bytes, deflated and in base64. None of the bytes can close the element.
std::string element(const std::string& id, std::string_view bytes) {
  return "<script type=\"text/plain\" id=\"" + id + "\">" + base64(deflated(bytes)) + "</script>\n";
}

Eigen::AlignedBox3d boxOf(const Positions& points) {
  return {points.rowwise().minCoeff(), points.rowwise().maxCoeff()};
}

const Eigen::AlignedBox3d unit_box(Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Ones());

/// The arrays of a page: elements with the numbers, and what the page must know to read them.
class Arrays {
public:
  /// Adds rows of integers. Each is stored less that of the row before it, little-endian: of rows
  /// in a good order differences are small, which deflates well.
  template <typename Integer>
  void add(const std::string& name, std::size_t components, const std::vector<Integer>& values) {
    std::string bytes;
    bytes.reserve(values.size() * sizeof(Integer));
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto difference = static_cast<std::uint32_t>(
          values[i] - (i < components ? Integer{0} : values[i - components]));
      for (std::size_t b = 0; b < sizeof(Integer); ++b) {
        bytes += static_cast<char>(difference >> (8 * b) & 0xffU);
      }
    }
    about_[name] = {{"bits", 8 * sizeof(Integer)}, {"components", components}};
    elements_ += element("array-" + name, bytes);
  }

  /// Adds points, in 2^16 steps of a box.
  void addPoints(const std::string& name, const Positions& points, const Eigen::AlignedBox3d& box) {
    addSteps<std::uint16_t>(name, points, box.min(), box.max());
  }

  /// Adds a number of each vertex, in 2^8 steps between the bounds between which all but one
  /// percent at either end are.
  void addShades(const std::string& name, const Eigen::ArrayXd& values) {
    const auto [low, high] = robustRange(values);
    addShades(name, values, low, high);
  }

  /// Adds powers of two of area, each side of 0 in units of its own end: limbs are squeezed by many
  /// powers of two, and little is stretched as much.
  void addArea(const Eigen::ArrayXd& values) {
    const auto [min, max] = robustRange(values);
    const double low = std::min(min, -1e-3);
    const double high = std::max(max, 1e-3);
    addShades("area", (values < 0.0).select(-values / low, values / high), -1.0, 1.0);
    about_["area"]["min"] = {low};
    about_["area"]["max"] = {high};
  }

  const Json& about() const { return about_; }
  const std::string& elements() const { return elements_; }

private:
  template <typename Integer>
  void addSteps(const std::string& name, const Eigen::MatrixXd& rows, const Eigen::VectorXd& min,
                const Eigen::VectorXd& max) {
    std::vector<Integer> steps(static_cast<std::size_t>(rows.size()));
    for (Eigen::Index i = 0; i < rows.size(); ++i) {
      const Eigen::Index c = i % rows.rows();
      const double size = std::max(max[c] - min[c], std::numeric_limits<double>::min());
      const double fraction = (std::clamp(rows.data()[i], min[c], max[c]) - min[c]) / size;
      steps[static_cast<std::size_t>(i)] =
          static_cast<Integer>(std::lround(fraction * std::numeric_limits<Integer>::max()));
    }
    add(name, static_cast<std::size_t>(rows.rows()), steps);
    about_[name]["min"] = std::vector<double>(min.begin(), min.end());
    about_[name]["max"] = std::vector<double>(max.begin(), max.end());
  }

  void addShades(const std::string& name, const Eigen::ArrayXd& values, double min, double max) {
    addSteps<std::uint8_t>(name, values.transpose().matrix(), Eigen::VectorXd::Constant(1, min),
                           Eigen::VectorXd::Constant(1, max));
  }

  static std::pair<double, double> robustRange(Eigen::ArrayXd values) {
    std::sort(values.begin(), values.end());
    const auto cut = static_cast<Eigen::Index>(0.01 * static_cast<double>(values.size() - 1));
    return {values[cut], values[values.size() - 1 - cut]};
  }

  Json about_ = Json::object();
  std::string elements_;
};

void addMesh(const ReportMesh& mesh, Arrays& arrays) {
  arrays.addPoints("positions", mesh.positions, boxOf(mesh.positions));
  const std::vector<std::uint32_t> corners(mesh.triangles.data(),
                                           mesh.triangles.data() + mesh.triangles.size());
  arrays.add("triangles", 3, corners);
  arrays.add("suspicious", 1, mesh.marks);
  if (mesh.sphere.cols() > 0) {
    arrays.addPoints("sphere", mesh.sphere, unit_box);
  }
  if (mesh.area_distortion.size() > 0) {
    arrays.addArea(mesh.area_distortion);
    arrays.addShades("angle", mesh.angle_distortion.log10());
    arrays.addShades("residual", mesh.residual);
  }
}

/// The rigid motion that best fits the points of the sphere to those of the object, row by row;
/// null without a sphere.
Json sphereTurn(const ReportMesh& mesh) {
  if (mesh.sphere.cols() == 0) {
    return nullptr;
  }
  const Eigen::Matrix4d turn = Eigen::umeyama(mesh.sphere, mesh.positions, false).transpose();
  return std::vector<double>(turn.data(), turn.data() + turn.size());
}

/// Adds the colours of the cloud, and its points if those of the mesh have moved.
void addCloud(const CloudReconstruction& cloud, bool has_moved, const ReportMesh& mesh,
              Arrays& arrays) {
  if (!cloud.data->colors.empty()) {
    std::vector<std::uint8_t> colors;
    for (const Index input : mesh.inputs) {
      const Color& color = cloud.data->colors[static_cast<std::size_t>(input)];
      colors.insert(colors.end(), color.begin(), color.begin() + 3);
    }
    arrays.add("colors", 3, colors);
  }
  if (has_moved) {
    const Positions points = positionsOf(*cloud.data)(Eigen::all, mesh.inputs);
    arrays.addPoints("cloud", points, boxOf(points));
  }
}

/// Adds the finite points that were left out, and returns their number.
std::size_t addLeftOut(const CloudReconstruction& cloud, const ReportMesh& mesh, Arrays& arrays) {
  const LeftOut& all = cloud.result.left_out;
  std::vector<Index> left_out;
  for (const auto* reason : {&all.unused, &all.outliers, &all.other_parts, &all.unmeshed}) {
    std::copy_if(reason->begin(), reason->end(), std::back_inserter(left_out), [&](Index point) {
      return cloud.data->position(static_cast<std::size_t>(point)).allFinite();
    });
  }
  if (!left_out.empty()) {
    std::vector<Index> shown(std::min(left_out.size(), max_left_out));
    for (std::size_t i = 0; i < shown.size(); ++i) {
      shown[i] = left_out[i * left_out.size() / shown.size()];
    }
    const Positions points = positionsOf(*cloud.data)(Eigen::all, shown);
    // Points outside of a box around the mesh are drawn on its sides, where they can be seen.
    const Eigen::AlignedBox3d box = boxOf(mesh.positions);
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(box.diagonal().norm() / 2.0);
    arrays.addPoints("left_out", points, {box.min() - margin, box.max() + margin});
  }
  return left_out.size();
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
  return {{"report", "FILE", "write a page (.html) to look at: mesh, sphere, verdict"}};
}

std::string parseHtmlReport(const CommandLine& command_line) {
  if (!command_line.has("report")) {
    return {};
  }
  std::string file = command_line.value("report", "");
  const std::string extension = ".html";
  if (file.size() <= extension.size() ||
      lowerCase(file.substr(file.size() - extension.size())) != extension) {
    throw UsageError("option -report: " + inQuotes(file) + " is not the name of a .html file",
                     "give a name such as page.html; -json writes numbers");
  }
  if (reportPage().empty()) {
    throw UsageError("option -report: this program was built without the page of the report",
                     "install three.js (libjs-three) and build again, or use -json");
  }
  return file;
}

void keepForHtmlReport(ReconstructionSettings& settings) {
  settings.options.details = true;
}

std::string repeatedCommand(const std::string& tool, const std::vector<std::string>& words) {
  std::string command = tool;
  for (const std::string& word : words) {
    command += " " + shellWord(word);
  }
  return command;
}

void writeHtmlReport(OutputFile& file, const HtmlReportInput& input) {
  const std::string_view page = reportPage();
  const std::size_t place = page.find(marker);
  const CloudReconstruction& cloud = *input.cloud;
  std::vector<const Surface*> surfaces;
  std::size_t vertices = 0;
  Eigen::Index triangles = 0;
  double edge_lengths = 0.0;
  bool has_moved = false;
  for (const Surface& surface : cloud.result.surfaces) {
    if (input.surface == nullptr || input.surface == &surface) {
      surfaces.push_back(&surface);
      vertices += surface.vertexCount();
      triangles += surface.triangles.cols();
      edge_lengths +=
          surface.measures.mean_edge_length * static_cast<double>(surface.vertexCount());
      has_moved = has_moved || surface.consolidation || surface.smoothing;
    }
  }
  const ReportMesh mesh = reportMesh(cloud, surfaces);
  Arrays arrays;
  addMesh(mesh, arrays);
  addCloud(cloud, has_moved, mesh, arrays);
  Json json;
  json["tool"] = {{"name", input.tool}, {"version", SPHERICAL_PARAM_VERSION}};
  json["command"] = input.command;
  json["report"] = input.report;
  json["mesh"] = {{"vertices", vertices},
                  {"triangles", triangles},
                  {"shown_vertices", mesh.positions.cols()},
                  {"shown_triangles", mesh.triangles.cols()},
                  {"surface", surfaces.front() - cloud.result.surfaces.data() + 1},
                  {"shown_surfaces", surfaces.size()},
                  {"surfaces", cloud.result.surfaces.size()}};
  // Where only some vertices are shown, they are farther from each other.
  const auto count = static_cast<double>(vertices);
  json["spacing"] =
      edge_lengths / count * std::sqrt(count / static_cast<double>(mesh.positions.cols()));
  json["view"] = nullptr;
  if (cloud.result.view) {
    const Eigen::Vector3d& sensor = cloud.result.view->place;
    json["view"] = std::vector<double>(sensor.begin(), sensor.end());
  }
  json["left_out"] = addLeftOut(cloud, mesh, arrays);
  json["sphere_turn"] = sphereTurn(mesh);
  json["arrays"] = arrays.about();

  file.write(page.substr(0, place));
  file.write(element("program", reportProgram()));
  file.write(element("data", json.dump(-1, ' ', false, Json::error_handler_t::replace)));
  file.write(arrays.elements());
  file.write(page.substr(place + marker.size()));
}

}  // namespace spherical_param::tools
