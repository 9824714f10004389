#include "core/map_relaxation.h"

#include "core/corner_table.h"
#include "core/exact_predicates.h"
#include "core/parallel.h"
#include "core/tangent_basis.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace spherical_param::internal {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Triangles thinner than this, height to longest side, count as such.
constexpr double kThinnest = 0.05;

/// A triangle of vertex u and two neighbours, on the sphere: half their determinant, which is its
/// area but for its distance from the sphere, and its Dirichlet energy, 1/4 of the sum of squared
/// sides times cotangents, which is the area at least, and just that if the map is conformal
/// (U. Pinkall and K. Polthier, 1993).
struct Image {
  double area;
  double dirichlet;

  Image(const Vector3d& u, const Vector3d& to_first, const Vector3d& to_next,
        const MapCorner& corner)
      : area(0.5 * u.dot(to_first.cross(to_next))),
        dirichlet(0.25 * (corner.cot_vertex * (to_next - to_first).squaredNorm() +
                          corner.cot_neighbor * to_next.squaredNorm() +
                          corner.cot_next * to_first.squaredNorm())) {}
};

/// Whether the sign of the area is beyond doubt. The differences are rounded by half a unit in the
/// last place each, the determinant by a few more.
bool isSurelyPositive(const Vector3d& to_first, const Vector3d& to_next, double area) {
  constexpr double unit = 32.0 * kUnitRoundoff;
  return area > 0.0 && area * area > unit * unit * to_first.squaredNorm() * to_next.squaredNorm();
}

bool isPositive(const Vector3d& u, const Vector3d& first, const Vector3d& next) {
  return orientation3d(Vector3d::Zero(), u, first, next) > 0;
}

/// MIPS (K. Hormann and G. Greiner, 2000) for the angles; the ratio of areas and its inverse.
double termOf(const Image& image, double mass, const MapEnergy& energy) {
  const double target = mass * energy.area_of_mass;
  return mass * (energy.angle_weight * image.dirichlet / image.area +
                 energy.area_weight * 0.5 * (image.area / target + target / image.area));
}

/// Energy of the triangles around a vertex that is at u; infinite if one is flipped.
double energyAround(const Positions& sphere, const MapCorner* corners, std::size_t count,
                    const Vector3d& u, const MapEnergy& energy) {
  double sum = 0.0;
  Vector3d to_first = sphere.col(corners[0].neighbor) - u;
  const Vector3d to_begin = to_first;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_last = i + 1 == count;
    const Vector3d to_next = is_last ? to_begin : Vector3d(sphere.col(corners[i + 1].neighbor) - u);
    const Image image(u, to_first, to_next, corners[i]);
    if (!isSurelyPositive(to_first, to_next, image.area) &&
        !(image.area > 0.0 && isPositive(u, sphere.col(corners[i].neighbor),
                                         sphere.col(corners[is_last ? 0 : i + 1].neighbor))))
      return std::numeric_limits<double>::infinity();
    sum += termOf(image, corners[i].mass, energy);
    to_first = to_next;
  }
  return sum;
}

/// Energy, gradient and Hessian in a tangent basis.
struct Model {
  double value = 0.0;
  Vector2d gradient = Vector2d::Zero();
  Matrix2d hessian = Matrix2d::Zero();
};

