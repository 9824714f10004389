#include "spherical_param/mesh_optimization.h"

#include "embedding_starts.h"
#include "helpers.h"
#include "mesh_optimizer.h"
#include "sampling_analysis.h"
#include "spherical_param/embedding.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/neighbor_graph.h"
#include "spherical_param/self_intersection.h"
#include "spherical_param/smoothing.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using internal::analyzeSampling;
using internal::MeshOptimizer;
using internal::Sampling;
using internal::SphereMesh;
using internal::SurfaceEnergy;
using test::bruteForceNeighbors;
using test::bruteForceSearch;
using test::graphOfMesh;
using test::isSphereOverAll;
using test::randomSphere;
using test::spiralSphere;
using test::withNoise;
using Bend = SurfaceEnergy::Bend;

/// A mesh, and the graph that its cloud has.
struct Case {
  Positions points;
  Triangles triangles;
  Graph graph;
};

/// Flips at random, whatever the shape.
Triangles scrambled(const Triangles& triangles, Index vertex_count, int flips, std::uint64_t seed) {
  SphereMesh mesh(triangles, static_cast<std::size_t>(vertex_count));
  std::mt19937_64 random(seed);
  for (int i = 0; i < flips; ++i)
    mesh.flip(static_cast<Index>(random() % static_cast<std::uint64_t>(mesh.size())),
              static_cast<int>(random() % 3));
  return mesh.triangles();
}

Graph localGraph(const Positions& points) {
  return buildNeighborGraph(points, bruteForceNeighbors(points, 12), {}, bruteForceSearch(points))
      .graph;
}

/// Seen from the centroid: right for a star-shaped cloud, folded for others.
Case radialStart(const Positions& points) {
  return {points, triangulateSphere(internal::projectFromCentroid(points)).triangles,
          localGraph(points)};
}

/// An affine image of an even sphere, with its convex hull, which is the best mesh there is.
Case ellipsoid(Index n, double a, double b, double c) {
  const Positions sphere = spiralSphere(n);
  const Triangles hull = triangulateSphere(sphere).triangles;
  const Positions points = Eigen::Vector3d(a, b, c).asDiagonal() * sphere;
  return {points, hull, graphOfMesh(points, hull)};
}

Case scrambledEllipsoid(Index n, double c, int flips, std::uint64_t seed) {
  Case result = ellipsoid(n, 1.0, 0.8, c);
  result.triangles = scrambled(result.triangles, n, flips, seed);
  return result;
}

/// A cloud of a noisy sphere with the triangles of the sphere.
Case noisySphere(Index n, double noise, std::uint64_t seed) {
  const Positions sphere = spiralSphere(n);
  const Triangles hull = triangulateSphere(sphere).triangles;
  // Mean distance of the points of a hexagonal pattern of the sphere's area.
  const double spacing = std::sqrt(8.0 * test::kPi / (std::sqrt(3.0) * n));
  const Positions points = withNoise(sphere, noise * spacing, seed);
  return {points, hull, graphOfMesh(points, hull)};
}

MeshOptimization optimize(const Case& of, const OptimizationOptions& options = {},
                          std::uint32_t seed = 1, const Execution& execution = {}) {
  return optimizeMesh(of.points, of.triangles, of.graph, options, seed, execution);
}

OptimizationOptions withMethod(OptimizationMethod method) {
  OptimizationOptions options;
  options.method = method;
  return options;
}

std::size_t intersectionsOf(const Positions& points, const Triangles& triangles) {
  return findSelfIntersections(points, triangles).size();
}

double areaOf(const Positions& points, const Triangles& triangles) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = points.col(triangles(0, t));
    const Eigen::Vector3d b = points.col(triangles(1, t));
    const Eigen::Vector3d c = points.col(triangles(2, t));
    sum += (b - a).cross(c - a).norm() / 2.0;
  }
  return sum;
}

/// The energy from its definition.
double energyOf(const Positions& points, const Triangles& triangles, Bend bend, double mu,
                const std::vector<double>& usual = {}) {
  std::map<std::pair<Index, Index>, Eigen::Vector3d> normal_left_of;
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = points.col(triangles(0, t));
    const Eigen::Vector3d b = points.col(triangles(1, t));
    const Eigen::Vector3d c = points.col(triangles(2, t));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const std::array<double, 3> sides{(b - a).norm(), (c - b).norm(), (a - c).norm()};
    const double bound = 4.0 * *std::max_element(sides.begin(), sides.end());
    sum += mu * std::min(bound, sides[0] * sides[1] * sides[2] / (2.0 * normal.norm()));
    for (int k = 0; k < 3; ++k)
      normal_left_of[{triangles(k, t), triangles((k + 1) % 3, t)}] = normal.normalized();
  }
  for (const auto& [edge, left] : normal_left_of) {
    const auto [v, w] = edge;
    if (v > w)
      continue;
    const Eigen::Vector3d& right = normal_left_of.at({w, v});
    const double angle = std::atan2(left.cross(right).norm(), left.dot(right));
    const double length = (points.col(v) - points.col(w)).norm();
    if (bend == Bend::Angle)
      sum += length * angle;
    else if (bend == Bend::Power)
      sum += length * std::pow(angle, 1.5);
    else
      sum += length * std::max(0.0, angle - (usual[static_cast<std::size_t>(v)] +
                                             usual[static_cast<std::size_t>(w)]) /
                                                2.0);
  }
  return sum;
}

std::set<std::pair<Index, Index>> edgesOf(const Triangles& triangles) {
  std::set<std::pair<Index, Index>> edges;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      edges.insert(std::minmax({triangles(k, t), triangles((k + 1) % 3, t)}));
  return edges;
}

/// What holds of every result.
void expectGuarantees(const Case& of, const MeshOptimization& result) {
  EXPECT_TRUE(isSphereOverAll(result.triangles, static_cast<Index>(of.points.cols())));
  EXPECT_TRUE(std::isfinite(result.report.energy));
  EXPECT_GE(result.report.rough, 0.0);
  EXPECT_LE(result.report.rough, 1.0);
  if (result.report.noise_steps == 0) {
    EXPECT_EQ(result.self_intersections, findSelfIntersections(of.points, result.triangles));
  }
  for (const OptimizationPhase& phase : result.report.phases) {
    EXPECT_GE(phase.seconds, 0.0);
    EXPECT_TRUE(std::isfinite(phase.energy_before) && std::isfinite(phase.energy)) << phase.name;
    // Untangling may pay for intersections, and what is rolled back was there for its energy.
    if (phase.name != "untangle" && phase.name != "roll back") {
      EXPECT_LE(phase.energy, phase.energy_before) << phase.name;
    }
    if (phase.name != "flips" && phase.name != "polish") {
      EXPECT_LE(phase.moves, phase.tried) << phase.name;
    }
  }
}

