#include "spherical_param/smoothing.h"

#include "helpers.h"
#include "spherical_param/errors.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>

namespace spherical_param {
namespace {

using test::kPi;

constexpr SmoothingMethod kMethods[] = {SmoothingMethod::Umbrella, SmoothingMethod::Biharmonic};

SmoothingOptions optionsOf(SmoothingMethod method, int steps = 5, bool restore_volume = true) {
  SmoothingOptions options;
  options.method = method;
  options.steps = steps;
  options.restore_volume = restore_volume;
  return options;
}

struct Mesh {
  Positions points;
  Triangles triangles;
};

/// The octahedron, each edge split in two `levels` times, on the unit sphere.
Mesh octasphere(int levels) {
  Mesh mesh{Positions(3, 6), Triangles(3, 8)};
  mesh.points << 1, -1, 0, 0, 0, 0,  //
      0, 0, 1, -1, 0, 0,             //
      0, 0, 0, 0, 1, -1;
  mesh.triangles << 0, 2, 1, 3, 2, 1, 3, 0,  //
      2, 1, 3, 0, 0, 2, 1, 3,                //
      4, 4, 4, 4, 5, 5, 5, 5;
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<Index, Index>, Index> middles;
    std::vector<Eigen::Vector3d> points;
    for (Eigen::Index i = 0; i < mesh.points.cols(); ++i)
      points.emplace_back(mesh.points.col(i));
    const auto middle = [&](Index a, Index b) {
      const auto [entry, is_new] =
          middles.insert({{std::min(a, b), std::max(a, b)}, static_cast<Index>(points.size())});
      if (is_new)
        points.emplace_back((mesh.points.col(a) + mesh.points.col(b)).normalized());
      return entry->second;
    };
    Triangles finer(3, 4 * mesh.triangles.cols());
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const Eigen::Matrix<Index, 3, 1> v = mesh.triangles.col(t);
      const Index ab = middle(v[0], v[1]);
      const Index bc = middle(v[1], v[2]);
      const Index ca = middle(v[2], v[0]);
      finer.col(4 * t) << v[0], ab, ca;
      finer.col(4 * t + 1) << v[1], bc, ab;
      finer.col(4 * t + 2) << v[2], ca, bc;
      finer.col(4 * t + 3) << ab, bc, ca;
    }
    mesh.triangles = finer;
    mesh.points.resize(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
      mesh.points.col(static_cast<Eigen::Index>(i)) = points[i];
  }
  return mesh;
}

/// A flat torus of m x m quads, each split in two: six neighbours everywhere.
Triangles torusTriangles(Index m) {
  Triangles triangles(3, 2 * m * m);
  Eigen::Index t = 0;
  const auto at = [m](Index i, Index j) { return (i % m) * m + j % m; };
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) {
      triangles.col(t++) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
      triangles.col(t++) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
    }
  return triangles;
}

/// Moves each point by up to `amplitude` away from or towards the origin.
Positions withNoise(const Positions& points, double amplitude, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-amplitude, amplitude);
  Positions noisy = points;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    noisy.col(i) += uniform(random) * points.col(i).normalized();
  return noisy;
}

/// Root mean square of the angles [rad] between the normals of triangles and the rays to them.
double normalDeviation(const Positions& points, const Triangles& triangles) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = points.col(triangles(0, t));
    const Eigen::Vector3d b = points.col(triangles(1, t));
    const Eigen::Vector3d c = points.col(triangles(2, t));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double angle = std::atan2(normal.cross(a + b + c).norm(), normal.dot(a + b + c));
    sum += angle * angle;
  }
  return std::sqrt(sum / static_cast<double>(triangles.cols()));
}

double largestDifference(const Positions& a, const Positions& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

/// The Laplacian of one step, by the sets of neighbours alone.
Positions laplacianOf(const Positions& points, const Triangles& triangles) {
  const Graph graph = test::graphOfMesh(points, triangles);
  Positions result(3, points.cols());
  for (std::size_t i = 0; i < graph.size(); ++i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t e = graph.offsets[i]; e < graph.offsets[i + 1]; ++e)
      sum += points.col(graph.neighbors[e]);
    const auto column = static_cast<Eigen::Index>(i);
    result.col(column) =
        sum / static_cast<double>(graph.offsets[i + 1] - graph.offsets[i]) - points.col(column);
  }
  return result;
}