Model modelAround(const Positions& sphere, const MapCorner* corners, std::size_t count,
                  const Vector3d& u, const TangentBasis& basis, const MapEnergy& energy) {
  Model model;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  const Vector3d x = basis.col(0);
  const Vector3d y = basis.col(1);
  Vector3d to_first = sphere.col(corners[0].neighbor) - u;
  const Vector3d to_begin = to_first;
  Vector2d first(x.dot(to_first), y.dot(to_first));
  const Vector2d begin = first;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_last = i + 1 == count;
    const Vector3d to_next = is_last ? to_begin : Vector3d(sphere.col(corners[i + 1].neighbor) - u);
    const Vector2d next = is_last ? begin : Vector2d(x.dot(to_next), y.dot(to_next));
    const MapCorner& corner = corners[i];
    const double mass = corner.mass;
    const Vector3d cross = to_first.cross(to_next);
    const double area = 0.5 * u.dot(cross);
    const double first_squared = to_first.squaredNorm();
    const double next_squared = to_next.squaredNorm();
    const double dirichlet =
        0.25 * (corner.cot_vertex * (to_next - to_first).squaredNorm() +
                corner.cot_neighbor * next_squared + corner.cot_next * first_squared);
    // On the sphere, u moves by x - |x|^2 / 2 u to second order; the determinant is linear in u.
    const Vector2d edge = next - first;
    const Vector2d area_gradient(0.5 * (x.dot(cross) - edge.y()), 0.5 * (y.dot(cross) + edge.x()));
    const double area_hessian = -area;
    const Vector2d d_gradient = -0.5 * (corner.cot_neighbor * next + corner.cot_next * first);
    const double d_hessian = 0.25 * (corner.cot_neighbor * (2.0 - next_squared) +
                                     corner.cot_next * (2.0 - first_squared));

    const double inverse = 1.0 / area;
    const double target = mass * energy.area_of_mass;
    const double angle = mass * energy.angle_weight;
    const double areas = mass * energy.area_weight;
    const double mips = dirichlet * inverse;
    // Derivatives by the area.
    const double by_area =
        -angle * mips * inverse + areas * 0.5 * (1.0 / target - target * inverse * inverse);
    const double by_area_twice =
        (2.0 * angle * mips + areas * target * inverse) * inverse * inverse;
    const double by_d = angle * inverse;
    const double by_both = -angle * inverse * inverse;
    model.value += angle * mips + areas * 0.5 * (area / target + target * inverse);
    model.gradient += by_d * d_gradient + by_area * area_gradient;
    const double isotropic = by_d * d_hessian + by_area * area_hessian;
    xx += isotropic + by_area_twice * area_gradient.x() * area_gradient.x() +
          2.0 * by_both * area_gradient.x() * d_gradient.x();
    yy += isotropic + by_area_twice * area_gradient.y() * area_gradient.y() +
          2.0 * by_both * area_gradient.y() * d_gradient.y();
    xy += by_area_twice * area_gradient.x() * area_gradient.y() +
          by_both * (area_gradient.x() * d_gradient.y() + area_gradient.y() * d_gradient.x());
    to_first = to_next;
    first = next;
  }
  model.hessian << xx, xy, xy, yy;
  return model;
}

/// -H^-1 g with the absolute values of H's eigenvalues: downhill.
Vector2d newtonStep(const Model& model) {
  const double a = model.hessian(0, 0);
  const double b = model.hessian(0, 1);
  const double c = model.hessian(1, 1);
  const double middle = 0.5 * (a + c);
  const double radius = std::hypot(0.5 * (a - c), b);
  const double larger = std::abs(middle) + radius;
  if (!(larger > 0.0) || !std::isfinite(larger))
    return Vector2d::Zero();
  const double least = 1e-6 * larger;
  const double high = std::max(std::abs(middle + radius), least);
  const double low = std::max(std::abs(middle - radius), least);
  // The eigenvector of middle + radius, unless the eigenvalues are equal.
  Vector2d axis(0.5 * (a - c) + radius, b);
  if (a < c)
    axis << b, radius - 0.5 * (a - c);
  const double length = axis.norm();
  if (!(length > 0.0))
    return -model.gradient / high;
  axis /= length;
  const Vector2d across(-axis.y(), axis.x());
  return -(axis * (axis.dot(model.gradient) / high) + across * (across.dot(model.gradient) / low));
}

}  // namespace

Vector3d mapCotangents(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const std::array<Vector3d, 3> corners = {a, b, c};
  // The longest side is the base: the corners next to it are acute.
  std::size_t top = 0;
  double longest = -1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double squared = (corners[(k + 2) % 3] - corners[(k + 1) % 3]).squaredNorm();
    if (squared > longest) {
      longest = squared;
      top = k;
    }
  }
  Vector3d cotangents = Vector3d::Constant(std::sqrt(1.0 / 3.0));
  if (!(longest > 0.0))
    return cotangents;
  const Vector3d& left = corners[(top + 1) % 3];
  const Vector3d base = (corners[(top + 2) % 3] - left) / std::sqrt(longest);
  const Vector3d side = (corners[top] - left) / std::sqrt(longest);
  const double x = std::clamp(base.dot(side), 0.0, 1.0);
  const double height = std::max(base.cross(side).norm(), kThinnest);
  const auto at = [&](std::size_t k) -> double& {
    return cotangents[static_cast<Eigen::Index>((top + k) % 3)];
  };
  at(0) = (height * height - x * (1.0 - x)) / height;
  at(1) = x / height;
  at(2) = (1.0 - x) / height;
  return cotangents;
}