// --- The moves -----------------------------------------------------------------------------------

struct Terms {
  const char* name;
  Bend bend;
  double mu;
};
constexpr std::array<Terms, 3> kTerms{
    {{"angle", Bend::Angle, 0.3}, {"power", Bend::Power, 0.8}, {"excess", Bend::Excess, 4.0}}};

/// Clouds on which all moves have something to do.
std::vector<Case> roughCases() {
  std::vector<Case> cases;
  cases.push_back(scrambledEllipsoid(300, 0.3, 400, 1));
  cases.push_back(noisySphere(300, 0.5, 2));
  const test::Tube tube = test::bentTube(12.0, 2.5, 10);
  cases.push_back(radialStart(withNoise(tube.points, 0.02, 3)));
  return cases;
}

/// Ends work that reports more often.
internal::FractionReport reportUpTo(int most) {
  return [most, calls = 0](double) mutable {
    if (++calls > most)
      throw std::runtime_error("too many reports: it may go on forever");
  };
}

/// Calls check(optimizer, energy of triangles from its definition, case).
template <typename Check>
void forEachEnergy(const Check& check) {
  for (const Case& of : roughCases())
    for (const Terms& terms : kTerms) {
      SCOPED_TRACE(terms.name);
      MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
      std::vector<double> usual = optimizer.medianAngles();
      SurfaceEnergy energy;
      energy.bend = terms.bend;
      energy.mu = terms.mu;
      energy.usual_angle = usual.data();
      optimizer.setEnergy(energy);
      check(
          optimizer,
          [&] {
            return energyOf(of.points, optimizer.mesh().triangles(), terms.bend, terms.mu, usual);
          },
          of);
    }
}

/// 1e-9: thousands of moves, each of which rounds at 1e-16 of the energy; acos near folds and flat
/// edges loses half of the digits against atan2, of which the flat ones count for nothing.
void expectEnergy(const MeshOptimizer& optimizer, double defined) {
  EXPECT_NEAR(optimizer.energy(), optimizer.recomputedEnergy(), 1e-9 * defined);
  EXPECT_NEAR(optimizer.energy(), defined, 1e-7 * defined);
}

TEST(MeshOptimizer, RunningEnergyIsThatOfTheMeshAfterAllMoves) {
  int relocated = 0;
  int recreated = 0;
  forEachEnergy([&](MeshOptimizer& optimizer, const auto& defined, const Case& of) {
    const auto n = static_cast<Index>(of.points.cols());
    expectEnergy(optimizer, defined());
    const double at_first = optimizer.energy();
    EXPECT_GT(optimizer.flipAll(), 0U);
    EXPECT_LT(optimizer.energy(), at_first);
    expectEnergy(optimizer, defined());
    for (Index v = 0; v < n; ++v) {
      const double before = optimizer.energy();
      if (optimizer.relocate(v)) {
        ++relocated;
        EXPECT_LT(optimizer.energy(), before);
      } else {
        EXPECT_EQ(optimizer.energy(), before);
      }
    }
    expectEnergy(optimizer, defined());
    std::uint64_t random = 4;
    for (Index v = 0; v < n; v += 5) {
      const std::vector<Index> part = optimizer.spread({v}, 12, random);
      const double before = optimizer.energy();
      if (optimizer.recreate(part, MeshOptimizer::isGain, random)) {
        ++recreated;
        EXPECT_LT(optimizer.energy(), before);
      } else {
        EXPECT_EQ(optimizer.energy(), before);
      }
    }
    expectEnergy(optimizer, defined());
    EXPECT_TRUE(isSphereOverAll(optimizer.mesh().triangles(), n));
  });
  EXPECT_GT(relocated, 100);
  EXPECT_GT(recreated, 20);
}

TEST(MeshOptimizer, MovesCommittedAtAnyCostAreCounted) {
  forEachEnergy([](MeshOptimizer& optimizer, const auto& defined, const Case& of) {
    std::uint64_t random = 5;
    for (Index v = 0; v < of.points.cols(); v += 3) {
      const double before = optimizer.energy();
      double reported = 0.0;
      optimizer.recreate(
          optimizer.spread({v}, 8, random),
          [&](double change) {
            reported = change;
            return true;
          },
          random);
      const double mean_length =
          std::accumulate(of.graph.lengths.begin(), of.graph.lengths.end(), 0.0) /
          static_cast<double>(of.graph.lengths.size());
      EXPECT_NEAR(reported * mean_length, optimizer.energy() - before, 1e-12 * before);
    }
    expectEnergy(optimizer, defined());
    EXPECT_TRUE(
        isSphereOverAll(optimizer.mesh().triangles(), static_cast<Index>(of.points.cols())));
  });
}

TEST(MeshOptimizer, AMoveThatIsNotKeptLeavesEverythingBitByBit) {
  forEachEnergy([](MeshOptimizer& optimizer, const auto&, const Case& of) {
    const auto n = static_cast<Index>(of.points.cols());
    std::uint64_t random = 6;
    const auto expect_untouched = [&](const auto& move) {
      const Triangles triangles = optimizer.mesh().triangles();
      const double energy = optimizer.energy();
      const double recomputed = optimizer.recomputedEnergy();
      if (move())
        return false;
      EXPECT_EQ(optimizer.mesh().triangles(), triangles);
      EXPECT_EQ(optimizer.energy(), energy);
      EXPECT_EQ(optimizer.recomputedEnergy(), recomputed);
      return true;
    };
    for (std::size_t size = 1; size <= static_cast<std::size_t>(n); size *= 2)
      EXPECT_TRUE(expect_untouched([&] {
        return optimizer.recreate(
            optimizer.spread({static_cast<Index>(size) - 1}, size, random),
            [](double) { return false; }, random);
      }));
    optimizer.flipAll();
    int stayed = 0;
    for (Index v = 0; v < n; ++v)
      stayed += expect_untouched([&] { return optimizer.relocate(v); }) ? 1 : 0;
    EXPECT_GT(stayed, 0);
  });
}

