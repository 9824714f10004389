#include "scan_shapes.h"

#include "neighbor_search.h"
#include "sample_elimination.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <unordered_map>

namespace spherical_param::tools {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// The point of the surface near a point: Newton's method along the gradient at the start.
Vector3d project(Vector3d p, const Distance& distance) {
  const Vector3d gradient = gradientAt(p, distance);
  double value = distance(p);
  for (int i = 0; i < 50 && std::abs(value) > 1e-13; ++i) {
    p -= value / gradient.squaredNorm() * gradient;
    value = distance(p);
  }
  return p;
}

}  // namespace

// z up, looking along +x (the hand: fingers up, palm towards -y). Gaps are wide enough that the 25
// nearest neighbours do not cross them at 5000 points.
const std::vector<Shape>& allShapes() {
  const Vector3d origin = Vector3d::Zero();
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  const Vector3d z = Vector3d::UnitZ();
  const double quarter = std::acos(0.0);  // of a turn
  const Distance face =
      body({{ellipsoid({-0.04, 0.0, 0.16}, {0.31, 0.24, 0.27})},                      // skull
            {ellipsoid({0.10, 0.0, -0.02}, {0.18, 0.17, 0.26}), 0.10},                // face
            {ellipsoid({0.18, 0.0, -0.22}, {0.08, 0.08, 0.06}), 0.08},                // chin
            {cone({-0.08, 0.0, -0.10}, 0.13, {-0.10, 0.0, -0.36}, 0.145), 0.08},      // neck
            {cone({0.265, 0.0, 0.09}, 0.022, {0.325, 0.0, -0.035}, 0.040), 0.05}},    // nose
           {{cone({0.250, 0.035, 0.115}, 0.028, {0.195, 0.15, 0.120}, 0.022), 0.04},  // brow
            {ball({0.290, 0.090, 0.055}, 0.050), 0.04, carved},
            {ball({0.215, 0.085, 0.052}, 0.042), 0.01},  // eye in its socket
            {cone({0.230, 0.11, -0.04}, 0.03, {0.19, 0.12, -0.08}, 0.03), 0.06},
            {ellipsoid({-0.03, 0.232, 0.04}, {0.065, 0.036, 0.085}), 0.045},  // ear
            {ellipsoid({-0.015, 0.276, 0.05}, {0.036, 0.022, 0.055}), 0.03, carved}});
  const Distance head =
      body({{face},
            {cone({0.268, -0.045, -0.115}, 0.020, {0.268, 0.045, -0.115}, 0.020), 0.03},  // lips
            {cone({0.256, -0.036, -0.165}, 0.022, {0.256, 0.036, -0.165}, 0.022), 0.02}});
  const Distance hair = bumps({-0.20, 0.0, 0.27}, 0.44, 0.095, 0.034);
  const Distance skin = bumps({0.0, 0.0, -0.05}, 0.60, 0.080, 0.005);
  static const std::vector<Shape> shapes = {
      {"sphere", "a sphere", ball(origin, 0.5)},
      {"head", "a head with a face, ears and bumpy hair",
       [=](const Vector3d& p) { return head(p) - hair(p) - skin(p); }},
      {"bird", "a bird, its tail folded back",
       body(
           {{ellipsoid({0.0, 0.0, -0.08}, {0.29, 0.17, 0.18}, {1.0, 0.0, 0.25})},
            {cone({0.20, 0.0, 0.02}, 0.10, {0.29, 0.0, 0.20}, 0.08), 0.06},        // neck
            {ball({0.30, 0.0, 0.25}, 0.115), 0.05},                                // head
            {cone({0.38, 0.0, 0.25}, 0.045, {0.50, 0.0, 0.22}, 0.018), 0.02},      // beak
            {cone({-0.22, 0.0, -0.12}, 0.065, {-0.34, 0.0, -0.10}, 0.050), 0.06},  // tail
            {arc({-0.34, 0.0, 0.08}, -x, z, 0.18, 0.050, quarter), 0.03},
            {cone({-0.34, 0.0, 0.26}, 0.050, {-0.20, 0.0, 0.28}, 0.045), 0.03},
            {ellipsoid({-0.16, 0.0, 0.29}, {0.17, 0.13, 0.040}, {1.0, 0.0, 0.15}), 0.04}},
           {{ellipsoid({-0.03, 0.16, -0.05}, {0.22, 0.040, 0.11}, {1.0, 0.0, 0.35}), 0.02},  // wing
            {ball({0.375, 0.065, 0.29}, 0.025), 0.01},                                       // eye
            {cone({0.02, 0.08, -0.20}, 0.035, {0.02, 0.09, -0.33}, 0.022), 0.02},            // leg
            {ellipsoid({0.06, 0.09, -0.345}, {0.080, 0.040, 0.022}), 0.02}})},               // foot
      {"hand", "a hand with five spread fingers",
       body({{cone({-0.150, 0.0, 0.01}, 0.034, {-0.228, -0.010, 0.20}, 0.034), 0.012},  // fingers
             {cone({-0.228, -0.010, 0.20}, 0.034, {-0.265, -0.045, 0.32}, 0.0289), 0.012},
             {cone({-0.050, 0.0, 0.02}, 0.036, {-0.078, -0.005, 0.25}, 0.036), 0.012},
             {cone({-0.078, -0.005, 0.25}, 0.036, {-0.093, -0.035, 0.42}, 0.0306), 0.012},
             {cone({0.050, 0.0, 0.02}, 0.035, {0.078, -0.005, 0.24}, 0.035), 0.012},
             {cone({0.078, -0.005, 0.24}, 0.035, {0.093, -0.040, 0.39}, 0.02975), 0.012},
             {cone({0.150, 0.0, 0.01}, 0.030, {0.222, -0.010, 0.17}, 0.030), 0.012},
             {cone({0.222, -0.010, 0.17}, 0.030, {0.258, -0.045, 0.27}, 0.0255), 0.012},
             {cone({-0.110, -0.01, -0.24}, 0.043, {-0.265, -0.045, -0.10}, 0.043), 0.012},
             {cone({-0.265, -0.045, -0.10}, 0.043, {-0.345, -0.060, 0.03}, 0.03655), 0.012},
             {box({0.0, 0.0, -0.13}, {0.185, 0.052, 0.17}, 0.050), 0.03},          // palm
             {ellipsoid({-0.10, -0.03, -0.19}, {0.07, 0.05, 0.11}), 0.04},         // thumb's ball
             {ellipsoid({0.11, -0.03, -0.19}, {0.055, 0.045, 0.10}), 0.04},        // heel
             {cone({0.0, 0.0, -0.26}, 0.085, {0.0, 0.0, -0.45}, 0.080), 0.08}})},  // wrist
      {"animal", "an animal on four legs",
       body({{cone({-0.22, 0.0, 0.02}, 0.125, {0.18, 0.0, 0.04}, 0.145)},         // trunk
             {cone({0.22, 0.0, 0.08}, 0.095, {0.36, 0.0, 0.26}, 0.070), 0.06},    // neck
             {ellipsoid({0.39, 0.0, 0.30}, {0.11, 0.080, 0.085}), 0.04},          // head
             {cone({0.44, 0.0, 0.28}, 0.055, {0.54, 0.0, 0.25}, 0.042), 0.04},    // muzzle
             {cone({-0.32, 0.0, 0.07}, 0.035, {-0.48, 0.0, 0.02}, 0.028), 0.04},  // tail
             {cone({-0.48, 0.0, 0.02}, 0.028, {-0.54, 0.0, -0.16}, 0.020), 0.01}},
            {{cone({0.36, 0.055, 0.36}, 0.030, {0.34, 0.095, 0.45}, 0.018), 0.02},    // ear
             {cone({0.19, 0.085, -0.02}, 0.070, {0.21, 0.095, -0.22}, 0.045), 0.04},  // front leg
             {cone({0.21, 0.095, -0.22}, 0.045, {0.20, 0.095, -0.40}, 0.036), 0.01},
             {cone({0.20, 0.095, -0.40}, 0.040, {0.24, 0.095, -0.41}, 0.032), 0.01},
             {cone({-0.24, 0.080, -0.02}, 0.085, {-0.21, 0.095, -0.22}, 0.048), 0.04},  // hind leg
             {cone({-0.21, 0.095, -0.22}, 0.048, {-0.25, 0.095, -0.40}, 0.036), 0.01},
             {cone({-0.25, 0.095, -0.40}, 0.040, {-0.21, 0.095, -0.41}, 0.032), 0.01}})},
      {"torus", "a torus (genus 1)", arc(origin, x, y, 0.36, 0.14, 2.0 * quarter)},
      {"bowl", "a shell with one opening", ball(origin, 0.5),
       [](const Vector3d& p) { return 0.15 - p.z(); }},
      {"pair", "two spheres (two pieces)", body({{ball(-0.3 * x, 0.2)}, {ball(0.3 * x, 0.2)}})},
      {"chair", "a chair of tubes (genus 4)",
       body({{box(origin, {0.21, 0.21, 0.035}, 0.03)},                               // seat
             {cone({-0.21, -0.17, 0.45}, 0.035, {-0.21, 0.17, 0.45}, 0.034), 0.02},  // back
             {cone({-0.19, -0.17, 0.23}, 0.035, {-0.19, 0.17, 0.23}, 0.034), 0.02}},
            {{cone({-0.17, 0.17, 0.0}, 0.036, {-0.21, 0.17, 0.45}, 0.035), 0.02},
             {cone({-0.17, 0.17, 0.0}, 0.036, {-0.19, 0.17, -0.46}, 0.032), 0.02},  // legs
             {cone({0.17, 0.17, 0.0}, 0.036, {0.19, 0.17, -0.46}, 0.032), 0.02},
             {cone({-0.18, 0.17, -0.25}, 0.032, {0.18, 0.17, -0.25}, 0.031), 0.02}})},
      {"holed", "a rabbit with four openings (open)",
       body({{ellipsoid({-0.06, 0.0, -0.12}, {0.30, 0.22, 0.23})},            // body
             {cone({0.14, 0.0, 0.02}, 0.13, {0.23, 0.0, 0.14}, 0.12), 0.08},  // neck
             {ellipsoid({0.29, 0.0, 0.15}, {0.14, 0.11, 0.11}), 0.05},        // head
             {ball({-0.38, 0.0, -0.10}, 0.07), 0.04},                         // tail
             {ball({0.12, 0.0, -0.40}, 0.05), 0.05, carved}},
            {{cone({0.22, 0.055, 0.23}, 0.035, {0.13, 0.09, 0.46}, 0.028), 0.03},    // ear
             {cone({0.10, 0.11, -0.24}, 0.06, {0.20, 0.12, -0.32}, 0.045), 0.04}}),  // foot
       body({{ball({-0.10, 0.0, -0.35}, 0.13)},
             {ball({-0.12, 0.0, 0.11}, 0.12)},
             {ball({-0.10, 0.215, -0.12}, 0.12)},
             {ball({-0.10, -0.215, -0.12}, 0.115)}})}};
  return shapes;
}

