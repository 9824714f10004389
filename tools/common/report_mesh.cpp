#include "common/report_mesh.h"

#include "space_filling_curve.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace spherical_param::tools {
namespace {

std::size_t at(Eigen::Index i) {
  return static_cast<std::size_t>(i);
}

/// A triangle by two of its sides, from the same corner.
struct Sides {
  Eigen::Vector3d first;
  Eigen::Vector3d second;

  Sides(const Positions& points, const Triangles& triangles, Index t)
      : first(points.col(triangles(1, t)) - points.col(triangles(0, t))),
        second(points.col(triangles(2, t)) - points.col(triangles(0, t))) {}

  double twiceArea() const { return first.cross(second).norm(); }
};

/// sigma_1 / sigma_2 of the linear map from a flat triangle to another.
double anisotropy(const Sides& from, const Sides& to) {
  constexpr double most = 1e6;
  // The trace of the inverse of one metric with the other is sigma_1^2 + sigma_2^2; over the
  // determinant it is the ratio and its inverse.
  const double sum = (from.second.squaredNorm() * to.first.squaredNorm() -
                      2.0 * from.first.dot(from.second) * to.first.dot(to.second) +
                      from.first.squaredNorm() * to.second.squaredNorm()) /
                     (from.twiceArea() * to.twiceArea());
  return sum < most ? sum / 2.0 + std::sqrt(std::max(0.0, sum * sum / 4.0 - 1.0)) : most;
}

void measureDistortion(ReportMesh& mesh) {
  Eigen::Array3Xd sums = Eigen::Array3Xd::Zero(3, mesh.positions.cols());
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Sides in_space(mesh.positions, mesh.triangles, t);
    const Sides on_sphere(mesh.sphere, mesh.triangles, t);
    const double area = in_space.twiceArea();
    const Eigen::Array3d added(area, on_sphere.twiceArea(), area * anisotropy(in_space, on_sphere));
    for (const Index v : mesh.triangles.col(t))
      sums.col(v) += added;
  }
  constexpr double least = 1e-300;
  const auto logarithms = [&](int row) {
    return (sums.row(row) / std::max(sums.row(row).sum(), least)).max(least).log();
  };
  mesh.area_distortion = (logarithms(1) - logarithms(0)).transpose() / std::log(2.0);
  mesh.angle_distortion = (sums.row(2) / sums.row(0).max(least)).max(1.0).transpose();
}

/// log10 of the residual of each vertex. What is not finite counts as 0, which has no logarithm.
Eigen::ArrayXd residualExponents(const Surface& result) {
  constexpr double least = 1e-17;
  Eigen::ArrayXd residuals =
      Eigen::ArrayXd::Constant(static_cast<Eigen::Index>(result.vertexCount()), least);
  for (std::size_t v = 0; v < result.vertex_residuals.size(); ++v)
    if (std::isfinite(result.vertex_residuals[v]))
      residuals[static_cast<Eigen::Index>(v)] = std::max(result.vertex_residuals[v], least);
  return residuals.log10();
}

/// A mark of vertices, beside the bits of triangle_mark.
constexpr std::uint8_t at_boundary = 128;

/// Leaves of the mesh's vertices the marked ones and those of suspicious triangles, if these are
/// few, and others evenly in their order. A triangle of the new mesh between three of suspicious
/// triangles is suspicious as well; one between three at the boundary is over an opening.
void reduce(std::size_t max_vertices, std::vector<std::uint8_t> marks_around, ReportMesh& mesh) {
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (const Index v : mesh.triangles.col(t)) {
      marks_around[at(v)] |= mesh.marks[at(t)];
    }
  }
  auto others = static_cast<std::size_t>(
      std::count(marks_around.begin(), marks_around.end(), std::uint8_t{0}));
  const std::size_t marked = marks_around.size() - others;
  const bool keeps_marked = 2 * marked <= max_vertices;
  others = keeps_marked ? others : marks_around.size();
  const std::size_t room = keeps_marked ? max_vertices - marked : max_vertices;
  std::vector<Index> kept;
  std::size_t seen = 0;
  for (std::size_t v = 0; v < marks_around.size(); ++v) {
    const bool is_other = !keeps_marked || marks_around[v] == 0;
    // Bresenham's line: `room` of the others at equal distances.
    if (!is_other || (seen + 1) * room / others != seen * room / others) {
      kept.push_back(static_cast<Index>(v));
    }
    seen += is_other ? 1 : 0;
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    mesh.inputs[i] = mesh.inputs[at(kept[i])];
  }
  mesh.inputs.resize(kept.size());
  mesh.positions = mesh.positions(Eigen::all, kept).eval();
  mesh.sphere = mesh.sphere(Eigen::all, kept).eval();
  for (Eigen::ArrayXd* values : {&mesh.area_distortion, &mesh.angle_distortion, &mesh.residual}) {
    *values = (*values)(kept).eval();
  }
  mesh.triangles = triangulateSphere(mesh.sphere);
  mesh.marks.clear();
  Index shown = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto mark = [&](Index k) { return marks_around[at(kept[at(mesh.triangles(k, t))])]; };
    const auto marks = static_cast<std::uint8_t>(mark(0) & mark(1) & mark(2));
    if ((marks & at_boundary) == 0) {
      mesh.marks.push_back(marks);
      mesh.triangles.col(shown++) = mesh.triangles.col(t).eval();
    }
  }
  mesh.triangles.conservativeResize(3, shown);
}

