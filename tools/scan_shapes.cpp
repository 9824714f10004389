#include "scan_shapes.h"

#include "spherical_param/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <variant>

namespace spherical_param::tools {

namespace {

// ---------------------------------------------------------------------------------------------
// Plain vectors. Shapes are evaluated millions of times: expression templates would make builds
// without optimisation a hundred times slower. And the order of the sums is fixed here, so that a
// scan does not depend on the version of a library.

struct Vec {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  static Vec filled(double value) { return {value, value, value}; }
  double dot(const Vec& b) const { return x * b.x + y * b.y + z * b.z; }
  double squaredNorm() const { return x * x + y * y + z * z; }
  double norm() const { return std::sqrt(x * x + y * y + z * z); }
  Vec times(const Vec& b) const { return {x * b.x, y * b.y, z * b.z}; }  // by component
};

Vec operator+(const Vec& a, const Vec& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec operator-(const Vec& a, const Vec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec operator-(const Vec& a) {
  return {-a.x, -a.y, -a.z};
}
Vec operator*(double scale, const Vec& a) {
  return {scale * a.x, scale * a.y, scale * a.z};
}
Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// The vector of length 1 of the same direction; of a zero vector, zero.
Vec normalized(const Vec& a) {
  const double length = a.norm();
  return length > 0.0 ? (1.0 / length) * a : Vec{};
}

constexpr Vec unit_x{1.0, 0.0, 0.0};
constexpr Vec unit_y{0.0, 1.0, 0.0};
constexpr Vec unit_z{0.0, 0.0, 1.0};

Eigen::Vector3d toEigen(const Vec& a) {
  return {a.x, a.y, a.z};
}

/// A cell or a node of a lattice.
struct Cell {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t z = 0;
};

bool operator==(const Cell& a, const Cell& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// The cell of the unit lattice that holds a point.
Cell cellAt(const Vec& p) {
  const auto part = [](double value) { return static_cast<std::int64_t>(std::floor(value)); };
  return {part(p.x), part(p.y), part(p.z)};
}

/// One of the eight corners of a cell: bits 0, 1 and 2 step along x, y and z.
Cell corner(const Cell& cell, unsigned bits) {
  return {cell.x + (bits & 1u), cell.y + (bits >> 1 & 1u), cell.z + (bits >> 2 & 1u)};
}

// ---------------------------------------------------------------------------------------------
// Random numbers. The distributions of the standard library differ between its implementations.

/// Pseudo-random numbers by SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom
/// number generators").
class Random {
public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15u;
    return mix(state_);
  }
  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// Uniform in [0, bound), for a bound below 2^32: Lemire 2019, "Fast random integer generation in
  /// an interval", without its rejection step, whose bias of bound / 2^32 does not matter here.
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

/// An implicit function at a point.
struct Field {
  double value = 0.0;
  Vec gradient;
};

/// Signed distance to the tube of a given radius around the point `nearest` of a curve.
Field tubeField(const Vec& p, const Vec& nearest, double radius) {
  const Vec offset = p - nearest;
  const double distance = offset.norm();
  if (distance == 0.0)
    return {-radius, Vec{}};
  return {distance - radius, (1.0 / distance) * offset};
}

/// Convex hull of two spheres, neither of which contains the other.
class RoundCone {
public:
  RoundCone(const Vec& a, double radius_a, const Vec& b, double radius_b)
      : a_(a), axis_(normalized(b - a)), length_((b - a).norm()), radius_(radius_a),
        slope_((radius_a - radius_b) / length_), shift_(slope_ / std::sqrt(1.0 - slope_ * slope_)) {
  }

  /// Exact distance. The hull is the union of the spheres around the points a + s u of the axis,
  /// with radius r_a - s slope. The one nearest to p touches the hull where the normal has the
  /// cosine `slope` with the axis, which puts its centre `shift` times the distance of p from the
  /// axis before the foot of p.
  Field operator()(const Vec& p) const {
    const Vec offset = p - a_;
    const double along = offset.dot(axis_);
    const double across = std::sqrt(std::max(0.0, offset.squaredNorm() - along * along));
    const double s = std::clamp(along - across * shift_, 0.0, length_);
    return tubeField(p, a_ + s * axis_, radius_ - s * slope_);
  }

private:
  Vec a_, axis_;
  double length_, radius_, slope_, shift_;
};

/// Tube around a half or a quarter of a circle, with round ends.
class ArcTube {
public:
  enum class Span { Quarter, Half };

  /// The arc starts at centre + radius * start and turns towards `turn`; these two are orthonormal.
  ArcTube(const Vec& centre, const Vec& start, const Vec& turn, double radius, double tube_radius,
          Span span)
      : centre_(centre), start_(start), turn_(turn), last_(span == Span::Half ? -start : turn),
        radius_(radius), tube_radius_(tube_radius), span_(span) {}

  Field operator()(const Vec& p) const {
    const Vec offset = p - centre_;
    const double x = offset.dot(start_);
    const double y = offset.dot(turn_);
    const double length = std::sqrt(x * x + y * y);
    const bool beside_arc = length > 0.0 && y >= 0.0 && (span_ == Span::Half || x >= 0.0);
    if (beside_arc)
      return tubeField(p, centre_ + (radius_ / length) * (x * start_ + y * turn_), tube_radius_);
    const Vec first_end = centre_ + radius_ * start_;
    const Vec last_end = centre_ + radius_ * last_;
    const bool first_nearer = (p - first_end).squaredNorm() <= (p - last_end).squaredNorm();
    return tubeField(p, first_nearer ? first_end : last_end, tube_radius_);
  }

private:
  Vec centre_, start_, turn_, last_;
  double radius_, tube_radius_;
  Span span_;
};

/// Ellipsoid with axes parallel to the coordinate axes, or turned about the y axis.
class Ellipsoid {
public:
  /// \param forward direction of the first axis, in the plane y = 0; any length.
  Ellipsoid(const Vec& centre, const Vec& radii, const Vec& forward = unit_x)
      : centre_(centre), inverse_{1.0 / radii.x, 1.0 / radii.y, 1.0 / radii.z},
        least_(std::min({radii.x, radii.y, radii.z})), first_(normalized(forward)),
        third_(cross(first_, unit_y)) {}

  /// First order estimate of the distance, k0 (k0 - 1) / k1 with k0 = |x / r| and k1 = |x / r^2|
  /// (Quilez, "Ellipsoid - SDF", iquilezles.org/articles/ellipsoids). Exact for a sphere.
  Field operator()(const Vec& p) const {
    const Vec offset = p - centre_;
    const Vec x1 = Vec{first_.dot(offset), offset.y, third_.dot(offset)}.times(inverse_);
    const Vec x2 = x1.times(inverse_);
    const double k0 = x1.norm();
    const double k1 = x2.norm();
    if (k1 == 0.0)
      return {-least_, {}};
    const Vec x4 = x2.times(inverse_).times(inverse_);
    const double value = k0 * (k0 - 1.0) / k1;
    const Vec gradient = ((2.0 - 1.0 / k0) / k1) * x2 - (value / (k1 * k1)) * x4;
    return {value, gradient.x * first_ + gradient.y * unit_y + gradient.z * third_};
  }

private:
  Vec centre_, inverse_;
  double least_;
  Vec first_, third_;
};

Ellipsoid sphere(const Vec& centre, double radius) {
  return Ellipsoid(centre, Vec::filled(radius));
}

/// Box with rounded edges, around a centre, with edges parallel to the coordinate axes.
class RoundedBox {
public:
  /// \param half_size half the lengths of the edges, each greater than `rounding`.
  RoundedBox(const Vec& centre, const Vec& half_size, double rounding)
      : centre_(centre), core_(half_size - Vec::filled(rounding)), rounding_(rounding) {}

  Field operator()(const Vec& p) const {
    const Vec offset = p - centre_;
    const Vec nearest = {std::clamp(offset.x, -core_.x, core_.x),
                         std::clamp(offset.y, -core_.y, core_.y),
                         std::clamp(offset.z, -core_.z, core_.z)};
    const Field outer = tubeField(offset, nearest, rounding_);
    if (outer.value > -rounding_)
      return outer;
    // Within the inner box: the distance to its nearest side.
    const Vec depth = {core_.x - std::abs(offset.x), core_.y - std::abs(offset.y),
                       core_.z - std::abs(offset.z)};
    const double least = std::min({depth.x, depth.y, depth.z});
    const Vec axis = least == depth.x ? unit_x : least == depth.y ? unit_y : unit_z;
    return {-rounding_ - least, offset.dot(axis) < 0.0 ? -axis : axis};
  }

private:
  Vec centre_, core_;
  double rounding_;
};

/// Torus around a parallel of the z axis.
class Torus {
public:
  Torus(const Vec& centre, double radius, double tube_radius)
      : centre_(centre), radius_(radius), tube_radius_(tube_radius) {}

  Field operator()(const Vec& p) const {
    const Vec offset = p - centre_;
    const double length = std::sqrt(offset.x * offset.x + offset.y * offset.y);
    const double scale = length > 0.0 ? radius_ / length : 0.0;
    return tubeField(offset, {scale * offset.x, scale * offset.y, 0.0}, tube_radius_);
  }

private:
  Vec centre_;
  double radius_, tube_radius_;
};

using Primitive = std::variant<RoundCone, ArcTube, Ellipsoid, RoundedBox, Torus>;

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

Field negated(const Field& field) {
  return {-field.value, -field.gradient};
}

/// Regular bumps within a ball, fading out towards its border.
struct Bumps {
  Vec centre;              ///< of the ball
  double radius = 0.0;     ///< of the ball
  double period = 0.0;     ///< distance between bumps
  double amplitude = 0.0;  ///< height of the bumps
};

/// w = 16 t^2 (1 - t)^2 with t the fractional part of x: a smooth wave of period 1 in [0, 1], in
/// place of a sine, and its derivative.
std::pair<double, double> wave(double x) {
  const double t = x - std::floor(x);
  const double u = t * (1.0 - t);
  return {16.0 * u * u, 32.0 * u * (1.0 - 2.0 * t)};
}

/// Height of the bumps: a product of waves along three oblique axes, times (1 - d^2 / R^2)^2.
Field bumpField(const Bumps& bumps, const Vec& p) {
  const Vec offset = p - bumps.centre;
  const double fade = 1.0 - offset.squaredNorm() / (bumps.radius * bumps.radius);
  if (fade <= 0.0)
    return {};
  // Orthogonal axes, none of them close to an axis of a shape's symmetry.
  constexpr std::array<Vec, 3> axes = {Vec{2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0},
                                       Vec{-2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0},
                                       Vec{-1.0 / 3.0, -2.0 / 3.0, 2.0 / 3.0}};
  std::array<double, 3> value{};
  std::array<double, 3> slope{};
  for (std::size_t i = 0; i < 3; ++i)
    std::tie(value[i], slope[i]) = wave(axes[i].dot(offset) / bumps.period);
  const double height = value[0] * value[1] * value[2];
  const Vec height_gradient = (1.0 / bumps.period) * (slope[0] * value[1] * value[2] * axes[0] +
                                                      value[0] * slope[1] * value[2] * axes[1] +
                                                      value[0] * value[1] * slope[2] * axes[2]);
  const Vec fade_gradient = (-2.0 / (bumps.radius * bumps.radius)) * offset;
  return {bumps.amplitude * height * fade * fade,
          bumps.amplitude * (fade * fade * height_gradient + 2.0 * fade * height * fade_gradient)};
}

/// A body made of primitives, one after the other, and of bumps on top.
class Solid {
public:
  /// Joins a primitive, with a fillet of about the size `blend` (0 = none).
  Solid& add(const Primitive& primitive, double blend) {
    parts_.push_back({primitive, blend, false});
    return *this;
  }
  /// Takes a primitive away, with an edge rounded by about `blend`.
  Solid& carve(const Primitive& primitive, double blend) {
    parts_.push_back({primitive, blend, true});
    return *this;
  }
  Solid& add(const Bumps& bumps) {
    bumps_.push_back(bumps);
    return *this;
  }

  Field operator()(const Vec& p) const {
    Field field{std::numeric_limits<double>::max(), Vec{}};
    for (const Part& part : parts_) {
      const Field other = std::visit([&](const auto& shape) { return shape(p); }, part.primitive);
      field = part.carved ? negated(smoothUnion(negated(field), other, part.blend))
                          : smoothUnion(field, other, part.blend);
    }
    for (const Bumps& bumps : bumps_) {
      const Field height = bumpField(bumps, p);
      field = {field.value - height.value, field.gradient - height.gradient};
    }
    return field;
  }

private:
  struct Part {
    Primitive primitive;
    double blend;
    bool carved;
  };
  std::vector<Part> parts_;
  std::vector<Bumps> bumps_;
};

/// All there is to know about a shape.
struct Surface {
  Solid solid;
  std::vector<Vec> inside;          ///< a point inside each component, whose +x ray leaves it once
  double coarsest_step = 0.0;       ///< largest step of a lattice that does not miss a feature
  std::optional<double> rim;        ///< an open surface ends at this z
  std::vector<Primitive> openings;  ///< what lies in them was not scanned
};

// ---------------------------------------------------------------------------------------------
// The shapes: z up, looking along +x (the hand: fingers up, palm towards -y). The lengths were
// chosen by eye; gaps are wide enough that the 25 nearest neighbours do not cross them at 5000
// points.

Surface makeHead() {
  Solid solid;
  solid
      .add(Ellipsoid({-0.04, 0.0, 0.16}, {0.31, 0.24, 0.27}), 0.0)                    // skull
      .add(Ellipsoid({0.10, 0.0, -0.02}, {0.18, 0.17, 0.26}), 0.10)                   // face
      .add(Ellipsoid({0.18, 0.0, -0.22}, {0.08, 0.08, 0.06}), 0.08)                   // chin
      .add(RoundCone({-0.08, 0.0, -0.10}, 0.13, {-0.10, 0.0, -0.36}, 0.145), 0.08)    // neck
      .add(RoundCone({0.265, 0.0, 0.09}, 0.022, {0.325, 0.0, -0.035}, 0.040), 0.05);  // nose
  for (const double side : {-1.0, 1.0}) {
    solid
        .add(RoundCone({0.250, side * 0.035, 0.115}, 0.028, {0.195, side * 0.15, 0.120}, 0.022),
             0.04)                                                 // brow
        .carve(sphere({0.290, side * 0.090, 0.055}, 0.050), 0.04)  // eye socket
        .add(sphere({0.215, side * 0.085, 0.052}, 0.042), 0.01)    // eye
        .add(RoundCone({0.230, side * 0.11, -0.04}, 0.03, {0.19, side * 0.12, -0.08}, 0.03), 0.06)
        .add(Ellipsoid({-0.03, side * 0.232, 0.04}, {0.065, 0.036, 0.085}), 0.045)  // ear
        .carve(Ellipsoid({-0.015, side * 0.276, 0.05}, {0.036, 0.022, 0.055}), 0.03);
  }
  solid
      .add(RoundCone({0.268, -0.045, -0.115}, 0.020, {0.268, 0.045, -0.115}, 0.020), 0.03)  // lips
      .add(RoundCone({0.256, -0.036, -0.165}, 0.022, {0.256, 0.036, -0.165}, 0.022), 0.02)
      .add(Bumps{{-0.20, 0.0, 0.27}, 0.44, 0.095, 0.034})  // hair
      .add(Bumps{{0.0, 0.0, -0.05}, 0.60, 0.080, 0.005});  // skin
  return {std::move(solid), {{0.0, 0.0, 0.0}}, 1.0 / 48.0, std::nullopt, {}};
}

Surface makeBird() {
  Solid solid;
  solid
      .add(Ellipsoid({0.0, 0.0, -0.08}, {0.29, 0.17, 0.18}, {1.0, 0.0, 0.25}), 0.0)  // body
      .add(RoundCone({0.20, 0.0, 0.02}, 0.10, {0.29, 0.0, 0.20}, 0.08), 0.06)        // neck
      .add(sphere({0.30, 0.0, 0.25}, 0.115), 0.05)                                   // head
      .add(RoundCone({0.38, 0.0, 0.25}, 0.045, {0.50, 0.0, 0.22}, 0.018), 0.02)      // beak
      .add(RoundCone({-0.22, 0.0, -0.12}, 0.065, {-0.34, 0.0, -0.10}, 0.050), 0.06)  // tail
      .add(ArcTube({-0.34, 0.0, 0.08}, -unit_z, -unit_x, 0.18, 0.050, ArcTube::Span::Half), 0.03)
      .add(RoundCone({-0.34, 0.0, 0.26}, 0.050, {-0.20, 0.0, 0.28}, 0.045), 0.03)
      .add(Ellipsoid({-0.16, 0.0, 0.29}, {0.17, 0.13, 0.040}, {1.0, 0.0, 0.15}), 0.04);
  for (const double side : {-1.0, 1.0}) {
    solid
        .add(Ellipsoid({-0.03, side * 0.16, -0.05}, {0.22, 0.040, 0.11}, {1.0, 0.0, 0.35}),
             0.02)                                              // wing
        .add(sphere({0.375, side * 0.065, 0.29}, 0.025), 0.01)  // eye
        .add(RoundCone({0.02, side * 0.08, -0.20}, 0.035, {0.02, side * 0.09, -0.33}, 0.022),
             0.02)                                                                  // leg
        .add(Ellipsoid({0.06, side * 0.09, -0.345}, {0.080, 0.040, 0.022}), 0.02);  // foot
  }
  return {std::move(solid), {{0.0, 0.0, -0.08}}, 1.0 / 48.0, std::nullopt, {}};
}

Surface makeHand() {
  struct Finger {
    Vec base, knuckle, tip;
    double radius;
  };
  const std::array<Finger, 5> fingers = {{
      {{-0.150, 0.0, 0.01}, {-0.228, -0.010, 0.20}, {-0.265, -0.045, 0.32}, 0.034},
      {{-0.050, 0.0, 0.02}, {-0.078, -0.005, 0.25}, {-0.093, -0.035, 0.42}, 0.036},
      {{0.050, 0.0, 0.02}, {0.078, -0.005, 0.24}, {0.093, -0.040, 0.39}, 0.035},
      {{0.150, 0.0, 0.01}, {0.222, -0.010, 0.17}, {0.258, -0.045, 0.27}, 0.030},
      {{-0.110, -0.01, -0.24}, {-0.265, -0.045, -0.10}, {-0.345, -0.060, 0.03}, 0.043},
  }};
  Solid solid;
  for (const Finger& finger : fingers)
    solid.add(RoundCone(finger.base, finger.radius, finger.knuckle, finger.radius), 0.012)
        .add(RoundCone(finger.knuckle, finger.radius, finger.tip, 0.85 * finger.radius), 0.012);
  solid
      .add(RoundedBox({0.0, 0.0, -0.13}, {0.185, 0.052, 0.17}, 0.050), 0.03)      // palm
      .add(Ellipsoid({-0.10, -0.03, -0.19}, {0.07, 0.05, 0.11}), 0.04)            // thumb's ball
      .add(Ellipsoid({0.11, -0.03, -0.19}, {0.055, 0.045, 0.10}), 0.04)           // heel
      .add(RoundCone({0.0, 0.0, -0.26}, 0.085, {0.0, 0.0, -0.45}, 0.080), 0.08);  // wrist
  return {std::move(solid), {{0.0, 0.0, -0.1}}, 1.0 / 48.0, std::nullopt, {}};
}

Surface makeAnimal() {
  Solid solid;
  solid
      .add(RoundCone({-0.22, 0.0, 0.02}, 0.125, {0.18, 0.0, 0.04}, 0.145), 0.0)    // trunk
      .add(RoundCone({0.22, 0.0, 0.08}, 0.095, {0.36, 0.0, 0.26}, 0.070), 0.06)    // neck
      .add(Ellipsoid({0.39, 0.0, 0.30}, {0.11, 0.080, 0.085}), 0.04)               // head
      .add(RoundCone({0.44, 0.0, 0.28}, 0.055, {0.54, 0.0, 0.25}, 0.042), 0.04)    // muzzle
      .add(RoundCone({-0.32, 0.0, 0.07}, 0.035, {-0.48, 0.0, 0.02}, 0.028), 0.04)  // tail
      .add(RoundCone({-0.48, 0.0, 0.02}, 0.028, {-0.54, 0.0, -0.16}, 0.020), 0.01);
  for (const double side : {-1.0, 1.0}) {
    solid.add(RoundCone({0.36, side * 0.055, 0.36}, 0.030, {0.34, side * 0.095, 0.45}, 0.018), 0.02)
        .add(RoundCone({0.19, side * 0.085, -0.02}, 0.070, {0.21, side * 0.095, -0.22}, 0.045),
             0.04)
        .add(RoundCone({0.21, side * 0.095, -0.22}, 0.045, {0.20, side * 0.095, -0.40}, 0.036),
             0.01)
        .add(RoundCone({0.20, side * 0.095, -0.40}, 0.040, {0.24, side * 0.095, -0.41}, 0.032),
             0.01)
        .add(RoundCone({-0.24, side * 0.080, -0.02}, 0.085, {-0.21, side * 0.095, -0.22}, 0.048),
             0.04)
        .add(RoundCone({-0.21, side * 0.095, -0.22}, 0.048, {-0.25, side * 0.095, -0.40}, 0.036),
             0.01)
        .add(RoundCone({-0.25, side * 0.095, -0.40}, 0.040, {-0.21, side * 0.095, -0.41}, 0.032),
             0.01);
  }
  return {std::move(solid), {{0.0, 0.0, 0.03}}, 1.0 / 48.0, std::nullopt, {}};
}

Surface makeStar() {
  // The twelve vertices of an icosahedron: cyclic permutations of (0, +-1, +-golden ratio).
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  Solid solid;
  solid.add(sphere(Vec{}, 0.16), 0.0);
  for (const double one : {-1.0, 1.0})
    for (const double other : {-golden, golden})
      for (const Vec& vertex : {Vec{0.0, one, other}, Vec{other, 0.0, one}, Vec{one, other, 0.0}})
        solid.add(RoundCone({}, 0.14, 0.53 * normalized(vertex), 0.013), 0.03);
  return {std::move(solid), {Vec{}}, 1.0 / 72.0, std::nullopt, {}};
}

Surface makeSnake() {
  // A flat spiral of half circles, whose centres alternate between two points: each adds `growth`
  // to the radius, so that neighbouring coils are 2 growth apart.
  constexpr double tube = 0.052;
  constexpr double growth = 0.095;
  constexpr double floor = -0.14;
  constexpr double left = -0.08;
  double radius = 0.115;
  double centre = left;
  double side = 1.0;
  const Vec tail = {centre + radius, 0.0, floor};
  Solid solid;
  solid.add(RoundCone(tail, tube, tail - 0.07 * unit_y, 0.020), 0.0);
  for (int half = 0; half < 4; ++half) {
    solid.add(ArcTube({centre, 0.0, floor}, side * unit_x, side * unit_y, radius, tube,
                      ArcTube::Span::Half),
              0.0);
    centre += side * growth;
    radius += growth;
    side = -side;
  }
  // From the outer end the neck rises and bends back over the coils.
  const Vec neck = {tail.x + 4.0 * growth, 0.0, floor};
  constexpr double bend = 0.10;
  constexpr double top = 0.14;
  solid.add(ArcTube(neck + bend * unit_z, -unit_z, unit_y, bend, tube, ArcTube::Span::Quarter), 0.0)
      .add(RoundCone({neck.x, bend, floor + bend}, tube, {neck.x, bend, top}, tube), 0.0)
      .add(ArcTube({neck.x - bend, bend, top}, unit_x, unit_z, bend, tube, ArcTube::Span::Quarter),
           0.0)
      .add(Ellipsoid({neck.x - bend - 0.06, bend, top + bend - 0.01}, {0.12, 0.085, 0.058}), 0.03);
  return {std::move(solid), {tail}, 1.0 / 48.0, std::nullopt, {}};
}

/// A rabbit, with openings as a scan has them where the scanner did not come.
Surface makeHoled() {
  Solid solid;
  solid
      .add(Ellipsoid({-0.06, 0.0, -0.12}, {0.30, 0.22, 0.23}), 0.0)            // body
      .add(RoundCone({0.14, 0.0, 0.02}, 0.13, {0.23, 0.0, 0.14}, 0.12), 0.08)  // neck
      .add(Ellipsoid({0.29, 0.0, 0.15}, {0.14, 0.11, 0.11}), 0.05)             // head
      .add(sphere({-0.38, 0.0, -0.10}, 0.07), 0.04)                            // tail
      .carve(sphere({0.12, 0.0, -0.40}, 0.05), 0.05);                          // between the feet
  for (const double side : {-1.0, 1.0})
    solid.add(RoundCone({0.22, side * 0.055, 0.23}, 0.035, {0.13, side * 0.09, 0.46}, 0.028), 0.03)
        .add(RoundCone({0.10, side * 0.11, -0.24}, 0.06, {0.20, side * 0.12, -0.32}, 0.045), 0.04);
  Surface holed{std::move(solid), {{-0.06, 0.0, -0.12}}, 1.0 / 48.0, std::nullopt, {}};
  holed.openings = {sphere({-0.10, 0.0, -0.35}, 0.13), sphere({-0.12, 0.0, 0.11}, 0.12),
                    sphere({-0.10, 0.215, -0.12}, 0.12), sphere({-0.10, -0.215, -0.12}, 0.115)};
  return holed;
}

/// A room from within: floor, ceiling and walls around a cupboard, a bed, a table block and a lamp.
/// The solid is the air, so that "outside" is behind the walls.
Surface makeRoom() {
  Solid air;
  air.add(RoundedBox(Vec{}, {0.50, 0.36, 0.23}, 0.025), 0.0)
      .carve(RoundedBox({-0.44, 0.29, -0.10}, {0.10, 0.09, 0.20}, 0.02), 0.02)     // cupboard
      .carve(RoundedBox({-0.20, -0.29, -0.20}, {0.17, 0.085, 0.09}, 0.03), 0.02)   // bed
      .carve(RoundedBox({0.22, 0.06, -0.20}, {0.11, 0.08, 0.11}, 0.02), 0.02)      // table
      .carve(RoundCone({0.10, 0.0, 0.25}, 0.03, {0.10, 0.0, 0.14}, 0.055), 0.02);  // lamp
  Surface room{std::move(air), {{0.0, 0.0, 0.0}}, 1.0 / 72.0, std::nullopt, {}};
  // A doorway and a window.
  room.openings = {RoundedBox({0.28, -0.36, -0.07}, {0.11, 0.07, 0.21}, 0.02),
                   RoundedBox({0.50, 0.16, 0.03}, {0.07, 0.12, 0.11}, 0.02)};
  return room;
}

Surface makeSurface(Shape shape) {
  const auto whole = [](const Primitive& primitive, const Vec& inside) {
    Solid solid;
    solid.add(primitive, 0.0);
    return Surface{std::move(solid), {inside}, 1.0 / 40.0, std::nullopt, {}};
  };
  switch (shape) {
  case Shape::Sphere:
    return whole(sphere(Vec{}, 0.5), Vec{});
  case Shape::Ellipsoid:
    return whole(Ellipsoid(Vec{}, {0.5, 0.32, 0.22}), Vec{});
  case Shape::Head:
    return makeHead();
  case Shape::Bird:
    return makeBird();
  case Shape::Hand:
    return makeHand();
  case Shape::Animal:
    return makeAnimal();
  case Shape::Dumbbell: {
    Surface dumbbell = whole(sphere({-0.3, 0.0, 0.0}, 0.2), Vec{});
    dumbbell.solid.add(sphere({0.3, 0.0, 0.0}, 0.2), 0.0)
        .add(RoundCone({-0.3, 0.0, 0.0}, 0.03, {0.3, 0.0, 0.0}, 0.03), 0.04);
    return dumbbell;
  }
  case Shape::Star:
    return makeStar();
  case Shape::Snake:
    return makeSnake();
  case Shape::Plate:
    return whole(RoundedBox(Vec{}, {0.5, 0.35, 0.045}, 0.04), Vec{});
  case Shape::Torus:
    return whole(Torus(Vec{}, 0.36, 0.14), {0.36, 0.0, 0.0});
  case Shape::Bowl: {
    Surface bowl = whole(sphere(Vec{}, 0.5), Vec{});
    bowl.rim = 0.15;
    return bowl;
  }
  case Shape::Pair: {
    Surface pair = whole(sphere({-0.3, 0.0, 0.0}, 0.2), {-0.3, 0.0, 0.0});
    pair.solid.add(sphere({0.3, 0.0, 0.0}, 0.2), 0.0);
    pair.inside.push_back({0.3, 0.0, 0.0});
    return pair;
  }
  case Shape::DoubleTorus: {
    Surface eight = whole(Torus({0.23, 0.0, 0.0}, 0.19, 0.08), {0.42, 0.0, 0.0});
    eight.solid.add(Torus({-0.23, 0.0, 0.0}, 0.19, 0.08), 0.04);
    return eight;
  }
  case Shape::Holed:
    return makeHoled();
  case Shape::Room:
    return makeRoom();
  }
  throw InvalidInput("makeSurface: not a shape; take one of allShapes()");
}

/// Step of Newton's method along the gradient towards the surface.
Vec stepToSurface(const Field& field) {
  const double squared = field.gradient.squaredNorm();
  // The gradient vanishes in the middle of a body only, where no point should be.
  return squared > 1e-6 ? (-field.value / squared) * field.gradient : Vec{};
}

/// Moves a point near the surface onto it. Returns the unit normal there.
Vec projectOnSurface(const Surface& surface, Vec& p) {
  Field field = surface.solid(p);
  for (int i = 0; i < 20 && std::abs(field.value) > 1e-13; ++i) {
    p = p + stepToSurface(field);
    field = surface.solid(p);
  }
  return normalized(field.gradient);
}

// ---------------------------------------------------------------------------------------------
// Triangulation: marching tetrahedra (Doi and Koide 1991, "An efficient method of triangulating
// equi-valued surfaces by using tetrahedral cells") on the six tetrahedra of each cube of a
// lattice. They fill space, so the result is closed and manifold whatever the function; marching
// cubes would need a table and care with its ambiguous cases. The cubes are found by following the
// surface from a start, so that the cost is that of the surface, not of the volume.

/// A mesh under construction.
struct Mesh {
  std::vector<Vec> vertices;
  std::vector<std::array<Index, 3>> triangles;
};

class SurfaceMesher {
public:
  SurfaceMesher(const Surface& surface, double step) : surface_(surface), step_(step) {}

  Mesh mesh() {
    for (const Vec& inside : surface_.inside)
      followSurface(startCube(inside));
    return std::move(mesh_);
  }

private:
  using Key = std::uint64_t;

  // 20 bits for each coordinate leave three for the direction of an edge.
  static Key keyOf(const Cell& node) {
    const auto part = [](std::int64_t i) { return static_cast<Key>(i + (1 << 19)); };
    return part(node.x) << 40 | part(node.y) << 20 | part(node.z);
  }
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

  Cell startCube(const Vec& inside) {
    Cell cube = cellAt((1.0 / step_) * inside);
    while (valueAt(corner(cube, 1)) < 0.0)
      ++cube.x;
    return cube;
  }

  void followSurface(const Cell& start) {
    std::vector<Cell> pending;
    const auto visit = [&](const Cell& cube) {
      if (visited_.try_emplace(keyOf(cube), true).second)
        pending.push_back(cube);
    };
    visit(start);
    while (!pending.empty()) {
      const Cell cube = pending.back();
      pending.pop_back();
      std::array<double, 8> values{};
      for (unsigned bits = 0; bits < 8; ++bits)
        values[bits] = valueAt(corner(cube, bits));
      triangulateCube(cube, values);
      for (unsigned axis = 0; axis < 3; ++axis)
        for (unsigned side = 0; side < 2; ++side) {
          unsigned inside_count = 0;
          for (unsigned bits = 0; bits < 8; ++bits)
            inside_count += (bits >> axis & 1u) == side && values[bits] < 0.0 ? 1u : 0u;
          if (inside_count == 0 || inside_count == 4)
            continue;
          const std::int64_t by = side == 0 ? -1 : 1;
          visit({cube.x + (axis == 0 ? by : 0), cube.y + (axis == 1 ? by : 0),
                 cube.z + (axis == 2 ? by : 0)});
        }
    }
  }

  /// The six tetrahedra around the diagonal from corner 0 to corner 7, one for each order of the
  /// axes (Kuhn's subdivision, which matches across the faces of neighbouring cubes).
  void triangulateCube(const Cell& cube, const std::array<double, 8>& values) {
    constexpr std::array<std::array<unsigned, 2>, 6> orders = {
        {{1, 2}, {2, 4}, {4, 1}, {1, 4}, {4, 2}, {2, 1}}};
    for (std::size_t i = 0; i < orders.size(); ++i) {
      const unsigned first = orders[i][0];
      const unsigned second = first | orders[i][1];
      // The first three orders are even permutations of the axes: positive volume.
      if (i < 3)
        triangulateTetrahedron(cube, values, {0, first, second, 7});
      else
        triangulateTetrahedron(cube, values, {0, second, first, 7});
    }
  }

  /// \param corners of a tetrahedron of positive volume.
  void triangulateTetrahedron(const Cell& cube, const std::array<double, 8>& values,
                              std::array<unsigned, 4> corners) {
    const auto is_inside = [&](unsigned bits) { return values[bits] < 0.0; };
    const auto inside_count = std::count_if(corners.begin(), corners.end(), is_inside);
    if (inside_count == 0 || inside_count == 4)
      return;
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
    auto& triangles = mesh_.triangles;
    if (inside_count == 1) {
      triangles.push_back({vertex(0, 1), vertex(0, 2), vertex(0, 3)});
    } else if (inside_count == 3) {
      triangles.push_back({vertex(0, 3), vertex(1, 3), vertex(2, 3)});
    } else {
      const Index a = vertex(0, 2);
      const Index b = vertex(0, 3);
      const Index c = vertex(1, 3);
      const Index d = vertex(1, 2);
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }

  Index vertexOnEdge(const Cell& cube, const std::array<double, 8>& values, unsigned a,
                     unsigned b) {
    // Along the edges of Kuhn's tetrahedra, one corner has all bits of the other.
    const unsigned low = std::min(a, b);
    const unsigned high = std::max(a, b);
    const Cell node = corner(cube, low);
    const Key key = keyOf(node) << 3 | (high - low);
    const auto [entry, is_new] =
        vertex_of_edge_.try_emplace(key, static_cast<Index>(mesh_.vertices.size()));
    if (is_new) {
      // Keeping away from the nodes keeps the vertices of different edges apart.
      const double t = std::clamp(values[low] / (values[low] - values[high]), 0.15, 0.85);
      const Vec start = positionOf(node);
      mesh_.vertices.push_back(start + t * (positionOf(corner(cube, high)) - start));
    }
    return entry->second;
  }

  const Surface& surface_;
  const double step_;
  Mesh mesh_;
  std::unordered_map<Key, double> values_;
  std::unordered_map<Key, bool> visited_;
  std::unordered_map<Key, Index> vertex_of_edge_;
};

double triangleArea(const Vec& a, const Vec& b, const Vec& c) {
  return 0.5 * cross(b - a, c - a).norm();
}

double triangleArea(const Mesh& mesh, const std::array<Index, 3>& triangle) {
  const auto vertex = [&](std::size_t i) {
    return mesh.vertices[static_cast<std::size_t>(triangle[i])];
  };
  return triangleArea(vertex(0), vertex(1), vertex(2));
}

double surfaceArea(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& triangle : mesh.triangles)
    area += triangleArea(mesh, triangle);
  return area;
}

/// Evens out the triangles: moves each vertex half of the way to the mean of its neighbours, along
/// the surface only, so that tips do not shrink, and by one Newton step towards the surface.
void relax(const Surface& surface, Mesh& mesh) {
  std::vector<Vec> sums(mesh.vertices.size());
  std::vector<int> counts(mesh.vertices.size(), 0);
  for (const auto& triangle : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto from = static_cast<std::size_t>(triangle[i]);
      const auto to = static_cast<std::size_t>(triangle[(i + 1) % 3]);
      sums[to] = sums[to] + mesh.vertices[from];
      ++counts[to];
    }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Vec& p = mesh.vertices[i];
    const Field field = surface.solid(p);
    const Vec normal = normalized(field.gradient);
    const Vec move = 0.5 * ((1.0 / counts[i]) * sums[i] - p);
    p = p + (move - normal.dot(move) * normal) + stepToSurface(field);
  }
}

/// What lies above a height.
struct Above {
  double height = 0.0;

  bool has(const Vec& p) const { return p.z >= height; }
  /// Where the border lies between two points, as a fraction of their distance.
  double crossing(const Vec& a, const Vec& b) const { return (height - a.z) / (b.z - a.z); }
  /// Moves a point near the border onto it.
  void put(Vec& p) const { p.z = height; }
};

/// What lies within a primitive.
struct Within {
  const Primitive& primitive;

  Field field(const Vec& p) const {
    return std::visit([&](const auto& shape) { return shape(p); }, primitive);
  }
  bool has(const Vec& p) const { return field(p).value <= 0.0; }
  double crossing(const Vec& a, const Vec& b) const {
    const double at_a = field(a).value;
    return at_a / (at_a - field(b).value);
  }
  void put(Vec& p) const { p = p + stepToSurface(field(p)); }
};

/// Takes a part of a mesh away.
template <typename Part>
Mesh cut(const Surface& surface, const Mesh& mesh, const Part& part) {
  Mesh rest;
  std::vector<Index> kept(mesh.vertices.size(), -1);
  std::unordered_map<std::uint64_t, Index> on_edge;
  const auto position = [&](Index i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
  std::vector<bool> stays;
  stays.reserve(mesh.vertices.size());
  for (const Vec& vertex : mesh.vertices)
    stays.push_back(!part.has(vertex));
  const auto append = [&](const Vec& p) {
    rest.vertices.push_back(p);
    return static_cast<Index>(rest.vertices.size() - 1);
  };
  const auto keep = [&](Index i) {
    Index& index = kept[static_cast<std::size_t>(i)];
    if (index < 0)
      index = append(position(i));
    return index;
  };
  const auto crossing = [&](Index inner, Index outer) {
    const auto [entry, is_new] = on_edge.try_emplace(
        static_cast<std::uint64_t>(inner) << 32 | static_cast<std::uint64_t>(outer), Index{0});
    if (is_new) {
      const Vec a = position(inner);
      const Vec b = position(outer);
      Vec p = a + part.crossing(a, b) * (b - a);
      // On the surface and on the border: alternating projections.
      for (int i = 0; i < 20; ++i) {
        projectOnSurface(surface, p);
        part.put(p);
      }
      entry->second = append(p);
    }
    return entry->second;
  };
  for (const auto& triangle : mesh.triangles) {
    std::vector<Index> polygon;
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = triangle[i];
      const Index b = triangle[(i + 1) % 3];
      const bool a_stays = stays[static_cast<std::size_t>(a)];
      const bool b_stays = stays[static_cast<std::size_t>(b)];
      if (a_stays)
        polygon.push_back(keep(a));
      if (a_stays != b_stays)
        polygon.push_back(a_stays ? crossing(a, b) : crossing(b, a));
    }
    for (std::size_t i = 2; i < polygon.size(); ++i)
      rest.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
  return rest;
}

/// A mesh without what was not scanned.
Mesh withOpenings(const Surface& surface, Mesh mesh) {
  if (surface.rim)
    mesh = cut(surface, mesh, Above{*surface.rim});
  for (const Primitive& opening : surface.openings)
    mesh = cut(surface, mesh, Within{opening});
  return mesh;
}

/// Mesh of a surface by a lattice of a given step, relaxed by a given number of sweeps.
Mesh meshSurface(const Surface& surface, double step, int sweeps) {
  Mesh mesh = SurfaceMesher(surface, std::min(step, surface.coarsest_step)).mesh();
  for (Vec& vertex : mesh.vertices)
    vertex = vertex + stepToSurface(surface.solid(vertex));
  for (int sweep = 0; sweep < sweeps; ++sweep)
    relax(surface, mesh);
  return withOpenings(surface, std::move(mesh));
}

// ---------------------------------------------------------------------------------------------
// Sampling

/// Points in the cells of a hashed grid. Cells that share a slot of the table are distinguished by
/// the positions of their points.
class PointGrid {
public:
  PointGrid(double cell_size, std::size_t capacity) : inverse_(1.0 / cell_size) {
    std::size_t slots = 64;
    while (slots < capacity)
      slots *= 2;
    first_.assign(slots, none);
    points_.reserve(capacity);
    next_.reserve(capacity);
  }

  const std::vector<Vec>& points() const { return points_; }

  /// Cell of a point, in units of cells; not rounded.
  Vec cellPosition(const Vec& p) const { return inverse_ * p; }

  void insert(const Vec& p) {
    std::uint32_t& slot = first_[slotOf(cellAt(cellPosition(p)))];
    next_.push_back(slot);
    slot = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
  }

  /// Calls visit(index, point) for each point of a cell until it returns false.
  /// \return false if visit did.
  template <typename Visit>
  bool visitCell(const Cell& cell, Visit&& visit) const {
    for (std::uint32_t i = first_[slotOf(cell)]; i != none; i = next_[i])
      if (cellAt(cellPosition(points_[i])) == cell && !visit(i, points_[i]))
        return false;
    return true;
  }

private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::size_t slotOf(const Cell& cell) const {
    const auto part = [](std::int64_t i) { return static_cast<std::uint64_t>(i + (1 << 20)); };
    const std::uint64_t hash = Random::mix(part(cell.x) << 42 | part(cell.y) << 21 | part(cell.z));
    return static_cast<std::size_t>(hash) & (first_.size() - 1);
  }

  double inverse_;
  std::vector<std::uint32_t> first_, next_;
  std::vector<Vec> points_;
};

/// Points spread over a mesh by area, one from each of `count` parts of equal area, shuffled.
std::vector<Vec> drawCandidates(const Mesh& mesh, std::size_t count, Random& random) {
  std::vector<Vec> candidates;
  candidates.reserve(count);
  const double spacing = surfaceArea(mesh) / static_cast<double>(count);
  double end = 0.0;
  std::size_t t = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double target = (static_cast<double>(i) + random.unit()) * spacing;
    while (t < mesh.triangles.size() && end <= target)
      end += triangleArea(mesh, mesh.triangles[t++]);
    const auto& triangle = mesh.triangles[t - 1];
    // Uniform in a triangle: Osada et al. 2002, "Shape distributions", equation 1.
    const double u = std::sqrt(random.unit());
    const double v = random.unit();
    const auto vertex = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(triangle[k])];
    };
    candidates.push_back((1.0 - u) * vertex(0) + u * (1.0 - v) * vertex(1) + u * v * vertex(2));
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
  // Within cells of two radii, the neighbours of a point are in the eight cells nearest to it.
  PointGrid grid(2.0 * radius, count);
  // Lower bound of the radius at which a candidate may be tried again.
  std::vector<float> retry_at(candidates.size(), std::numeric_limits<float>::max());
  while (true) {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (static_cast<double>(retry_at[i]) < radius)
        continue;
      const Vec& p = candidates[i];
      const Vec cell_position = grid.cellPosition(p);
      const Cell low = cellAt(cell_position - Vec::filled(0.5));
      double squared = radius * radius;
      const auto is_far = [&](std::size_t, const Vec& q) {
        const double distance = (p - q).squaredNorm();
        if (distance >= squared)
          return true;
        squared = distance;
        return false;
      };
      bool free = true;
      for (unsigned bits = 0; bits < 8 && free; ++bits)
        free = grid.visitCell(corner(low, bits), is_far);
      retry_at[i] = free ? 0.0f : static_cast<float>(std::sqrt(squared));
      if (free) {
        grid.insert(p);
        if (grid.points().size() == count)
          return grid.points();
      }
    }
    radius *= shrinkage;
  }
}

/// Mean distance of each point to its k nearest neighbours, which lie within about `reach`.
std::vector<double> meanNeighborDistances(const std::vector<Vec>& points, std::size_t k,
                                          double reach) {
  PointGrid grid(reach, points.size());
  for (const Vec& p : points)
    grid.insert(p);
  std::vector<double> means;
  means.reserve(points.size());
  std::vector<double> squared;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec& p = points[i];
    const Cell cell = cellAt(grid.cellPosition(p));
    const auto kth = [&] { return squared.begin() + static_cast<std::ptrdiff_t>(k) - 1; };
    for (std::int64_t rings = 1;; ++rings) {
      squared.clear();
      for (std::int64_t x = -rings; x <= rings; ++x)
        for (std::int64_t y = -rings; y <= rings; ++y)
          for (std::int64_t z = -rings; z <= rings; ++z)
            grid.visitCell({cell.x + x, cell.y + y, cell.z + z}, [&](std::size_t j, const Vec& q) {
              if (j != i)
                squared.push_back((p - q).squaredNorm());
              return true;
            });
      if (squared.size() < k)
        continue;
      std::nth_element(squared.begin(), kth(), squared.end());
      // Points outside of the cells looked at are further away than this.
      const double seen = reach * static_cast<double>(rings);
      if (*kth() <= seen * seen || squared.size() + 1 == points.size())
        break;
    }
    // In ascending order the sum does not depend on how the library partitions.
    std::sort(squared.begin(), kth() + 1);
    double sum = 0.0;
    for (auto distance = squared.begin(); distance <= kth(); ++distance)
      sum += std::sqrt(*distance);
    means.push_back(sum / static_cast<double>(k));
  }
  return means;
}

/// Indices of the points that are equal, as floats, to a point of lower index.
std::vector<std::size_t> findRepeated(const Positions& points) {
  const Eigen::Matrix3Xf rounded = points.cast<float>();
  const auto column = [&](std::size_t i) { return rounded.col(static_cast<Eigen::Index>(i)); };
  std::vector<std::size_t> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    for (Eigen::Index row = 0; row < 3; ++row)
      if (column(i)[row] != column(j)[row])
        return column(i)[row] < column(j)[row];
    return i < j;
  });
  std::vector<std::size_t> repeated;
  for (std::size_t i = 1; i < order.size(); ++i)
    if (column(order[i - 1]) == column(order[i]))
      repeated.push_back(order[i]);
  return repeated;
}

