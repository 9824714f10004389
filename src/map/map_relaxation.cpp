#include "map_relaxation.h"

#include "corner_table.h"
#include "index_loops.h"
#include "tangent_basis.h"
#include "triangle_geometry.h"

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

/// Triangles with a smaller ratio of height to longest side count as if they had this one.
constexpr double kThinnest = 0.05;
/// Logarithms of ratios of areas that are smaller count by their squares.
constexpr double kSmallLog = 0.05;

/// A triangle of vertex u and two neighbours, on the sphere.
struct Image {
  Vector3d cross;
  /// Half the determinant: the area of a small triangle, and 0 where a triangle of any size begins
  /// to be flipped.
  double determinant;
  /// The tangent of half the area is determinant / quotient.
  double quotient;
  double area;  ///< of the spherical triangle (A. van Oosterom and J. Strackee, 1983)
  /// 1/4 of the sum of squared sides times cotangents: the area at least, and just that if the map
  /// is conformal (U. Pinkall and K. Polthier, 1993).
  double dirichlet;

  Image(const Vector3d& u, const Vector3d& to_first, const Vector3d& to_next,
        const MapCorner& corner)
      : cross(to_first.cross(to_next)), determinant(0.5 * u.dot(cross)) {
    const double first_squared = to_first.squaredNorm();
    const double next_squared = to_next.squaredNorm();
    const double opposite_squared = (to_next - to_first).squaredNorm();
    dirichlet = 0.25 * (corner.cot_vertex * opposite_squared + corner.cot_neighbor * next_squared +
                        corner.cot_next * first_squared);
    // Half of 1 + ab + bc + ca, by differences.
    quotient = 2.0 - 0.25 * (first_squared + next_squared + opposite_squared);
    area = 2.0 * arcTangent(determinant, quotient);
  }

private:
  /// atan2(y, x) for y > 0; by its series where that is exact to 1e-13, as for nearly all
  /// triangles.
  static double arcTangent(double y, double x) {
    constexpr double small = 0.015;
    if (!(y < small * x))
      return std::atan2(y, x);
    const double tangent = y / x;
    const double squared = tangent * tangent;
    return tangent * (1.0 - squared * (1.0 / 3.0 - squared * 0.2));
  }
};

/// Whether the sign of the determinant is beyond doubt. The differences are rounded by half a unit
/// in the last place each, the determinant by a few more.
bool isSurelyPositive(const Vector3d& to_first, const Vector3d& to_next, double determinant) {
  constexpr double unit = 32.0 * kUnitRoundoff;
  return determinant > 0.0 &&
         determinant * determinant > unit * unit * to_first.squaredNorm() * to_next.squaredNorm();
}

/// What the ratio of an area to its target costs, and the derivatives by the ratio's logarithm.
struct AreaTerm {
  double value;
  double slope;
  double curvature;

  AreaTerm(double ratio, const MapEnergy& energy) {
    const double inverse = 1.0 / ratio;
    value = energy.ratio_weight * 0.5 * (ratio + inverse);
    slope = energy.ratio_weight * 0.5 * (ratio - inverse);
    curvature = value;
    if (energy.log_weight > 0.0) {
      const double log = std::log(ratio);
      const double root = std::sqrt(kSmallLog * kSmallLog + log * log);
      value += energy.log_weight * (1.0 - kSmallLog + root);
      slope += energy.log_weight * log / root;
      curvature += energy.log_weight * (kSmallLog * kSmallLog) / (root * root * root);
    }
  }
};

/// For the angles MIPS (K. Hormann and G. Greiner, 2000), the mean of sigma_1 / sigma_2 and its
/// inverse; over the determinant, so that it grows beyond all bounds before a triangle is flipped,
/// however large that is. For the areas terms as the statistics of the distortion have: they grow
/// with the ratio and its inverse; and the logarithm makes them sharp where the ratio is near 1.
double termOf(const Image& image, double mass, const MapEnergy& energy) {
  return mass * (energy.angle_weight * image.dirichlet / image.determinant +
                 AreaTerm(image.area / (mass * energy.area_of_mass), energy).value);
}

