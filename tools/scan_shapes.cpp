#include "scan_shapes.h"

#include "neighbor_search.h"
#include "spherical_param/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace spherical_param::tools {

namespace {

// Plain vectors: expression templates would make builds without optimisation a hundred times
// slower, and the order of the sums is fixed here, so that a scan does not depend on a library.
struct Vec {
  double x = 0.0, y = 0.0, z = 0.0;
};
Vec operator+(const Vec& a, const Vec& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec operator-(const Vec& a, const Vec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec operator*(double scale, const Vec& a) {
  return {scale * a.x, scale * a.y, scale * a.z};
}
/// By component.
Vec operator*(const Vec& a, const Vec& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
double dot(const Vec& a, const Vec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
double norm(const Vec& a) {
  return std::sqrt(dot(a, a));
}
Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// The vector of length 1 of the same direction; of a zero vector, zero.
Vec normalized(const Vec& a) {
  const double length = norm(a);
  return length > 0.0 ? (1.0 / length) * a : Vec{};
}
Eigen::Vector3d toEigen(const Vec& a) {
  return {a.x, a.y, a.z};
}

constexpr Vec unit_x{1.0, 0.0, 0.0};
constexpr Vec unit_y{0.0, 1.0, 0.0};
constexpr Vec unit_z{0.0, 0.0, 1.0};

/// A cell or a node of a lattice.
struct Cell {
  std::int64_t x = 0, y = 0, z = 0;
};

/// The cell of the unit lattice that holds a point.
Cell cellAt(const Vec& p) {
  const auto part = [](double value) { return static_cast<std::int64_t>(std::floor(value)); };
  return {part(p.x), part(p.y), part(p.z)};
}

/// One of the eight corners of a cell: bits 0, 1 and 2 step along x, y and z.
Cell corner(const Cell& cell, unsigned bits) {
  return {cell.x + (bits & 1u), cell.y + (bits >> 1 & 1u), cell.z + (bits >> 2 & 1u)};
}

/// Of 60 bits, 20 for each coordinate.
std::uint64_t keyOf(const Cell& cell) {
  const auto part = [](std::int64_t i) { return static_cast<std::uint64_t>(i + (1 << 19)); };
  return part(cell.x) << 40 | part(cell.y) << 20 | part(cell.z);
}

/// Pseudo-random numbers by SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom
/// number generators"). The distributions of the standard library differ between implementations.
class Random {
public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15u;
    return mix(state_);
  }
  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// Uniform in [0, bound), for a bound below 2^32, but for a bias of bound / 2^32.
  std::size_t below(std::size_t bound) {
    return static_cast<std::size_t>(((bits() >> 32) * static_cast<std::uint64_t>(bound)) >> 32);
  }

  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

private:
  std::uint64_t state_;
};

// ---------------------------------------------------------------------------------------------
// Implicit surfaces: negative inside, about the signed distance near the surface. Only sums,
// products, quotients and square roots, which are the same on every platform.

/// Value and gradient at a point.
struct Field {
  double value = 0.0;
  Vec gradient;
};
using Primitive = std::function<Field(const Vec&)>;

/// Signed distance to the tube of a given radius around the point `nearest` of a curve.
Field tubeField(const Vec& p, const Vec& nearest, double radius) {
  const Vec offset = p - nearest;
  const double distance = norm(offset);
  return {distance - radius, distance > 0.0 ? (1.0 / distance) * offset : Vec{}};
}

/// Convex hull of two spheres, neither of which contains the other. It is the union of the spheres
/// around a + s u with radius r_a - s slope. The one nearest to p touches the hull where the normal
/// has the cosine `slope` with the axis, which puts its centre `shift` times the distance of p from
/// the axis before the foot of p.
Primitive cone(const Vec& a, double radius_a, const Vec& b, double radius_b) {
  const double length = norm(b - a);
  const double slope = (radius_a - radius_b) / length;
  return
      [=, axis = normalized(b - a), shift = slope / std::sqrt(1.0 - slope * slope)](const Vec& p) {
        const Vec offset = p - a;
        const double along = dot(offset, axis);
        const double across = std::sqrt(std::max(0.0, dot(offset, offset) - along * along));
        const double s = std::clamp(along - across * shift, 0.0, length);
        return tubeField(p, a + s * axis, radius_a - s * slope);
      };
}

/// Tube around a half or a quarter of a circle, with round ends. The arc starts at
/// centre + radius * start and turns towards `turn`; these two are orthonormal.
Primitive arc(const Vec& centre, const Vec& start, const Vec& turn, double radius, double tube,
              bool half = true) {
  return [=, last = half ? -1.0 * start : turn](const Vec& p) {
    const Vec offset = p - centre;
    const double x = dot(offset, start);
    const double y = dot(offset, turn);
    const double length = std::sqrt(x * x + y * y);
    if (length > 0.0 && y >= 0.0 && (half || x >= 0.0))
      return tubeField(p, centre + (radius / length) * (x * start + y * turn), tube);
    const Field at_first = tubeField(p, centre + radius * start, tube);
    const Field at_last = tubeField(p, centre + radius * last, tube);
    return at_first.value <= at_last.value ? at_first : at_last;
  };
}

/// Ellipsoid whose first axis has the direction `forward`, in the plane y = 0. First order estimate
/// of the distance, k0 (k0 - 1) / k1 with k0 = |x / r| and k1 = |x / r^2| (Quilez, "Ellipsoid -
/// SDF", iquilezles.org/articles/ellipsoids). Exact for a sphere.
Primitive ellipsoid(const Vec& centre, const Vec& radii, const Vec& forward = unit_x) {
  const Vec first = normalized(forward);
  return [=, third = cross(first, unit_y), least = std::min({radii.x, radii.y, radii.z}),
          inverse = Vec{1.0 / radii.x, 1.0 / radii.y, 1.0 / radii.z}](const Vec& p) -> Field {
    const Vec offset = p - centre;
    const Vec x1 = Vec{dot(first, offset), offset.y, dot(third, offset)} * inverse;
    const Vec x2 = x1 * inverse;
    const double k0 = norm(x1);
    const double k1 = norm(x2);
    if (k1 == 0.0)
      return {-least, {}};
    const double value = k0 * (k0 - 1.0) / k1;
    const Vec gradient =
        ((2.0 - 1.0 / k0) / k1) * x2 - (value / (k1 * k1)) * (x2 * inverse * inverse);
    return {value, gradient.x * first + gradient.y * unit_y + gradient.z * third};
  };
}

Primitive ball(const Vec& centre, double radius) {
  return ellipsoid(centre, {radius, radius, radius});
}

/// Box with edges parallel to the coordinate axes, rounded by less than each of `half_size`.
Primitive box(const Vec& centre, const Vec& half_size, double rounding) {
  return [=, core = half_size - Vec{rounding, rounding, rounding}](const Vec& p) -> Field {
    const Vec offset = p - centre;
    const Field outer =
        tubeField(offset,
                  {std::clamp(offset.x, -core.x, core.x), std::clamp(offset.y, -core.y, core.y),
                   std::clamp(offset.z, -core.z, core.z)},
                  rounding);
    const double depth = std::min(
        {core.x - std::abs(offset.x), core.y - std::abs(offset.y), core.z - std::abs(offset.z)});
    return outer.value > -rounding ? outer : Field{-rounding - depth, {}};
  };
}

/// Torus around a parallel of the z axis.
Primitive torus(const Vec& centre, double radius, double tube) {
  return [=](const Vec& p) {
    const Vec offset = p - centre;
    const double length = std::sqrt(offset.x * offset.x + offset.y * offset.y);
    const double scale = length > 0.0 ? radius / length : 0.0;
    return tubeField(offset, {scale * offset.x, scale * offset.y, 0.0}, tube);
  };
}

/// Height of regular bumps within a ball: waves along three oblique axes, multiplied with each
/// other and with (1 - d^2 / R^2)^2. The wave is 16 t^2 (1 - t)^2, t the fractional part of x.
Primitive bumps(const Vec& centre, double radius, double period, double amplitude) {
  return [=](const Vec& p) -> Field {
    const Vec offset = p - centre;
    const double fade = 1.0 - dot(offset, offset) / (radius * radius);
    if (fade <= 0.0)
      return {};
    // Orthogonal axes, none of them close to an axis of a shape's symmetry.
    constexpr std::array<Vec, 3> axes = {Vec{2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0},
                                         Vec{-2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0},
                                         Vec{-1.0 / 3.0, -2.0 / 3.0, 2.0 / 3.0}};
    std::array<double, 3> wave{};
    std::array<double, 3> slope{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double x = dot(axes[i], offset) / period;
      const double t = x - std::floor(x);
      const double u = t * (1.0 - t);
      wave[i] = 16.0 * u * u;
      slope[i] = 32.0 * u * (1.0 - 2.0 * t);
    }
    const double height = wave[0] * wave[1] * wave[2];
    const Vec height_gradient = (1.0 / period) * (slope[0] * wave[1] * wave[2] * axes[0] +
                                                  wave[0] * slope[1] * wave[2] * axes[1] +
                                                  wave[0] * wave[1] * slope[2] * axes[2]);
    const Vec fade_gradient = (-2.0 / (radius * radius)) * offset;
    return {amplitude * height * fade * fade,
            amplitude * (fade * fade * height_gradient + 2.0 * fade * height * fade_gradient)};
  };
}

/// What lies above a height.
Primitive above(double height) {
  return [=](const Vec& p) -> Field { return {height - p.z, {0.0, 0.0, -1.0}}; };
}

/// Union with a fillet of about the size `blend`: the quadratic smooth minimum (Quilez, "Smooth
/// minimum", iquilezles.org/articles/smin). Equals the minimum where the values differ by more.
Field smoothUnion(const Field& a, const Field& b, double blend) {
  const Field& lower = a.value < b.value ? a : b;
  const Field& upper = a.value < b.value ? b : a;
  const double overlap = blend - (upper.value - lower.value);
  if (overlap <= 0.0)
    return lower;
  const double weight = 0.5 * overlap / blend;
  return {lower.value - 0.5 * weight * overlap,
          (1.0 - weight) * lower.gradient + weight * upper.gradient};
}

/// A body made of primitives, joined one after the other.
class Solid {
public:
  /// Joins a primitive, with a fillet of about the size `blend`.
  Solid& add(const Primitive& primitive, double blend = 0.0) {
    parts_.emplace_back(
        [=](const Field& field, const Vec& p) { return smoothUnion(field, primitive(p), blend); });
    return *this;
  }
  /// Takes a primitive away, with an edge rounded by about `blend`.
  Solid& carve(const Primitive& primitive, double blend) {
    const auto negated = [](const Field& a) { return Field{-a.value, -1.0 * a.gradient}; };
    parts_.emplace_back([=](const Field& field, const Vec& p) {
      return negated(smoothUnion(negated(field), primitive(p), blend));
    });
    return *this;
  }
  Solid& raise(const Primitive& height) {
    parts_.emplace_back([=](const Field& field, const Vec& p) {
      const Field by = height(p);
      return Field{field.value - by.value, field.gradient - by.gradient};
    });
    return *this;
  }
  Field operator()(const Vec& p) const {
    Field field{std::numeric_limits<double>::max(), Vec{}};
    for (const auto& join : parts_)
      field = join(field, p);
    return field;
  }

private:
  std::vector<std::function<Field(const Field&, const Vec&)>> parts_;
};

// ---------------------------------------------------------------------------------------------
// The shapes: z up, looking along +x (the hand: fingers up, palm towards -y). The lengths were
// chosen by eye; gaps are wide enough that the 25 nearest neighbours do not cross them at 5000
// points.

constexpr std::array<double, 2> both_sides = {-1.0, 1.0};

Solid makeHead() {
  Solid s;
  s.add(ellipsoid({-0.04, 0.0, 0.16}, {0.31, 0.24, 0.27}))                       // skull
      .add(ellipsoid({0.10, 0.0, -0.02}, {0.18, 0.17, 0.26}), 0.10)              // face
      .add(ellipsoid({0.18, 0.0, -0.22}, {0.08, 0.08, 0.06}), 0.08)              // chin
      .add(cone({-0.08, 0.0, -0.10}, 0.13, {-0.10, 0.0, -0.36}, 0.145), 0.08)    // neck
      .add(cone({0.265, 0.0, 0.09}, 0.022, {0.325, 0.0, -0.035}, 0.040), 0.05);  // nose
  for (const double y : both_sides)
    s.add(cone({0.250, y * 0.035, 0.115}, 0.028, {0.195, y * 0.15, 0.120}, 0.022), 0.04)  // brow
        .carve(ball({0.290, y * 0.090, 0.055}, 0.050), 0.04)
        .add(ball({0.215, y * 0.085, 0.052}, 0.042), 0.01)  // eye in its socket
        .add(cone({0.230, y * 0.11, -0.04}, 0.03, {0.19, y * 0.12, -0.08}, 0.03), 0.06)
        .add(ellipsoid({-0.03, y * 0.232, 0.04}, {0.065, 0.036, 0.085}), 0.045)  // ear
        .carve(ellipsoid({-0.015, y * 0.276, 0.05}, {0.036, 0.022, 0.055}), 0.03);
  s.add(cone({0.268, -0.045, -0.115}, 0.020, {0.268, 0.045, -0.115}, 0.020), 0.03)  // lips
      .add(cone({0.256, -0.036, -0.165}, 0.022, {0.256, 0.036, -0.165}, 0.022), 0.02)
      .raise(bumps({-0.20, 0.0, 0.27}, 0.44, 0.095, 0.034))  // hair
      .raise(bumps({0.0, 0.0, -0.05}, 0.60, 0.080, 0.005));  // skin
  return s;
}

Solid makeBird() {
  Solid s;
  s.add(ellipsoid({0.0, 0.0, -0.08}, {0.29, 0.17, 0.18}, {1.0, 0.0, 0.25}))     // body
      .add(cone({0.20, 0.0, 0.02}, 0.10, {0.29, 0.0, 0.20}, 0.08), 0.06)        // neck
      .add(ball({0.30, 0.0, 0.25}, 0.115), 0.05)                                // head
      .add(cone({0.38, 0.0, 0.25}, 0.045, {0.50, 0.0, 0.22}, 0.018), 0.02)      // beak
      .add(cone({-0.22, 0.0, -0.12}, 0.065, {-0.34, 0.0, -0.10}, 0.050), 0.06)  // tail
      .add(arc({-0.34, 0.0, 0.08}, -1.0 * unit_z, -1.0 * unit_x, 0.18, 0.050), 0.03)
      .add(cone({-0.34, 0.0, 0.26}, 0.050, {-0.20, 0.0, 0.28}, 0.045), 0.03)
      .add(ellipsoid({-0.16, 0.0, 0.29}, {0.17, 0.13, 0.040}, {1.0, 0.0, 0.15}), 0.04);
  for (const double y : both_sides)  // wing, eye, leg, foot
    s.add(ellipsoid({-0.03, y * 0.16, -0.05}, {0.22, 0.040, 0.11}, {1.0, 0.0, 0.35}), 0.02)
        .add(ball({0.375, y * 0.065, 0.29}, 0.025), 0.01)
        .add(cone({0.02, y * 0.08, -0.20}, 0.035, {0.02, y * 0.09, -0.33}, 0.022), 0.02)
        .add(ellipsoid({0.06, y * 0.09, -0.345}, {0.080, 0.040, 0.022}), 0.02);
  return s;
}

Solid makeHand() {
  Solid s;
  const auto finger = [&](const Vec& base, const Vec& knuckle, const Vec& tip, double radius) {
    s.add(cone(base, radius, knuckle, radius), 0.012)
        .add(cone(knuckle, radius, tip, 0.85 * radius), 0.012);
  };
  finger({-0.150, 0.0, 0.01}, {-0.228, -0.010, 0.20}, {-0.265, -0.045, 0.32}, 0.034);
  finger({-0.050, 0.0, 0.02}, {-0.078, -0.005, 0.25}, {-0.093, -0.035, 0.42}, 0.036);
  finger({0.050, 0.0, 0.02}, {0.078, -0.005, 0.24}, {0.093, -0.040, 0.39}, 0.035);
  finger({0.150, 0.0, 0.01}, {0.222, -0.010, 0.17}, {0.258, -0.045, 0.27}, 0.030);
  finger({-0.110, -0.01, -0.24}, {-0.265, -0.045, -0.10}, {-0.345, -0.060, 0.03}, 0.043);
  s.add(box({0.0, 0.0, -0.13}, {0.185, 0.052, 0.17}, 0.050), 0.03)           // palm
      .add(ellipsoid({-0.10, -0.03, -0.19}, {0.07, 0.05, 0.11}), 0.04)       // thumb's ball
      .add(ellipsoid({0.11, -0.03, -0.19}, {0.055, 0.045, 0.10}), 0.04)      // heel
      .add(cone({0.0, 0.0, -0.26}, 0.085, {0.0, 0.0, -0.45}, 0.080), 0.08);  // wrist
  return s;
}

Solid makeAnimal() {
  Solid s;
  s.add(cone({-0.22, 0.0, 0.02}, 0.125, {0.18, 0.0, 0.04}, 0.145))            // trunk
      .add(cone({0.22, 0.0, 0.08}, 0.095, {0.36, 0.0, 0.26}, 0.070), 0.06)    // neck
      .add(ellipsoid({0.39, 0.0, 0.30}, {0.11, 0.080, 0.085}), 0.04)          // head
      .add(cone({0.44, 0.0, 0.28}, 0.055, {0.54, 0.0, 0.25}, 0.042), 0.04)    // muzzle
      .add(cone({-0.32, 0.0, 0.07}, 0.035, {-0.48, 0.0, 0.02}, 0.028), 0.04)  // tail
      .add(cone({-0.48, 0.0, 0.02}, 0.028, {-0.54, 0.0, -0.16}, 0.020), 0.01);
  for (const double y : both_sides)  // ear, front leg, hind leg
    s.add(cone({0.36, y * 0.055, 0.36}, 0.030, {0.34, y * 0.095, 0.45}, 0.018), 0.02)
        .add(cone({0.19, y * 0.085, -0.02}, 0.070, {0.21, y * 0.095, -0.22}, 0.045), 0.04)
        .add(cone({0.21, y * 0.095, -0.22}, 0.045, {0.20, y * 0.095, -0.40}, 0.036), 0.01)
        .add(cone({0.20, y * 0.095, -0.40}, 0.040, {0.24, y * 0.095, -0.41}, 0.032), 0.01)
        .add(cone({-0.24, y * 0.080, -0.02}, 0.085, {-0.21, y * 0.095, -0.22}, 0.048), 0.04)
        .add(cone({-0.21, y * 0.095, -0.22}, 0.048, {-0.25, y * 0.095, -0.40}, 0.036), 0.01)
        .add(cone({-0.25, y * 0.095, -0.40}, 0.040, {-0.21, y * 0.095, -0.41}, 0.032), 0.01);
  return s;
}

Solid makeStar() {
  Solid s;
  // The twelve vertices of an icosahedron: cyclic permutations of (0, +-1, +-golden ratio).
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  s.add(ball({}, 0.16));
  for (const double a : {-1.0, 1.0})
    for (const double b : {-golden, golden})
      for (const Vec& vertex : {Vec{0.0, a, b}, Vec{b, 0.0, a}, Vec{a, b, 0.0}})
        s.add(cone({}, 0.14, 0.53 * normalized(vertex), 0.013), 0.03);
  return s;
}

/// A flat spiral of half circles around two centres, from whose outer end the neck rises and bends
/// back over the coils.
Solid makeSnake() {
  Solid s;
  constexpr double tube = 0.052;
  s.add(cone({0.035, 0.0, -0.14}, tube, {0.035, -0.07, -0.14}, 0.020))
      .add(arc({-0.08, 0.0, -0.14}, unit_x, unit_y, 0.115, tube))
      .add(arc({0.015, 0.0, -0.14}, -1.0 * unit_x, -1.0 * unit_y, 0.21, tube))
      .add(arc({-0.08, 0.0, -0.14}, unit_x, unit_y, 0.305, tube))
      .add(arc({0.015, 0.0, -0.14}, -1.0 * unit_x, -1.0 * unit_y, 0.40, tube))
      .add(arc({0.415, 0.0, -0.04}, -1.0 * unit_z, unit_y, 0.10, tube, false))
      .add(cone({0.415, 0.10, -0.04}, tube, {0.415, 0.10, 0.14}, tube))
      .add(arc({0.315, 0.10, 0.14}, unit_x, unit_z, 0.10, tube, false))
      .add(ellipsoid({0.255, 0.10, 0.23}, {0.12, 0.085, 0.058}), 0.03);
  return s;
}

Solid makeHoled() {
  Solid s;
  s.add(ellipsoid({-0.06, 0.0, -0.12}, {0.30, 0.22, 0.23}))               // body
      .add(cone({0.14, 0.0, 0.02}, 0.13, {0.23, 0.0, 0.14}, 0.12), 0.08)  // neck
      .add(ellipsoid({0.29, 0.0, 0.15}, {0.14, 0.11, 0.11}), 0.05)        // head
      .add(ball({-0.38, 0.0, -0.10}, 0.07), 0.04)                         // tail
      .carve(ball({0.12, 0.0, -0.40}, 0.05), 0.05);                       // between the feet
  for (const double y : both_sides)
    s.add(cone({0.22, y * 0.055, 0.23}, 0.035, {0.13, y * 0.09, 0.46}, 0.028), 0.03)
        .add(cone({0.10, y * 0.11, -0.24}, 0.06, {0.20, y * 0.12, -0.32}, 0.045), 0.04);
  return s;
}

struct Surface {
  ShapeInfo info;
  int lattice = 0;          ///< steps a unit of a lattice that does not miss a feature
  std::vector<Vec> inside;  ///< a point inside each component, whose +x ray leaves it once
  Solid solid;
  std::vector<Primitive> openings;  ///< what lies in them was not scanned
};

const std::vector<Surface>& allSurfaces() {
  const Solid balls = Solid().add(ball({-0.3, 0.0, 0.0}, 0.2)).add(ball({0.3, 0.0, 0.0}, 0.2));
  const Primitive neck = cone({-0.3, 0.0, 0.0}, 0.03, {0.3, 0.0, 0.0}, 0.03);
  const Primitive left = torus({-0.23, 0.0, 0.0}, 0.19, 0.08);
  const Primitive right = torus({0.23, 0.0, 0.0}, 0.19, 0.08);
  const Vec egg = {0.5, 0.32, 0.22};
  const std::vector<Primitive> rabbit_openings = {
      ball({-0.10, 0.0, -0.35}, 0.13), ball({-0.12, 0.0, 0.11}, 0.12),
      ball({-0.10, 0.215, -0.12}, 0.12), ball({-0.10, -0.215, -0.12}, 0.115)};
  const std::vector<Vec> middle = {Vec{}};
  const auto one = [](const Primitive& primitive) { return Solid().add(primitive); };
  static const std::vector<Surface> surfaces = {
      {{"sphere", "a sphere"}, 40, middle, one(ball({}, 0.5)), {}},
      {{"ellipsoid", "an ellipsoid with three axes"}, 40, middle, one(ellipsoid({}, egg)), {}},
      {{"head", "a head with a face, ears and bumpy hair"}, 48, middle, makeHead(), {}},
      {{"bird", "a bird, its tail folded back"}, 48, {{0.0, 0.0, -0.08}}, makeBird(), {}},
      {{"hand", "a hand with five spread fingers"}, 48, {{0.0, 0.0, -0.1}}, makeHand(), {}},
      {{"animal", "an animal on four legs"}, 48, {{0.0, 0.0, 0.03}}, makeAnimal(), {}},
      {{"dumbbell", "two balls and a thin neck"}, 40, middle, Solid(balls).add(neck, 0.04), {}},
      {{"star", "a ball with twelve sharp spikes"}, 72, middle, makeStar(), {}},
      {{"snake", "a coiled snake, its head raised"}, 48, {{0.035, 0.0, -0.14}}, makeSnake(), {}},
      {{"plate", "a flat plate"}, 40, middle, one(box({}, {0.5, 0.35, 0.045}, 0.04)), {}},
      {{"torus", "a torus (genus 1)"}, 40, {{0.36, 0.0, 0.0}}, one(torus({}, 0.36, 0.14)), {}},
      {{"bowl", "a shell without its lid (open)"}, 40, middle, one(ball({}, 0.5)), {above(0.15)}},
      {{"pair", "two spheres (two pieces)"}, 40, {{-0.3, 0.0, 0.0}, {0.3, 0.0, 0.0}}, balls, {}},
      {{"double_torus", "two tori grown together (genus 2)"},
       40,
       {{0.42, 0.0, 0.0}},
       one(right).add(left, 0.04),
       {}},
      {{"holed", "a rabbit with four openings (open)"},
       48,
       {{-0.06, 0.0, -0.12}},
       makeHoled(),
       rabbit_openings}};
  return surfaces;
}

const Surface& findSurface(const std::string& name) {
  for (const Surface& surface : allSurfaces())
    if (surface.info.name == name)
      return surface;
  throw InvalidInput("there is no shape '" + name + "'; take one of allShapes()");
}

/// Step of Newton's method along the gradient towards the surface.
Vec stepToSurface(const Field& field) {
  const double squared = dot(field.gradient, field.gradient);
  // The gradient vanishes in the middle of a body only, where no point should be.
  return squared > 1e-6 ? (-field.value / squared) * field.gradient : Vec{};
}

/// Moves a point near the surface onto it. Returns the unit normal there.
Vec projectOnSurface(const Solid& solid, Vec& p) {
  Field field = solid(p);
  for (int i = 0; i < 20 && std::abs(field.value) > 1e-13; ++i) {
    p = p + stepToSurface(field);
    field = solid(p);
  }
  return normalized(field.gradient);
}

// ---------------------------------------------------------------------------------------------
// Triangulation: marching tetrahedra (Doi and Koide 1991, "An efficient method of triangulating
// equi-valued surfaces by using tetrahedral cells") on the six tetrahedra of each cube of a
// lattice. They fill space, so the result is closed and manifold whatever the function. The cubes
// are found by following the surface from a start: the cost is that of the surface.

struct Mesh {
  std::vector<Vec> vertices;
  std::vector<std::array<Index, 3>> triangles;

  Index append(const Vec& p) {
    vertices.push_back(p);
    return static_cast<Index>(vertices.size() - 1);
  }
  const Vec& at(Index vertex) const { return vertices[static_cast<std::size_t>(vertex)]; }
};

class SurfaceMesher {
public:
  SurfaceMesher(const Surface& surface, double step) : surface_(surface), step_(step) {}

  Mesh mesh() {
    for (const Vec& inside : surface_.inside) {
      Cell cube = cellAt((1.0 / step_) * inside);
      while (valueAt(corner(cube, 1)) < 0.0)
        ++cube.x;
      followSurface(cube);
    }
    return std::move(mesh_);
  }

private:
  /// The lattice is shifted, so that no plane of symmetry of a shape lies in a plane of nodes.
  Vec positionOf(const Cell& node) const {
    return step_ * Vec{static_cast<double>(node.x) + 0.3127, static_cast<double>(node.y) + 0.4219,
                       static_cast<double>(node.z) + 0.3671};
  }

  double valueAt(const Cell& node) {
    const auto [entry, is_new] = values_.try_emplace(keyOf(node), 0.0);
    if (is_new)
      entry->second = surface_.solid(positionOf(node)).value;
    return entry->second;
  }

  void followSurface(const Cell& start) {
    std::vector<Cell> pending;
    const auto visit = [&](const Cell& cube) {
      if (visited_.insert(keyOf(cube)).second)
        pending.push_back(cube);
    };
    visit(start);
    while (!pending.empty()) {
      const Cell cube = pending.back();
      pending.pop_back();
      std::array<double, 8> values{};
      for (unsigned bits = 0; bits < 8; ++bits)
        values[bits] = valueAt(corner(cube, bits));
      // Kuhn's subdivision, which matches across the faces of neighbouring cubes: a tetrahedron
      // around the diagonal for each order of the axes. All volumes are positive.
      for (const auto& [a, b] :
           {std::pair{1u, 3u}, {2u, 6u}, {4u, 5u}, {5u, 1u}, {6u, 4u}, {3u, 2u}})
        triangulate(cube, values, {0, a, b, 7});
      for (unsigned axis = 0; axis < 3; ++axis)
        for (unsigned side = 0; side < 2; ++side) {
          unsigned inside_count = 0;
          for (unsigned bits = 0; bits < 8; ++bits)
            inside_count += (bits >> axis & 1u) == side && values[bits] < 0.0 ? 1u : 0u;
          const std::int64_t by = side == 0 ? -1 : 1;
          if (inside_count != 0 && inside_count != 4)
            visit({cube.x + (axis == 0 ? by : 0), cube.y + (axis == 1 ? by : 0),
                   cube.z + (axis == 2 ? by : 0)});
        }
    }
  }

  /// \param corners of a tetrahedron of positive volume.
  void triangulate(const Cell& cube, const std::array<double, 8>& values,
                   std::array<unsigned, 4> corners) {
    const auto is_inside = [&](unsigned bits) { return values[bits] < 0.0; };
    const auto inside_count = std::count_if(corners.begin(), corners.end(), is_inside);
    // Put the corners inside first; two swaps at a time keep the volume positive.
    bool odd = false;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 3; j > i; --j)
        if (!is_inside(corners[j - 1]) && is_inside(corners[j])) {
          std::swap(corners[j - 1], corners[j]);
          odd = !odd;
        }
    if (odd)
      inside_count == 1 ? std::swap(corners[2], corners[3]) : std::swap(corners[0], corners[1]);
    const auto vertex = [&](std::size_t i, std::size_t j) {
      return vertexOnEdge(cube, values, corners[i], corners[j]);
    };
    if (inside_count == 1)
      mesh_.triangles.push_back({vertex(0, 1), vertex(0, 2), vertex(0, 3)});
    if (inside_count == 3)
      mesh_.triangles.push_back({vertex(0, 3), vertex(1, 3), vertex(2, 3)});
    if (inside_count == 2) {
      const std::array<Index, 4> at = {vertex(0, 2), vertex(0, 3), vertex(1, 3), vertex(1, 2)};
      mesh_.triangles.push_back({at[0], at[1], at[2]});
      mesh_.triangles.push_back({at[0], at[2], at[3]});
    }
  }

  Index vertexOnEdge(const Cell& cube, const std::array<double, 8>& values, unsigned a,
                     unsigned b) {
    // Along the edges of Kuhn's tetrahedra, one corner has all bits of the other.
    const unsigned low = std::min(a, b);
    const unsigned high = std::max(a, b);
    const auto [entry, is_new] =
        vertex_of_edge_.try_emplace(keyOf(corner(cube, low)) << 3 | (high - low), Index{0});
    if (is_new) {
      // Keeping away from the nodes keeps the vertices of different edges apart.
      const double t = std::clamp(values[low] / (values[low] - values[high]), 0.15, 0.85);
      const Vec start = positionOf(corner(cube, low));
      entry->second = mesh_.append(start + t * (positionOf(corner(cube, high)) - start));
    }
    return entry->second;
  }

  const Surface& surface_;
  const double step_;
  Mesh mesh_;
  std::unordered_map<std::uint64_t, double> values_;
  std::unordered_set<std::uint64_t> visited_;
  std::unordered_map<std::uint64_t, Index> vertex_of_edge_;
};

double areaOf(const Mesh& mesh, const std::array<Index, 3>& triangle) {
  const Vec& a = mesh.at(triangle[0]);
  return 0.5 * norm(cross(mesh.at(triangle[1]) - a, mesh.at(triangle[2]) - a));
}

double areaOf(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& triangle : mesh.triangles)
    area += areaOf(mesh, triangle);
  return area;
}

/// Evens out the triangles: moves each vertex half of the way to the mean of its neighbours, along
/// the surface only, so that tips do not shrink, and by one Newton step towards the surface.
void relax(const Solid& solid, Mesh& mesh) {
  std::vector<Vec> sums(mesh.vertices.size());
  std::vector<int> counts(mesh.vertices.size(), 0);
  for (const auto& triangle : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto to = static_cast<std::size_t>(triangle[(i + 1) % 3]);
      sums[to] = sums[to] + mesh.at(triangle[i]);
      ++counts[to];
    }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Vec& p = mesh.vertices[i];
    const Field field = solid(p);
    const Vec normal = normalized(field.gradient);
    const Vec move = 0.5 * ((1.0 / counts[i]) * sums[i] - p);
    p = p + (move - dot(normal, move) * normal) + stepToSurface(field);
  }
}

/// The mesh without what lies within an opening.
Mesh cut(const Solid& solid, const Mesh& mesh, const Primitive& opening) {
  Mesh rest;
  std::vector<Index> kept;
  for (const Vec& vertex : mesh.vertices)
    kept.push_back(opening(vertex).value > 0.0 ? rest.append(vertex) : -1);
  std::unordered_map<std::uint64_t, Index> on_edge;
  const auto crossing = [&](Index inner, Index outer) {
    const auto [entry, is_new] = on_edge.try_emplace(
        static_cast<std::uint64_t>(inner) << 32 | static_cast<std::uint64_t>(outer), Index{0});
    if (is_new) {
      const double value = opening(mesh.at(inner)).value;
      const double t = value / (value - opening(mesh.at(outer)).value);
      Vec p = mesh.at(inner) + t * (mesh.at(outer) - mesh.at(inner));
      // On the surface and on the border: alternating projections.
      for (int i = 0; i < 20; ++i) {
        projectOnSurface(solid, p);
        p = p + stepToSurface(opening(p));
      }
      entry->second = rest.append(p);
    }
    return entry->second;
  };
  for (const auto& triangle : mesh.triangles) {
    std::vector<Index> polygon;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = triangle[i];
      const Index b = triangle[(i + 1) % 3];
      const Index kept_a = kept[static_cast<std::size_t>(a)];
      const Index kept_b = kept[static_cast<std::size_t>(b)];
      if (kept_a >= 0)
        polygon.push_back(kept_a);
      if ((kept_a >= 0) != (kept_b >= 0))
        polygon.push_back(kept_a >= 0 ? crossing(a, b) : crossing(b, a));
    }
    for (std::size_t i = 2; i < polygon.size(); ++i)
      rest.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
  return rest;
}

/// Mesh of a surface by a lattice of a given step, or the coarsest, relaxed by a given number of
/// sweeps.
Mesh meshSurface(const Surface& surface, double step, int sweeps) {
  Mesh mesh = SurfaceMesher(surface, std::min(step, 1.0 / surface.lattice)).mesh();
  for (Vec& vertex : mesh.vertices)
    vertex = vertex + stepToSurface(surface.solid(vertex));
  for (int sweep = 0; sweep < sweeps; ++sweep)
    relax(surface.solid, mesh);
  for (const Primitive& opening : surface.openings)
    mesh = cut(surface.solid, mesh, opening);
  return mesh;
}

// ---------------------------------------------------------------------------------------------
// Sampling

/// Points spread over a mesh by area, one from each of `count` parts of equal area, shuffled.
std::vector<Vec> drawCandidates(const Mesh& mesh, double area, std::size_t count, Random& random) {
  std::vector<Vec> candidates;
  candidates.reserve(count);
  const double spacing = area / static_cast<double>(count);
  double end = 0.0;
  std::size_t t = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double target = (static_cast<double>(i) + random.unit()) * spacing;
    while (t < mesh.triangles.size() && end <= target)
      end += areaOf(mesh, mesh.triangles[t++]);
    const auto& [a, b, c] = mesh.triangles[t - 1];
    // Uniform in a triangle: Osada et al. 2002, "Shape distributions", equation 1.
    const double u = std::sqrt(random.unit());
    const double v = random.unit();
    candidates.push_back((1.0 - u) * mesh.at(a) + u * (1.0 - v) * mesh.at(b) + u * v * mesh.at(c));
  }
  for (std::size_t i = count - 1; i > 0; --i)
    std::swap(candidates[i], candidates[random.below(i + 1)]);
  return candidates;
}