TEST(Smoothing, NoisySphereBecomesSmoother) {
  const Mesh sphere = octasphere(4);  // 1026 points, edges of some 0.1
  const Positions noisy = withNoise(sphere.points, 0.05, 1);
  const double before = normalDeviation(noisy, sphere.triangles);
  for (const SmoothingMethod method : kMethods) {
    const Smoothing smooth = smoothSurface(noisy, sphere.triangles, optionsOf(method));
    // Five steps leave a gain of 0.03 at most at k = 1/2.
    EXPECT_LT(normalDeviation(smooth.points, sphere.triangles), 0.25 * before);
    // Nearer to the true surface too.
    const auto roughness = [](const Positions& points) {
      const Eigen::ArrayXd radii = points.colwise().norm().transpose().array();
      return std::sqrt((radii - radii.mean()).square().mean());
    };
    EXPECT_LT(roughness(smooth.points), 0.5 * roughness(noisy));
  }
}

TEST(Smoothing, VolumeIsRestoredUnlessThatIsSwitchedOff) {
  const Mesh sphere = octasphere(3);
  const test::Tube tube = test::bentTube(12.0, 2.0, 12);
  for (const auto& [points, triangles] :
       {std::pair(withNoise(sphere.points, 0.1, 2), sphere.triangles),
        std::pair(withNoise(tube.points, 0.1, 3), tube.triangles)}) {
    const double volume = test::volumeOf(points, triangles);
    for (const SmoothingMethod method : kMethods) {
      const Smoothing smooth = smoothSurface(points, triangles, optionsOf(method));
      // Newton's method ends below 1e-12; the rest is the rounding of the sums.
      EXPECT_NEAR(test::volumeOf(smooth.points, triangles) / volume, 1.0, 1e-11);
      EXPECT_NEAR(smooth.report.volume_before / volume, 1.0, 1e-12);
      EXPECT_NEAR(smooth.report.volume_after / volume, 1.0, 1e-11);
    }
  }
}

TEST(Smoothing, OnlyTheUmbrellaShrinksByItself) {
  const Mesh sphere = octasphere(4);
  const Positions noisy = withNoise(sphere.points, 0.02, 4);
  const auto change = [&](SmoothingMethod method) {
    const Smoothing smooth = smoothSurface(noisy, sphere.triangles, optionsOf(method, 5, false));
    EXPECT_NEAR(smooth.report.volume_after, test::volumeOf(smooth.points, sphere.triangles), 1e-12);
    return smooth.report.volume_after / smooth.report.volume_before - 1.0;
  };
  // The coordinates of a sphere have k = h^2 / 2 with edges of h^2 = 4 pi / 1026 * 2 / sqrt(3), so
  // k = 0.0071: five steps of the umbrella take 3 * 5 k = 11 % of the volume, the flow takes
  // 3 ln(2) (k / 0.129)^2 = 0.6 %, and the noise and uneven triangles add to it.
  EXPECT_LT(change(SmoothingMethod::Umbrella), -0.08);
  EXPECT_LT(std::abs(change(SmoothingMethod::Biharmonic)), 0.012);
}

TEST(Smoothing, OneStepOfTheUmbrellaMovesByTheLaplacian) {
  const Mesh sphere = octasphere(2);
  const Positions noisy = withNoise(sphere.points, 0.2, 5);
  SmoothingOptions options = optionsOf(SmoothingMethod::Umbrella, 1, false);
  const Smoothing smooth = smoothSurface(noisy, sphere.triangles, options);
  EXPECT_LT(largestDifference(smooth.points, noisy + laplacianOf(noisy, sphere.triangles)), 1e-14);
}