/// Moves each point along its normal by a uniform random number in [-noise, noise] times its mean
/// distance to its 25 nearest neighbours: the perturbation of section 4.2 of the paper.
void perturb(const std::vector<Vec>& samples, double spacing, const ScanOptions& options,
             Scan& scan) {
  constexpr std::size_t neighbors = 25;
  const std::vector<double> distances =
      meanNeighborDistances(samples, std::min(neighbors, samples.size() - 1), 3.0 * spacing);
  // Its own stream of random numbers: the samples must not depend on the noise.
  Random random(Random::mix(options.seed) + 1);
  const auto move = [&](std::size_t i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double offset = options.noise * distances[i] * (2.0 * random.unit() - 1.0);
    scan.points.col(column) = toEigen(samples[i]) + offset * scan.normals.col(column);
  };
  for (std::size_t i = 0; i < samples.size(); ++i)
    move(i);
  for (auto repeated = findRepeated(scan.points); !repeated.empty();
       repeated = findRepeated(scan.points))
    for (const std::size_t i : repeated)
      move(i);
}

}  // namespace

const std::vector<ShapeInfo>& allShapes() {
  static const std::vector<ShapeInfo> shapes = {
      {Shape::Sphere, "sphere", "a sphere", true},
      {Shape::Ellipsoid, "ellipsoid", "an ellipsoid with three different axes", true},
      {Shape::Head, "head", "a head with a face, ears and bumpy hair", true},
      {Shape::Bird, "bird", "a bird whose tail is folded back over its body", true},
      {Shape::Hand, "hand", "a hand with five spread fingers", true},
      {Shape::Animal, "animal", "an animal on four legs", true},
      {Shape::Dumbbell, "dumbbell", "two balls joined by a thin neck", true},
      {Shape::Star, "star", "a ball with twelve sharp spikes", true},
      {Shape::Snake, "snake", "a coiled snake with its head raised", true},
      {Shape::Plate, "plate", "a flat plate with rounded edges", true},
      {Shape::Torus, "torus", "a torus (genus 1)", false},
      {Shape::Bowl, "bowl", "an open shell", false},
      {Shape::Pair, "pair", "two spheres apart (two pieces)", false},
      {Shape::DoubleTorus, "double_torus", "two tori grown together (genus 2)", false},
      {Shape::Holed, "holed", "a rabbit with four openings (open)", false},
      {Shape::Room, "room", "a room from within, with a door and a window (open)", false},
  };
  return shapes;
}

