#include "spherical_param/map/resampling.h"

#include "caps.h"
#include "corner_table.h"
#include "index_loops.h"
#include "input_checks.h"
#include "spherical_param/errors.h"
#include "triangle_geometry.h"

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

/// The pixels of a geometry image. Seen from the middle of the image, column and row are x to the
/// right and y upwards, from -f to f.
class OctahedralSquare {
public:
  explicit OctahedralSquare(int frequency) : f_(frequency) {}

  Index side() const { return 2 * f_ + 1; }
  Eigen::Index pixelCount() const { return Eigen::Index{side()} * side(); }
  Eigen::Index pixel(Index x, Index y) const { return Eigen::Index{f_ - y} * side() + (x + f_); }

  /// The same bits for pixels that are the same place.
  Vector3d direction(Index x, Index y) const {
    const Index z = f_ - std::abs(x) - std::abs(y);
    if (z >= 0)
      return Vector3d(x, y, z).normalized();
    return Vector3d(x < 0 ? std::abs(y) - f_ : f_ - std::abs(y),
                    y < 0 ? std::abs(x) - f_ : f_ - std::abs(x), z)
        .normalized();
  }
  Vector3d direction(Eigen::Index pixel) const {
    return direction(static_cast<Index>(pixel % side()) - f_,
                     f_ - static_cast<Index>(pixel / side()));
  }

  /// The first pixel that is the same place.
  Eigen::Index firstPixel(Index x, Index y) const {
    if (std::abs(x) == f_ && std::abs(y) == f_)
      return 0;
    if (std::abs(y) == f_)
      return pixel(-std::abs(x), y);
    if (std::abs(x) == f_)
      return pixel(x, std::abs(y));
    return pixel(x, y);
  }

  /// The vertex of each pixel: the first pixels of all places, in their order.
  std::vector<Index> vertices() const {
    std::vector<Index> result;
    result.reserve(static_cast<std::size_t>(pixelCount()));
    Index count = 0;
    for (Index y = f_; y >= -f_; --y)
      for (Index x = -f_; x <= f_; ++x) {
        const Eigen::Index first = firstPixel(x, y);
        result.push_back(first == pixel(x, y) ? count++ : entry(result, first));
      }
    return result;
  }

  /// Two triangles for each square of four pixels, between which the edges of the octahedron run.
  Triangles triangles(const std::vector<Index>& vertices) const {
    Triangles result(3, Eigen::Index{8} * f_ * f_);
    Eigen::Index t = 0;
    const auto at = [&](Index x, Index y) { return entry(vertices, pixel(x, y)); };
    for (Index y = f_ - 1; y >= -f_; --y)
      for (Index x = -f_; x < f_; ++x) {
        const Index a = at(x, y);
        const Index b = at(x + 1, y);
        const Index c = at(x + 1, y + 1);
        const Index d = at(x, y + 1);
        if ((x < 0) == (y < 0)) {
          result.col(t++) << a, b, d;
          result.col(t++) << b, c, d;
        } else {
          result.col(t++) << a, b, c;
          result.col(t++) << a, c, d;
        }
      }
    return result;
  }

  GridSphere grid() const {
    const auto n = static_cast<Eigen::Index>(gridVertices(SphereGrid::Octahedral, f_));
    const std::vector<Index> vertex = vertices();
    GridSphere grid{Positions(3, n), triangles(vertex), f_};
    for (Eigen::Index i = 0; i < pixelCount(); ++i)
      grid.directions.col(entry(vertex, i)) = direction(i);
    return grid;
  }

private:
  Index f_;
};

void checkSide(const std::string& function, int side) {
  internal::checkRange(function + ": side", side, 3, 16385);
  if (side % 2 == 0)
    throw InvalidInput(function + ": side = " + std::to_string(side) + " is even; use an odd one");
}

Positions pixelDirections(int side) {
  const OctahedralSquare square(side / 2);
  Positions directions(3, square.pixelCount());
  for (Eigen::Index i = 0; i < directions.cols(); ++i)
    directions.col(i) = square.direction(i);
  return directions;
}

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

Positions geometryImageDirections(int side) {
  checkSide("geometryImageDirections", side);
  return pixelDirections(side);
}

GeometryImage makeGeometryImage(const SphereSurface& surface, int side) {
  checkSide("makeGeometryImage", side);
  return {side, surface.evaluate(pixelDirections(side)).positions};
}

GeometryImage geometryImageOfMesh(const ResampledMesh& mesh) {
  const std::size_t count = internal::columnCount(mesh.points);
  const int frequency = gridFrequency(SphereGrid::Octahedral, count);
  const int side = 2 * frequency + 1;
  checkSide("geometryImageOfMesh", side);
  if (gridVertices(SphereGrid::Octahedral, frequency) != count)
    throw InvalidInput("geometryImageOfMesh: " + std::to_string(count) +
                       " vertices are not those of an octahedral grid; use makeGridSphere()");
  const OctahedralSquare square(frequency);
  return {side, mesh.points(Eigen::all, square.vertices())};
}

ResampledMesh meshOfGeometryImage(const GeometryImage& image) {
  checkSide("meshOfGeometryImage", image.side);
  const OctahedralSquare square(image.side / 2);
  if (image.positions.cols() != square.pixelCount())
    throw InvalidInput("meshOfGeometryImage: " + std::to_string(image.positions.cols()) +
                       " pixels; an image of side " + std::to_string(image.side) + " has " +
                       std::to_string(square.pixelCount()));
  for (Eigen::Index i = 0; i < image.positions.cols(); ++i)
    if (!image.positions.col(i).allFinite())
      throw InvalidInput("meshOfGeometryImage: pixel " + std::to_string(i) +
                         " is not finite; every pixel needs a position");

  GridSphere grid = square.grid();
  ResampledMesh mesh{grid.directions, {}, grid.directions, std::move(grid.triangles)};
  // Sums of two and of four equal numbers are exact: where pixels agree, nothing changes.
  Indexed<int> pixels(internal::columnCount(mesh.points), 0);
  Eigen::Index i = 0;
  for (const Index v : square.vertices()) {
    const Vector3d position = image.positions.col(i++);
    mesh.points.col(v) = pixels[v] == 0 ? position : Vector3d(mesh.points.col(v) + position);
    ++pixels[v];
  }
  for (Index v = 0; v < pixels.count(); ++v)
    mesh.points.col(v) /= pixels[v];

  const std::size_t count = internal::columnCount(mesh.points);
  const internal::CornerTable corners(mesh.triangles, count, internal::threadCount(0, count));
  mesh.normals = internal::vertexNormals(mesh.points, mesh.triangles, mesh.directions, corners, 0);
  return mesh;
}

}  // namespace spherical_param
