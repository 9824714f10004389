#include "nasty_sets.h"

#include "guarantees.h"
#include "spherical_param/errors.h"

#include <exception>

namespace stress {
namespace {

using Eigen::Vector3d;
using test::kPi;
using Points = std::vector<Vector3d>;

/// Mostly few, sometimes thousands.
int size(Random& random) {
  const double kind = random.share();
  if (kind < 0.6)
    return random.integer(4, 24);
  if (kind < 0.95)
    return random.integer(20, 60);
  return kind < 0.998 ? random.integer(60, 500) : random.integer(1000, 3000);
}

/// Of what is no surface: the optimisation has much to do there.
int sizeOfSolid(Random& random) {
  return random.chance(0.98) ? random.integer(4, 40) : random.integer(40, 200);
}

/// 10 to the power of a random integer.
double scale(Random& random, int low, int high) {
  return std::pow(10.0, random.integer(low, high));
}

template <typename Make>
Points pointsBy(int count, const Make& make) {
  Points points(static_cast<std::size_t>(count));
  for (Vector3d& p : points)
    p = make();
  return points;
}

Points inCube(Random& random, int count) {
  return pointsBy(count, [&] { return random.inCube(); });
}

Points onSphere(Random& random) {
  return pointsBy(size(random), [&] { return random.onSphere(); });
}

/// The lattice points of a box; those on its surface if it is hollow.
Points lattice(Random& random, bool is_hollow) {
  const int most = random.chance(0.03) ? 10 : 5;
  const auto side = [&] { return random.integer(2, most); };
  const Eigen::Vector3i size{side(), side(), side()};
  Points points;
  for (const Eigen::Vector3i& p : test::latticeOf(size))
    if (!is_hollow || p.minCoeff() == 0 || (size - p).minCoeff() == 1)
      points.emplace_back(p.cast<double>());
  return points;
}

Points latticeSubset(Random& random) {
  const int m = random.integer(2, 12);
  return pointsBy(sizeOfSolid(random), [&] { return random.onLattice(0, m); });
}

/// Integers on one sphere, exactly.
Points exactSphere(Random& random) {
  // Sums of three squares in many ways.
  const int squared = random.one(std::array<int, 7>{18, 42, 54, 126, 162, 225, 378});
  const int most = static_cast<int>(std::sqrt(squared));
  Points points;
  for (int x = -most; x <= most; ++x)
    for (int y = -most; y <= most; ++y)
      for (int z = -most; z <= most; ++z)
        if (x * x + y * y + z * z == squared)
          points.emplace_back(x, y, z);
  return points;
}

/// Circles, one above the other, or one and two points.
Points circles(Random& random) {
  const int ring = random.integer(3, 50);
  const int rings = random.chance(0.5) ? 1 : random.integer(2, 5);
  Points points{{0, 0, -1}};
  for (int i = 0; i < rings * ring; ++i)
    points.emplace_back(std::cos(2 * kPi * i / ring), std::sin(2 * kPi * i / ring), i / ring);
  if (random.chance(0.7))
    points.emplace_back(0, 0, rings);
  return points;
}

Points collinearAndSome(Random& random) {
  const Vector3d direction(random.integer(-5, 5), random.integer(-5, 5), random.integer(1, 5));
  int i = 0;
  Points points = pointsBy(std::min(size(random), 600), [&]() -> Vector3d {
    return direction * (random.chance(0.5) ? i++ : random.integer(0, 999));
  });
  // None or one more is in a plane with them; two are, by chance.
  for (int more = random.integer(0, 3); more > 0; --more)
    points.push_back(random.onLattice(-9, 9));
  return points;
}

Points coplanarAndSome(Random& random) {
  const int a = random.integer(-7, 7);
  const int b = random.integer(-7, 7);
  const int steps = random.chance(0.3) ? 2 : 500;
  Points points = pointsBy(size(random), [&] {
    const double x = random.integer(-steps, steps) / 512.0;
    const double y = random.integer(-steps, steps) / 512.0;
    return Vector3d(x, y, a * x + b * y);
  });
  for (int more = random.integer(0, 2); more > 0; --more) {
    Vector3d p = random.one(points);
    // From one unit in the last place to far above.
    p.z() = random.chance(0.3) ? std::nextafter(p.z(), 1e9) : p.z() + scale(random, -18, 2);
    points.push_back(p);
  }
  return points;
}

/// Many points of all at one place, or nearly.
Points clusters(Random& random, int low, int high) {
  Points points = onSphere(random);
  const Points places = points;
  for (int count = random.integer(1, 4); count > 0; --count) {
    const double radius = scale(random, low, high);
    const Vector3d center = random.chance(0.3) ? Vector3d(0, 0, 0) : random.one(places);
    for (int i = random.integer(2, random.chance(0.1) ? 60 : 15); i > 0; --i)
      points.emplace_back(center + radius * random.inCube());
  }
  return points;
}

/// A sphere or lattice points, each axis by another power of ten.
Points flat(Random& random) {
  Points points = random.chance(0.5)
                      ? onSphere(random)
                      : pointsBy(random.integer(4, 40), [&] { return random.onLattice(-3, 3); });
  const bool is_extreme = random.chance(0.5);
  Vector3d axes(1.0, 1.0, scale(random, is_extreme ? -320 : -12, -1));
  if (random.chance(0.5))
    axes.y() = scale(random, is_extreme ? -320 : -6, -1);
  for (Vector3d& p : points)
    p = p.cwiseProduct(axes);
  return points;
}

/// One of them may be a single point.
Points twoBlobs(Random& random) {
  Points points;
  const Vector3d apart = random.onSphere() * scale(random, 1, 20);
  for (int blob = 0; blob < 2; ++blob) {
    const bool is_full = random.chance(0.5);
    for (int i = random.chance(0.2) ? 1 : random.integer(2, random.chance(0.1) ? 200 : 50); i > 0;
         --i)
      points.emplace_back(blob * apart + (is_full ? random.inCube() : random.onSphere()));
  }
  return points;
}

/// A long thin limb on a body.
Points limb(Random& random) {
  Points points = onSphere(random);
  const double radius = random.real(0.01, 0.2);
  const double length = radius * random.real(5, 80);
  for (int i = random.integer(20, random.chance(0.1) ? 150 : 50); i > 0; --i) {
    const double angle = random.real(0, 2 * kPi);
    const double height = 1.0 + length * random.share();
    points.push_back(test::onCircle(angle, radius, height));
  }
  points.emplace_back(0, 0, 1.0 + length);
  return points;
}

Points tooFew(Random& random) {
  const Points distinct = inCube(random, random.integer(0, 3));
  const int count = distinct.empty() ? 0 : random.integer(0, 50);
  return pointsBy(count, [&] { return random.one(distinct); });
}

/// A curve in space: around each point the surface is a guess.
Points spaceCurve(Random& random) {
  const int kind = random.integer(0, 4);
  const int m = random.integer(1, 5);
  const int n = random.integer(2, 7);
  const double radius = random.real(0.05, 0.8);
  const auto at = [&](double t) -> Vector3d {
    const double angle = 2 * kPi * m * t;
    const double other = 2 * kPi * n * t;
    switch (kind) {
    case 0:  // through powers
      return {2 * t - 1, std::pow(2 * t - 1, n), std::pow(2 * t - 1, n + 1)};
    case 1:  // a helix, or a spiral on a cone
      return {(1 - radius * t) * std::cos(angle), (1 - radius * t) * std::sin(angle), n * t};
    case 2:  // a knot on a torus
      return test::onCircle(angle, 1 + radius * std::cos(other), radius * std::sin(other));
    case 3:  // a figure of Lissajous
      return {std::sin(angle + radius), std::sin(other), std::sin(angle + other)};
    default:  // with corners
      return {std::floor(n * t), n * t - std::floor(n * t), radius * std::floor(n * t) * t};
    }
  };
  const int count = random.chance(0.8) ? random.integer(20, 80) : random.integer(80, 250);
  const bool is_even = random.chance(0.6);
  const double noise = random.chance(0.6) ? 0.0 : scale(random, -5, -2);
  int i = 0;
  return pointsBy(count, [&]() -> Vector3d {
    const double t = is_even ? static_cast<double>(i++) / count : random.share();
    return at(t) + noise * random.inCube();
  });
}

struct Family {
  const char* name;
  std::function<Points(Random&)> make;
};

const std::vector<Family>& families() {
  static const std::vector<Family> all{
      {"lattice on a box", [](Random& random) { return lattice(random, true); }},
      {"full grid", [](Random& random) { return lattice(random, false); }},
      {"subset of a lattice", latticeSubset},
      {"random on a sphere", onSphere},
      {"exactly on a sphere", exactSphere},
      {"circles", circles},
      {"collinear and up to 3", collinearAndSome},
      {"coplanar and up to 2", coplanarAndSome},
      {"clusters of 1e-8 to 1e-16", [](Random& random) { return clusters(random, -16, -8); }},
      {"clusters of 1e-17 to 1e-310", [](Random& random) { return clusters(random, -310, -17); }},
      {"flat", flat},
      {"two far blobs", twoBlobs},
      {"limb", limb},
      {"space curve", spaceCurve},
      {"random in a cube", [](Random& random) { return inCube(random, sizeOfSolid(random)); }},
      {"fewer than 4 distinct", tooFew},
  };
  return all;
}

/// What may be done to any set.
void treat(Random& random, Points& points) {
  if (random.chance(0.12)) {  // with another set
    const Family& other = random.one(families());
    const double factor = scale(random, -3, 3);
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
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const int which = random.integer(0, static_cast<int>(points.size()) - 1);
    const int axis = random.integer(0, 2);
    points[static_cast<std::size_t>(which)][axis] =
        random.one(std::array<double, 5>{std::nan(""), infinity, -infinity, 1.01e100, -1e300});
  }
}

}  // namespace

Options someOptions(Random& random, bool is_large) {
  const auto one = [&random](int count) { return random.integer(0, count - 1); };
  Options options;
  options.topology = static_cast<TopologyMode>(one(2));
  options.threads = 1;
  if (one(2) == 0)
    return withTopology(options);
  if (options.topology == TopologyMode::Scan)
    options.surface = static_cast<SurfaceMode>(one(4));
  options.method = one(3) == 0 ? Method::Paper : Method::Default;
  options.paper.weights = static_cast<EdgeWeights>(one(3));
  options.paper.k = 3 + one(30);
  options.paper.max_iterations = is_large ? 50 : one(10) == 0 ? 0 : 300;
  options.smoothing = one(3) == 0 ? one(30) : 0;
  options.seed = static_cast<std::uint32_t>(one(1000000));
  options.details = one(4) == 0;
  options.outliers = one(5) == 0 ? static_cast<OutlierMode>(one(4)) : OutlierMode::None;
  options.parts = one(5) == 0 ? static_cast<PartsMode>(one(4)) : PartsMode::All;
  options.min_points = 4 + one(60);
  return withTopology(options);
}

NastySet makeNastySet(std::uint64_t seed) {
  Random random(seed);
  // In turns, so that each is tried as often.
  const Family& family = families()[seed % families().size()];
  NastySet set;
  set.family = family.name;
  Points points = family.make(random);
  treat(random, points);
  set.points = test::positionsOf(points);
  set.options = someOptions(random, points.size() > 600);
  return set;
}

Answer answerTo(const NastySet& set, int threads, const NeighborSearchFactory& search_of) {
  Answer answer;
  Options options = set.options;
  options.threads = threads;
  try {
    answer.result = reconstruct(set.points, options, search_of);
    answer.bytes = bytesOf(answer.result);
    answer.fault = canBeMeshed(set.points, options)
                       ? faultOfLists(set.points, options, answer.result)
                       : "points that cannot be meshed are accepted";
    for (const Surface& surface : answer.result.surfaces)
      if (answer.fault.empty())
        answer.fault = faultOf(set.points, options, surface);
  } catch (const InvalidInput& error) {
    answer.bytes = error.what();
    if (mustBeMeshed(set.points, options))
      answer.fault = "rejected: " + answer.bytes;
  } catch (const std::exception& error) {
    answer.fault = std::string("not a documented exception: ") + error.what();
  }
  return answer;
}

}  // namespace stress