const Shape& findShape(const std::string& name) {
  for (const Shape& shape : allShapes())
    if (shape.name == name)
      return shape;
  throw InvalidInput("there is no shape '" + name + "'; take one of allShapes()");
}

// Surface nets (Gibson 1998, "Constrained elastic surface nets"): a vertex in each cube of a
// lattice that the surface cuts, and two triangles around each edge that it cuts. The mesh is not
// manifold if the surface passes a cube twice. The lattice lies so that this does not happen at 256
// cells, which the tests check for every shape.
TruthMesh referenceMesh(const std::string& name, int cells) {
  const Shape& shape = findShape(name);
  const auto is_cut = [&](const Vector3d& p) { return shape.opening && shape.opening(p) <= 0.0; };
  const double step = 1.28 / cells;
  const auto position = [&](const Vector3d& node) -> Vector3d {
    return step * (node + Vector3d(0.27, 0.41, 0.13)).array() - 0.64;
  };
  const auto key = [](const Vector3i& node) { return node.dot(Vector3i(1, 1 << 9, 1 << 18)); };
  std::unordered_map<int, double> values;  // of nodes, by their keys
  const auto value = [&](const Vector3i& node) {
    const auto [entry, is_new] = values.try_emplace(key(node));
    if (is_new)
      entry->second = shape.distance(position(node.cast<double>()));
    return entry->second;
  };
  // Where the surface cuts an edge; not at a node, where vertices of several cubes would meet.
  const auto crossing = [&](const Vector3i& node, int axis) -> std::optional<Vector3d> {
    const double a = value(node);
    const double b = value(node + Vector3i::Unit(axis));
    if ((a < 0.0) == (b < 0.0))
      return std::nullopt;
    return position(node.cast<double>() + std::clamp(a / (a - b), 0.1, 0.9) * Vector3d::Unit(axis));
  };

  std::vector<Vector3i> cubes;  // with a vertex, by their lowest nodes
  std::vector<Vector3d> vertices;
  std::vector<bool> is_on_boundary;  // of the opening
  std::unordered_map<int, Index> vertex_of_cube;
  const std::function<void(const Vector3i&, int)> visit = [&](const Vector3i& low, int size) {
    const Vector3d center = position(low.cast<double>().array() + 0.5 * size);
    // 3 instead of 1, because it is not quite the distance; 2 is enough for all shapes.
    if (std::abs(shape.distance(center)) > 3.0 * std::sqrt(0.75) * size * step)
      return;
    for (int i = 0; i < 8 && size > 1; ++i)
      visit(low + size / 2 * Vector3i(i & 1, i >> 1 & 1, i >> 2), size / 2);
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();  // of the crossings, and their number
    bool is_open = false;
    for (int i = 0; i < 12 && size == 1; ++i) {
      const int axis = i % 3;
      const Vector3i node = low + (i / 3 % 2) * Vector3i::Unit((axis + 1) % 3) +
                            (i / 6) * Vector3i::Unit((axis + 2) % 3);
      const auto where = crossing(node, axis);
      if (where && !is_cut(*where))
        sum += where->homogeneous();
      else if (where)
        is_open = true;
    }
    if (sum.w() == 0.0)
      return;
    vertex_of_cube[key(low)] = static_cast<Index>(cubes.size());
    cubes.push_back(low);
    vertices.emplace_back(sum.hnormalized());
    is_on_boundary.push_back(is_open);
  };
  visit({0, 0, 0}, cells);

  std::vector<Eigen::Matrix<Index, 3, 1>> triangles;
  for (const Vector3i& cube : cubes)
    for (int axis = 0; axis < 3; ++axis) {
      const auto where = crossing(cube, axis);
      if (!where || is_cut(*where))
        continue;
      const int turn = value(cube) < 0.0 ? 1 : 2;  // counter-clockwise seen from outside
      const Vector3i a = Vector3i::Unit((axis + turn) % 3);
      const Vector3i b = Vector3i::Unit((axis + 3 - turn) % 3);
      const auto vertex = [&](const Vector3i& other) { return vertex_of_cube.at(key(other)); };
      std::array<Index, 4> around = {vertex(cube), vertex(cube - a), vertex(cube - a - b),
                                     vertex(cube - b)};
      // No triangle has all its vertices on the boundary loop.
      const auto is_boundary = [&](Index v) { return is_on_boundary[static_cast<std::size_t>(v)]; };
      if (is_boundary(around[0]) && is_boundary(around[2]))
        std::rotate(around.begin(), around.begin() + 1, around.end());
      triangles.emplace_back(around[0], around[1], around[2]);
      triangles.emplace_back(around[0], around[2], around[3]);
    }

  TruthMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  forEach(vertices.size(), [&](std::size_t i) {
    Vector3d p = project(vertices[i], shape.distance);
    for (int k = 0; k < 20 && is_on_boundary[i]; ++k)  // alternating projections
      p = project(project(p, shape.distance), shape.opening);
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = p;
  });
  mesh.triangles = Eigen::Map<const Triangles>(triangles[0].data(), 3,
                                               static_cast<Eigen::Index>(triangles.size()));
  return mesh;
}