const std::vector<ScanPreset>& allPresets() {
  static const std::vector<ScanPreset> presets = {
      {"tweety", Shape::Bird, 19818, "a bird in place of the paper's Tweety"},
      {"max", Shape::Head, 52809, "a head in place of the paper's Max"},
      {"igea", Shape::Head, 134345, "a head in place of the paper's Igea"},
  };
  return presets;
}

std::optional<ShapeInfo> findShape(std::string_view name) {
  for (const ShapeInfo& info : allShapes())
    if (info.name == name)
      return info;
  return std::nullopt;
}

std::optional<ScanPreset> findPreset(std::string_view name) {
  for (const ScanPreset& preset : allPresets())
    if (preset.name == name)
      return preset;
  return std::nullopt;
}

Scan generateScan(const ScanOptions& options) {
  constexpr std::size_t least_points = 4;
  constexpr std::size_t most_points = 100'000'000;
  if (options.points < least_points || options.points > most_points)
    throw InvalidInput("generateScan: " + std::to_string(options.points) +
                       " points; ask for 4 to 100000000");
  constexpr double most_noise = 100.0;
  if (!(options.noise >= 0.0 && options.noise <= most_noise))
    throw InvalidInput("generateScan: noise " + std::to_string(options.noise) +
                       "; give a number from 0 to 100");

  const Surface surface = makeSurface(options.shape);
  // About one node of the lattice per sample; finer than this changes nothing that can be seen.
  const double finest_step = 1.0 / 128.0;
  const double step = std::max(finest_step, 1.0 / std::sqrt(static_cast<double>(options.points)));
  const Mesh mesh = meshSurface(surface, step, 0);
  const double area = surfaceArea(mesh);

  Random random(options.seed);
  constexpr std::size_t candidates_per_sample = 8;
  constexpr std::size_t least_candidates = 2000;
  const std::size_t candidate_count =
      std::max(least_candidates, candidates_per_sample * options.points);
  std::vector<Vec> samples =
      chooseSamples(drawCandidates(mesh, candidate_count, random), area, options.points);

  Scan scan;
  const auto n = static_cast<Eigen::Index>(options.points);
  scan.points.resize(3, n);
  scan.normals.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    Vec& sample = samples[static_cast<std::size_t>(i)];
    scan.normals.col(i) = toEigen(projectOnSurface(surface, sample));
    scan.points.col(i) = toEigen(sample);
  }
  // Without noise no two points are equal as floats: the samples keep a distance of more than half
  // of the spacing, 5e-5 for the greatest number of points.
  if (options.noise > 0.0)
    perturb(samples, std::sqrt(area / static_cast<double>(options.points)), options, scan);
  return scan;
}

TruthMesh referenceMesh(Shape shape, std::size_t triangle_count) {
  constexpr std::size_t most_triangles = 20'000'000;
  if (triangle_count == 0 || triangle_count > most_triangles)
    throw InvalidInput("referenceMesh: " + std::to_string(triangle_count) +
                       " triangles; ask for 1 to 20000000");
  const Surface surface = makeSurface(shape);
  constexpr int sweeps = 5;
  Mesh mesh = meshSurface(surface, surface.coarsest_step, sweeps);
  // The number of triangles grows with the inverse square of the step.
  const double ratio =
      static_cast<double>(mesh.triangles.size()) / static_cast<double>(triangle_count);
  if (ratio < 1.0)
    mesh = meshSurface(surface, surface.coarsest_step * std::sqrt(ratio), sweeps);

  for (Vec& vertex : mesh.vertices)
    projectOnSurface(surface, vertex);
  TruthMesh truth;
  truth.vertices.resize(3, static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    truth.vertices.col(static_cast<Eigen::Index>(i)) = toEigen(mesh.vertices[i]);
  truth.triangles.resize(3, static_cast<Eigen::Index>(mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      truth.triangles(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(t)) =
          mesh.triangles[t][i];
  return truth;
}

}  // namespace spherical_param::tools
