#include "scan_scenes.h"

#include "bit_mixing.h"
#include "pi.h"
#include "scan_distances.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <utility>

namespace spherical_param::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using internal::kPi;

constexpr double no_depth = std::numeric_limits<double>::quiet_NaN();

/// Of a normal distribution, nearly: the sum of twelve uniform numbers has a variance of 1.
double normal(std::mt19937_64& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i)
    sum += uniform(random);
  return sum;
}

/// A sensor that measures along rays, one for each place of an image.
struct Sensor {
  bool is_panorama = false;      ///< all around z, else it looks along z
  double low = 0.0, high = 0.0;  ///< of a panorama, elevations [rad]
  double focal_length = 1.0;     ///< of a camera, in widths; its image is 4 x 3
  double max_range = 1.0;        ///< what is farther is not seen
  double noise = 0.0;            ///< standard deviation of the depth at depth 1
  double noise_power = 0.0;      ///< of the depth, with which the noise, and the step, grow
  double step = 0.0;             ///< of depths at depth 1; 0: none
  double flying = 0.0;   ///< fraction of the points before a jump in depth that lie in the jump
  double missing = 0.0;  ///< fraction of points without a depth
};

struct Grid {
  Eigen::Index columns, rows;

  std::size_t size() const { return static_cast<std::size_t>(columns * rows); }
};

Grid gridOf(const Sensor& sensor, std::size_t points) {
  const double aspect = sensor.is_panorama ? 2.0 * kPi / (sensor.high - sensor.low) : 4.0 / 3.0;
  const double rows = std::max(2.0, std::round(std::sqrt(static_cast<double>(points) / aspect)));
  return {static_cast<Eigen::Index>(std::max(2.0, std::round(rows * aspect))),
          static_cast<Eigen::Index>(rows)};
}

