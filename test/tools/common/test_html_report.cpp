// The page of -report and the mesh on it: its data are taken apart by code of its own.

#include "common/html_report.h"

#include "common/output_file.h"
#include "common/report_mesh.h"
#include "helpers.h"
#include "page_data.h"
#include "scan_shapes.h"
#include "spherical_param/map/sphere_map.h"
#include "tool_runner.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

using tool_test::Page;

Positions scanned(const std::string& shape, std::size_t points) {
  ScanOptions options;
  options.shape = shape;
  options.points = points;
  return generateScan(options).points;
}

ReconstructionSettings twoThreads() {
  ReconstructionSettings settings;
  settings.options.threads = 2;
  settings.options.topology = TopologyMode::Sphere;
  return settings;
}

/// A cloud on its way through the parts of the tool.
struct Shown {
  std::unique_ptr<CloudReconstruction> cloud = std::make_unique<CloudReconstruction>();
  ReportMesh mesh;
  Page page;
};

/// \param outliers points at the end that are left out; with any, all points have colours.
Shown show(const Positions& points, ReconstructionSettings settings = twoThreads(),
           Index outliers = 0, std::size_t max_triangles = kMaxReportTriangles) {
  Shown shown;
  CloudReconstruction& cloud = *shown.cloud;
  auto data = std::make_shared<PointData>();
  data->points = toPoints(points);
  if (outliers > 0) {
    for (Index i = 0; i < points.cols(); ++i) {
      data->colors.push_back({static_cast<std::uint8_t>(i % 251),
                              static_cast<std::uint8_t>(i / 251),
                              static_cast<std::uint8_t>(255 - i % 13), 255});
    }
  }
  cloud.data = data;
  keepForHtmlReport(settings);
  cloud.result = reconstruct(points.leftCols(points.cols() - outliers), settings.options);
  for (auto i = static_cast<Index>(points.cols()) - outliers; i < points.cols(); ++i)
    cloud.result.left_out.outliers.push_back(i);
  const Surface& surface = cloud.surface();
  const int threads = settings.options.threads;
  shown.mesh = reportMesh(cloud, surface, max_triangles, threads);
  const tool_test::TemporaryDirectory directory;
  OutputFile file(directory.file("page.html"));
  writeHtmlReport(file, "<html>\n<!--DATA-->\n</html>\n",
                  {"tool", "tool in out", {{"input", "in.ply"}}, &cloud, &surface, threads},
                  max_triangles);
  file.commit();
  shown.page = tool_test::decodedPage(tool_test::readFile(directory.file("page.html")));
  return shown;
}

double shareOf(double value, double min, double max) {
  return max > min ? (std::clamp(value, min, max) - min) / (max - min) : 0.0;
}