/// Chooses `count` of the candidates, far from each other: dart throwing in which the distance to
/// keep shrinks as soon as no candidate is left that keeps it (McCool and Fiume 1992, "Hierarchical
/// Poisson disk sampling distributions").
std::vector<Vec> chooseSamples(const std::vector<Vec>& candidates, double area, std::size_t count) {
  // Random packings of discs get stuck when they cover 0.547 of the plane (Feder 1980, "Random
  // sequential adsorption"): count pi r^2 / 4 = 0.547 area, r = 0.835 sqrt(area / count).
  double radius = 0.85 * std::sqrt(area / static_cast<double>(count));
  constexpr double shrinkage = 0.98;
  // Lists of samples by a hash of their cells. Within cells of two radii, the neighbours of a point
  // are in the eight cells nearest to it.
  const double inverse_cell = 1.0 / (2.0 * radius);
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::size_t slots = 64;
  while (slots < count)
    slots *= 2;
  std::vector<std::uint32_t> first(slots, none);
  std::vector<std::uint32_t> next;
  std::vector<Vec> samples;
  const auto slot_of = [&](const Cell& cell) {
    return static_cast<std::size_t>(Random::mix(keyOf(cell))) & (slots - 1);
  };
  // Lower bound of the radius at which a candidate may be tried again.
  std::vector<float> retry_at(candidates.size(), std::numeric_limits<float>::max());
  for (;; radius *= shrinkage)
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (static_cast<double>(retry_at[i]) < radius)
        continue;
      const Vec& p = candidates[i];
      const Cell low = cellAt(inverse_cell * p - Vec{0.5, 0.5, 0.5});
      double squared = radius * radius;
      bool free = true;
      for (unsigned bits = 0; bits < 8 && free; ++bits)
        for (std::uint32_t j = first[slot_of(corner(low, bits))]; j != none && free; j = next[j]) {
          const double distance = dot(p - samples[j], p - samples[j]);
          free = distance >= squared;
          squared = std::min(squared, distance);
        }
      retry_at[i] = free ? 0.0f : static_cast<float>(std::sqrt(squared));
      if (!free)
        continue;
      std::uint32_t& slot = first[slot_of(cellAt(inverse_cell * p))];
      next.push_back(slot);
      slot = static_cast<std::uint32_t>(samples.size());
      samples.push_back(p);
      if (samples.size() == count)
        return samples;
    }
}