/// The ray through a place of the image, of such a length that depths are along the axis of a
/// camera, and distances in a panorama.
Vector3d rayOf(const Sensor& sensor, const Grid& grid, Eigen::Index i) {
  const double u =
      (static_cast<double>(i % grid.columns) + 0.5) / static_cast<double>(grid.columns);
  const double v = (static_cast<double>(i / grid.columns) + 0.5) / static_cast<double>(grid.rows);
  if (!sensor.is_panorama)
    return {(u - 0.5) / sensor.focal_length, 0.75 * (v - 0.5) / sensor.focal_length, 1.0};
  const double azimuth = -2.0 * kPi * u;
  const double elevation = sensor.high + v * (sensor.low - sensor.high);
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

/// Surfaces as a sensor sees them, at the origin.
using Surfaces = std::vector<Distance>;

/// Moves a scene into the frame of a sensor.
///
/// \param axes of the sensor, in the scene.
Surfaces seenFrom(const Vector3d& place, const Matrix3d& axes, const Surfaces& scene) {
  Surfaces seen;
  for (const Distance& distance : scene)
    seen.emplace_back([=](const Vector3d& p) { return distance(place + axes * p); });
  return seen;
}

/// Of a camera that looks at a point: to the right, down, along its axis.
Matrix3d axesToward(const Vector3d& place, const Vector3d& target) {
  Matrix3d axes;
  axes.col(2) = (target - place).normalized();
  axes.col(0) = axes.col(2).cross(Vector3d::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

/// The depth along a ray, and the surface there; NaN and -1: none. Sphere tracing (J. C. Hart,
/// 1996).
std::pair<double, int> trace(const Surfaces& surfaces, const Vector3d& ray, double max_range) {
  constexpr int most_steps = 2000;  // along a surface that the ray grazes
  const double length = ray.norm();
  double depth = 1e-3 * max_range;
  int nearest = 0;
  for (int step = 0; step < most_steps && depth < max_range; ++step) {
    const Vector3d p = depth * ray;
    double least = std::numeric_limits<double>::max();
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      const double value = surfaces[s](p);
      if (value < least) {
        least = value;
        nearest = static_cast<int>(s);
      }
    }
    if (least < 1e-6 * depth)
      break;
    depth += 0.7 * least / length;  // because it is not quite the distance
  }
  if (depth < max_range)
    return {depth, nearest};
  return {no_depth, -1};
}

/// What is measured of the true depths, which it replaces.
void measure(const Sensor& sensor, const Grid& grid, double factor, std::mt19937_64& random,
             Eigen::VectorXd& depths) {
  const Eigen::VectorXd clean = depths;
  const double fraction = std::min(1.0, factor);
  for (Eigen::Index i = 0; i < depths.size(); ++i) {
    double nearest = clean[i];
    const Eigen::Index column = i % grid.columns;
    for (const auto& [other, is_inside] :
         {std::pair{i - 1, column > 0}, std::pair{i + 1, column + 1 < grid.columns},
          std::pair{i - grid.columns, i >= grid.columns},
          std::pair{i + grid.columns, i + grid.columns < depths.size()}})
      if (is_inside && clean[other] < nearest)
        nearest = clean[other];
    // The same numbers are drawn for each point, whatever becomes of them.
    const bool is_flying = uniform(random) < fraction * sensor.flying;
    const double between = uniform(random);
    const double error = normal(random);
    const bool is_missing = uniform(random) < fraction * sensor.missing;
    double depth = clean[i];
    if (is_flying && depth - nearest > 0.03 * depth)
      depth = nearest + between * (depth - nearest);
    const double growth = factor * std::pow(depth, sensor.noise_power);
    depth += sensor.noise * growth * error;
    const double step = sensor.step * growth;
    if (step > 0.0)
      depth = step * std::round(depth / step);
    depths[i] = is_missing ? no_depth : depth;
  }
}

/// The triangles between neighbouring rays that hit the same thing, of which none is seen at less
/// than 4 degrees.
///
/// \param clean what the rays hit. \param labels what each hit; -1: nothing.
/// \param ray of a place; triangles face against it.
TruthMesh truthOf(const Positions& clean, const std::vector<int>& labels, const Grid& grid,
                  bool is_around, const std::function<Vector3d(Eigen::Index)>& ray) {
  std::vector<Index> triangles;
  const auto add = [&](const std::array<Eigen::Index, 3>& corners) {
    for (const Eigen::Index corner : corners) {
      const int thing = labels[static_cast<std::size_t>(corner)];
      if (thing < 0 || thing != labels[static_cast<std::size_t>(corners[0])])
        return;
    }
    const auto corner = [&](std::size_t k) { return clean.col(corners[k]); };
    const Vector3d area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const Vector3d along = ray(corners[0]);
    if (-area.dot(along) > std::sin(4.0 / 180.0 * kPi) * area.norm() * along.norm())
      for (const Eigen::Index c : corners)
        triangles.push_back(static_cast<Index>(c));
  };
  for (Eigen::Index row = 0; row + 1 < grid.rows; ++row)
    for (Eigen::Index column = 0; column + (is_around ? 0 : 1) < grid.columns; ++column) {
      const Eigen::Index a = row * grid.columns + column;
      const Eigen::Index b = row * grid.columns + (column + 1) % grid.columns;
      add({a, a + grid.columns, b + grid.columns});
      add({a, b + grid.columns, b});
    }
  std::vector<Index> vertex_of(labels.size(), -1);
  Index count = 0;
  for (const Index corner : triangles)
    if (vertex_of[static_cast<std::size_t>(corner)] < 0)
      vertex_of[static_cast<std::size_t>(corner)] = count++;
  TruthMesh truth;
  truth.vertices.resize(3, count);
  truth.triangles.resize(3, static_cast<Eigen::Index>(triangles.size() / 3));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Index vertex = vertex_of[static_cast<std::size_t>(triangles[i])];
    truth.vertices.col(vertex) = clean.col(triangles[i]);
    truth.triangles.data()[i] = vertex;
  }
  return truth;
}

/// \param truth what is seen; null: not wanted.
Scan scanSurfaces(const Surfaces& surfaces, const Sensor& sensor, const ScanOptions& options,
                  TruthMesh* truth = nullptr) {
  const Grid grid = gridOf(sensor, options.points);
  const auto n = static_cast<Eigen::Index>(grid.size());
  std::vector<int> labels(grid.size());
  Eigen::VectorXd depths(n);
  Scan scan = {Positions(3, n), Positions(3, n), static_cast<std::size_t>(grid.rows)};
  Positions clean(3, n);
  const auto ray = [&](Eigen::Index i) { return rayOf(sensor, grid, i); };
  forEach(grid.size(), [&](std::size_t place) {
    const auto i = static_cast<Eigen::Index>(place);
    const auto [depth, thing] = trace(surfaces, ray(i), sensor.max_range);
    depths[i] = depth;
    labels[place] = thing;
    clean.col(i) = depth * ray(i);
    scan.normals.col(i).setZero();
    if (thing >= 0)
      scan.normals.col(i) =
          gradientAt(clean.col(i), surfaces[static_cast<std::size_t>(thing)]).normalized();
  });
  if (truth != nullptr)
    *truth = truthOf(clean, labels, grid, sensor.is_panorama, ray);
  std::mt19937_64 random(options.seed);
  measure(sensor, grid, options.noise, random, depths);
  for (Eigen::Index i = 0; i < n; ++i)
    scan.points.col(i) = depths[i] * ray(i);
  return scan;
}

/// A shape of another size at another place, turned about z [rad].
Distance placed(const std::string& name, const Vector3d& center, double size, double turn) {
  const Matrix3d axes = Eigen::AngleAxisd(-turn, Vector3d::UnitZ()).toRotationMatrix();
  return [=, &distance = findShape(name).distance](const Vector3d& p) {
    const Vector3d offset = (p - center) / size;
    const double away = offset.norm() - 0.8;  // no shape is larger
    return size * (away > 0.2 ? away : distance(axes * offset));
  };
}

/// z up, x away from the camera, the top of the desk at z = 0.
Scan scanDesk(const ScanOptions& options, TruthMesh* truth) {
  const Surfaces room = {
      body({{box({0.0, 0.0, -0.02}, {0.40, 0.52, 0.02}, 0.005)},
            {placed("head", {0.12, -0.22, 0.19}, 0.38, 2.8)},
            {placed("animal", {-0.12, 0.13, 0.157}, 0.35, 4.0)},
            {box({0.10, 0.30, 0.02}, {0.11, 0.15, 0.02}, 0.004)},
            {box({0.12, 0.28, 0.055}, {0.09, 0.13, 0.015}, 0.004)},
            {ball({0.12, 0.26, 0.14}, 0.07)}}),
      body({{cone({-0.22, -0.18, 0.04}, 0.04, {-0.22, -0.18, 0.1}, 0.039)},
            {arc({-0.22, -0.22, 0.07}, -Vector3d::UnitY(), Vector3d::UnitZ(), 0.027, 0.007, 1.7)},
            {cone({-0.22, -0.18, 0.045}, 0.034, {-0.22, -0.18, 0.3}, 0.033), 0.0, carved}}),
      [](const Vector3d& p) { return 0.52 - p.x(); },
      [](const Vector3d& p) { return 0.72 + p.z(); }};
  const Vector3d camera(-0.70, 0.08, 0.50);
  Sensor sensor;
  sensor.focal_length = 0.95;
  sensor.max_range = 4.0;
  sensor.noise = 0.0015;
  sensor.noise_power = 2.0;
  sensor.step = 0.0025;
  sensor.flying = 0.3;
  sensor.missing = 0.01;
  return scanSurfaces(seenFrom(camera, axesToward(camera, {0.06, 0.02, 0.06}), room), sensor,
                      options, truth);
}

/// z up, the ground near z = 0.
Scan scanYard(const ScanOptions& options, TruthMesh* truth) {
  const Vector3d z = Vector3d::UnitZ();
  const auto person = [](double x, double y) {
    return body({{cone({x, y, 0.25}, 0.13, {x, y, 1.25}, 0.22)}, {ball({x, y, 1.65}, 0.13), 0.1}});
  };
  const auto wheel = [&](double x, double y) {
    return arc({x, y, 0.32}, z, Vector3d::UnitX(), 0.2, 0.12, 2.0 * kPi);
  };
  const Surfaces yard = {
      [](const Vector3d& p) {
        return 0.95 * (p.z() + 0.1 * std::sin(0.7 * p.x()) * std::cos(0.5 * p.y()));
      },
      body({{box({9.0, 4.0, 2.0}, {3.0, 4.0, 2.0}, 0.02)},
            {box({6.0, 1.8, 1.9}, {0.12, 0.6, 0.7}, 0.01), 0.0, carved},
            {box({6.0, 6.2, 1.9}, {0.12, 0.6, 0.7}, 0.01), 0.0, carved},
            {box({6.0, 4.0, 1.0}, {0.12, 0.5, 1.05}, 0.01), 0.0, carved}}),
      [chimney = box({8.0, 2.0, 5.6}, {0.3, 0.3, 1.0}, 0.01)](const Vector3d& p) {  // on the roof
        const double slope = 0.8 * (p.z() - 6.0) + 0.6 * std::abs(p.x() - 9.0);
        const double roof = std::max(
            {slope, -slope - 0.2, std::abs(p.y() - 4.0) - 4.3, std::abs(p.x() - 9.0) - 3.4});
        return std::min(roof, chimney(p));
      },
      box({-6.0, 0.0, 0.9}, {0.15, 12.0, 1.1}, 0.02),
      body({{cone({3.0, -4.0, -0.2}, 0.08, {3.0, -4.0, 4.0}, 0.06)},
            {ball({3.0, -4.0, 4.1}, 0.2), 0.05}}),
      person(2.2, 2.0),
      person(-2.0, 4.0),
      placed("animal", {3.2, -1.2, 0.6}, 1.5, 2.2),
      body({{box({4.6, 0.6, 0.5}, {0.3, 0.3, 0.7}, 0.02)},
            {placed("head", {4.6, 0.6, 1.55}, 0.8, 3.4)}}),
      body({{box({0.5, -8.0, 0.7}, {2.1, 0.85, 0.4}, 0.15)},
            {box({0.3, -8.0, 1.2}, {1.2, 0.75, 0.4}, 0.25), 0.1},
            {wheel(-0.9, -7.2)},
            {wheel(1.8, -7.2)},
            {wheel(-0.9, -8.8)},
            {wheel(1.8, -8.8)}}),
      [=, crown = body({{ball({-3.5, -5.0, 3.6}, 1.6)}, {ball({-3.0, -4.4, 4.6}, 1.2), 0.4}}),
       leaves = bumps({-3.4, -4.8, 3.9}, 3.5, 0.55, 0.22),
       trunk = cone({-3.5, -5.0, -0.2}, 0.22, {-3.5, -5.0, 3.0}, 0.15)](const Vector3d& p) {
        const double away = crown(p);
        return std::min(trunk(p), away > 0.5 ? away - 0.25 : 0.6 * (away - leaves(p)));
      }};
  Sensor sensor;
  sensor.is_panorama = true;
  sensor.low = -kPi / 3.0;
  sensor.high = 35.0 / 180.0 * kPi;
  sensor.max_range = 20.0;
  sensor.noise = 0.003;
  return scanSurfaces(seenFrom({0.0, 0.0, 1.6}, Matrix3d::Identity(), yard), sensor, options,
                      truth);
}

/// z up, the tips of the teeth near z = 6.
Scan scanJaw(const ScanOptions& options, TruthMesh* truth) {
  const Vector3d x = Vector3d::UnitX();
  std::vector<Part> teeth;
  for (int i = 0; i < 14; ++i) {
    const double angle = kPi * (i + 0.5) / 14.0;
    const Vector3d root(27.0 * std::cos(angle), 36.0 * std::sin(angle) - 15.0, -5.0);
    const double back = std::abs(angle / kPi - 0.5) * 2.0;  // 0: in front, 1: the last
    const Vector3d outward = Vector3d(root.x(), 0.7 * (root.y() + 15.0), 0.0).normalized();
    const Vector3d along(-outward.y(), outward.x(), 0.0);
    const double width = 2.4 + 1.2 * back;
    const double depth = 0.8 + 2.4 * back;
    // Wider above the neck, so that it hides the gum.
    std::vector<Part> tooth = {{cone(root, 2.1, root + Vector3d(0.0, 0.0, 5.0), 2.6)}};
    for (const double side : {-1.0, 1.0})
      for (const double cheek : {-1.0, 1.0})
        tooth.push_back({ball(root + Vector3d(0.0, 0.0, 8.5 - 0.8 * back) +
                                  side * 0.55 * width * along + cheek * 0.55 * depth * outward,
                              1.6 + 0.6 * back),
                         1.2});
    teeth.push_back({body(tooth), 0.0});
  }
  const Vector3d middle(0.0, -15.0, -7.0);
  std::vector<Part> gum = {{arc(middle, Vector3d::UnitY(), x, 27.0, 6.0, 0.5 * kPi)}};
  gum.push_back(
      {arc(middle + Vector3d(0.0, 9.0, 0.0), Vector3d::UnitY(), x, 26.0, 5.5, 0.4 * kPi), 5.0});
  gum.push_back({ellipsoid({0.0, -10.0, -12.0}, {24.0, 24.0, 5.0}), 6.0});
  const Vector3d place(6.0, -40.0, 80.0);
  Sensor sensor;
  sensor.focal_length = 1.35;
  sensor.max_range = 300.0;
  sensor.noise = 0.015;
  sensor.missing = 0.005;
  return scanSurfaces(
      seenFrom(place, axesToward(place, {0.0, -2.0, 0.0}), {body(gum), body(teeth)}), sensor,
      options, truth);
}

/// Of two numbers of a cell and a third one, uniform in [0, 1).
double hashed(std::int64_t a, std::int64_t b, std::uint64_t c) {
  return uniform(internal::splitmix64(static_cast<std::uint64_t>(a - 1) * 0x9E3779B97F4A7C15U +
                                      static_cast<std::uint64_t>(b) * 0xD1B54A32D192ED03U +
                                      c * 0x8CB92BA72F3D8DD7U));
}

/// What lies below a place.
struct Below {
  double ground, height;
  int thing;             ///< 0: the ground
  bool is_tree = false;  ///< of which points lie anywhere
};

Below below(double x, double y) {
  constexpr double cell = 30.0;  // [m], with one house and some trees
  const auto terrain = [](double at_x, double at_y) {
    return 3.0 * std::sin(0.05 * at_x) + 2.0 * std::cos(0.07 * at_y);
  };
  const auto column = static_cast<std::int64_t>(std::floor(x / cell));
  const auto row = static_cast<std::int64_t>(std::floor(y / cell));
  std::uint64_t draw = 0;
  const auto between = [&](double low, double high) {
    return low + (high - low) * hashed(column, row, ++draw);
  };
  const int first = static_cast<int>(1 + 8 * (4096 * row + column));
  const double ground = terrain(x, y);
  Below result = {ground, ground, 0};
  const double center_x = cell * (static_cast<double>(column) + 0.5) + between(-4.0, 4.0);
  const double center_y = cell * (static_cast<double>(row) + 0.5) + between(-4.0, 4.0);
  double along = x - center_x;
  double across = y - center_y;
  const double length = between(4.0, 7.0);
  const double width = between(3.0, 5.0);
  const double eaves = between(4.0, 7.0);
  if (between(0.0, 1.0) < 0.5)
    std::swap(along, across);
  const bool is_built = between(0.0, 1.0) < 0.85;
  if (is_built && std::abs(along) < length && std::abs(across) < width) {
    result.height = terrain(center_x, center_y) + eaves + 0.7 * (width - std::abs(across));
    result.thing = first;
  }
  for (int tree = 1; tree <= 3; ++tree) {
    const double tree_x = cell * static_cast<double>(column) + between(3.0, cell - 3.0);
    const double tree_y = cell * static_cast<double>(row) + between(3.0, cell - 3.0);
    const double radius = between(1.5, 3.0);
    const double tall = between(4.0, 9.0);
    const double part = std::hypot(x - tree_x, y - tree_y) / radius;
    if (part >= 1.0)
      continue;
    const double top = terrain(tree_x, tree_y) + tall * (0.6 + 0.4 * std::sqrt(1.0 - part * part));
    if (top > result.height)
      result = {ground, top, first + tree, true};
  }
  return result;
}

/// Lines four times as far apart as their points, in strips that overlap by a third, and disagree.
Scan scanTown(const ScanOptions& options, TruthMesh* truth) {
  constexpr double spacing = 0.3;
  constexpr double strip_width = 60.0;
  constexpr double strip_step = 40.0;
  constexpr double area = 4.0 * spacing * spacing;  // of a point in one strip
  const Vector3d corner(468000.0, 5421000.0, 300.0);
  const double factor = options.noise;
  const double size =
      std::sqrt(static_cast<double>(options.points) * area * strip_step / strip_width);
  const auto strips = static_cast<Eigen::Index>(std::max(1.0, std::round(size / strip_step)));
  // As long as wide, for large towns; small ones are one strip.
  const auto in_line = static_cast<Eigen::Index>(std::min(strip_width, 1.5 * size) / spacing);
  const auto lines = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(options.points) /
                                                   std::max<Eigen::Index>(1, strips * in_line));
  const auto heightAt = [&](double x, double y) { return below(x, y).height; };
  std::mt19937_64 random(options.seed);
  const Eigen::Index n = strips * lines * in_line;
  Scan scan = {Positions(3, n), Positions(3, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index strip = i / in_line / lines;
    const double x = strip_step * static_cast<double>(strip) +
                     spacing * (static_cast<double>(i % in_line) + 0.3 * uniform(random));
    const double y =
        4.0 * spacing * (static_cast<double>(i / in_line % lines) + 0.2 * uniform(random));
    const Below place = below(x, y);
    const bool is_through = uniform(random) < 0.3 * std::min(1.0, factor);
    const double depth = uniform(random);
    double z =
        place.height + factor * (0.02 * normal(random) + 0.08 * static_cast<double>(strip % 2));
    if (place.is_tree)
      z = is_through
              ? z + place.ground - place.height
              : z - std::min(1.0, factor) * 0.6 * depth * depth * (place.height - place.ground);
    constexpr double step = 1e-2;
    scan.points.col(i) = (100.0 * (Vector3d(x, y, z) + corner)).array().round() / 100.0;
    scan.normals.col(i) = Vector3d(heightAt(x - step, y) - heightAt(x + step, y),
                                   heightAt(x, y - step) - heightAt(x, y + step), 2.0 * step)
                              .normalized();
  }
  if (truth == nullptr)
    return scan;
  const double width =
      strip_step * static_cast<double>(strips - 1) + spacing * static_cast<double>(in_line);
  const double mesh = std::sqrt(area);
  const Grid grid = {static_cast<Eigen::Index>(width / mesh),
                     static_cast<Eigen::Index>(4.0 * spacing * static_cast<double>(lines) / mesh)};
  Positions clean(3, static_cast<Eigen::Index>(grid.size()));
  std::vector<int> labels(grid.size());
  for (Eigen::Index i = 0; i < clean.cols(); ++i) {
    // Rows from the far side on, as a camera above has them.
    const double x = mesh * static_cast<double>(i % grid.columns);
    const double y = mesh * static_cast<double>(grid.rows - 1 - i / grid.columns);
    const Below place = below(x, y);
    clean.col(i) = Vector3d(x, y, place.height) + corner;
    labels[static_cast<std::size_t>(i)] = place.thing;
  }
  *truth = truthOf(clean, labels, grid, false,
                   [](Eigen::Index) -> Vector3d { return -Vector3d::UnitZ(); });
  return scan;
}

}  // namespace

