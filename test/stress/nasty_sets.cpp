#include "nasty_sets.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>

namespace stress {
namespace {

using Eigen::Vector3d;
using spherical_param::Positions;
using Points = std::vector<Vector3d>;

constexpr double kPi = 3.14159265358979323846;

/// Numbers that are the same with every standard library.
class Random {
public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [low, high].
  int integer(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  /// In [0, 1).
  double share() { return std::ldexp(static_cast<double>(engine_() >> 11U), -53); }
  double real(double low, double high) { return low + (high - low) * share(); }
  bool chance(double probability) { return share() < probability; }
  template <typename Container>
  auto one(const Container& of) {
    return of.begin()[integer(0, static_cast<int>(of.size()) - 1)];
  }
  Vector3d inCube() { return {real(-1, 1), real(-1, 1), real(-1, 1)}; }
  Vector3d onSphere() {
    for (;;) {
      const Vector3d p = inCube();
      if (p.norm() > 0.1 && p.norm() <= 1.0)
        return p.normalized();
    }
  }
  template <typename T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i)
      std::swap(values[i - 1],
                values[static_cast<std::size_t>(integer(0, static_cast<int>(i) - 1))]);
  }

private:
  std::mt19937_64 engine_;
};

/// Mostly few, sometimes thousands.
int size(Random& random) {
  const double kind = random.share();
  if (kind < 0.6)
    return random.integer(4, 24);
  if (kind < 0.95)
    return random.integer(20, 60);
  if (kind < 0.998)
    return random.integer(60, 500);
  return random.integer(1000, 3000);
}

/// Of what is no surface: the optimisation has much to do there.
int sizeOfSolid(Random& random) {
  return random.chance(0.98) ? random.integer(4, 40) : random.integer(40, 200);
}

Points inCube(Random& random, int count) {
  Points points(static_cast<std::size_t>(count));
  for (Vector3d& p : points)
    p = random.inCube();
  return points;
}

Points cubeSurface(Random& random) {
  const int m = random.integer(2, random.chance(0.03) ? 15 : 5);
  Points points;
  for (int x = 0; x < m; ++x)
    for (int y = 0; y < m; ++y)
      for (int z = 0; z < m; ++z)
        if (std::min({x, y, z}) == 0 || std::max({x, y, z}) == m - 1)
          points.emplace_back(x, y, z);
  return points;
}

Points grid(Random& random) {
  const int most = random.chance(0.03) ? 8 : 4;
  const int a = random.integer(2, most);
  const int b = random.integer(2, most);
  const int c = random.integer(2, most);
  Points points;
  for (int x = 0; x < a; ++x)
    for (int y = 0; y < b; ++y)
      for (int z = 0; z < c; ++z)
        points.emplace_back(x, y, z);
  return points;
}

Points latticeSubset(Random& random) {
  const int m = random.integer(2, 12);
  Points points(static_cast<std::size_t>(sizeOfSolid(random)));
  for (Vector3d& p : points)
    p << random.integer(0, m), random.integer(0, m), random.integer(0, m);
  return points;
}

Points randomSphere(Random& random) {
  Points points(static_cast<std::size_t>(size(random)));
  for (Vector3d& p : points)
    p = random.onSphere();
  return points;
}

/// Integers on one sphere, exactly.
Points exactSphere(Random& random) {
  // Sums of three squares in many ways.
  const int squared = random.one(std::array<int, 7>{18, 42, 54, 126, 162, 225, 378});
  const int most = static_cast<int>(std::sqrt(squared));
  Points points;
  for (int x = -most; x <= most; ++x)
    for (int y = -most; y <= most; ++y)
      for (int z = 0; z * z <= squared; ++z)
        if (x * x + y * y + z * z == squared) {
          points.emplace_back(x, y, z);
          if (z > 0)
            points.emplace_back(x, y, -z);
        }
  while (points.size() < 4)
    points.push_back(random.onSphere());
  return points;
}

/// Circles, one above the other, or one and two points.
Points cocircular(Random& random) {
  const int ring = random.integer(3, 50);
  const int rings = random.chance(0.5) ? 1 : random.integer(2, 5);
  Points points;
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < ring; ++k)
      points.emplace_back(std::cos(2 * kPi * k / ring), std::sin(2 * kPi * k / ring), r);
  points.emplace_back(0, 0, -1);
  if (random.chance(0.7))
    points.emplace_back(0, 0, rings);
  return points;
}