TEST(Smoothing, WavesOnARegularMeshAreMultipliedByTheGainOfTheirFrequency) {
  // On a torus of six neighbours each, plane waves are eigenvectors of the Laplacian.
  constexpr Index m = 24;
  const Triangles triangles = torusTriangles(m);
  constexpr int steps = 5;
  const double half_gain = 1.0 - std::pow(0.5, 1.0 / steps);
  for (const auto& [p, q] : {std::pair(0, 0), std::pair(1, 0), std::pair(2, 3), std::pair(8, 8),
                             std::pair(12, 12), std::pair(8, 16)}) {
    const double a = 2.0 * kPi * p / m;
    const double b = 2.0 * kPi * q / m;
    const double k = 1.0 - (std::cos(a) + std::cos(b) + std::cos(a + b)) / 3.0;
    Positions points(3, m * m);
    for (Index i = 0; i < m; ++i)
      for (Index j = 0; j < m; ++j) {
        const double phase = a * i + b * j;
        points.col(i * m + j) << std::cos(phase), std::sin(phase), std::cos(phase + 1.0);
      }
    SmoothingOptions options = optionsOf(SmoothingMethod::Umbrella, steps, false);
    EXPECT_LT(largestDifference(smoothSurface(points, triangles, options).points,
                                std::pow(1.0 - k, steps) * points),
              1e-14);
    options.method = SmoothingMethod::Biharmonic;
    // The series is cut at 1e-7, twice with the gain at k = 0.
    EXPECT_LT(largestDifference(smoothSurface(points, triangles, options).points,
                                std::exp2(-(k / half_gain) * (k / half_gain)) * points),
              5e-7);
  }
}

TEST(Smoothing, BiharmonicFlowIsAsStrongAsSoManyStepsOfTheUmbrella) {
  // The frequency of gain one half is the same, for few steps and many.
  constexpr Index m = 36;
  const Triangles triangles = torusTriangles(m);
  for (const int steps : {3, 20}) {
    double below = 1.0;  // gains of waves around that frequency
    double above = 0.0;
    double umbrella_below = 1.0;
    double umbrella_above = 0.0;
    for (int p = 1; p <= m / 2 && above == 0.0; ++p) {
      const double a = 2.0 * kPi * p / m;
      Positions points(3, m * m);
      for (Index i = 0; i < m; ++i)
        for (Index j = 0; j < m; ++j)
          points.col(i * m + j) << std::cos(a * i), std::sin(a * i), 0.0;
      const auto gain = [&](SmoothingMethod method) {
        return smoothSurface(points, triangles, optionsOf(method, steps, false))
            .points.col(0)
            .head<2>()
            .norm();
      };
      const double umbrella = gain(SmoothingMethod::Umbrella);
      const double flow = gain(SmoothingMethod::Biharmonic);
      if (umbrella >= 0.5) {
        below = std::min(below, flow);
        umbrella_below = std::min(umbrella_below, umbrella);
      } else {
        above = flow;
        umbrella_above = umbrella;
      }
    }
    EXPECT_GE(below, umbrella_below - 1e-6);  // passes what lies below better,
    EXPECT_LE(above, umbrella_above + 1e-6);  // stops what lies above better
    EXPECT_GE(below, 0.5 - 1e-6);
    EXPECT_LT(above, 0.5);
  }
}

TEST(Smoothing, FlatRegularInteriorStays) {
  // A cushion: two layers of a grid, upper and lower, joined around; deep inside, each layer is
  // flat and regular, so that its Laplacian vanishes.
  constexpr Index m = 41;
  Positions points(3, 2 * m * m);
  std::vector<std::array<Index, 3>> list;
  const auto at = [](Index layer, Index i, Index j) { return layer * m * m + i * m + j; };
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j)
      for (Index layer = 0; layer < 2; ++layer)
        points.col(at(layer, i, j)) << i, j, layer;
  for (Index i = 0; i + 1 < m; ++i)
    for (Index j = 0; j + 1 < m; ++j) {
      list.push_back({at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1)});
      list.push_back({at(1, i, j), at(1, i + 1, j + 1), at(1, i, j + 1)});
      list.push_back({at(0, i, j), at(0, i + 1, j + 1), at(0, i + 1, j)});
      list.push_back({at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1)});
    }
  const auto wall = [&](Index i, Index j, Index next_i, Index next_j) {
    list.push_back({at(0, i, j), at(0, next_i, next_j), at(1, next_i, next_j)});
    list.push_back({at(0, i, j), at(1, next_i, next_j), at(1, i, j)});
  };
  for (Index s = 0; s + 1 < m; ++s) {
    wall(s, 0, s + 1, 0);
    wall(m - 1, s, m - 1, s + 1);
    wall(s + 1, m - 1, s, m - 1);
    wall(0, s + 1, 0, s);
  }
  Triangles triangles(3, static_cast<Eigen::Index>(list.size()));
  for (std::size_t t = 0; t < list.size(); ++t)
    triangles.col(static_cast<Eigen::Index>(t)) << list[t][0], list[t][1], list[t][2];
  ASSERT_TRUE(test::isSphereOverAll(triangles, 2 * m * m));

  for (const SmoothingMethod method : kMethods) {
    const Smoothing smooth = smoothSurface(points, triangles, optionsOf(method, 5, false));
    // Five steps of Umbrella reach five edges far. The flow reaches further, but
    // dies out fast: 20 edges from the rim less than 1e-5 of an edge is left.
    double inside = 0.0;
    for (const Index i : {at(0, m / 2, m / 2), at(1, m / 2, m / 2)})
      inside = std::max(inside, (smooth.points.col(i) - points.col(i)).norm());
    EXPECT_LT(inside, method == SmoothingMethod::Biharmonic ? 1e-5 : 1e-12);
    EXPECT_GT(smooth.report.max_displacement, 0.1);  // of the rim
  }
}