Scan generateScan(const ScanOptions& options) {
  const TruthMesh mesh = referenceMesh(options.shape, 128);
  const auto corner = [&](Eigen::Index t, int k) -> Vector3d {
    return mesh.vertices.col(mesh.triangles(k, t));
  };
  Eigen::VectorXd areas(mesh.triangles.cols());
  for (Eigen::Index t = 0; t < areas.size(); ++t)
    areas[t] = 0.5 * (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();

  // Three candidates for each point, one from each of as many parts of equal area. More candidates
  // would give 3 % more spacing and take much longer.
  Positions points(3, std::max<Eigen::Index>(2000, 3 * static_cast<Eigen::Index>(options.points)));
  std::mt19937_64 random(options.seed);
  const double part = areas.sum() / static_cast<double>(points.cols());
  Eigen::Index t = 0;
  double end = areas[0];
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double target = (static_cast<double>(i) + uniform(random)) * part;
    while (end <= target && t + 1 < areas.size())
      end += areas[++t];
    // Uniform in a triangle: Osada et al. 2002, "Shape distributions", equation 1.
    const double u = std::sqrt(uniform(random));
    const double v = uniform(random);
    points.col(i) = (1.0 - u) * corner(t, 0) + u * (1.0 - v) * corner(t, 1) + u * v * corner(t, 2);
  }
  // The two sides of a thin part keep their distance from each other, too.
  const std::vector<Index> kept = eliminateSamples(points, options.points, areas.sum());

  const Distance& distance = findShape(options.shape).distance;
  Scan scan = {Positions(3, kept.size()), Positions(3, kept.size())};
  forEach(kept.size(), [&](std::size_t i) {
    const Vector3d p = project(points.col(kept[i]), distance);
    scan.points.col(static_cast<Eigen::Index>(i)) = p;
    scan.normals.col(static_cast<Eigen::Index>(i)) = gradientAt(p, distance).normalized();
  });
  if (options.noise == 0.0)
    return scan;

  const int neighbors = static_cast<int>(std::min<std::size_t>(25, kept.size() - 1));
  const NeighborLists lists = findNearestNeighbors(scan.points, neighbors);
  const Positions clean = scan.points;
  random.seed(~options.seed);  // another stream than that of the samples
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    double sum = 0.0;  // the point itself is in its list and adds nothing
    for (std::size_t k = lists.offsets[i]; k < lists.offsets[i + 1]; ++k)
      sum += (clean.col(lists.indices[k]) - clean.col(column)).norm();
    const double width = options.noise * sum / neighbors;
    scan.points.col(column) += width * (2.0 * uniform(random) - 1.0) * scan.normals.col(column);
  }
  return scan;
}