TEST(MeshOptimizer, AfterFlipAllNoFlipGains) {
  // By the energy of the whole mesh, flip by flip.
  for (const Terms& terms : {kTerms[0], kTerms[1]})
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const Case of = scrambledEllipsoid(60, 0.4, 80, seed);
      MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
      SurfaceEnergy energy;
      energy.bend = terms.bend;
      energy.mu = terms.mu;
      optimizer.setEnergy(energy);
      EXPECT_GT(optimizer.flipAll(), 0U);
      const Triangles flipped = optimizer.mesh().triangles();
      const double least = energyOf(of.points, flipped, terms.bend, terms.mu);
      int tried = 0;
      for (Index t = 0; t < flipped.cols(); ++t)
        for (int k = 0; k < 3; ++k) {
          SphereMesh other(flipped, 60);
          if (!other.flip(t, k))
            continue;
          ++tried;
          EXPECT_GT(energyOf(of.points, other.triangles(), terms.bend, terms.mu),
                    least * (1.0 - 1e-7));
        }
      EXPECT_GT(tried, 200);
      EXPECT_EQ(optimizer.flipAll(), 0U);
    }
}

TEST(MeshOptimizer, NoFlipIsMadeForItsRounding) {
  // Beside lengths this small, all that is rounded off looks like a gain: of the two diagonals of a
  // rectangle, each may gain on the other. Of 600,000 turned boxes it does on these.
  const Case cube = radialStart(test::cubeGrid(2));
  for (const std::uint64_t seed :
       {67289U, 88198U, 107940U, 132340U, 164943U, 270944U, 524909U, 559612U}) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.5, 2.0);
    const auto next = [&] {
      const double x = uniform(random);
      const double y = uniform(random);
      return Eigen::Vector3d(x, y, uniform(random));
    };
    Case of = cube;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(uniform(random), next().normalized()).toRotationMatrix();
    of.points = (turn * next().asDiagonal() * cube.points).eval();
    of.triangles = scrambled(cube.triangles, 8, 10, seed);
    std::fill(of.graph.lengths.begin(), of.graph.lengths.end(), 1e-30);
    MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
    optimizer.setEnergy(SurfaceEnergy());
    EXPECT_NO_THROW(optimizer.flipAll(reportUpTo(10)));
  }
}

TEST(MeshOptimizer, EnergiesBeyondTheRangeOfDoubleAreNoGain) {
  // The difference of two of them is no number: the same flips were made for ever.
  for (const double scale : {1e100, 1e150, 1e160, 1e300})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Case of = scrambledEllipsoid(30, 0.4, 40, seed);
      std::mt19937_64 random(seed);
      for (Index v = 0; v < 30; ++v)
        if (random() % 2 == 0)
          of.points.col(v) *= scale;
      std::fill(of.graph.lengths.begin(), of.graph.lengths.end(), seed % 2 == 0 ? 1.0 : 1e200);
      MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
      optimizer.setEnergy(SurfaceEnergy());
      EXPECT_NO_THROW(optimizer.flipAll(reportUpTo(10)));
      EXPECT_TRUE(isSphereOverAll(optimizer.mesh().triangles(), 30));
    }
}

TEST(MeshOptimizer, EnergyOfACubeIsThatOfItsEdgesAndCircles) {
  const int k = 4;  // cells along an edge
  const Case of = radialStart(test::cubeGrid(k + 1));
  const MeshOptimization result = optimize(of);
  // 12 edges of length 1 are bent by a right angle; the 12 k^2 triangles have half a diagonal of
  // their cell as circumradius. 1e-6: acos near 1 is off by 1e-8, on flat edges of length 60.
  const double expected = 12.0 * test::kPi / 2.0 + 0.3 * 12.0 * k * k * std::sqrt(0.5) / k;
  EXPECT_NEAR(result.report.energy, expected, 1e-6);
  EXPECT_NEAR(energyOf(of.points, result.triangles, Bend::Angle, 0.3), expected, 1e-6);
}

TEST(MeshOptimizer, SpreadStaysTogetherAndHasTheSeedsFirst) {
  const Case of = ellipsoid(300, 1.0, 0.8, 0.6);
  MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
  std::uint64_t random = 7;
  for (const std::size_t count : {1U, 2U, 7U, 96U, 299U, 300U, 1000U}) {
    const std::vector<Index> part = optimizer.spread({17, 17, 4}, count, random);
    EXPECT_EQ(part.size(), std::min<std::size_t>(count, 300));
    EXPECT_EQ(part[0], 17);
    if (part.size() > 1) {
      EXPECT_EQ(part[1], 4);
    }
    EXPECT_EQ(std::set<Index>(part.begin(), part.end()).size(), part.size());
    std::set<Index> reached{17, 4};
    for (const Index v : part) {
      EXPECT_EQ(reached.count(v), 1U);
      for (std::size_t e = of.graph.offsets[static_cast<std::size_t>(v)];
           e < of.graph.offsets[static_cast<std::size_t>(v) + 1]; ++e)
        reached.insert(of.graph.neighbors[e]);
    }
  }
}

TEST(MeshOptimizer, IntersectionsAroundAllVerticesAreThoseOfTheMesh) {
  const Case of = roughCases()[0];
  MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
  std::vector<Index> all(static_cast<std::size_t>(of.points.cols()));
  std::iota(all.begin(), all.end(), Index{0});
  const std::size_t expected = intersectionsOf(of.points, of.triangles);
  EXPECT_GT(expected, 0U);
  EXPECT_EQ(optimizer.intersectionsAround(all), expected);
  EXPECT_EQ(optimizer.intersectionsAround({}), 0U);
}

TEST(MeshOptimizer, IntersectionsAreThoseOfAMeshOfWhichNothingIsKnown) {
  std::vector<Case> cases = roughCases();
  cases.push_back(ellipsoid(3000, 1.0, 0.7, 0.4));
  cases.push_back(scrambledEllipsoid(3000, 0.3, 2000, 3));
  cases.push_back(noisySphere(3000, 0.7, 4));
  for (const Case& of : cases)
    EXPECT_EQ(MeshOptimizer(of.points, of.triangles, of.graph, 1).intersections(),
              findSelfIntersections(of.points, of.triangles));
}

TEST(MeshOptimizer, TrianglesOfAPlainFanDoNotIntersect) {
  std::vector<Case> cases = roughCases();
  cases.push_back(scrambledEllipsoid(1000, 0.3, 700, 3));
  for (const Case& of : cases) {
    const MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
    const std::vector<std::uint8_t> fans = optimizer.plainFans();
    int plain = 0;
    for (Index v = 0; v < of.points.cols(); ++v) {
      if (fans[static_cast<std::size_t>(v)] == 0)
        continue;
      ++plain;
      std::vector<Index> around;
      optimizer.mesh().forEachAround(v, [&](Index t, int) { around.push_back(t); });
      Triangles fan(3, static_cast<Eigen::Index>(around.size()));
      for (Eigen::Index i = 0; i < fan.cols(); ++i)
        fan.col(i) = of.triangles.col(around[static_cast<std::size_t>(i)]);
      EXPECT_EQ(intersectionsOf(of.points, fan), 0U);
    }
    EXPECT_GT(plain, 0);
    EXPECT_LT(plain, of.points.cols());
  }
  // Where nothing is wrong, they are plain.
  const Case smooth = ellipsoid(1000, 1.0, 0.9, 0.8);
  const std::vector<std::uint8_t> fans =
      MeshOptimizer(smooth.points, smooth.triangles, smooth.graph, 1).plainFans();
  EXPECT_GT(std::count(fans.begin(), fans.end(), 1), 900);
}