TEST(Smoothing, ReportedDisplacementsAreThoseOfThePoints) {
  const Mesh sphere = octasphere(3);
  const Positions noisy = withNoise(sphere.points, 0.1, 7);
  for (const SmoothingMethod method : kMethods) {
    const Smoothing smooth = smoothSurface(noisy, sphere.triangles, optionsOf(method));
    const Eigen::ArrayXd moved = (smooth.points - noisy).colwise().norm().transpose().array();
    EXPECT_NEAR(smooth.report.max_displacement, moved.maxCoeff(), 1e-14);
    EXPECT_NEAR(smooth.report.mean_displacement, moved.mean(), 1e-13);
    EXPECT_NEAR(smooth.report.rms_displacement, std::sqrt(moved.square().mean()), 1e-13);
    EXPECT_GT(smooth.report.max_displacement, 0.01);
  }
}

TEST(Smoothing, ZeroStepsChangeNothing) {
  const Mesh sphere = octasphere(2);
  Positions points = withNoise(sphere.points, 0.1, 8);
  points.array() += 0.1;
  for (const SmoothingMethod method : kMethods) {
    const Smoothing smooth = smoothSurface(points, sphere.triangles, optionsOf(method, 0));
    EXPECT_EQ(smooth.points, points);
    EXPECT_EQ(smooth.report.max_displacement, 0.0);
    EXPECT_EQ(smooth.report.volume_after, smooth.report.volume_before);
    EXPECT_NEAR(smooth.report.volume_before, test::volumeOf(points, sphere.triangles), 1e-12);
  }
}

TEST(Smoothing, MovesWithRotationTranslationAndScale) {
  const Mesh sphere = octasphere(3);
  const Positions noisy = withNoise(sphere.points, 0.1, 9);
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(1000.0, -2000.0, 500.0);
  const Positions moved = (50.0 * rotation * noisy).colwise() + shift;
  for (const SmoothingMethod method : kMethods) {
    const Smoothing smooth = smoothSurface(noisy, sphere.triangles, optionsOf(method));
    const Smoothing other = smoothSurface(moved, sphere.triangles, optionsOf(method));
    // Coordinates of 2000 are rounded by 2e-13; the volume's restoration by no more.
    EXPECT_LT(largestDifference(other.points, (50.0 * rotation * smooth.points).colwise() + shift),
              1e-9);
    EXPECT_NEAR(other.report.rms_displacement, 50.0 * smooth.report.rms_displacement, 1e-9);
  }
}

TEST(Smoothing, SurfaceTurnedInsideOutIsSmoothedAlike) {
  const Mesh sphere = octasphere(3);
  const Positions noisy = withNoise(sphere.points, 0.1, 10);
  Triangles turned = sphere.triangles;
  turned.row(1).swap(turned.row(2));
  const Smoothing smooth =
      smoothSurface(noisy, sphere.triangles, optionsOf(SmoothingMethod::Biharmonic));
  const Smoothing other = smoothSurface(noisy, turned, optionsOf(SmoothingMethod::Biharmonic));
  EXPECT_LT(largestDifference(smooth.points, other.points), 1e-12);
  EXPECT_NEAR(other.report.volume_after, -smooth.report.volume_after, 1e-12);
}