const std::vector<Scene>& allScenes() {
  static const std::vector<Scene> scenes = {
      {"desk", "a desk in a room, by a depth camera", 76800, scanDesk},
      {"yard", "a yard with a house, by a laser scanner on a tripod", 136800, scanYard},
      {"town", "houses and trees, by an airborne laser scanner", 100000, scanTown},
      {"jaw", "teeth, by structured light", 76800, scanJaw}};
  return scenes;
}

Scan scanFromViews(const ScanOptions& options) {
  constexpr double away = 3.0;
  const Surfaces shape = {findShape(options.shape).distance};
  Sensor sensor;
  sensor.focal_length = 1.8;
  sensor.max_range = 2.0 * away;
  std::vector<std::pair<Vector3d, Matrix3d>> cameras;
  for (int i = 0; i < options.views; ++i) {
    const double azimuth = 2.0 * kPi * i / options.views;
    const double elevation = (i % 2 == 0 ? 5.0 : 35.0) / 180.0 * kPi;
    const Vector3d place =
        away * Vector3d(std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    cameras.emplace_back(place, axesToward(place, Vector3d::Zero()));
  }
  // Most rays miss the shape. How many do not, coarse images show.
  constexpr std::size_t coarse = 4800;
  const auto images = [&](std::size_t rays) {
    std::vector<Scan> scans;
    ScanOptions one = options;
    one.points = rays;
    one.noise = 0.0;
    for (const auto& [place, axes] : cameras)
      scans.push_back(scanSurfaces(seenFrom(place, axes, shape), sensor, one));
    return scans;
  };
  const auto seen = [](const std::vector<Scan>& scans) {
    std::size_t count = 0;
    for (const Scan& scan : scans)
      for (const auto p : scan.points.colwise())
        count += p.allFinite() ? 1 : 0;
    return count;
  };
  const double fraction = static_cast<double>(std::max<std::size_t>(1, seen(images(coarse)))) /
                          static_cast<double>(coarse);
  const std::vector<Scan> scans =
      images(static_cast<std::size_t>(static_cast<double>(options.points) / fraction));
  const auto n = static_cast<Eigen::Index>(seen(scans));
  if (n == 0)
    throw InvalidInput("no ray hits the shape; take more points, or fewer views");
  // A ray's distance from the next one, where the shape is.
  const double spacing =
      away / sensor.focal_length * 0.75 / static_cast<double>(scans.front().rows);
  const double sigma = options.noise * spacing;
  Scan merged = {Positions(3, n), Positions(3, n)};
  std::mt19937_64 random(options.seed);
  Eigen::Index i = 0;
  for (std::size_t view = 0; view < scans.size(); ++view) {
    const auto& [place, axes] = cameras[view];
    Vector3d error;  // not in the arguments of a call, whose order is the compiler's
    for (int axis = 2; axis >= 0; --axis)
      error[axis] = 0.5 * sigma * normal(random);
    for (Eigen::Index k = 0; k < scans[view].points.cols(); ++k) {
      const Vector3d p = scans[view].points.col(k);
      if (!p.allFinite())
        continue;
      merged.points.col(i) = place + axes * (p + sigma * normal(random) * p.normalized()) + error;
      merged.normals.col(i++) = axes * scans[view].normals.col(k);
    }
  }
  return merged;
}

}  // namespace spherical_param::tools