/// Moves each point along its normal by a uniform random number in [-noise, noise] times its mean
/// distance to its 25 nearest neighbours: the perturbation of section 4.2 of the paper.
void perturb(const ScanOptions& options, Scan& scan) {
  const int neighbors = static_cast<int>(std::min<std::size_t>(25, options.points - 1));
  const NeighborLists lists = findNearestNeighbors(scan.points, neighbors);
  // Its own stream of random numbers: the samples must not depend on the noise.
  Random random(Random::mix(options.seed) + 1);
  const Positions clean = scan.points;
  std::set<std::array<float, 3>> taken;
  for (std::size_t i = 0; i < options.points; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const auto at = [&](Index j) { return Vec{clean(0, j), clean(1, j), clean(2, j)}; };
    std::vector<double> distances;
    for (std::size_t k = lists.offsets[i]; k < lists.offsets[i + 1]; ++k)
      distances.push_back(norm(at(static_cast<Index>(i)) - at(lists.indices[k])));
    // The point itself is in its list and adds nothing.
    std::sort(distances.begin(), distances.end());
    double sum = 0.0;
    for (const double distance : distances)
      sum += distance;
    std::array<float, 3> rounded{};
    do {
      const double offset = options.noise * (sum / neighbors) * (2.0 * random.unit() - 1.0);
      scan.points.col(column) = clean.col(column) + offset * scan.normals.col(column);
      Eigen::Map<Eigen::Vector3f>(rounded.data()) = scan.points.col(column).cast<float>();
    } while (!taken.insert(rounded).second);
  }
}

}  // namespace