TEST(MeshOptimizer, AFanThatGoesAroundTwiceIsNotPlain) {
  // Seven spokes, each two sevenths of a turn after the last: always to the same side.
  const Index ring = 7;
  Case of;
  of.points.resize(3, ring + 2);
  of.points.col(0) << 0.0, 0.0, 0.1;
  of.points.col(1) << 0.0, 0.0, -5.0;
  of.triangles.resize(3, 2 * ring);
  for (Index i = 0; i < ring; ++i) {
    const double angle = 2.0 * 2.0 * test::kPi * i / ring;
    of.points.col(2 + i) << std::cos(angle), std::sin(angle), 0.01 * i;
    const Index next = 2 + (i + 1) % ring;
    of.triangles.col(2 * i) << 0, 2 + i, next;
    of.triangles.col(2 * i + 1) << 1, next, 2 + i;
  }
  of.graph = graphOfMesh(of.points, of.triangles);
  const MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
  EXPECT_EQ(optimizer.plainFans()[0], 0);
  EXPECT_EQ(optimizer.intersections(), findSelfIntersections(of.points, of.triangles));
  EXPECT_GT(optimizer.intersections().size(), 0U);
}

TEST(MeshOptimizer, ASecondPassGivesTheResultOfAFirstOne) {
  constexpr double factor = 3.0;
  constexpr double least = 0.2;
  std::vector<Case> cases = roughCases();
  cases.push_back(noisySphere(3000, 0.2, 5));
  for (const Case& of : cases) {
    MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
    optimizer.setExcessEnergy(4.0, factor, least);
    optimizer.flipAll();
    std::uint64_t random = 8;
    for (int round = 0; round < 3; ++round) {
      optimizer.setEnergy(SurfaceEnergy{});
      for (Index v = round; v < of.points.cols(); v += 37) {
        optimizer.relocate(v);
        optimizer.recreate(
            optimizer.spread({v}, 5, random), [](double) { return true; }, random);
      }
      MeshOptimizer fresh(of.points, optimizer.mesh().triangles(), of.graph, 1);
      std::vector<double> usual = fresh.medianAngles();
      for (double& angle : usual)
        angle = std::max(factor * angle, least);
      SurfaceEnergy energy;
      energy.bend = Bend::Excess;
      energy.mu = 4.0;
      energy.usual_angle = usual.data();
      fresh.setEnergy(energy);

      optimizer.setExcessEnergy(4.0, factor, least);
      EXPECT_EQ(optimizer.energy(), fresh.energy());
      const std::size_t flips = optimizer.flipAll();
      EXPECT_GT(flips, 0U);
      EXPECT_EQ(flips, fresh.flipAll());
      EXPECT_EQ(optimizer.energy(), fresh.energy());
      EXPECT_EQ(optimizer.mesh().triangles(), fresh.mesh().triangles());
    }
  }
}

TEST(MeshOptimizer, VerticesAreRoughAtSharpEdgesAndFarFromTheirNeighbors) {
  Case of = ellipsoid(400, 1.0, 0.9, 0.8);
  const MeshOptimizer clean(of.points, of.triangles, of.graph, 1);
  EXPECT_TRUE(clean.roughVertices(0.8).empty());
  EXPECT_TRUE(clean.edgesBelow(0.8).empty());
  // A mesh that joins points on opposite sides, and none to its neighbours in the graph.
  const Triangles far = triangulateSphere(randomSphere(400, 8)).triangles;
  EXPECT_GT(MeshOptimizer(of.points, far, of.graph, 1).roughVertices(-2.0).size(), 300U);
  // One point pushed in.
  of.points.col(200) *= 0.5;
  const MeshOptimizer dented(of.points, of.triangles, of.graph, 1);
  const std::vector<Index> rough = dented.roughVertices(0.8);
  EXPECT_TRUE(std::is_sorted(rough.begin(), rough.end()));
  EXPECT_TRUE(std::binary_search(rough.begin(), rough.end(), 200));
  EXPECT_LT(rough.size(), 10U);
}

// --- Meshes that can be checked by hand
// ------------------------------------------------------------

TEST(MeshOptimization, EdgesAcrossACreaseAreFlippedBack) {
  const int m = 5;
  const Positions points = test::cubeGrid(m);
  const Case good = radialStart(points);
  // The creases: two coordinates of both ends are 0 or 1, and the ends are neighbours.
  std::set<std::pair<Index, Index>> creases;
  const auto extremes = [&](Index i) {
    return (points.col(i).array() == 0.0 || points.col(i).array() == 1.0).count();
  };
  for (Index i = 0; i < points.cols(); ++i)
    for (Index j = i + 1; j < points.cols(); ++j)
      if (extremes(i) >= 2 && extremes(j) >= 2 &&
          std::abs((points.col(i) - points.col(j)).norm() - 1.0 / (m - 1)) < 1e-12)
        creases.insert({i, j});
  ASSERT_EQ(creases.size(), 12U * (m - 1));
  const auto creases_in = [&](const Triangles& triangles) {
    std::size_t count = 0;
    for (const auto& edge : edgesOf(triangles))
      count += creases.count(edge);
    return count;
  };
  // Every third crease is cut by the other diagonal.
  SphereMesh cut(optimize(good).triangles, static_cast<std::size_t>(points.cols()));
  ASSERT_EQ(creases_in(cut.triangles()), creases.size());
  int seen = 0;
  for (Index t = 0; t < cut.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (creases.count(std::minmax({cut.vertex(t, (k + 1) % 3), cut.vertex(t, (k + 2) % 3)})) >
              0 &&
          seen++ % 3 == 0)
        cut.flip(t, k);
  const Case start{points, cut.triangles(), good.graph};
  ASSERT_LT(creases_in(start.triangles), creases.size() - 10);
  for (const OptimizationMethod method : {OptimizationMethod::Flips, OptimizationMethod::Full}) {
    const MeshOptimization result = optimize(start, withMethod(method));
    expectGuarantees(start, result);
    EXPECT_EQ(creases_in(result.triangles), creases.size());
    EXPECT_NEAR(test::volumeOf(points, result.triangles), 1.0, 1e-12);
    EXPECT_NEAR(areaOf(points, result.triangles), 6.0, 1e-12);
    EXPECT_TRUE(result.self_intersections.empty());
  }
}

TEST(MeshOptimization, ABoxGetsItsTwelveEdgesFromAnyMeshOfItsCorners) {
  Positions points(3, 8);
  for (Index i = 0; i < 8; ++i)
    points.col(i) << 1.0 * (i & 1), 2.0 * ((i >> 1) & 1), 3.0 * ((i >> 2) & 1);
  const Triangles hull = triangulateSphere(internal::projectFromCentroid(points)).triangles;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Case of{points, scrambled(hull, 8, 10, seed), graphOfMesh(points, hull)};
    const MeshOptimization result = optimize(of);
    expectGuarantees(of, result);
    EXPECT_NEAR(std::abs(test::volumeOf(points, result.triangles)), 6.0, 1e-12) << seed;
    EXPECT_NEAR(areaOf(points, result.triangles), 22.0, 1e-12);
    EXPECT_TRUE(result.self_intersections.empty());
    const auto edges = edgesOf(result.triangles);
    for (Index i = 0; i < 8; ++i)
      for (const Index bit : {1, 2, 4})
        EXPECT_EQ(edges.count({std::min(i, i ^ bit), std::max(i, i ^ bit)}), 1U);
  }
}