/// Calls visit(corner, next corner, to the neighbour, to the next one) for the triangles around a
/// vertex that is at u.
template <typename Visit>
void forEachTriangle(const Positions& sphere, const MapRing& ring, const Vector3d& u,
                     const Visit& visit) {
  const Vector3d to_begin = sphere.col(ring.begin()->neighbor) - u;
  Vector3d to_first = to_begin;
  for (const MapCorner* corner = ring.begin(); corner != ring.end(); ++corner) {
    const bool is_last = corner + 1 == ring.end();
    const MapCorner& next = is_last ? *ring.begin() : corner[1];
    const Vector3d to_next = is_last ? to_begin : Vector3d(sphere.col(next.neighbor) - u);
    visit(*corner, next, to_first, to_next);
    to_first = to_next;
  }
}

/// Energy of the triangles around a vertex that is at u; infinite if one is flipped.
double energyAround(const Positions& sphere, const MapRing& ring, const Vector3d& u,
                    const MapEnergy& energy) {
  double sum = 0.0;
  bool is_flipped = false;
  forEachTriangle(sphere, ring, u,
                  [&](const MapCorner& corner, const MapCorner& next, const Vector3d& to_first,
                      const Vector3d& to_next) {
                    if (is_flipped)
                      return;
                    const Image image(u, to_first, to_next, corner);
                    is_flipped =
                        !isSurelyPositive(to_first, to_next, image.determinant) &&
                        !(image.determinant > 0.0 &&
                          isOutward(u, sphere.col(corner.neighbor), sphere.col(next.neighbor)));
                    sum += termOf(image, corner.mass, energy);
                  });
  return is_flipped ? std::numeric_limits<double>::infinity() : sum;
}

/// Energy, gradient and Hessian in a tangent basis.
struct Model {
  double value = 0.0;
  Vector2d gradient = Vector2d::Zero();
  Matrix2d hessian = Matrix2d::Zero();  ///< the lower triangle

  /// Adds f(a), where a has the gradient `of_gradient` and `of_hessian` times the identity as
  /// Hessian.
  void addFunctionOf(double slope, double curvature, const Vector2d& of_gradient,
                     double of_hessian) {
    gradient += slope * of_gradient;
    hessian(0, 0) += curvature * of_gradient.x() * of_gradient.x() + slope * of_hessian;
    hessian(1, 0) += curvature * of_gradient.x() * of_gradient.y();
    hessian(1, 1) += curvature * of_gradient.y() * of_gradient.y() + slope * of_hessian;
  }
  /// Adds the mixed second derivative of a function of two values with these gradients.
  void addMixed(double derivative, const Vector2d& a, const Vector2d& b) {
    hessian(0, 0) += 2.0 * derivative * a.x() * b.x();
    hessian(1, 0) += derivative * (a.x() * b.y() + a.y() * b.x());
    hessian(1, 1) += 2.0 * derivative * a.y() * b.y();
  }
};

