#include "common/report_mesh.h"

#include "spherical_param/self_intersection.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace spherical_param::tools {
namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

/// A triangle in its plane, by its edges from one corner: (length, 0) and (x, height).
struct InPlane {
  double length;
  double x;
  double height;

  InPlane(const Eigen::Vector3d& first, const Eigen::Vector3d& second)
      : length(first.norm()), x(length > 0.0 ? first.dot(second) / length : second.norm()),
        height(length > 0.0 ? first.cross(second).norm() / length : 0.0) {}
};

/// sigma_1 / sigma_2 of the linear map from a flat triangle to another.
double anisotropy(const InPlane& source, const InPlane& image) {
  constexpr double most = 1e6;
  if (!(source.length > 0.0) || !(source.height > 0.0)) {
    return most;
  }
  const double a = image.length / source.length;
  const double b = (image.x - a * source.x) / source.height;
  const double d = image.height / source.height;
  // sigma_1 + sigma_2 and sigma_1 - sigma_2 are the moduli of the conformal and the anticonformal
  // part; the determinant, which is their product, does not cancel out.
  const double sigma_1 = 0.5 * (std::hypot(a + d, b) + std::hypot(a - d, b));
  const double determinant = a * d;
  return sigma_1 * sigma_1 < most * determinant ? sigma_1 * sigma_1 / determinant : most;
}

void measureDistortion(ReportMesh& mesh) {
  const auto n = static_cast<std::size_t>(mesh.positions.cols());
  std::vector<double> in_space(n, 0.0);
  std::vector<double> on_sphere(n, 0.0);
  std::vector<double> weighted(n, 0.0);
  double all_space = 0.0;
  double all_sphere = 0.0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto edges = [&](const Positions& of) {
      const Eigen::Vector3d corner = of.col(mesh.triangles(0, t));
      return std::pair<Eigen::Vector3d, Eigen::Vector3d>(of.col(mesh.triangles(1, t)) - corner,
                                                         of.col(mesh.triangles(2, t)) - corner);
    };
    const auto [a, b] = edges(mesh.positions);
    const auto [c, d] = edges(mesh.sphere);
    const double area = a.cross(b).norm() / 2.0;
    const double image = c.cross(d).norm() / 2.0;
    const double angle = anisotropy(InPlane(a, b), InPlane(c, d));
    all_space += area;
    all_sphere += image;
    for (Index k = 0; k < 3; ++k) {
      const std::size_t v = at(mesh.triangles(k, t));
      in_space[v] += area;
      on_sphere[v] += image;
      weighted[v] += area * angle;
    }
  }
  constexpr double least = 1e-300;
  for (std::size_t v = 0; v < n; ++v) {
    const double fraction = std::max(in_space[v] / std::max(all_space, least), least);
    const double image = std::max(on_sphere[v] / std::max(all_sphere, least), least);
    mesh.area_distortion.push_back(std::log2(image) - std::log2(fraction));
    mesh.angle_distortion.push_back(in_space[v] > 0.0 ? std::max(1.0, weighted[v] / in_space[v])
                                                      : 1.0);
  }
}

/// log10 of the residual of each vertex. What is not finite counts as 0, which has no logarithm.
std::vector<double> residualExponents(const Surface& result) {
  constexpr double least = 1e-17;
  std::vector<double> exponents(result.vertexCount(), std::log10(least));
  std::transform(result.vertex_residuals.begin(), result.vertex_residuals.end(), exponents.begin(),
                 [least](double residual) {
                   return std::log10(std::isfinite(residual) ? std::max(residual, least) : least);
                 });
  return exponents;
}

/// Marks of the triangles where they are shown.
std::vector<std::uint8_t> marksOf(const Surface& result, int threads) {
  std::vector<std::uint8_t> marks = result.diagnosis.triangle_marks;
  marks.resize(static_cast<std::size_t>(result.triangles.cols()), 0);
  if (result.smoothed.cols() == 0) {
    return marks;
  }
  // The self-intersections of the result are those of the points of the input.
  std::vector<std::array<Index, 2>> pairs;
  if (result.smoothing.self_intersections > 0) {
    Execution execution;
    execution.threads = threads;
    pairs = findSelfIntersections(result.moved(), result.triangles, execution);
  }
  markSelfIntersections(pairs, marks);
  return marks;
}