TEST(MeshOptimization, ABipyramidGetsItsRingBack) {
  for (const Index ring : {4, 5, 6, 9}) {
    Positions points(3, ring + 2);
    for (Index i = 0; i < ring; ++i)
      points.col(i) << std::cos(2.0 * test::kPi * i / ring), std::sin(2.0 * test::kPi * i / ring),
          0.0;
    points.col(ring) << 0.0, 0.0, 1.0;
    points.col(ring + 1) << 0.0, 0.0, -1.0;
    const Triangles hull = triangulateSphere(internal::projectFromCentroid(points)).triangles;
    SphereMesh cut(hull, static_cast<std::size_t>(ring) + 2);
    // The axis in place of a side of the ring.
    bool is_cut = false;
    for (Index t = 0; t < cut.size() && !is_cut; ++t)
      for (int k = 0; k < 3 && !is_cut; ++k)
        is_cut = cut.vertex(t, k) >= ring && cut.flip(t, k);
    ASSERT_TRUE(is_cut);
    const Case of{points, cut.triangles(), graphOfMesh(points, hull)};
    ASSERT_NE(test::canonical(of.triangles), test::canonical(hull));
    const MeshOptimization result = optimize(of, withMethod(OptimizationMethod::Flips));
    EXPECT_EQ(test::canonical(result.triangles), test::canonical(hull));
    EXPECT_EQ(test::canonical(optimize(of).triangles), test::canonical(hull));
  }
}

TEST(MeshOptimization, AScrambledSphereFindsBackToItsHull) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Case true_mesh = ellipsoid(800, 1.0, 0.8, 0.6);
    const Case of = scrambledEllipsoid(800, 0.6, 2000, seed);
    EXPECT_GT(intersectionsOf(of.points, of.triangles), 300U);
    const MeshOptimization result = optimize(of);
    expectGuarantees(of, result);
    EXPECT_TRUE(result.self_intersections.empty());
    const double volume = test::volumeOf(of.points, true_mesh.triangles);
    // Some diagonals of nearly square cells may be the other ones.
    EXPECT_NEAR(test::volumeOf(of.points, result.triangles), volume, 1e-3 * volume);
    EXPECT_LE(result.report.energy,
              1.01 * energyOf(of.points, true_mesh.triangles, Bend::Angle, 0.3));
  }
}

TEST(MeshOptimization, CloseParallelSheetsAreKeptApart) {
  // A disc whose two faces are, in the middle, half as far apart as their points.
  const Index n = 600;
  const double spacing = std::sqrt(8.0 * test::kPi / (std::sqrt(3.0) * n));
  const Positions sphere = spiralSphere(n);
  const Positions points = Eigen::Vector3d(1.0, 1.0, 0.25 * spacing).asDiagonal() * sphere;
  const Triangles hull = triangulateSphere(sphere).triangles;
  const Case of{points, scrambled(hull, n, 1500, 1), graphOfMesh(points, hull)};
  EXPECT_GT(intersectionsOf(points, of.triangles), 100U);
  const MeshOptimization result = optimize(of);
  expectGuarantees(of, result);
  EXPECT_TRUE(result.self_intersections.empty());
  EXPECT_NEAR(test::volumeOf(points, result.triangles), test::volumeOf(points, hull),
              0.02 * test::volumeOf(points, hull));
}

/// A tube on the sphere by its axis and angle, as an embedding has it, but folded: beyond a place
/// the axis runs back for a while.
Case foldedTube(double fold) {
  const int ring = 10;
  const test::Tube tube = test::bentTube(10.0, 2.0, ring);
  const auto n = static_cast<Index>(tube.points.cols());
  const int rings = (n - 2) / ring;
  Positions directions(3, n);
  for (Index i = 0; i < n - 2; ++i) {
    const Index r = i / ring;
    double s = (r + 1.0) / (rings + 1.0);
    if (s > 0.5)
      s = s < 0.5 + fold ? 1.0 - s + 1e-3 : s - 2.0 * fold + 1e-3;
    const double angle = 2.0 * test::kPi * (i % ring + 0.5 * (r % 2)) / ring;
    const double height = 1.0 - 1.8 * s;
    const double radius = std::sqrt(1.0 - height * height);
    directions.col(i) << radius * std::cos(angle), radius * std::sin(angle), height;
  }
  directions.col(n - 2) << 0.0, 0.0, 1.0;
  directions.col(n - 1) << 0.0, 0.0, -1.0;
  return {withNoise(tube.points, 0.01, 4), triangulateSphere(directions).triangles,
          graphOfMesh(tube.points, tube.triangles)};
}

TEST(MeshOptimization, AFoldedStartIsUnfolded) {
  const Case of = foldedTube(0.15);
  const std::size_t before = intersectionsOf(of.points, of.triangles);
  EXPECT_GT(before, 500U);
  const MeshOptimization flips = optimize(of, withMethod(OptimizationMethod::Flips));
  const MeshOptimization full = optimize(of);
  expectGuarantees(of, flips);
  expectGuarantees(of, full);
  EXPECT_LT(10 * full.self_intersections.size(), before);
  EXPECT_LT(full.self_intersections.size(), flips.self_intersections.size());
  EXPECT_LT(full.report.energy, flips.report.energy);
  EXPECT_LT(test::fractionBeyondTwoSteps(of.graph, full.triangles),
            0.2 * test::fractionBeyondTwoSteps(of.graph, of.triangles));
}