Scan sliceShape(const ScanOptions& options) {
  const TruthMesh mesh = referenceMesh(options.shape);
  const double low = mesh.vertices.row(2).minCoeff();
  const double step = (mesh.vertices.row(2).maxCoeff() - low) / options.slices;
  const auto height = [&](Index vertex) { return (mesh.vertices(2, vertex) - low) / step - 0.5; };
  std::vector<Vector3d> points;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = mesh.triangles(k, t);
      const Index b = mesh.triangles((k + 1) % 3, t);
      // Each edge is a side of two triangles, once upward; on a boundary some are missed.
      for (double plane = std::ceil(height(a)); plane < height(b); ++plane) {
        const double fraction = (plane - height(a)) / (height(b) - height(a));
        points.emplace_back(mesh.vertices.col(a) +
                            fraction * (mesh.vertices.col(b) - mesh.vertices.col(a)));
      }
    }
  std::sort(points.begin(), points.end(), [](const Vector3d& a, const Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  const Distance& distance = findShape(options.shape).distance;
  Scan scan = {Positions(3, points.size()), Positions(3, points.size())};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    scan.points.col(column) = points[i];
    scan.normals.col(column) = gradientAt(points[i], distance).normalized();
  }
  return scan;
}

}  // namespace spherical_param::tools
