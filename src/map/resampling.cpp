#include "spherical_param/map/resampling.h"

#include "caps.h"
#include "index_loops.h"
#include "input_checks.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using internal::entry;
using internal::Indexed;

constexpr Index kMaxVertices = Index{1} << 29;

/// A grid has `factor` f^2 + 2 vertices.
Index factorOf(SphereGrid grid) {
  return grid == SphereGrid::Icosahedral ? 10 : 4;
}

// --- The icosahedron -----------------------------------------------------------------------------

constexpr std::array<std::array<Index, 3>, 20> kIcosahedron{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

Positions icosahedronCorners() {
  const double phi = 0.5 * (1.0 + std::sqrt(5.0));
  Positions corners(3, 12);
  for (Index i = 0; i < 4; ++i) {
    const double one = i % 2 == 0 ? -1.0 : 1.0;
    const double other = i < 2 ? phi : -phi;
    corners.col(i) << one, other, 0.0;
    corners.col(4 + i) << 0.0, one, other;
    corners.col(8 + i) << other, 0.0, one;
  }
  return corners.colwise().normalized();
}

/// The vertices of a geodesic grid: the corners of the icosahedron, those on its edges, those in
/// its faces.
class Geodesic {
public:
  explicit Geodesic(int frequency) : frequency_(frequency), corners_(icosahedronCorners()) {
    Index count = 0;
    for (const auto& face : kIcosahedron)
      for (std::size_t k = 0; k < 3; ++k) {
        const Index a = face[k];
        const Index b = face[(k + 1) % 3];
        if (a < b)
          edges_(a, b) = count++;
      }
    // sin(x i) for the corner's weight i / f, where x is the angle of an edge: great circles with
    // equal steps along the edges, and areas in the faces that differ less than those of plain
    // barycentric coordinates.
    const double angle = std::acos(1.0 / std::sqrt(5.0));
    for (int i = 0; i <= frequency; ++i)
      sines_.push_back(std::sin(angle * i / frequency));
  }

  GridSphere grid() const {
    const Index f = frequency_;
    const auto n = static_cast<Eigen::Index>(gridVertices(SphereGrid::Icosahedral, f));
    GridSphere grid{Positions(3, n), Triangles(3, 2 * n - 4), frequency_};
    grid.directions.leftCols(12) = corners_;
    Eigen::Index t = 0;
    for (std::size_t face = 0; face < kIcosahedron.size(); ++face) {
      const auto& [a, b, c] = kIcosahedron[face];
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
        for (Index i = 1; from < to && i < f; ++i)
          grid.directions.col(onEdge(from, to, i)) = direction(from, f - i, to, i, from, 0);
      for (Index i = 0; i < f; ++i)
        for (Index j = 0; i + j < f; ++j) {
          if (i > 0 && j > 0)
            grid.directions.col(vertex(face, i, j)) = direction(a, f - i - j, b, i, c, j);
          grid.triangles.col(t++) << vertex(face, i, j), vertex(face, i + 1, j),
              vertex(face, i, j + 1);
          if (i + j + 1 < f)
            grid.triangles.col(t++) << vertex(face, i + 1, j), vertex(face, i + 1, j + 1),
                vertex(face, i, j + 1);
        }
    }
    return grid;
  }

private:
  /// Vertex i of f on the edge from a to b.
  Index onEdge(Index a, Index b, Index i) const {
    if (a > b)
      return onEdge(b, a, frequency_ - i);
    return 12 + edges_(a, b) * (frequency_ - 1) + i - 1;
  }

  /// The vertex with the weights f - i - j, i and j of a face's corners.
  Index vertex(std::size_t face, Index i, Index j) const {
    const auto& [a, b, c] = kIcosahedron[face];
    const Index f = frequency_;
    if (i == 0)
      return j == 0 ? a : j == f ? c : onEdge(a, c, j);
    if (j == 0)
      return i == f ? b : onEdge(a, b, i);
    if (i + j == f)
      return onEdge(b, c, j);
    // Row i has f - i - 1 inner vertices.
    const Index in_rows_before = (i - 1) * (f - 1) - i * (i - 1) / 2;
    return 12 + 30 * (f - 1) + static_cast<Index>(face) * ((f - 1) * (f - 2) / 2) + in_rows_before +
           j - 1;
  }

  Vector3d direction(Index a, Index weight_a, Index b, Index weight_b, Index c,
                     Index weight_c) const {
    return (sines_[weight_a] * corners_.col(a) + sines_[weight_b] * corners_.col(b) +
            sines_[weight_c] * corners_.col(c))
        .normalized();
  }

  Index frequency_;
  Positions corners_;
  Eigen::Matrix<Index, 12, 12> edges_;  ///< number of the edge from a to b > a
  Indexed<double> sines_;
};

// --- The octahedron, unfolded into a square ------------------------------------------------------

/// The octahedron unfolded into a square: the upper half is the diamond in the middle, the lower
/// half the four corners. Its points (x, y), each from -f to f, are vertices of the grid; those of
/// the border coincide in pairs, and the four corners.
class OctahedralSquare {
public:
  explicit OctahedralSquare(int frequency) : f_(frequency) {}

  /// Two triangles for each unit square, between which the edges of the octahedron run.
  GridSphere grid() const {
    const auto n = static_cast<Eigen::Index>(gridVertices(SphereGrid::Octahedral, f_));
    GridSphere grid{Positions(3, n), Triangles(3, Eigen::Index{8} * f_ * f_), f_};
    const std::vector<Index> vertices = this->vertices();
    for (Index y = f_; y >= -f_; --y)
      for (Index x = -f_; x <= f_; ++x)
        grid.directions.col(entry(vertices, place(x, y))) = direction(x, y);
    Eigen::Index t = 0;
    const auto at = [&](Index x, Index y) { return entry(vertices, place(x, y)); };
    for (Index y = f_ - 1; y >= -f_; --y)
      for (Index x = -f_; x < f_; ++x) {
        const Index a = at(x, y);
        const Index b = at(x + 1, y);
        const Index c = at(x + 1, y + 1);
        const Index d = at(x, y + 1);
        if ((x < 0) == (y < 0)) {
          grid.triangles.col(t++) << a, b, d;
          grid.triangles.col(t++) << b, c, d;
        } else {
          grid.triangles.col(t++) << a, b, c;
          grid.triangles.col(t++) << a, c, d;
        }
      }
    return grid;
  }

  /// The vertex of each point, row by row from the top.
  std::vector<Index> vertices() const {
    std::vector<Index> result;
    Index count = 0;
    for (Index y = f_; y >= -f_; --y)
      for (Index x = -f_; x <= f_; ++x) {
        const Eigen::Index first = firstSame(x, y);
        result.push_back(first == place(x, y) ? count++ : entry(result, first));
      }
    return result;
  }

private:
  /// Where a point is, row by row from the top.
  Eigen::Index place(Index x, Index y) const {
    return Eigen::Index{f_ - y} * (2 * f_ + 1) + (x + f_);
  }

  Vector3d direction(Index x, Index y) const {
    const Index z = f_ - std::abs(x) - std::abs(y);
    if (z >= 0)
      return Vector3d(x, y, z).normalized();
    return Vector3d(x < 0 ? std::abs(y) - f_ : f_ - std::abs(y),
                    y < 0 ? std::abs(x) - f_ : f_ - std::abs(x), z)
        .normalized();
  }

  /// The place of the first point with the same direction.
  Eigen::Index firstSame(Index x, Index y) const {
    if (std::abs(x) == f_ && std::abs(y) == f_)
      return 0;
    if (std::abs(y) == f_)
      return place(-std::abs(x), y);
    if (std::abs(x) == f_)
      return place(x, std::abs(y));
    return place(x, y);
  }

  Index f_;
};

}  // namespace