TEST(MeshOptimization, ARadialStartOfABentTubeGetsTheTubesMesh) {
  // Seen from its centroid, the tube hides much of itself; nothing intersects, but much is spiky.
  const test::Tube tube = test::bentTube(10.0, 2.0, 12);
  const Case of = radialStart(withNoise(tube.points, 0.01, 4));
  const MeshOptimization result = optimize(of);
  expectGuarantees(of, result);
  ASSERT_EQ(result.report.noise_steps, 0);
  const auto energy = [&](const Triangles& triangles) {
    return energyOf(of.points, triangles, Bend::Angle, 0.3);
  };
  EXPECT_GT(energy(of.triangles), 4.0 * energy(tube.triangles));
  EXPECT_LT(energy(result.triangles), 1.1 * energy(tube.triangles));
  EXPECT_LT(test::fractionBeyondTwoSteps(of.graph, result.triangles),
            0.2 * test::fractionBeyondTwoSteps(of.graph, of.triangles));
}

// --- Any input
// -------------------------------------------------------------------------------------

TEST(MeshOptimization, AnyCloudStaysASphereOverAllPoints) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto in_cube = [&](Index n) {
    Positions points(3, n);
    for (Index i = 0; i < n; ++i)
      points.col(i) << uniform(random), uniform(random), uniform(random);
    return points;
  };
  std::vector<Positions> clouds;
  for (const Index n : {4, 5, 6, 8, 15})
    for (int i = 0; i < 3; ++i)
      clouds.push_back(in_cube(n));
  clouds.push_back(in_cube(60));  // no surface
  Positions flat = in_cube(24);
  flat.row(2) *= 1e-12;
  clouds.push_back(flat);
  flat.row(2).setZero();  // no area between sheets, many triangles without area
  flat.col(0) << 0.0, 0.0, 0.5;
  clouds.push_back(flat);
  Positions line = in_cube(30);
  line.topRows(2) *= 1e-9;
  clouds.push_back(line);
  clouds.push_back(test::cubeGrid(4));
  // The same shape again, 1e-8 beside itself, and a tiny one beside a large one.
  const Positions sphere = spiralSphere(40);
  clouds.push_back(test::horizontally(sphere, withNoise(sphere, 1e-8, 10)));
  clouds.push_back(test::horizontally(sphere, 1e-8 * randomSphere(20, 11)));
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    SCOPED_TRACE("cloud " + std::to_string(i));
    const Case of = radialStart(clouds[i]);
    for (const OptimizationMethod method :
         {OptimizationMethod::None, OptimizationMethod::Flips, OptimizationMethod::Full})
      expectGuarantees(of, optimize(of, withMethod(method)));
  }
}

TEST(MeshOptimization, NoneLeavesTheTrianglesAndLooksAtThem) {
  const Case of = scrambledEllipsoid(200, 0.5, 100, 12);
  const MeshOptimization result = optimize(of, withMethod(OptimizationMethod::None));
  EXPECT_EQ(result.triangles, of.triangles);
  EXPECT_TRUE(result.report.phases.empty());
  EXPECT_EQ(result.self_intersections, findSelfIntersections(of.points, of.triangles));
  EXPECT_FALSE(result.self_intersections.empty());
  const double energy = energyOf(of.points, of.triangles, Bend::Angle, 0.3);
  EXPECT_NEAR(result.report.energy, energy, 1e-7 * energy);
}

TEST(MeshOptimization, FlipsAreFlipsAlone) {
  const Case of = scrambledEllipsoid(200, 0.5, 100, 13);
  const MeshOptimization result = optimize(of, withMethod(OptimizationMethod::Flips));
  expectGuarantees(of, result);
  ASSERT_EQ(result.report.phases.size(), 1U);
  const OptimizationPhase& phase = result.report.phases.front();
  EXPECT_EQ(phase.name, "flips");
  EXPECT_GT(phase.moves, 0U);
  EXPECT_LT(phase.energy, phase.energy_before);
  // Each phase by its own terms, the result by those of equation (1).
  const double energy = energyOf(of.points, result.triangles, Bend::Angle, 0.3);
  EXPECT_NEAR(result.report.energy, energy, 1e-7 * energy);
}

TEST(MeshOptimization, PhasesAreInTheOrderOfTheWork) {
  const Case of = scrambledEllipsoid(400, 0.5, 600, 14);
  const MeshOptimization result = optimize(of);
  std::vector<std::string> names;
  for (const OptimizationPhase& phase : result.report.phases)
    if (names.empty() || names.back() != phase.name)
      names.push_back(phase.name);
  ASSERT_GE(names.size(), 3U);
  EXPECT_EQ(names[0], "flips");
  EXPECT_EQ(names[1], "relocate");
  EXPECT_NE(std::find(names.begin(), names.end(), "polish"), names.end());
  const double energy = energyOf(of.points, result.triangles, Bend::Angle, 0.3);
  EXPECT_NEAR(result.report.energy, energy, 1e-7 * energy);
}

TEST(MeshOptimization, SameBitsForAnyNumberOfThreads) {
  // More triangles than a single thread is left with.
  for (const bool noisy : {false, true}) {
    const Case of = noisy ? noisySphere(2600, 0.3, 15) : scrambledEllipsoid(2600, 0.6, 3000, 15);
    const MeshOptimization one = optimize(of, {}, 1, test::onThreads(1));
    for (const int threads : {2, 4}) {
      const MeshOptimization other = optimize(of, {}, 1, test::onThreads(threads));
      EXPECT_EQ(one.triangles, other.triangles);
      EXPECT_EQ(one.self_intersections, other.self_intersections);
      EXPECT_EQ(one.report.energy, other.report.energy);
      EXPECT_EQ(one.report.rough, other.report.rough);
      EXPECT_EQ(one.report.alignment, other.report.alignment);
      EXPECT_EQ(one.report.unevenness, other.report.unevenness);
      EXPECT_EQ(one.report.noise_steps, other.report.noise_steps);
      ASSERT_EQ(one.report.phases.size(), other.report.phases.size());
      for (std::size_t i = 0; i < one.report.phases.size(); ++i) {
        EXPECT_EQ(one.report.phases[i].name, other.report.phases[i].name);
        EXPECT_EQ(one.report.phases[i].tried, other.report.phases[i].tried);
        EXPECT_EQ(one.report.phases[i].moves, other.report.phases[i].moves);
        EXPECT_EQ(one.report.phases[i].energy_before, other.report.phases[i].energy_before);
        EXPECT_EQ(one.report.phases[i].energy, other.report.phases[i].energy);
        EXPECT_EQ(one.report.phases[i].self_intersections,
                  other.report.phases[i].self_intersections);
      }
    }
  }
}