/// The page holds what is to be shown, in steps of its arrays.
void expectShown(const Shown& shown) {
  const Page& page = shown.page;
  const ReportMesh& mesh = shown.mesh;
  const Surface& result = shown.cloud->surface();
  const auto n = static_cast<Index>(mesh.positions.cols());
  EXPECT_EQ(page.data["mesh"]["vertices"], result.vertexCount());
  EXPECT_EQ(page.data["mesh"]["triangles"], result.triangles.cols());
  EXPECT_EQ(page.data["mesh"]["shown_vertices"], n);
  EXPECT_EQ(page.data["mesh"]["shown_triangles"], mesh.triangles.cols());
  EXPECT_EQ(page.triangles("triangles"), mesh.triangles);
  EXPECT_TRUE(test::isSphereOverAll(mesh.triangles, n));
  EXPECT_TRUE(std::equal(mesh.marks.begin(), mesh.marks.end(),
                         page.arrays.at("suspicious").integers.data()));
  EXPECT_EQ(mesh.positions,
            picked(vertexPositions(*shown.cloud, shown.cloud->surface()), mesh.vertices));
  EXPECT_EQ(mesh.sphere, picked(result.sphere, mesh.vertices));
  constexpr double step = 1.0 / 65535.0;
  ASSERT_EQ(page["positions"].cols(), n);
  ASSERT_EQ(page["sphere"].cols(), n);
  const Eigen::Vector3d size =
      mesh.positions.rowwise().maxCoeff() - mesh.positions.rowwise().minCoeff();
  const Positions off = (page["positions"] - mesh.positions).array().colwise() / size.array();
  EXPECT_LE(off.cwiseAbs().maxCoeff(), 0.51 * step);
  EXPECT_LE((page["sphere"] - mesh.sphere).cwiseAbs().maxCoeff(), 1.01 * step);
  const auto range = [&](const std::string& name, const char* end) {
    return page.data["arrays"][name][end][0].get<double>();
  };
  for (Index v = 0; v < n; ++v) {
    const auto expect_shade = [&](const std::string& name, double share) {
      EXPECT_NEAR(page.arrays.at(name).integers(v), 255.0 * share, 0.51) << name;  // half a step
    };
    const auto i = static_cast<std::size_t>(v);
    const double area = mesh.area_distortion[i];
    expect_shade("area", shareOf(area / (area < 0.0 ? -range("area", "min") : range("area", "max")),
                                 -1.0, 1.0));
    expect_shade("angle", shareOf(std::log10(mesh.angle_distortion[i]), range("angle", "min"),
                                  range("angle", "max")));
    expect_shade("residual",
                 shareOf(mesh.residual[i], range("residual", "min"), range("residual", "max")));
    const double residual = result.vertex_residuals[static_cast<std::size_t>(mesh.vertices[i])];
    EXPECT_DOUBLE_EQ(mesh.residual[i], std::log10(std::max(residual, 1e-17)));
  }
  const auto h = static_cast<Index>(page["history_positions"].cols());
  EXPECT_EQ(page["history_frames"].cols(), h * static_cast<Index>(page.data["frames"].size()));
  EXPECT_GE(page.data["frames"].size(), 3U);
  EXPECT_EQ(page.data["frames"].back()["step"], "end");
  EXPECT_TRUE(test::isSphereOverAll(page.triangles("history_triangles"), h));
}

/// Twice the areas of the triangles around each vertex.
Eigen::ArrayXd areasAround(const ReportMesh& mesh) {
  Eigen::ArrayXd areas = Eigen::ArrayXd::Zero(mesh.positions.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return mesh.positions.col(mesh.triangles(k, t));
    };
    const double area = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    for (int k = 0; k < 3; ++k)
      areas(mesh.triangles(k, t)) += area;
  }
  return areas;
}

TEST(HtmlReport, HoldsTheMeshItsMarksAndDistortionUpToRounding) {
  const Shown shown = show(scanned("bowl", 2000));
  expectShown(shown);
  const Surface& result = shown.cloud->surface();
  // The same triangles in another order, each with its marks.
  const auto marked = [](const Triangles& triangles, const std::vector<std::uint8_t>& marks,
                         const std::vector<Index>& vertices) {
    std::map<std::set<Index>, std::uint8_t> all;
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      std::set<Index> corners;
      for (int k = 0; k < 3; ++k)
        corners.insert(vertices[static_cast<std::size_t>(triangles(k, t))]);
      all[corners] = marks[static_cast<std::size_t>(t)];
    }
    return all;
  };
  const ReportMesh& mesh = shown.mesh;
  EXPECT_EQ(marked(mesh.triangles, mesh.marks, mesh.vertices),
            marked(result.triangles, result.diagnosis.triangle_marks,
                   test::range(0, static_cast<Eigen::Index>(result.vertexCount()))));
  EXPECT_TRUE(std::any_of(mesh.marks.begin(), mesh.marks.end(),
                          [](std::uint8_t mark) { return mark != 0; }));
  for (const char* absent : {"cloud", "colors", "outliers"})
    EXPECT_EQ(shown.page.arrays.count(absent), 0U);
  // Each vertex has the mean of the distortion of angles over its triangles, by their areas.
  const Eigen::ArrayXd areas = areasAround(mesh);
  const auto angles = Eigen::Map<const Eigen::ArrayXd>(mesh.angle_distortion.data(), areas.size());
  const MapDistortion core = measureMapDistortion(mesh.positions, mesh.triangles, mesh.sphere, 1);
  EXPECT_NEAR((areas * angles).sum() / areas.sum(), core.angle.mean, 1e-9 * core.angle.mean);
}