MapRows makeMapRows(const Positions& points, const Triangles& triangles,
                    const std::vector<float>& masses, Index vertex_count, int requested) {
  const auto n = static_cast<std::size_t>(vertex_count);
  const auto m = static_cast<std::size_t>(triangles.cols());
  const int threads = threadCount(requested, n, kParallelThreshold);
  std::vector<std::array<float, 3>> cotangents(m);
  forEachItem(m, threads, [&](std::size_t, std::size_t i) {
    const auto t = static_cast<Eigen::Index>(i);
    const Vector3d of_corners = mapCotangents(
        points.col(triangles(0, t)), points.col(triangles(1, t)), points.col(triangles(2, t)));
    for (std::size_t k = 0; k < 3; ++k)
      cotangents[i][k] = static_cast<float>(of_corners[static_cast<Eigen::Index>(k)]);
  });
  const CornerTable corners(triangles, n, threads);

  // Colours: the lowest that no neighbour has.
  std::vector<Index> color(n, -1);
  std::vector<Index> taken_by;  // of each colour, the last vertex with a neighbour that has it
  for (Index v = 0; v < vertex_count; ++v) {
    corners.forEachCorner(v, [&](Index t, Index k) {
      const Index other = color[static_cast<std::size_t>(triangles(nextCorner(k), t))];
      if (other >= 0)
        taken_by[static_cast<std::size_t>(other)] = v;
    });
    Index c = 0;
    while (static_cast<std::size_t>(c) < taken_by.size() &&
           taken_by[static_cast<std::size_t>(c)] == v)
      ++c;
    if (static_cast<std::size_t>(c) == taken_by.size())
      taken_by.push_back(-1);
    color[static_cast<std::size_t>(v)] = c;
  }

  MapRows rows;
  rows.colors.assign(taken_by.size() + 1, 0);
  for (const Index c : color)
    ++rows.colors[static_cast<std::size_t>(c) + 1];
  for (std::size_t c = 0; c + 1 < rows.colors.size(); ++c)
    rows.colors[c + 1] += rows.colors[c];
  rows.vertices.resize(n);
  std::vector<std::uint32_t> next(rows.colors.begin(), rows.colors.end() - 1);
  for (Index v = 0; v < vertex_count; ++v)
    rows.vertices[next[static_cast<std::size_t>(color[static_cast<std::size_t>(v)])]++] = v;
  rows.begin.resize(n + 1);
  rows.begin[0] = 0;
  for (std::size_t i = 0; i < n; ++i)
    rows.begin[i + 1] =
        rows.begin[i] + static_cast<std::uint32_t>(corners.countAt(rows.vertices[i]));
  rows.corners.resize(rows.begin[n]);
  forEachBlock(n, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::vector<std::pair<Index, std::uint32_t>> behind;  // vertex behind, corner
    for (std::size_t i = begin; i < end; ++i) {
      behind.clear();
      corners.forEachCorner(rows.vertices[i], [&](Index t, Index k) {
        behind.emplace_back(triangles(nextCorner(k), t), static_cast<std::uint32_t>(4 * t + k));
      });
      std::sort(behind.begin(), behind.end());
      Index neighbor = behind.front().first;
      for (std::uint32_t r = rows.begin[i]; r < rows.begin[i + 1]; ++r) {
        const auto at =
            std::lower_bound(behind.begin(), behind.end(), std::pair(neighbor, std::uint32_t{0}));
        const std::size_t t = at->second >> 2U;
        const auto k = static_cast<Index>(at->second & 3U);
        const std::array<float, 3>& cot = cotangents[t];
        rows.corners[r] = {neighbor, masses[t], cot[static_cast<std::size_t>(k)],
                           cot[static_cast<std::size_t>(nextCorner(k))],
                           cot[static_cast<std::size_t>(previousCorner(k))]};
        neighbor = triangles(previousCorner(k), static_cast<Eigen::Index>(t));
      }
    }
  });
  return rows;
}