const std::vector<ShapeInfo>& allShapes() {
  static const std::vector<ShapeInfo> shapes = [] {
    std::vector<ShapeInfo> infos;
    for (const Surface& surface : allSurfaces())
      infos.push_back(surface.info);
    return infos;
  }();
  return shapes;
}

const std::vector<ScanPreset>& allPresets() {
  static const std::vector<ScanPreset> presets = {
      {"tweety", "bird", 19818}, {"max", "head", 52809}, {"igea", "head", 134345}};
  return presets;
}

Scan generateScan(const ScanOptions& options) {
  if (options.points < 4 || options.points > 100'000'000)
    throw InvalidInput("generateScan: " + std::to_string(options.points) +
                       " points; ask for 4 to 100000000");
  if (!(options.noise >= 0.0 && options.noise <= 100.0))
    throw InvalidInput("generateScan: noise " + std::to_string(options.noise) +
                       "; give a number from 0 to 100");

  const Surface& surface = findSurface(options.shape);
  // About one node of the lattice per sample; finer than this changes nothing that can be seen.
  const double finest_step = 1.0 / 128.0;
  const double step = std::max(finest_step, 1.0 / std::sqrt(static_cast<double>(options.points)));
  const Mesh mesh = meshSurface(surface, step, 0);
  const double area = areaOf(mesh);
  Random random(options.seed);
  const std::size_t candidates = std::max<std::size_t>(2000, 8 * options.points);
  std::vector<Vec> samples =
      chooseSamples(drawCandidates(mesh, area, candidates, random), area, options.points);

  Scan scan;
  const auto n = static_cast<Eigen::Index>(options.points);
  scan.points.resize(3, n);
  scan.normals.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    Vec& sample = samples[static_cast<std::size_t>(i)];
    scan.normals.col(i) = toEigen(projectOnSurface(surface.solid, sample));
    scan.points.col(i) = toEigen(sample);
  }
  // Without noise no two points are equal as floats: the samples keep a distance of more than half
  // of the spacing, 5e-5 for the greatest number of points.
  if (options.noise > 0.0)
    perturb(options, scan);
  return scan;
}