TEST(MeshOptimization, SeedDecidesWhatIsRandom) {
  const test::Tube tube = test::bentTube(10.0, 2.5, 10);
  const Case of = radialStart(withNoise(tube.points, 0.02, 16));
  const MeshOptimization first = optimize(of);
  EXPECT_EQ(first.triangles, optimize(of).triangles);
  EXPECT_NE(first.triangles, optimize(of, {}, 2).triangles);
}

TEST(MeshOptimization, ScaleByAPowerOfTwoChangesNothing) {
  Case of = scrambledEllipsoid(300, 0.5, 400, 17);
  const MeshOptimization result = optimize(of);
  for (const int exponent : {-20, 3, 30}) {
    Case scaled = of;
    scaled.points *= std::ldexp(1.0, exponent);
    scaled.graph = graphOfMesh(scaled.points, ellipsoid(300, 1.0, 0.8, 0.5).triangles);
    const MeshOptimization other = optimize(scaled);
    EXPECT_EQ(result.triangles, other.triangles);
    EXPECT_EQ(std::ldexp(result.report.energy, exponent), other.report.energy);
    EXPECT_EQ(result.report.alignment, other.report.alignment);
  }
}

TEST(MeshOptimization, RenamedVerticesAreFlippedAlike) {
  // Gains of different edges are different in a cloud without symmetry, so their order is the same.
  const Index n = 400;
  const Positions points =
      Eigen::Vector3d(1.0, 0.8, 0.6).asDiagonal() * withNoise(randomSphere(n, 18), 0.01, 19);
  const Triangles hull = triangulateSphere(internal::projectFromCentroid(points)).triangles;
  const Case of{points, scrambled(hull, n, 200, 20), graphOfMesh(points, hull)};
  std::vector<Index> place(static_cast<std::size_t>(n));
  std::iota(place.begin(), place.end(), Index{0});
  std::mt19937_64 random(21);
  std::shuffle(place.begin(), place.end(), random);
  const auto renamed = [&](const Triangles& triangles) {
    return Triangles(
        triangles.unaryExpr([&](Index v) { return place[static_cast<std::size_t>(v)]; }));
  };
  Positions moved(3, n);
  for (Index i = 0; i < n; ++i)
    moved.col(place[static_cast<std::size_t>(i)]) = points.col(i);
  const Case other{moved, renamed(of.triangles).rowwise().reverse(),
                   graphOfMesh(moved, renamed(hull))};
  const OptimizationOptions flips = withMethod(OptimizationMethod::Flips);
  EXPECT_EQ(test::canonical(renamed(optimize(of, flips).triangles)),
            test::canonical(optimize(other, flips).triangles));
}

// --- The caller's part
// -----------------------------------------------------------------------------

TEST(MeshOptimization, BadInputIsInvalidInput) {
  const Case good = ellipsoid(50, 1.0, 0.8, 0.6);
  EXPECT_NO_THROW(optimize(good));
  for (const int threads : {-1, 1025})
    EXPECT_THROW(optimize(good, {}, 1, test::onThreads(threads)), InvalidInput);
  const auto bad = [&](const auto& change) {
    for (const OptimizationMethod method : {OptimizationMethod::None, OptimizationMethod::Full}) {
      Case of = good;
      OptimizationOptions options = withMethod(method);
      change(of, options);
      EXPECT_THROW(optimize(of, options), InvalidInput);
    }
  };
  bad([](Case& of, OptimizationOptions&) { of.points = Positions(of.points.leftCols(49)); });
  bad([](Case& of, OptimizationOptions&) { of.graph = Graph(); });
  bad([](Case& of, OptimizationOptions&) { of.triangles(0, 0) = 50; });
  bad([](Case& of, OptimizationOptions&) { of.triangles(0, 0) = -1; });
  bad([](Case& of, OptimizationOptions&) { of.triangles = Triangles(of.triangles.leftCols(95)); });
  bad([](Case& of, OptimizationOptions&) { std::swap(of.triangles(0, 7), of.triangles(1, 7)); });
  bad([](Case& of, OptimizationOptions&) {
    of.points(1, 7) = std::numeric_limits<double>::quiet_NaN();
  });
  bad([](Case& of, OptimizationOptions&) {
    of.points(1, 7) = std::numeric_limits<double>::infinity();
  });
  bad([](Case& of, OptimizationOptions&) {  // a point that no triangle has
    of.points.conservativeResize(Eigen::NoChange, 51);
    of.points.col(50).setConstant(2.0);
    of.graph.offsets.push_back(of.graph.offsets.back());
  });
  bad([](Case& of, OptimizationOptions&) {  // two pieces
    const Positions points = of.points;
    of.points = test::horizontally(points, 3.0 * points);
    Triangles both(3, 2 * of.triangles.cols());
    both << of.triangles, (of.triangles.array() + 50).matrix();
    of.triangles = both;
    of.graph = graphOfMesh(of.points, both);
  });
}

TEST(MeshOptimization, ProgressMayEndTheWork) {
  const Case of = noisySphere(200, 0.6, 23);
  for (const int last : {1, 2, 5}) {
    int calls = 0;
    EXPECT_THROW(optimize(of, {}, 1, test::reportingTo([&](double) { return ++calls < last; })),
                 Cancelled);
    EXPECT_EQ(calls, last);
  }
}

TEST(MeshOptimization, ProgressChangesNothing) {
  // In a plane, triangles overlap whatever is done: all rounds of untangling are made.
  Case flat = ellipsoid(6, 1.0, 0.8, 1.0);
  flat.points = randomSphere(6, 22);
  flat.points.row(2).setZero();
  for (const Case& of : {noisySphere(60, 1.0, 22), flat}) {
    MeshOptimization watched;
    const std::vector<double> fractions = test::fractionsOf(
        [&](const auto& report) { watched = optimize(of, {}, 1, test::reportingTo(report)); });
    EXPECT_TRUE(test::areFractions(fractions));
    EXPECT_GT(fractions.size(), 5U);
    EXPECT_EQ(watched.triangles, optimize(of).triangles);
  }
}

TEST(MeshOptimization, FlipsReportWhileTheyWork) {
  const Case of = scrambledEllipsoid(100000, 0.6, 200000, 6);
  MeshOptimizer optimizer(of.points, of.triangles, of.graph, 1);
  optimizer.setEnergy(SurfaceEnergy());
  const std::vector<double> fractions =
      test::fractionsOf([&](const auto& report) { optimizer.flipAll(report); });
  EXPECT_TRUE(test::areFractions(fractions));
  EXPECT_GE(fractions.size(), 4U);  // two of the first candidates, then of the queue
}