int gridFrequency(SphereGrid grid, std::size_t vertices) {
  const double factor = factorOf(grid);
  const double most = std::floor(std::sqrt((kMaxVertices - 2) / factor));
  const double wanted = std::max(0.0, static_cast<double>(vertices) - 2.0) / factor;
  // Nearest in vertices: between f and f + 1, the middle of their squares.
  double f = std::floor(std::sqrt(wanted));
  if (wanted - f * f > (f + 1.0) * (f + 1.0) - wanted)
    f += 1.0;
  return static_cast<int>(std::clamp(f, 1.0, most));
}

int gridFrequency(SphereGrid grid, std::size_t vertices, const SphereSurface& surface) {
  const double all = static_cast<double>(vertices) / surface.coverage();
  return gridFrequency(grid, static_cast<std::size_t>(std::min<double>(all, kMaxVertices)));
}

std::size_t gridVertices(SphereGrid grid, int frequency) {
  internal::checkEnum("gridVertices: grid", grid, SphereGrid::Octahedral);
  const int most = gridFrequency(grid, kMaxVertices);
  if (frequency < 1 || frequency > most)
    throw InvalidInput("gridVertices: frequency = " + std::to_string(frequency) +
                       " is not possible; use 1 to " + std::to_string(most));
  const Index vertices = factorOf(grid) * frequency * frequency + 2;
  return static_cast<std::size_t>(vertices);
}

GridSphere makeGridSphere(SphereGrid grid, int frequency) {
  gridVertices(grid, frequency);  // refuses what is too much
  return grid == SphereGrid::Icosahedral ? Geodesic(frequency).grid()
                                         : OctahedralSquare(frequency).grid();
}

SphereMapOptions mapOptionsForResampling() {
  SphereMapOptions options;
  options.area_weight = 0.5;
  options.sweeps = 40;
  return options;
}

ResampledMesh resampleSurface(const SphereSurface& surface, const GridSphere& grid) {
  ResampledMesh mesh{{}, {}, grid.directions, grid.triangles};
  if (surface.isOpen())
    internal::cutOpenings(mesh.directions, mesh.triangles, [&](const Vector3d& direction) {
      return surface.isCap(surface.locate(direction).triangle);
    });
  SurfaceSamples samples = surface.evaluate(mesh.directions);
  mesh.points = std::move(samples.positions);
  mesh.normals = std::move(samples.normals);
  return mesh;
}

GeometryImage geometryImageOfMesh(const ResampledMesh& mesh) {
  const std::size_t count = internal::columnCount(mesh.points);
  const int frequency = gridFrequency(SphereGrid::Octahedral, count);
  if (gridVertices(SphereGrid::Octahedral, frequency) != count)
    throw InvalidInput("geometryImageOfMesh: " + std::to_string(count) +
                       " vertices are not those of an octahedral grid; use makeGridSphere()");
  return {2 * frequency + 1, mesh.points(Eigen::all, OctahedralSquare(frequency).vertices())};
}

}  // namespace spherical_param