/// Sorts the triangles by their vertices, each from its least vertex on.
void sortTriangles(ReportMesh& mesh) {
  std::vector<std::pair<std::array<Index, 3>, std::uint8_t>> sorted;
  sorted.reserve(mesh.marks.size());
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    std::array<Index, 3> corners = {mesh.triangles(0, t), mesh.triangles(1, t),
                                    mesh.triangles(2, t)};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    sorted.emplace_back(corners, mesh.marks[at(t)]);
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t t = 0; t < sorted.size(); ++t) {
    std::copy(sorted[t].first.begin(), sorted[t].first.end(), mesh.triangles.data() + 3 * t);
    mesh.marks[t] = sorted[t].second;
  }
}

ReportMesh meshOfSurface(const Surface& result, std::size_t max_triangles) {
  const bool has_sphere = result.sphere.cols() > 0;
  ReportMesh mesh;
  const std::vector<Index> vertices =
      internal::mortonOrder(has_sphere ? result.sphere : result.points);
  mesh.positions = result.points(Eigen::all, vertices);
  std::vector<Index> place_of(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    place_of[at(vertices[i])] = static_cast<Index>(i);
    mesh.inputs.push_back(result.input_of_vertex[at(vertices[i])]);
  }
  mesh.triangles = result.triangles.unaryExpr([&place_of](Index v) { return place_of[at(v)]; });
  mesh.marks = result.diagnosis.triangle_marks;
  mesh.marks.resize(at(mesh.triangles.cols()), 0);
  if (has_sphere) {
    mesh.sphere = result.sphere(Eigen::all, vertices);
    mesh.residual = residualExponents(result)(vertices);
    measureDistortion(mesh);
    const std::size_t max_vertices = std::max<std::size_t>(max_triangles / 2 + 2, 4);
    if (at(mesh.triangles.cols()) > max_triangles && vertices.size() > max_vertices) {
      std::vector<std::uint8_t> marks(vertices.size(), 0);
      for (const std::vector<Index>& loop : result.boundary)
        for (const Index v : loop)
          marks[at(place_of[at(v)])] = at_boundary;
      reduce(max_vertices, std::move(marks), mesh);
    }
  }
  sortTriangles(mesh);
  return mesh;
}

}  // namespace

ReportMesh reportMesh(const CloudReconstruction& cloud, const std::vector<const Surface*>& surfaces,
                      std::size_t max_triangles) {
  std::size_t whole = 0;    // triangles of surfaces without a sphere
  std::size_t reduced = 0;  // of the others
  for (const Surface* surface : surfaces) {
    (surface->sphere.cols() > 0 ? reduced : whole) += at(surface->triangles.cols());
  }
  const std::size_t room = std::min(max_triangles - std::min(max_triangles, whole), reduced);
  std::vector<ReportMesh> meshes;
  ReportMesh all;
  bool has_sphere = cloud.result.view.has_value();
  Index vertices = 0;
  for (const Surface* surface : surfaces) {
    const std::size_t fraction =
        at(surface->triangles.cols()) * room / std::max<std::size_t>(reduced, 1);
    meshes.push_back(meshOfSurface(*surface, fraction));
    has_sphere = has_sphere && surface->sphere.cols() > 0;
    vertices += static_cast<Index>(meshes.back().positions.cols());
    all.marks.insert(all.marks.end(), meshes.back().marks.begin(), meshes.back().marks.end());
    all.inputs.insert(all.inputs.end(), meshes.back().inputs.begin(), meshes.back().inputs.end());
  }
  if (meshes.size() == 1) {
    return std::move(meshes.front());
  }
  all.positions.resize(3, vertices);
  all.sphere.resize(3, has_sphere ? vertices : 0);
  all.triangles.resize(3, static_cast<Eigen::Index>(all.marks.size()));
  Index vertex = 0;
  Eigen::Index triangle = 0;
  for (const ReportMesh& mesh : meshes) {
    all.positions.middleCols(vertex, mesh.positions.cols()) = mesh.positions;
    if (has_sphere) {
      all.sphere.middleCols(vertex, mesh.sphere.cols()) = mesh.sphere;
    }
    all.triangles.middleCols(triangle, mesh.triangles.cols()) = mesh.triangles.array() + vertex;
    vertex += static_cast<Index>(mesh.positions.cols());
    triangle += mesh.triangles.cols();
  }
  return all;
}

}  // namespace spherical_param::tools