TruthMesh referenceMesh(const std::string& shape, std::size_t triangle_count) {
  if (triangle_count == 0 || triangle_count > 20'000'000)
    throw InvalidInput("referenceMesh: " + std::to_string(triangle_count) +
                       " triangles; ask for 1 to 20000000");
  const Surface& surface = findSurface(shape);
  constexpr int sweeps = 5;
  Mesh mesh = meshSurface(surface, 1.0, sweeps);
  // The number of triangles grows with the inverse square of the step.
  const double ratio =
      static_cast<double>(mesh.triangles.size()) / static_cast<double>(triangle_count);
  if (ratio < 1.0)
    mesh = meshSurface(surface, 1.0 / surface.lattice * std::sqrt(ratio), sweeps);

  TruthMesh truth;
  truth.vertices.resize(3, static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    projectOnSurface(surface.solid, mesh.vertices[i]);
    truth.vertices.col(static_cast<Eigen::Index>(i)) = toEigen(mesh.vertices[i]);
  }
  truth.triangles.resize(3, static_cast<Eigen::Index>(mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    truth.triangles.col(static_cast<Eigen::Index>(t)) =
        Eigen::Map<const Eigen::Matrix<Index, 3, 1>>(mesh.triangles[t].data());
  return truth;
}

}  // namespace spherical_param::tools