Points collinearAndSome(Random& random) {
  const Vector3d direction(random.integer(-5, 5), random.integer(-5, 5), random.integer(1, 5));
  Points points(static_cast<std::size_t>(std::min(size(random), 600)));
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = direction * (random.chance(0.5) ? static_cast<double>(i) : random.integer(0, 999));
  // None or one more is in a plane with them; two are, by chance.
  const int more = random.integer(0, 3);
  for (int i = 0; i < more; ++i)
    points.emplace_back(random.integer(-9, 9), random.integer(-9, 9), random.integer(-9, 9));
  return points;
}

Points coplanarAndSome(Random& random) {
  const int a = random.integer(-7, 7);
  const int b = random.integer(-7, 7);
  Points points(static_cast<std::size_t>(size(random)));
  for (Vector3d& p : points) {
    const double x = random.integer(-500, 500) / 512.0;
    const double y = random.integer(-500, 500) / 512.0;
    p << x, y, a * x + b * y;
  }
  const int more = random.integer(0, 2);
  for (int i = 0; i < more; ++i) {
    Vector3d p = random.one(points);
    // From one unit in the last place to far above.
    p.z() = random.chance(0.3) ? std::nextafter(p.z(), 1e9)
                               : p.z() + std::pow(10.0, random.integer(-15, 2));
    points.push_back(p);
  }
  return points;
}

/// A part of all points at one place, or nearly.
Points clusters(Random& random, int least_exponent, int most_exponent) {
  Points points = randomSphere(random);
  const std::size_t ordinary = points.size();
  const int count = random.integer(1, 4);
  for (int c = 0; c < count; ++c) {
    const double radius = std::pow(10.0, -random.integer(least_exponent, most_exponent));
    const Vector3d center =
        random.chance(0.3)
            ? Vector3d::Zero().eval()
            : points[static_cast<std::size_t>(random.integer(0, static_cast<int>(ordinary) - 1))];
    const int members = random.integer(2, random.chance(0.1) ? 60 : 15);
    for (int i = 0; i < members; ++i)
      points.emplace_back(center + radius * random.inCube());
  }
  return points;
}

/// What is between all and nothing: a difference of one point, in one coordinate, by any power.
Points nearlyFlat(Random& random) {
  Points points(static_cast<std::size_t>(random.integer(4, 40)));
  const auto tiny = [&] { return std::pow(10.0, -random.integer(5, 320)); };
  const double thickness = tiny();
  const double width = random.chance(0.5) ? 1.0 : tiny();
  for (Vector3d& p : points)
    p << random.share(), width * random.integer(-3, 3), thickness * random.integer(-2, 2);
  return points;
}

Points outlier(Random& random) {
  Points points = randomSphere(random);
  points.emplace_back(random.onSphere() * std::pow(10.0, random.integer(2, 20)));
  return points;
}

Points twoBlobs(Random& random) {
  Points points;
  const Vector3d apart = random.onSphere() * std::pow(10.0, random.integer(1, 15));
  for (int blob = 0; blob < 2; ++blob) {
    const bool is_full = random.chance(0.5);
    for (int i = random.integer(2, random.chance(0.1) ? 200 : 50); i > 0; --i)
      points.push_back(blob * apart + (is_full ? random.inCube() : random.onSphere()));
  }
  return points;
}

/// All but one in a plane, or slivers.
Points fewDegenerate(Random& random) {
  Points points(static_cast<std::size_t>(random.integer(4, 7)));
  const double thickness = std::pow(10.0, -random.integer(3, 17));
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] << random.integer(0, 2), random.integer(0, 2), i == 0 ? thickness : 0.0;
  return points;
}

/// A long thin limb on a body.
Points limb(Random& random) {
  Points points = randomSphere(random);
  const double radius = random.real(0.01, 0.2);
  const double length = radius * random.real(5, 80);
  const int count = random.integer(20, random.chance(0.1) ? 150 : 50);
  for (int i = 0; i < count; ++i) {
    const double angle = random.real(0, 2 * kPi);
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                        1.0 + length * random.share());
  }
  points.emplace_back(0, 0, 1.0 + length);
  return points;
}

Points ellipsoid(Random& random) {
  Points points = randomSphere(random);
  const Vector3d axes(1.0, std::pow(10.0, -random.real(0, 6)), std::pow(10.0, -random.real(0, 12)));
  for (Vector3d& p : points)
    p = p.cwiseProduct(axes);
  return points;
}