TEST(Smoothing, SameBitsForAnyNumberOfThreads) {
  // Enough points for several threads, and not a multiple of the blocks.
  const Mesh sphere = octasphere(7);  // 65538
  const Positions noisy = withNoise(sphere.points, 0.01, 11);
  for (const SmoothingMethod method : kMethods) {
    const SmoothingOptions options = optionsOf(method, 2);
    const Smoothing one = smoothSurface(noisy, sphere.triangles, options, 1);
    for (const int threads : {2, 5, 0}) {
      const Smoothing several = smoothSurface(noisy, sphere.triangles, options, threads);
      EXPECT_EQ(one.points, several.points);
      EXPECT_EQ(one.report.volume_before, several.report.volume_before);
      EXPECT_EQ(one.report.volume_after, several.report.volume_after);
      EXPECT_EQ(one.report.mean_displacement, several.report.mean_displacement);
    }
  }
}

TEST(Smoothing, HighestFrequencyOfAnyClosedMeshIsNotAmplified) {
  // Points of three neighbours in all triangles of an octahedron, which reach k = 3/2, the most
  // there can be: the many steps would blow up what is amplified.
  const Mesh base = octasphere(0);
  Mesh mesh{Positions(3, 14), Triangles(3, 24)};
  mesh.points.leftCols(6) = base.points;
  for (Eigen::Index t = 0; t < 8; ++t) {
    const auto apex = static_cast<Index>(6 + t);
    mesh.points.col(apex).setZero();
    for (int k = 0; k < 3; ++k) {
      mesh.points.col(apex) += base.points.col(base.triangles(k, t)) / 5.0;
      mesh.triangles.col(3 * t + k) << base.triangles(k, t), base.triangles((k + 1) % 3, t), apex;
    }
  }
  ASSERT_TRUE(test::isSphereOverAll(mesh.triangles, 14));
  // k = 3/2: +1 at the points of three neighbours, -1 at the others, in all coordinates alike.
  Positions points = Positions::Constant(3, 14, 1.0);
  points.leftCols(6).setConstant(-1.0);
  ASSERT_LT(largestDifference(laplacianOf(points, mesh.triangles), -1.5 * points), 1.0 + 1e-15);
  points += mesh.points;
  for (const SmoothingMethod method : kMethods) {
    const SmoothingOptions options = optionsOf(method, 200, false);
    EXPECT_LT(smoothSurface(points, mesh.triangles, options).points.cwiseAbs().maxCoeff(), 3.0);
  }
}

TEST(Smoothing, PointsOfNoTriangleStay) {
  const Mesh sphere = octasphere(2);
  const Positions noisy = withNoise(sphere.points, 0.1, 12);
  Positions stray(3, 2);
  stray << 0.5, 7.0, 0.25, 8.0, 0.125, 9.0;
  const Positions both = test::horizontally(noisy, stray);
  for (const SmoothingMethod method : kMethods) {
    const Smoothing alone = smoothSurface(noisy, sphere.triangles, optionsOf(method));
    const Smoothing with_stray = smoothSurface(both, sphere.triangles, optionsOf(method));
    EXPECT_EQ(with_stray.points.leftCols(noisy.cols()), alone.points);
    EXPECT_EQ(with_stray.points.rightCols(2), stray);
    EXPECT_EQ(with_stray.report.mean_displacement, alone.report.mean_displacement);
  }
}