Model modelAround(const Positions& sphere, const MapRing& ring, const Vector3d& u,
                  const TangentBasis& basis, const MapEnergy& energy) {
  Model model;
  const Vector3d x = basis.col(0);
  const Vector3d y = basis.col(1);
  forEachTriangle(
      sphere, ring, u,
      [&](const MapCorner& corner, const MapCorner&, const Vector3d& to_first,
          const Vector3d& to_next) {
        const Vector2d first(x.dot(to_first), y.dot(to_first));
        const Vector2d next(x.dot(to_next), y.dot(to_next));
        const double mass = corner.mass;
        const Image image(u, to_first, to_next, corner);
        // A step of x in the tangent plane takes u to u + x - |x|^2 / 2 u, to second order. The
        // determinant is linear in u.
        const Vector2d edge = next - first;
        const Vector2d determinant_gradient(0.5 * (x.dot(image.cross) - edge.y()),
                                            0.5 * (y.dot(image.cross) + edge.x()));
        const double determinant_hessian = -image.determinant;
        const Vector2d dirichlet_gradient =
            -0.5 * (corner.cot_neighbor * next + corner.cot_next * first);
        const double dirichlet_hessian =
            0.25 * (corner.cot_neighbor * (2.0 - to_next.squaredNorm()) +
                    corner.cot_next * (2.0 - to_first.squaredNorm()));
        // The derivative of the arc tangent; ab + ca has the gradient b + c. How the gradient
        // changes is left out: next to its square it does not count.
        const Vector2d area_gradient =
            2.0 / (image.determinant * image.determinant + image.quotient * image.quotient) *
            (image.quotient * determinant_gradient - 0.5 * image.determinant * (first + next));

        const double angle_weight = mass * energy.angle_weight;
        const double by_determinant = 1.0 / image.determinant;
        const double angle = angle_weight * image.dirichlet * by_determinant;
        const AreaTerm term(image.area / (mass * energy.area_of_mass), energy);
        const double by_area = 1.0 / image.area;
        model.value += angle + mass * term.value;
        model.addFunctionOf(angle_weight * by_determinant, 0.0, dirichlet_gradient,
                            dirichlet_hessian);
        model.addFunctionOf(-angle * by_determinant, 2.0 * angle * by_determinant * by_determinant,
                            determinant_gradient, determinant_hessian);
        model.addMixed(-angle_weight * by_determinant * by_determinant, determinant_gradient,
                       dirichlet_gradient);
        model.addFunctionOf(mass * term.slope * by_area,
                            mass * std::max(0.0, term.curvature - term.slope) * by_area * by_area,
                            area_gradient, 0.0);
      });
  return model;
}

/// -H^-1 g with the absolute values of H's eigenvalues: downhill.
Vector2d newtonStep(const Model& model) {
  const double a = model.hessian(0, 0);
  const double b = model.hessian(1, 0);
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

/// Numbers the vertices by colours, such that no two neighbours have the same: each vertex takes
/// the lowest colour that no neighbour has.
void colorVertices(const Triangles& triangles, const CornerTable& corners, Index vertex_count,
                   MapRows& rows) {
  Indexed<Index> color(static_cast<std::size_t>(vertex_count), -1);
  Indexed<Index> taken_by;  // of each colour, the last vertex with a neighbour that has it
  for (Index v = 0; v < vertex_count; ++v) {
    corners.forEachCorner(v, [&](Index t, Index k) {
      const Index other = color[triangles(nextCorner(k), t)];
      if (other >= 0)
        taken_by[other] = v;
    });
    color[v] = 0;
    while (color[v] < indexCount(taken_by) && taken_by[color[v]] == v)
      ++color[v];
    if (color[v] == indexCount(taken_by))
      taken_by.push_back(-1);
  }

  NeighborRows by_color = nodesOfParts(color, taken_by.size());
  rows.vertices.assign(by_color.neighbors.begin(), by_color.neighbors.end());
  rows.colors = std::move(by_color.offsets);
}

}  // namespace

Eigen::Vector3f mapCotangents(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  Eigen::Matrix3d corners;
  corners << a, b, c;
  // The longest side is the base: the corners next to it are acute.
  Index top = 0;
  double longest = -1.0;
  for (Index k = 0; k < 3; ++k) {
    const double squared = (corners.col((k + 2) % 3) - corners.col((k + 1) % 3)).squaredNorm();
    if (squared > longest) {
      longest = squared;
      top = k;
    }
  }
  Vector3d cotangents = Vector3d::Constant(std::sqrt(1.0 / 3.0));
  if (!(longest > 0.0))
    return cotangents.cast<float>();
  const Vector3d left = corners.col((top + 1) % 3);
  const Vector3d base = (corners.col((top + 2) % 3) - left) / std::sqrt(longest);
  const Vector3d side = (corners.col(top) - left) / std::sqrt(longest);
  const double x = std::clamp(base.dot(side), 0.0, 1.0);
  const double height = std::max(base.cross(side).norm(), kThinnest);
  cotangents[top] = (height * height - x * (1.0 - x)) / height;
  cotangents[(top + 1) % 3] = x / height;
  cotangents[(top + 2) % 3] = (1.0 - x) / height;
  return cotangents.cast<float>();
}