TEST(MeshOptimization, EveryMethodReportsDuringLongWork) {
  const Case of = scrambledEllipsoid(150000, 0.6, 100000, 5);
  for (const OptimizationMethod method :
       {OptimizationMethod::None, OptimizationMethod::Flips, OptimizationMethod::Full}) {
    OptimizationOptions options;
    options.method = method;
    const auto run = [&](const std::function<bool(double)>& progress) {
      optimize(of, options, 1, test::reportingTo(progress));
    };
    const std::vector<double> fractions = test::fractionsOf(run);
    EXPECT_TRUE(test::areFractions(fractions));
    EXPECT_GE(fractions.size(), method == OptimizationMethod::None ? 8U : 20U);
  }
}

TEST(MeshOptimization, NoiseAloneIsSmoothed) {
  const auto steps = [](const Case& of, OptimizationMethod method) {
    const MeshOptimization result = optimize(of, withMethod(method));
    expectGuarantees(of, result);
    EXPECT_EQ(result.report.noise_steps > 0,
              method == OptimizationMethod::Full && result.report.rough > 0.5);
    return result.report.noise_steps;
  };
  EXPECT_EQ(steps(ellipsoid(500, 1.0, 0.8, 0.6), OptimizationMethod::Full), 0);
  EXPECT_EQ(steps(radialStart(test::cubeGrid(6)), OptimizationMethod::Full), 0);
  const Case noisy = noisySphere(500, 0.4, 24);
  EXPECT_EQ(steps(noisy, OptimizationMethod::None), 0);
  EXPECT_EQ(steps(noisy, OptimizationMethod::Flips), 0);
  EXPECT_GT(steps(noisy, OptimizationMethod::Full), 0);
}

TEST(MeshOptimization, EnergyOfANoisyCloudIsThatOnTheGivenPoints) {
  const Case of = noisySphere(200, 0.5, 26);
  for (const bool finish : {false, true}) {
    OptimizationOptions options;
    options.finish_on_points = finish;
    const MeshOptimization result = optimize(of, options);
    ASSERT_GT(result.report.noise_steps, 0);
    const double energy = energyOf(of.points, result.triangles, Bend::Angle, 0.3);
    EXPECT_NEAR(result.report.energy, energy, 1e-7 * energy);
  }
}

// --- How a surface was sampled
// ---------------------------------------------------------------------

/// The side of a cylinder of radius 1, `ring` points around, rings at a distance of `step`.
Sampling samplingOfCylinder(int ring, int rings, double step) {
  Positions points(3, ring * rings);
  for (int r = 0; r < rings; ++r)
    for (int k = 0; k < ring; ++k) {
      const double angle = 2.0 * test::kPi * k / ring;
      points.col(r * ring + k) << std::cos(angle), std::sin(angle), step * r;
    }
  return analyzeSampling(points, localGraph(points), 1);
}

TEST(SamplingAnalysis, AlignmentShowsWhetherPointsAreFartherApartWhereTheSurfaceBendsLess) {
  const int ring = 40;
  const double even = 2.0 * test::kPi / ring;
  EXPECT_GT(samplingOfCylinder(ring, 25, 2.0 * even).alignment, 0.9);
  EXPECT_LT(samplingOfCylinder(ring, 40, 0.5 * even).alignment, -0.9);
}

TEST(SamplingAnalysis, EvenSamplingsKnowNothingOfTheCurvature) {
  // Independent points on a cylinder and on a torus, as many everywhere as there is area.
  const int n = 1500;
  std::mt19937_64 random(28);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Positions cylinder(3, n);
  Positions torus(3, n);
  for (Index i = 0; i < n; ++i) {
    const double a = 2.0 * test::kPi * uniform(random);
    cylinder.col(i) << std::cos(a), std::sin(a), 4.0 * uniform(random);
    double b = 2.0 * test::kPi * uniform(random);
    while (1.4 * uniform(random) > 1.0 + 0.4 * std::cos(b))
      b = 2.0 * test::kPi * uniform(random);
    const double radius = 1.0 + 0.4 * std::cos(b);
    torus.col(i) << radius * std::cos(a), radius * std::sin(a), 0.4 * std::sin(b);
  }
  EXPECT_NEAR(analyzeSampling(cylinder, localGraph(cylinder), 1).alignment, 0.0, 0.15);
  EXPECT_NEAR(analyzeSampling(torus, localGraph(torus), 1).alignment, 0.0, 0.15);
}

TEST(SamplingAnalysis, SpheresAreNotTakenForSamplingsThatFollowTheCurvature) {
  const Positions even = spiralSphere(1500);
  EXPECT_LT(analyzeSampling(even, localGraph(even), 1).alignment, 0.15);
  const Positions random = randomSphere(1500, 30);
  EXPECT_LT(analyzeSampling(random, localGraph(random), 1).alignment, 0.15);
}

TEST(SamplingAnalysis, UnevennessDistinguishesRandomFromRegularSamplings) {
  const auto unevenness = [](const Positions& points) {
    return analyzeSampling(points, localGraph(points), 1).unevenness;
  };
  EXPECT_GT(unevenness(randomSphere(1500, 29)), 0.3);
  EXPECT_LT(unevenness(spiralSphere(1500)), 0.3);
  EXPECT_LT(unevenness(test::cubeGrid(12)), 0.3);
  // All lengths alike.
  const Positions octahedron{{1.0, -1.0, 0.0, 0.0, 0.0, 0.0},
                             {0.0, 0.0, 1.0, -1.0, 0.0, 0.0},
                             {0.0, 0.0, 0.0, 0.0, 1.0, -1.0}};
  const Graph graph = graphOfMesh(octahedron, triangulateSphere(octahedron).triangles);
  EXPECT_NEAR(analyzeSampling(octahedron, graph, 1).unevenness, 0.0, 1e-7);
}

TEST(SamplingAnalysis, SameBitsForAnyNumberOfThreads) {
  const Positions sphere = spiralSphere(3000);
  const Positions points = Eigen::Vector3d(1.0, 0.5, 0.25).asDiagonal() * sphere;
  const Graph graph = graphOfMesh(points, triangulateSphere(sphere).triangles);
  const Sampling one = analyzeSampling(points, graph, 1);
  EXPECT_NE(one.alignment, 0.0);
  for (const int threads : {2, 4}) {
    const Sampling other = analyzeSampling(points, graph, threads);
    EXPECT_EQ(one.alignment, other.alignment);
    EXPECT_EQ(one.unevenness, other.unevenness);
  }
}

}  // namespace
}  // namespace spherical_param
