#include "spherical_param/map/texture_atlas.h"

#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"

#include "index_loops.h"
#include "input_checks.h"
#include "pi.h"
#include "sphere_cutting.h"
#include "triangle_geometry.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <utility>

namespace spherical_param {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using internal::CellSide;
using internal::CutSphere;
using internal::entry;
using internal::indexCount;
using internal::Indexed;
using internal::PlaneSigns;
using internal::SphereCells;

/// Planes of sphere_cutting.h.
constexpr int x_plane = 0;
constexpr int y_plane = 1;
constexpr int z_plane = 2;

/// A face of the cube: right, up and outward are a right-handed frame of axes.
struct CubeFace {
  std::array<int, 3> right;
  std::array<int, 3> up;
  std::array<int, 3> outward;
};

/// In rows of three, the upper row first.
constexpr std::array<CubeFace, 6> cube_faces = {{
    {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
    {{0, -1, 0}, {0, 0, 1}, {-1, 0, 0}},
    {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
    {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
}};

double along(const std::array<int, 3>& axis, const Vector3d& point) {
  return axis[0] * point.x() + axis[1] * point.y() + axis[2] * point.z();
}

/// A chart is smooth in each of its cells. Those of the octahedral chart and of the cube map are
/// whole octants and faces: the charts are projective there, so that they keep great circles
/// straight and turn no triangle over, however large it is. A triangle over the border of two
/// octants would not wrap round, but it could be turned over. Longitude and latitude are cut along
/// three more half meridians than they need, so that triangles at the poles get corners there.
SphereCells cellsOf(SphereChart chart) {
  if (chart == SphereChart::CubeMap)
    // x - y, x + y, x - z, x + z, y - z and y + z are planes 3 to 8.
    return {{{3, 1}, {4, 1}, {5, 1}, {6, 1}},   {{3, -1}, {4, -1}, {5, -1}, {6, -1}},
            {{3, -1}, {4, 1}, {7, 1}, {8, 1}},  {{3, 1}, {4, -1}, {7, -1}, {8, -1}},
            {{5, -1}, {6, 1}, {7, -1}, {8, 1}}, {{5, 1}, {6, -1}, {7, 1}, {8, -1}}};
  SphereCells quarters;
  for (const int y : {1, -1})
    for (const int x : {1, -1})
      quarters.push_back({{x_plane, x}, {y_plane, y}});
  if (chart == SphereChart::Equirectangular)
    return quarters;
  SphereCells octants;
  for (const int z : {1, -1})
    for (const std::vector<CellSide>& quarter : quarters) {
      octants.push_back(quarter);
      octants.back().push_back({z_plane, z});
    }
  return octants;
}

/// The place of a point, of any length, that is in a cell.
Vector2d coordinatesIn(const TextureAtlasOptions& options, const std::vector<CellSide>& cell,
                       Index index, const Vector3d& point) {
  switch (options.chart) {
  case SphereChart::Equirectangular: {
    const double y_sign = cell[1].sign;
    // The cell decides between both ends of the image.
    const double longitude = point.y() == 0.0 && point.x() < 0.0 ? y_sign * internal::kPi
                             : point.x() == 0.0 && point.y() == 0.0
                                 ? 0.0
                                 : std::atan2(point.y(), point.x());
    const double latitude = std::atan2(point.z(), std::hypot(point.x(), point.y()));
    return {std::clamp((1.0 + longitude / internal::kPi) / 2.0, 0.0, 1.0),
            std::clamp(0.5 + latitude / internal::kPi, 0.0, 1.0)};
  }
  case SphereChart::Octahedral: {
    const double sum = point.cwiseAbs().sum();
    Vector2d place(point.x() / sum, point.y() / sum);
    if (point.z() < 0.0)
      place = {cell[0].sign * (1.0 - std::abs(point.y()) / sum),
               cell[1].sign * (1.0 - std::abs(point.x()) / sum)};
    return ((Vector2d::Ones() + place) / 2.0).cwiseMax(0.0).cwiseMin(1.0);
  }
  case SphereChart::CubeMap: {
    const CubeFace& face = entry(cube_faces, index);
    const double depth = along(face.outward, point);
    const double free = 1.0 - 2.0 * options.margin;
    const auto place = [&](const std::array<int, 3>& axis) {
      return options.margin +
             free * (1.0 + std::clamp(along(axis, point) / depth, -1.0, 1.0)) / 2.0;
    };
    const double row = index < 3 ? 1.0 : 0.0;
    return {(index % 3 + place(face.right)) / 3.0, (row + place(face.up)) / 2.0};
  }
  }
  return Vector2d::Zero();
}

bool isPole(const Vector3d& point) {
  return point.x() == 0.0 && point.y() == 0.0;
}

/// Places of the corners of triangles.
struct Places {
  const TextureAtlasOptions& options;
  const SphereCells& cells;
  const CutSphere& sphere;

  std::array<Vector2d, 3> of(Index t) const {
    const std::array<Index, 3>& triangle = sphere.triangles[t];
    const Index cell = sphere.cells[t];
    std::array<Vector2d, 3> places;
    for (std::size_t k = 0; k < 3; ++k)
      places[k] = coordinatesIn(options, cells[cell], cell, sphere.points[triangle[k]]);
    // A pole is the whole upper or lower side of the image; each triangle gets a part of that.
    for (std::size_t k = 0; k < 3; ++k)
      if (options.chart == SphereChart::Equirectangular && isPole(sphere.points[triangle[k]]))
        places[k].x() = (places[(k + 1) % 3].x() + places[(k + 2) % 3].x()) / 2.0;
    return places;
  }
};

/// Splits edges until no triangle is turned over in a chart where great circles are not straight.
///
/// Three corners that are nearly on a great circle change their orientation there with its
/// curvature. The edge opposite to the middle one is split beside that: of both parts, each has
/// nearly a right angle, and so has its image.
class Straightening {
public:
  Straightening(const Places& places, CutSphere& sphere) : places_(places), sphere_(sphere) {}

  void run() {
    std::vector<Index> turned;
    for (Index t = 0; t < indexCount(sphere_.triangles); ++t)
      if (isTurnedOver(t))
        turned.push_back(t);
    if (turned.empty())
      return;
    for (Index t = 0; t < indexCount(sphere_.triangles); ++t)
      addSides(t);
    // Each split shortens edges, whose images then are straighter. What is left after this number
    // is as small as rounding.
    std::size_t budget = 64 * sphere_.triangles.size() + 4096;
    while (!turned.empty() && budget > 0) {
      const Index t = turned.back();
      turned.pop_back();
      if (!isTurnedOver(t))
        continue;
      --budget;
      for (const Index part : split(t))
        if (isTurnedOver(part))
          turned.push_back(part);
    }
  }

private:
  bool isTurnedOver(Index t) const {
    const std::array<Vector2d, 3> p = places_.of(t);
    const Vector2d b = p[1] - p[0];
    const Vector2d c = p[2] - p[0];
    const double doubled_area = b.x() * c.y() - b.y() * c.x();
    // Places are rounded: below this nothing is certain.
    const double rounding =
        4.0 * internal::kUnitRoundoff * std::sqrt(std::max(b.squaredNorm(), c.squaredNorm()));
    return doubled_area < -rounding;
  }

  void addSides(Index t) {
    const std::array<Index, 3>& triangle = sphere_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k)
      left_of_[{triangle[k], triangle[(k + 1) % 3]}] = t;
  }

  /// Splits the longest side of a triangle. \return the triangles that there are now instead.
  std::vector<Index> split(Index t) {
    const std::array<Index, 3> triangle = sphere_.triangles[t];
    std::size_t longest = 0;
    double length = -1.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double other = (sphere_.points[triangle[k]].normalized() -
                            sphere_.points[triangle[(k + 1) % 3]].normalized())
                               .squaredNorm();
      if (other > length) {
        length = other;
        longest = k;
      }
    }
    const Index a = triangle[longest];
    const Index b = triangle[(longest + 1) % 3];
    const Index c = triangle[(longest + 2) % 3];
    const double fraction = fractionBeside(sphere_.points[a], sphere_.points[b], sphere_.points[c]);
    const Index middle = addVertex(a, b, fraction);
    if (middle < 0)
      return {};
    const auto across = left_of_.find({b, a});
    const Index other = across == left_of_.end() ? -1 : across->second;
    std::vector<Index> parts = {t, replace(t, a, b, middle)};
    if (other >= 0)  // else the edge is in the boundary
      parts.insert(parts.end(), {other, replace(other, b, a, middle)});
    return parts;
  }

  /// How far along from a to b the point is that is closest to c.
  static double fractionBeside(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const Vector3d normal = a.cross(b);
    const double of_a = c.cross(b).dot(normal);
    const double of_b = a.cross(c).dot(normal);
    const double fraction = of_b / (of_a + of_b);
    // NaN where the edge has no length.
    return fraction > 0.02 && fraction < 0.98 ? fraction : 0.5;
  }

  /// A new vertex on an edge, -1 if there is no room for one.
  Index addVertex(Index a, Index b, double fraction) {
    const Vector3d point = (1.0 - fraction) * sphere_.points[a] + fraction * sphere_.points[b];
    if (point == sphere_.points[a] || point == sphere_.points[b])
      return -1;
    // Both ends are in one triangle of the mesh.
    std::vector<std::pair<Index, double>> parts;
    for (const auto& [end, weight] : {std::pair(a, 1.0 - fraction), std::pair(b, fraction)}) {
      const CutVertex& vertex = sphere_.vertices[end];
      for (Index k = 0; k < 3; ++k) {
        const Index v = entry(vertex.vertices, k);
        if (vertex.weights[k] == 0.0)
          continue;
        const auto known = std::find_if(parts.begin(), parts.end(),
                                        [v](const auto& part) { return part.first == v; });
        if (known == parts.end())
          parts.emplace_back(v, weight * vertex.weights[k]);
        else
          known->second += weight * vertex.weights[k];
      }
    }
    parts.resize(3, {parts.back().first, 0.0});
    CutVertex vertex;
    for (Index k = 0; k < 3; ++k)
      std::tie(entry(vertex.vertices, k), vertex.weights[k]) = entry(parts, k);
    sphere_.vertices.push_back(vertex);
    sphere_.points.push_back(point);
    return indexCount(sphere_.points) - 1;
  }

  /// Replaces the triangle left of the edge from a to b by two. \return the new one.
  Index replace(Index t, Index a, Index b, Index middle) {
    std::array<Index, 3>& triangle = sphere_.triangles[t];
    left_of_.erase({a, b});
    std::array<Index, 3> part = triangle;
    *std::find(triangle.begin(), triangle.end(), b) = middle;
    *std::find(part.begin(), part.end(), a) = middle;
    sphere_.triangles.push_back(part);
    sphere_.cells.push_back(sphere_.cells[t]);
    sphere_.source.push_back(sphere_.source[t]);
    addSides(t);
    addSides(indexCount(sphere_.triangles) - 1);
    return indexCount(sphere_.triangles) - 1;
  }

  const Places& places_;
  CutSphere& sphere_;
  std::map<std::pair<Index, Index>, Index> left_of_;  // directed edge -> triangle
};

void checkOptions(const TextureAtlasOptions& options, const std::string& function) {
  internal::checkEnum(function + ": chart", options.chart, SphereChart::CubeMap);
  if (!(options.margin >= 0.0 && options.margin < 0.25))
    throw InvalidInput(function + ": margin is " + std::to_string(options.margin) +
                       "; give a fraction of the side of a face in [0, 0.25)");
}

void checkMesh(const Triangles& triangles, const Positions& sphere) {
  const std::string function = "makeTextureAtlas";
  const MeshTopology topology = checkTopology(triangles, internal::columnCount(sphere));
  if (!topology.isSphere() && !topology.isOpenSurface())
    throw InvalidInput(function +
                       ": the triangles are not an oriented manifold of genus 0 over all vertices; "
                       "give a mesh as reconstruct() makes it");
  internal::checkUnitVectors("makeTextureAtlas", sphere, 2e-6);  // single precision passes
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    if (internal::isFlipped(sphere, triangles, t))
      throw InvalidInput(function + ": triangle " + std::to_string(t) +
                         " is flipped on the sphere; give a map that is one to one, as "
                         "computeSphereMap() makes it");
}

}  // namespace

TextureAtlas makeTextureAtlas(const Triangles& triangles, const Positions& sphere,
                              const TextureAtlasOptions& options) {
  checkOptions(options, "makeTextureAtlas");
  checkMesh(triangles, sphere);

  const bool has_poles = options.chart == SphereChart::Equirectangular;
  const SphereCells cells = cellsOf(options.chart);
  CutSphere cut = internal::cutSphere(triangles, sphere, cells, has_poles ? y_plane : -1);
  const Places places{options, cells, cut};
  if (has_poles)
    Straightening(places, cut).run();

  TextureAtlas atlas;
  atlas.chart = options.chart;
  const Index count = indexCount(cut.triangles);
  atlas.triangles.resize(3, count);
  atlas.coordinate_triangles.resize(3, count);
  Indexed<Vector2d> columns;
  columns.reserve(cut.vertices.size());
  // The columns of a vertex are a list that begins at the first.
  Indexed<Index> first(cut.vertices.size(), -1);
  Indexed<Index> next;
  next.reserve(cut.vertices.size());
  for (Index t = 0; t < count; ++t) {
    const std::array<Vector2d, 3> corners = places.of(t);
    for (Index k = 0; k < 3; ++k) {
      const Index vertex = entry(cut.triangles[t], k);
      Index* column = &first[vertex];
      while (*column >= 0 && columns[*column] != entry(corners, k))
        column = &next[*column];
      atlas.triangles(k, t) = vertex;
      atlas.coordinate_triangles(k, t) = *column < 0 ? indexCount(columns) : *column;
      if (*column < 0) {
        *column = indexCount(columns);
        columns.push_back(entry(corners, k));
        next.push_back(-1);
      }
    }
  }
  atlas.coordinates.resize(2, indexCount(columns));
  for (Index i = 0; i < indexCount(columns); ++i)
    atlas.coordinates.col(i) = columns[i];
  atlas.vertices = std::move(cut.vertices);
  atlas.source = std::move(cut.source);
  return atlas;
}

Eigen::MatrixXd atCutVertices(const TextureAtlas& atlas, const Eigen::MatrixXd& values) {
  Index last = -1;
  for (const CutVertex& vertex : atlas.vertices)
    for (const Index v : vertex.vertices) {
      if (v < 0)
        throw InvalidInput("atCutVertices: the atlas names a vertex below 0; use one that "
                           "makeTextureAtlas() made");
      last = std::max(last, v);
    }
  if (values.cols() != last + 1)
    throw InvalidInput("atCutVertices: there are values of " + std::to_string(values.cols()) +
                       " vertices, the mesh has " + std::to_string(last + 1) +
                       "; give one column for each");
  Eigen::MatrixXd result(values.rows(), indexCount(atlas.vertices));
  for (Index i = 0; i < result.cols(); ++i) {
    const CutVertex& vertex = entry(atlas.vertices, i);
    auto column = result.col(i);
    // Values without weight do not count, even if they are not finite.
    if (vertex.weights[0] == 1.0) {
      column = values.col(vertex.vertices[0]);
      continue;
    }
    column.setZero();
    for (Eigen::Index k = 0; k < 3; ++k)
      if (vertex.weights[k] > 0.0)
        column += vertex.weights[k] * values.col(entry(vertex.vertices, k));
  }
  return result;
}

Vector2d chartCoordinates(const TextureAtlasOptions& options, const Vector3d& direction) {
  checkOptions(options, "chartCoordinates");
  internal::checkDirections("chartCoordinates", direction);
  const SphereCells cells = cellsOf(options.chart);
  const PlaneSigns signs = internal::planeSigns(direction);
  Index cell = 0;
  while (!internal::isInCell(signs, cells[cell]))
    ++cell;
  return coordinatesIn(options, cells[cell], cell, direction);
}

}  // namespace spherical_param