/// Leaves of the mesh's vertices those of suspicious triangles, if these are few, and others evenly
/// in their order. A triangle of the new mesh between three of the former is suspicious as well.
void reduce(std::size_t max_vertices, ReportMesh& mesh) {
  std::vector<std::uint8_t> marks_around(mesh.vertices.size(), 0);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (Index k = 0; k < 3; ++k) {
      std::uint8_t& mark = marks_around[at(mesh.triangles(k, t))];
      mark = static_cast<std::uint8_t>(mark | mesh.marks[at(t)]);
    }
  }
  const auto unmarked = static_cast<std::size_t>(
      std::count(marks_around.begin(), marks_around.end(), std::uint8_t{0}));
  const std::size_t marked = mesh.vertices.size() - unmarked;
  const bool keeps_marked = 2 * marked <= max_vertices;
  const std::size_t others =
      std::max<std::size_t>(keeps_marked ? unmarked : mesh.vertices.size(), 1);
  const std::size_t room = keeps_marked ? max_vertices - marked : max_vertices;
  std::vector<Index> kept;
  std::size_t seen = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (keeps_marked && marks_around[v] != 0) {
      kept.push_back(static_cast<Index>(v));
    } else {
      // Bresenham's line: `room` of the others at equal distances.
      if ((seen + 1) * room / others != seen * room / others) {
        kept.push_back(static_cast<Index>(v));
      }
      ++seen;
    }
  }
  std::vector<Index> vertices;
  vertices.reserve(kept.size());
  for (const Index v : kept) {
    vertices.push_back(mesh.vertices[at(v)]);
  }
  mesh.vertices = std::move(vertices);
  mesh.positions = picked(mesh.positions, kept);
  mesh.sphere = picked(mesh.sphere, kept);
  mesh.area_distortion = picked(mesh.area_distortion, kept);
  mesh.angle_distortion = picked(mesh.angle_distortion, kept);
  mesh.residual = picked(mesh.residual, kept);
  mesh.triangles = triangulateSphere(mesh.sphere);
  mesh.marks.clear();
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto mark = [&](Index k) { return marks_around[at(kept[at(mesh.triangles(k, t))])]; };
    mesh.marks.push_back(static_cast<std::uint8_t>(mark(0) & mark(1) & mark(2)));
  }
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

}  // namespace

std::vector<double> picked(const std::vector<double>& values, const std::vector<Index>& indices) {
  std::vector<double> result;
  result.reserve(indices.size());
  for (const Index i : indices) {
    result.push_back(values[at(i)]);
  }
  return result;
}

Positions picked(const Positions& points, const std::vector<Index>& indices) {
  return points(Eigen::all, indices);
}

std::vector<Index> orderAlongCurve(const Positions& points) {
  // Morton order: the bits of the three coordinates in turn.
  constexpr int bits = 16;
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  const Eigen::Vector3d high = points.rowwise().maxCoeff();
  std::vector<std::pair<std::uint64_t, Index>> keys;
  keys.reserve(static_cast<std::size_t>(points.cols()));
  for (Index v = 0; v < points.cols(); ++v) {
    std::uint64_t key = 0;
    for (Index c = 0; c < 3; ++c) {
      const double fraction =
          high[c] > low[c] ? std::clamp((points(c, v) - low[c]) / (high[c] - low[c]), 0.0, 1.0)
                           : 0.0;
      const auto place = static_cast<std::uint64_t>(fraction * ((1 << bits) - 1));
      for (unsigned bit = 0; bit < bits; ++bit) {
        key |= (place >> bit & 1U) << (3 * bit + static_cast<unsigned>(c));
      }
    }
    keys.emplace_back(key, v);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Index> order;
  order.reserve(keys.size());
  for (const auto& [key, v] : keys) {
    order.push_back(v);
  }
  return order;
}

ReportMesh reportMesh(const CloudReconstruction& cloud, const Surface& result,
                      std::size_t max_triangles, int threads) {
  const bool has_sphere = result.sphere.cols() > 0;
  const Positions positions = vertexPositions(cloud, result);
  ReportMesh mesh;
  mesh.vertices = orderAlongCurve(has_sphere ? result.sphere : positions);
  mesh.positions = picked(positions, mesh.vertices);
  std::vector<Index> place_of(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    place_of[at(mesh.vertices[i])] = static_cast<Index>(i);
  }
  mesh.triangles = result.triangles.unaryExpr([&place_of](Index v) { return place_of[at(v)]; });
  mesh.marks = marksOf(result, threads);
  if (has_sphere) {
    mesh.sphere = picked(result.sphere, mesh.vertices);
    mesh.residual = picked(residualExponents(result), mesh.vertices);
    measureDistortion(mesh);
    if (static_cast<std::size_t>(mesh.triangles.cols()) > max_triangles) {
      reduce(max_triangles / 2 + 2, mesh);
    }
  }
  sortTriangles(mesh);
  return mesh;
}

}  // namespace spherical_param::tools