Points tooFew(Random& random) {
  Points distinct(static_cast<std::size_t>(random.integer(0, 3)));
  for (Vector3d& p : distinct)
    p = random.inCube();
  Points points;
  if (!distinct.empty())
    for (int i = random.integer(0, 50); i > 0; --i)
      points.push_back(random.one(distinct));
  return points;
}

struct Family {
  const char* name;
  std::function<Points(Random&)> make;
};

const std::vector<Family>& families() {
  static const std::vector<Family> all{
      {"lattice on a cube", cubeSurface},
      {"full grid", grid},
      {"subset of a lattice", latticeSubset},
      {"random on a sphere", randomSphere},
      {"exactly on a sphere", exactSphere},
      {"circles", cocircular},
      {"collinear and up to 3", collinearAndSome},
      {"coplanar and up to 2", coplanarAndSome},
      {"clusters of 1e-8 to 1e-16", [](Random& random) { return clusters(random, 8, 16); }},
      {"clusters of 1e-17 to 1e-310", [](Random& random) { return clusters(random, 17, 310); }},
      {"nearly flat", nearlyFlat},
      {"far outlier", outlier},
      {"two far blobs", twoBlobs},
      {"4 to 7 random", [](Random& random) { return inCube(random, random.integer(4, 7)); }},
      {"4 to 7 degenerate", fewDegenerate},
      {"limb", limb},
      {"ellipsoid", ellipsoid},
      {"random in a cube", [](Random& random) { return inCube(random, sizeOfSolid(random)); }},
      {"fewer than 4 distinct", tooFew},
  };
  return all;
}

/// What may be done to any set.
void treat(Random& random, Points& points) {
  if (random.chance(0.12)) {  // with another set
    const Family& other = random.one(families());
    const double factor = std::pow(10.0, random.integer(-3, 3));
    const Vector3d shift = random.chance(0.5) ? Vector3d::Zero().eval() : random.onSphere() * 3.0;
    for (const Vector3d& p : other.make(random))
      points.emplace_back(factor * p + shift);
  }
  if (random.chance(0.15)) {
    const Vector3d axis = random.onSphere();
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(random.real(0, 6), axis).toRotationMatrix();
    for (Vector3d& p : points)
      p = turn * p;
  }
  if (random.chance(0.1)) {  // as a survey's coordinates, perhaps in single precision
    const Vector3d shift(5e5 + random.share(), 1e7 + random.share(), random.real(0, 3000));
    const bool is_float = random.chance(0.4);
    for (Vector3d& p : points) {
      p += shift;
      if (is_float)
        p = p.cast<float>().cast<double>();
    }
  }
  if (random.chance(0.15)) {  // of an extreme extent
    const int power =
        random.chance(0.6) ? random.one(std::array<int, 2>{-30, 30}) : random.integer(-315, 78);
    for (Vector3d& p : points)
      for (int axis = 0; axis < 3; ++axis)  // in two steps: 1e-315 itself has few digits
        p[axis] = p[axis] * std::pow(10.0, power / 2) * std::pow(10.0, power - power / 2);
  }
  if (random.chance(0.15) && !points.empty())  // duplicates, zeros of both signs
    for (int i = random.integer(1, 100); i > 0; --i) {
      Vector3d p = random.one(points);
      for (int axis = 0; axis < 3; ++axis)
        if (p[axis] == 0.0)
          p[axis] = -p[axis];
      points.push_back(p);
    }
  if (random.chance(0.2))
    random.shuffle(points);
  if (random.chance(0.03) && !points.empty()) {
    const std::array<double, 5> bad{std::numeric_limits<double>::quiet_NaN(),
                                    std::numeric_limits<double>::infinity(),
                                    -std::numeric_limits<double>::infinity(), 1.01e100, -1e300};
    const int which = random.integer(0, static_cast<int>(points.size()) - 1);
    points[static_cast<std::size_t>(which)][random.integer(0, 2)] = random.one(bad);
  }
}

}  // namespace

NastySet makeNastySet(std::uint64_t seed) {
  Random random(seed);
  // In turns, so that each is tried as often.
  const Family& family = families()[seed % families().size()];
  NastySet set;
  set.family = family.name;
  Points points = family.make(random);
  treat(random, points);
  set.points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    set.points.col(static_cast<Eigen::Index>(i)) = points[i];
  return set;
}

}  // namespace stress