TEST(HtmlReport, AMeshWithHandlesIsShownAsAWholeWithTheirLoopsAndWithoutASphere) {
  ReconstructionSettings settings = twoThreads();
  settings.options.handles = HandleMode::Auto;
  const Shown shown = show(scanned("torus", 1500), settings, 0, 1000);
  const Surface& result = shown.cloud->surface();
  ASSERT_EQ(result.genus(), 1U);
  const Page& page = shown.page;
  EXPECT_EQ(page.triangles("triangles"), shown.mesh.triangles);
  EXPECT_EQ(page.data["mesh"]["shown_triangles"], result.triangles.cols());
  EXPECT_EQ(std::set<Index>(shown.mesh.vertices.begin(), shown.mesh.vertices.end()).size(),
            result.vertexCount());
  for (const char* absent :
       {"sphere", "area", "angle", "residual", "history_positions", "history_frames"})
    EXPECT_EQ(page.arrays.count(absent), 0U) << absent;
  EXPECT_TRUE(page.data["sphere_turn"].is_null());
  EXPECT_TRUE(page.data["frames"].empty());
  ASSERT_EQ(page.data["handles"].size(), 1U);
  const HandleLoop& handle = result.handles.front();
  EXPECT_EQ(page.data["handles"][0]["points"], handle.loop.size());
  EXPECT_EQ(page.data["handles"][0]["is_cut"], false);
  const Positions loop = picked(vertexPositions(*shown.cloud, result), handle.loop);
  ASSERT_EQ(page["handles"].cols(), loop.cols());
  EXPECT_LT((page["handles"] - loop).cwiseAbs().maxCoeff(), 1e-4);  // the extent is about 1
}

TEST(HtmlReport, HistoryEndsAtTheSphereAndBeginsElsewhere) {
  for (const Method method : {Method::Default, Method::Paper}) {
    ReconstructionSettings settings = twoThreads();
    settings.options.method = method;
    const Shown shown = show(scanned("hand", 1500), settings);
    expectShown(shown);
    const Eigen::MatrixXd& positions = shown.page["history_positions"];
    const Eigen::MatrixXd& frames = shown.page["history_frames"];
    const Positions vertices = vertexPositions(*shown.cloud, shown.cloud->surface());
    const Eigen::MatrixXd last = frames.rightCols(positions.cols());
    for (Eigen::Index i = 0; i < positions.cols(); ++i) {
      Eigen::Index nearest = 0;
      (vertices.colwise() - Eigen::Vector3d(positions.col(i)))
          .colwise()
          .squaredNorm()
          .minCoeff(&nearest);
      EXPECT_LE((last.col(i) - shown.cloud->surface().sphere.col(nearest)).cwiseAbs().maxCoeff(),
                1.01 / 65535.0);
    }
    EXPECT_GT((last - frames.leftCols(positions.cols())).cwiseAbs().maxCoeff(), 0.1);
  }
}

TEST(HtmlReport, ShowsSmoothedPointsOutliersAndColours) {
  ReconstructionSettings settings = twoThreads();
  settings.options.smoothing = 5;
  Positions far(3, 6);
  for (Eigen::Index i = 0; i < 6; ++i)
    far.col(i) << (i == 0 ? 0.9 : 3.0), 0.1 * static_cast<double>(i), -2.0;
  const Shown shown = show(test::horizontally(scanned("head", 1500), far), settings, 6);
  expectShown(shown);
  const Page& page = shown.page;
  const PointData& data = *shown.cloud->data;
  for (std::size_t row = 0; row < shown.mesh.vertices.size(); ++row) {
    const auto index = static_cast<std::size_t>(shown.mesh.vertices[row]);
    const auto column = static_cast<Eigen::Index>(row);
    for (Eigen::Index c = 0; c < 3; ++c)
      EXPECT_EQ(page.arrays.at("colors").integers(c, column),
                data.colors[index][static_cast<std::size_t>(c)]);
    // The object has an extent of about 1.
    EXPECT_LT((page["cloud"].col(column) - data.position(index)).cwiseAbs().maxCoeff(), 1e-4);
  }
  // Those that are far off come to the side of a box that is as much larger than the mesh as its
  // diagonal is long, in its middle.
  EXPECT_EQ(page.data["outliers"], 6);
  ASSERT_EQ(page["outliers"].cols(), 6);
  const Eigen::Vector3d high = shown.mesh.positions.rowwise().maxCoeff();
  const double margin = (high - shown.mesh.positions.rowwise().minCoeff()).norm() / 2.0;
  EXPECT_LT(high.x() + margin, 3.0);
  for (Eigen::Index i = 0; i < 6; ++i)
    EXPECT_NEAR(page["outliers"](0, i), std::min(far(0, i), high.x() + margin), 1e-4);
}