bool isMapValid(const Positions& sphere, const MapCorner* corners, std::size_t count,
                const Vector3d& at) {
  for (std::size_t i = 0; i < count; ++i)
    if (!isPositive(at, sphere.col(corners[i].neighbor),
                    sphere.col(corners[i + 1 == count ? 0 : i + 1].neighbor)))
      return false;
  return true;
}

double relaxMapVertex(Positions& sphere, Index v, const MapCorner* corners, std::size_t count,
                      const MapEnergy& energy) {
  const Vector3d u = sphere.col(v);
  const TangentBasis basis = tangentBasis(u);
  const Model model = modelAround(sphere, corners, count, u, basis, energy);
  const Vector2d step = newtonStep(model);
  const double slope = model.gradient.dot(step);
  // What cannot be gained is not worth the evaluation.
  constexpr double least_gain = 1e-7;
  if (!(-slope > least_gain * model.value))
    return 0.0;
  const Vector3d direction = basis * step;
  constexpr int most_halvings = 8;
  double length = 1.0;
  for (int k = 0; k < most_halvings; ++k) {
    const Vector3d moved = (u + length * direction).normalized();
    const double value = energyAround(sphere, corners, count, moved, energy);
    constexpr double sufficient = 1e-2;
    if (value <= model.value + sufficient * length * slope) {
      sphere.col(v) = moved;
      return model.value - value;
    }
    length *= 0.5;
  }
  return 0.0;
}

double sweepMap(Positions& sphere, const MapRows& rows, const MapEnergy& energy, int requested) {
  double gain = 0.0;
  for (std::size_t c = 0; c + 1 < rows.colors.size(); ++c) {
    const std::size_t first = rows.colors[c];
    const std::size_t count = rows.colors[c + 1] - first;
    const int threads = threadCount(requested, count, kParallelThreshold);
    gain += sumOfBlocks(count, threads, 0.0, [&](std::size_t begin, std::size_t end) {
      double part = 0.0;
      for (std::size_t i = first + begin; i < first + end; ++i)
        part += relaxMapVertex(sphere, rows.vertices[i], &rows.corners[rows.begin[i]],
                               rows.begin[i + 1] - rows.begin[i], energy);
      return part;
    });
  }
  return gain;
}

namespace {

/// A third of the sum of term(image, mass) over all corners.
template <typename Term>
double sumOverTriangles(const Positions& sphere, const MapRows& rows, int requested,
                        const Term& term) {
  const std::size_t n = rows.vertices.size();
  const int threads = threadCount(requested, n, kParallelThreshold);
  return sumOfBlocks(
             n, threads, 0.0,
             [&](std::size_t begin, std::size_t end) {
               double part = 0.0;
               for (std::size_t i = begin; i < end; ++i) {
                 const Vector3d u = sphere.col(rows.vertices[i]);
                 for (std::uint32_t r = rows.begin[i]; r < rows.begin[i + 1]; ++r) {
                   const std::uint32_t next = r + 1 == rows.begin[i + 1] ? rows.begin[i] : r + 1;
                   part += term(Image(u, sphere.col(rows.corners[r].neighbor) - u,
                                      sphere.col(rows.corners[next].neighbor) - u, rows.corners[r]),
                                rows.corners[r].mass);
                 }
               }
               return part;
             }) /
         3.0;
}

}  // namespace

double mapEnergy(const Positions& sphere, const MapRows& rows, const MapEnergy& energy,
                 int threads) {
  return sumOverTriangles(sphere, rows, threads, [&](const Image& image, double mass) {
    return termOf(image, mass, energy);
  });
}

double mapArea(const Positions& sphere, const MapRows& rows, int threads) {
  return sumOverTriangles(sphere, rows, threads,
                          [](const Image& image, double) { return image.area; });
}

}  // namespace spherical_param::internal