TEST(Smoothing, MeshWithoutVolumeIsSmoothedAllTheSame) {
  // Flat, and both sides of one triangle: nothing to restore, and nothing that is not finite.
  const Mesh sphere = octasphere(2);
  Positions flat = withNoise(sphere.points, 0.1, 13);
  flat.row(2).setZero();
  Triangles two_sides(3, 2);
  two_sides << 0, 0, 1, 2, 2, 1;
  for (const SmoothingMethod method : kMethods) {
    const Smoothing smooth = smoothSurface(flat, sphere.triangles, optionsOf(method));
    EXPECT_TRUE(smooth.points.allFinite());
    EXPECT_EQ(smooth.points.row(2).cwiseAbs().maxCoeff(), 0.0);
    EXPECT_TRUE(
        smoothSurface(sphere.points.leftCols(3), two_sides, optionsOf(method)).points.allFinite());
    // All points in one place.
    const Positions same = Positions::Constant(3, flat.cols(), 0.3);
    EXPECT_LT(
        largestDifference(smoothSurface(same, sphere.triangles, optionsOf(method)).points, same),
        1e-15);
  }
}

TEST(Smoothing, EmptyMeshIsSmoothedToItself) {
  EXPECT_EQ(smoothSurface(Positions(3, 0), Triangles(3, 0), optionsOf(SmoothingMethod::Biharmonic))
                .points.cols(),
            0);
  const Positions points = Positions::Ones(3, 2);
  EXPECT_EQ(smoothSurface(points, Triangles(3, 0), optionsOf(SmoothingMethod::Biharmonic)).points,
            points);
}

TEST(Smoothing, UnsoundMeshIsInvalidInput) {
  const Mesh sphere = octasphere(1);
  const auto smooth = [&](const Triangles& triangles) {
    return smoothSurface(sphere.points, triangles, optionsOf(SmoothingMethod::Biharmonic));
  };
  EXPECT_NO_THROW(smooth(sphere.triangles));
  // Open.
  EXPECT_THROW(smooth(sphere.triangles.leftCols(sphere.triangles.cols() - 1)), InvalidInput);
  // One triangle turned over.
  Triangles turned = sphere.triangles;
  std::swap(turned(0, 5), turned(1, 5));
  EXPECT_THROW(smooth(turned), InvalidInput);
  // A triangle twice; one that names a vertex twice.
  Triangles repeated(3, sphere.triangles.cols() + 1);
  repeated << sphere.triangles, sphere.triangles.col(0);
  EXPECT_THROW(smooth(repeated), InvalidInput);
  repeated.rightCols(1) << 0, 0, 1;
  EXPECT_THROW(smooth(repeated), InvalidInput);
  repeated.rightCols(1) << 0, 0, 0;
  EXPECT_THROW(smooth(repeated), InvalidInput);
  // The whole mesh twice: two fans at each vertex.
  Triangles twice(3, 2 * sphere.triangles.cols());
  twice << sphere.triangles, sphere.triangles;
  EXPECT_THROW(smooth(twice), InvalidInput);
  // Two tetrahedra at one vertex.
  Triangles pinched(3, 8);
  pinched << 0, 0, 1, 2, 3, 3, 4, 5,  //
      2, 1, 2, 0, 5, 4, 5, 3,         //
      1, 3, 3, 3, 4, 6, 6, 6;
  EXPECT_THROW(smooth(pinched), InvalidInput);
  Triangles out_of_range = sphere.triangles;
  out_of_range(2, 3) = static_cast<Index>(sphere.points.cols());
  EXPECT_THROW(smooth(out_of_range), InvalidInput);
  out_of_range(2, 3) = -1;
  EXPECT_THROW(smooth(out_of_range), InvalidInput);
}

TEST(Smoothing, CoordinatesThatAreNotFiniteAreInvalidInput) {
  const Mesh sphere = octasphere(1);
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Positions points = sphere.points;
    points(1, 4) = value;
    EXPECT_THROW(smoothSurface(points, sphere.triangles, optionsOf(SmoothingMethod::Biharmonic)),
                 InvalidInput);
  }
}

TEST(Smoothing, OptionsOutOfRangeAreInvalidInput) {
  const Mesh sphere = octasphere(1);
  const auto with = [&](const auto& change) {
    SmoothingOptions options;
    change(options);
    return smoothSurface(sphere.points, sphere.triangles, options);
  };
  for (const int steps : {-1, 10001})
    EXPECT_THROW(with([&](SmoothingOptions& o) { o.steps = steps; }), InvalidInput);
  for (const int threads : {-1, 1025})
    EXPECT_THROW(smoothSurface(sphere.points, sphere.triangles, {}, threads), InvalidInput);
}

}  // namespace
}  // namespace spherical_param