TEST(HtmlReport, ArraysAreTheSameForAnyNumberOfThreads) {
  std::map<std::string, std::string> first;
  for (const int threads : {1, 2, 3}) {
    ReconstructionSettings settings = twoThreads();
    settings.options.threads = threads;
    settings.options.smoothing = 2;
    const Shown shown = show(scanned("animal", 2000), settings, 0, 2000);
    if (threads == 1)
      first = shown.page.texts;
    EXPECT_TRUE(shown.page.texts == first) << threads;
  }
}

TEST(HtmlReport, HasAboutTwelveBytesForATriangle) {
  const Shown shown = show(test::spiralSphere(20000));
  // The program of the page and the unfolding of large meshes are as large for every mesh.
  double size = 0.0;
  for (const auto& [name, text] : shown.page.texts)
    size += name.rfind("history", 0) == 0 ? 0.0 : static_cast<double>(text.size());
  EXPECT_LT(size, 13.5 * static_cast<double>(shown.mesh.triangles.cols()));
}

TEST(HtmlReport, AReducedMeshIsClosedAndHasTheShapeAndTheSuspiciousPlaces) {
  const Shown whole = show(scanned("bowl", 2400));
  const Shown shown = show(scanned("bowl", 2400), twoThreads(), 0, 1200);
  expectShown(shown);
  EXPECT_EQ(shown.mesh.triangles.cols(), 1200);
  EXPECT_EQ(std::set<Index>(shown.mesh.vertices.begin(), shown.mesh.vertices.end()).size(), 602U);
  const auto holes = [](const Shown& of) {
    return std::count_if(of.mesh.marks.begin(), of.mesh.marks.end(),
                         [](std::uint8_t mark) { return (mark & 2U) != 0; });
  };
  EXPECT_GT(holes(whole), 10);
  EXPECT_GT(holes(shown), holes(whole) / 2);
  // A fourth of the vertices flattens what is round a little.
  const double area = areasAround(whole.mesh).sum();
  EXPECT_NEAR(areasAround(shown.mesh).sum(), area, 0.1 * area);
}

TEST(HtmlReport, HasTheSpacingOfTheShownPointsOfTheInput) {
  ReconstructionSettings smoothed = twoThreads();
  smoothed.options.smoothing = 5;
  const Positions points = 1e6 * scanned("bird", 1500);
  for (const std::size_t max_triangles : {kMaxReportTriangles, std::size_t{800}}) {
    const Shown shown = show(points, smoothed, 0, max_triangles);
    const Positions cloud = picked(points, shown.mesh.vertices);
    const NeighborLists nearest = test::bruteForceNeighbors(cloud, 1);
    std::vector<double> distances;
    for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
      const Index other = nearest.indices[static_cast<std::size_t>(i)];
      distances.push_back((cloud.col(i) - cloud.col(other)).norm());
    }
    std::sort(distances.begin(), distances.end());
    const double median = distances[distances.size() / 2];
    const double spacing = shown.page.data["spacing"];
    EXPECT_TRUE(spacing > median && spacing < 2.0 * median) << spacing << ", " << median;
  }
}

TEST(HtmlReport, TinyCloudsHaveAPage) {
  for (const std::size_t points : {4U, 5U, 12U})
    expectShown(show(scanned("sphere", points)));
}

}  // namespace
}  // namespace spherical_param::tools