MapRows makeMapRows(const Positions& points, const Triangles& triangles,
                    const Indexed<float>& masses, Index vertex_count, int requested) {
  const auto n = static_cast<std::size_t>(vertex_count);
  const int threads = threadCount(requested, n);
  Eigen::Matrix3Xf cotangents(3, triangles.cols());
  forEachIndex(columnCount(triangles), threads, [&](Index t) {
    cotangents.col(t) = mapCotangents(points.col(triangles(0, t)), points.col(triangles(1, t)),
                                      points.col(triangles(2, t)));
  });
  const CornerTable corners(triangles, n, threads);

  MapRows rows;
  colorVertices(triangles, corners, vertex_count, rows);
  rows.begin.resize(n + 1);
  rows.begin[0] = 0;
  for (std::size_t i = 0; i < n; ++i)
    rows.begin[i + 1] =
        rows.begin[i] + static_cast<std::uint32_t>(corners.countAt(rows.vertices[i]));
  rows.corners.resize(rows.begin[n]);
  using VertexBehind = std::array<Index, 3>;  // vertex, triangle, corner
  forEachIndex<std::vector<VertexBehind>>(n, threads, {}, [&](auto& behind, Index i) {
    behind.clear();
    corners.forEachCorner(rows.vertices[i], [&](Index t, Index k) {
      behind.push_back({triangles(nextCorner(k), t), t, k});
    });
    std::sort(behind.begin(), behind.end());
    Index neighbor = behind.front()[0];
    for (std::uint32_t r = rows.begin[i]; r < rows.begin[i + 1]; ++r) {
      const auto at = std::lower_bound(behind.begin(), behind.end(), std::array{neighbor, 0, 0});
      const auto [v, t, k] = *at;
      const auto cot = cotangents.col(t);
      rows.corners[r] = {neighbor, masses[t], cot[k], cot[nextCorner(k)], cot[previousCorner(k)]};
      neighbor = triangles(previousCorner(k), t);
    }
  });
  return rows;
}

bool isMapValid(const Positions& sphere, const MapRing& ring, const Vector3d& at) {
  bool is_valid = true;
  forEachTriangle(
      sphere, ring, at, [&](const MapCorner& corner, const MapCorner& next, const auto&...) {
        is_valid =
            is_valid && isOutward(at, sphere.col(corner.neighbor), sphere.col(next.neighbor));
      });
  return is_valid;
}

double relaxMapVertex(Positions& sphere, Index v, const MapRing& ring, const MapEnergy& energy) {
  const Vector3d u = sphere.col(v);
  const TangentBasis basis = tangentBasis(u);
  const Model model = modelAround(sphere, ring, u, basis, energy);
  const Vector2d step = newtonStep(model);
  const double slope = model.gradient.dot(step);
  // A smaller gain is not worth the evaluation.
  constexpr double least_gain = 1e-7;
  if (!(-slope > least_gain * model.value))
    return 0.0;
  const Vector3d direction = basis * step;
  constexpr int most_halvings = 8;
  double length = 1.0;
  for (int k = 0; k < most_halvings; ++k) {
    const Vector3d moved = (u + length * direction).normalized();
    const double value = energyAround(sphere, ring, moved, energy);
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
    const auto first = static_cast<Index>(rows.colors[c]);
    const std::size_t count = rows.colors[c + 1] - rows.colors[c];
    gain += accumulate(count, threadCount(requested, count), 0.0, [&](Index i, double& sum) {
      sum += relaxMapVertex(sphere, rows.vertices[first + i], rows.around(first + i), energy);
    });
  }
  return gain;
}

double mapEnergy(const Positions& sphere, const MapRows& rows, const MapEnergy& energy,
                 int requested) {
  const std::size_t n = rows.vertices.size();
  const double sum = accumulate(n, threadCount(requested, n), 0.0, [&](Index i, double& part) {
    const Vector3d u = sphere.col(rows.vertices[i]);
    forEachTriangle(sphere, rows.around(i), u,
                    [&](const MapCorner& corner, const MapCorner&, const auto&... to_others) {
                      part += termOf(Image(u, to_others..., corner), corner.mass, energy);
                    });
  });
  return sum / 3.0;  // each triangle is around three vertices
}

}  // namespace spherical_param::internal
