#include "spherical_param/map/morphing.h"

#include "exact_predicates.h"
#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/sphere_triangulation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

SphereSurfaceOptions linear() {
  SphereSurfaceOptions options;
  options.fit = SurfaceFit::Linear;
  return options;
}

MorphOptions unaligned(std::vector<PointPair> pairs = {}) {
  MorphOptions options;
  options.align = false;
  options.pairs = std::move(pairs);
  return options;
}

MorphOptions resampled(std::size_t samples) {
  MorphOptions options;
  options.connectivity = MorphConnectivity::Resampled;
  options.samples = samples;
  return options;
}

/// A sphere with bumps of different sizes at places without any symmetry.
struct Blob {
  std::vector<Vector3d> places;
  std::vector<double> heights;

  double radius(const Vector3d& u) const {
    double r = 1.0;
    for (std::size_t i = 0; i < places.size(); ++i)
      r += heights[i] * std::exp(-6.0 * (1.0 - u.dot(places[i])));
    return r;
  }
};

Blob firstBlob() {
  return {{Vector3d(1, 0.1, 0.2).normalized(), Vector3d(-0.3, 1, 0.1).normalized(),
           Vector3d(0.4, -0.2, -1).normalized()},
          {1.5, 0.9, 0.5}};
}

Blob secondBlob() {
  return {{Vector3d(0.1, 1, -0.3).normalized(), Vector3d(-1, 0.2, 0.3).normalized(),
           Vector3d(0.1, 0.1, 1).normalized(), Vector3d(0.8, -0.7, 0).normalized()},
          {1.3, 1.0, 0.4, -0.3}};
}

/// A mesh with its map.
struct Mapped {
  Positions points;
  Triangles triangles;
  Positions sphere;

  SphereSurface surface() const { return {points, triangles, sphere, linear()}; }
};

Mapped meshOf(const Blob& blob, const Positions& sphere) {
  Mapped mesh{sphere, triangulateSphere(sphere).triangles, sphere};
  for (Eigen::Index i = 0; i < sphere.cols(); ++i)
    mesh.points.col(i) *= blob.radius(sphere.col(i));
  return mesh;
}

/// Faces of an octahedron in parts: edges of many sizes on few great circles.
Mapped octahedralMesh(int parts) {
  std::vector<Vector3d> places;
  for (int x = -parts; x <= parts; ++x)
    for (int y = -parts; y <= parts; ++y)
      for (int z = -parts; z <= parts; ++z)
        if (std::abs(x) + std::abs(y) + std::abs(z) == parts)
          places.emplace_back(Vector3d(x, y, z).normalized());
  Mapped mesh;
  mesh.sphere.resize(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    mesh.sphere.col(static_cast<Eigen::Index>(i)) = places[i];
  mesh.points = mesh.sphere;
  mesh.triangles = triangulateSphere(mesh.sphere).triangles;
  return mesh;
}

Matrix3d rotationBy(double angle, const Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

std::vector<std::array<double, 3>> columnsOf(const Positions& positions) {
  std::vector<std::array<double, 3>> columns;
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    columns.push_back({positions(0, i), positions(1, i), positions(2, i)});
  std::sort(columns.begin(), columns.end());
  return columns;
}

bool hasAllColumns(const Positions& some, const Positions& all) {
  const auto wanted = columnsOf(some);
  const auto given = columnsOf(all);
  return std::includes(given.begin(), given.end(), wanted.begin(), wanted.end());
}

/// Vertices of a morph that are a vertex of the first mesh at one end, and of the second at the
/// other.
int countPair(const MorphResult& morph, const Vector3d& first, const Vector3d& second) {
  int count = 0;
  for (Eigen::Index i = 0; i < morph.first.cols(); ++i)
    count += morph.first.col(i) == first && morph.second.col(i) == second ? 1 : 0;
  return count;
}

void expectSound(const MorphResult& morph) {
  const auto w = static_cast<Index>(morph.first.cols());
  EXPECT_EQ(morph.second.cols(), w);
  EXPECT_EQ(morph.sphere.cols(), w);
  EXPECT_EQ(morph.first_places.size(), static_cast<std::size_t>(w));
  EXPECT_EQ(morph.second_places.size(), static_cast<std::size_t>(w));
  EXPECT_TRUE(morph.first.allFinite());
  EXPECT_TRUE(morph.second.allFinite());
  EXPECT_LT((morph.sphere.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-12);
  EXPECT_TRUE(test::isSphereOverAll(morph.triangles, w));
}

/// The ends of a morph with all vertices are the meshes: each triangle is a part of one of theirs.
/// Areas and volumes tell, and that all vertices are there.
void expectEnds(const MorphResult& morph, const Mapped& first, const Mapped& second) {
  const auto expectEnd = [&](const Positions& end, const Mapped& mesh) {
    EXPECT_TRUE(hasAllColumns(mesh.points, end));
    const double area = surfaceArea(mesh.points, mesh.triangles);
    EXPECT_NEAR(surfaceArea(end, morph.triangles), area, 1e-10 * area);
    EXPECT_NEAR(test::volumeOf(end, morph.triangles), test::volumeOf(mesh.points, mesh.triangles),
                1e-10 * area * std::sqrt(area));
  };
  expectEnd(morph.first, first);
  expectEnd(morph.second, second);
}

/// Edges of two triangulations that cross, by all pairs.
int crossingsOf(const Positions& first, const Triangles& first_triangles, const Positions& second,
                const Triangles& second_triangles) {
  const auto side = [](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    return internal::orientation3d(Vector3d::Zero(), a, b, c);
  };
  const auto edgesOf = [](const Triangles& triangles) {
    std::vector<std::array<Index, 2>> edges;
    for (Eigen::Index t = 0; t < triangles.cols(); ++t)
      for (int k = 0; k < 3; ++k)
        if (triangles(k, t) < triangles((k + 1) % 3, t))
          edges.push_back({triangles(k, t), triangles((k + 1) % 3, t)});
    return edges;
  };
  int count = 0;
  for (const auto& e : edgesOf(first_triangles))
    for (const auto& f : edgesOf(second_triangles)) {
      const Vector3d a = first.col(e[0]);
      const Vector3d b = first.col(e[1]);
      const Vector3d c = second.col(f[0]);
      const Vector3d d = second.col(f[1]);
      const int of_c = side(a, b, c);
      // On opposite sides of each other, and not by their antipodes.
      count += of_c == -side(a, b, d) && side(c, d, a) == -of_c && side(c, d, b) == of_c ? 1 : 0;
    }
  return count;
}

TEST(Morphing, FindsTheRotationOfACopy) {
  const Mapped mesh = meshOf(firstBlob(), test::spiralSphere(700));
  const SphereSurface surface = mesh.surface();
  int turn = 0;
  for (const double angle : {0.01, 2.5}) {
    const Matrix3d rotation = rotationBy(angle, Vector3d(0.3, std::cos(turn), std::sin(turn)));
    ++turn;
    Mapped other = mesh;
    other.sphere = (rotation * other.sphere).colwise().normalized();
    const MorphResult morph = morphSurfaces(surface, other.surface());
    EXPECT_LT((morph.rotation - rotation).norm(), 1e-6) << angle;
    EXPECT_LT(morph.alignment_error, 1e-12);
    expectSound(morph);
    // The same place on both: the vertices are one.
    EXPECT_EQ(morph.first.cols(), mesh.points.cols());
    EXPECT_EQ(morph.first, morph.second);
  }
}

TEST(Morphing, FindsTheRotationOfAnotherSampling) {
  const Matrix3d rotation = rotationBy(2.2, {0.2, -1.0, 0.4});
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(3000));
  Mapped second = meshOf(firstBlob(), rotationBy(1.0, {1, 1, 0}) * test::spiralSphere(2500));
  second.points = (7.0 * second.points).colwise() + Vector3d(3, -50, 8);  // size and place are free
  second.sphere = (rotation * second.sphere).colwise().normalized();
  const MorphResult morph = morphSurfaces(first.surface(), second.surface());
  EXPECT_LT((morph.rotation - rotation).norm(), 1e-2);
  EXPECT_LT(morph.alignment_error, 1e-4);
}

TEST(Morphing, NoOtherRotationIsBetter) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(1500));
  const Mapped second = meshOf(secondBlob(), test::spiralSphere(1300));
  const MorphResult morph = morphSurfaces(first.surface(), second.surface());

  // The same integral over the true shapes: vertices count as much as a third of their triangles.
  struct Samples {
    Positions directions, points;
    std::vector<double> weights;
    Vector3d center = Vector3d::Zero();
    double scale = 1.0;
  };
  const auto samplesOf = [](const Blob& blob) {
    const Mapped mesh = meshOf(blob, test::spiralSphere(400));
    Samples samples{mesh.sphere, mesh.points, std::vector<double>(400, 0.0)};
    const double area = surfaceArea(mesh.points, mesh.triangles);
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
      for (int k = 0; k < 3; ++k)
        samples.weights[static_cast<std::size_t>(mesh.triangles(k, t))] +=
            surfaceArea(mesh.points, mesh.triangles.col(t)) / 3.0 / area;
    for (Eigen::Index i = 0; i < 400; ++i)
      samples.center += samples.weights[static_cast<std::size_t>(i)] * mesh.points.col(i);
    samples.scale = 1.0 / std::sqrt(area);
    return samples;
  };
  const Samples of_first = samplesOf(firstBlob());
  const Samples of_second = samplesOf(secondBlob());
  const auto half = [](const Samples& one, const Samples& other, const Blob& blob,
                       const Matrix3d& rotation) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < one.points.cols(); ++i) {
      const Vector3d u = rotation * one.directions.col(i);
      sum += one.weights[static_cast<std::size_t>(i)] *
             (one.scale * (one.points.col(i) - one.center) -
              other.scale * (blob.radius(u) * u - other.center))
                 .squaredNorm();
    }
    return sum;
  };
  const auto errorOf = [&](const Matrix3d& rotation) {
    return 0.5 * (half(of_first, of_second, secondBlob(), rotation) +
                  half(of_second, of_first, firstBlob(), rotation.transpose()));
  };
  const double found = errorOf(morph.rotation);
  EXPECT_NEAR(found, morph.alignment_error, 0.02 * found);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2500; ++i)
    best = std::min(best, errorOf(Eigen::Quaterniond(normal(random), normal(random), normal(random),
                                                     normal(random))
                                      .normalized()
                                      .toRotationMatrix()));
  for (int i = 0; i < 500; ++i)
    best = std::min(best, errorOf(rotationBy(0.1 * normal(random),
                                             {normal(random), normal(random), normal(random)}) *
                                  morph.rotation));
  // Both integrals have errors of their own.
  EXPECT_LT(found, best * 1.002);
}

TEST(Morphing, ExchangingTheSurfacesInvertsTheRotation) {
  const SphereSurface first = meshOf(firstBlob(), test::spiralSphere(900)).surface();
  const SphereSurface second = meshOf(secondBlob(), test::spiralSphere(1100)).surface();
  const MorphResult there = morphSurfaces(first, second);
  const MorphResult back = morphSurfaces(second, first);
  EXPECT_NEAR(there.alignment_error, back.alignment_error, 1e-9);
  EXPECT_LT((there.rotation * back.rotation - Matrix3d::Identity()).norm(), 1e-5);
}

TEST(Morphing, WithoutAlignmentTheMapsAreAsTheyAre) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(300));
  const Mapped second = meshOf(secondBlob(), test::randomSphere(300, 1));
  const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned());
  EXPECT_EQ(morph.rotation, Matrix3d::Identity());
  EXPECT_GT(morph.alignment_error, 0.0);
  for (Eigen::Index i = 0; i < morph.sphere.cols(); ++i) {
    EXPECT_LT(morph.first.col(i).normalized().cross(morph.sphere.col(i)).norm(), 0.3);
    EXPECT_GT(morph.first.col(i).dot(morph.second.col(i)), 0.0);
  }
}

TEST(Morphing, EndsAreTheMeshes) {
  for (const auto& [a, b] :
       {std::pair(40, 40), std::pair(4, 300), std::pair(900, 5), std::pair(700, 800)}) {
    const Mapped first = meshOf(firstBlob(), test::randomSphere(a, 5));
    const Mapped second = meshOf(secondBlob(), test::randomSphere(b, 6));
    if (first.triangles.cols() != 2 * a - 4)
      continue;
    const auto covers = [](const Mapped& mesh) {
      for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
        if (internal::orientation3d(Vector3d::Zero(), mesh.sphere.col(mesh.triangles(0, t)),
                                    mesh.sphere.col(mesh.triangles(1, t)),
                                    mesh.sphere.col(mesh.triangles(2, t))) <= 0)
          return false;
      return true;
    };
    if (!covers(first) || !covers(second))
      continue;  // few random points may leave a half sphere empty
    const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned());
    expectSound(morph);
    expectEnds(morph, first, second);
    EXPECT_TRUE(morph.impossible.empty());
  }
}

TEST(Morphing, CrossingsAreThoseOfAllPairsOfEdges) {
  const Mapped first = meshOf(firstBlob(), test::randomSphere(150, 11));
  const Mapped second = meshOf(secondBlob(), test::randomSphere(90, 12));
  const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned());
  expectSound(morph);
  // Vertices that became one do not count twice, nor the crossings beside them.
  const int crossings = crossingsOf(first.sphere, first.triangles, second.sphere, second.triangles);
  EXPECT_LE(morph.first.cols(), 150 + 90 + crossings);
  EXPECT_GT(morph.first.cols(), 0.9 * (150 + 90 + crossings));
}

TEST(Morphing, MeshesOnCommonGreatCirclesAreLaidOverEachOther) {
  std::vector<Mapped> meshes;
  for (const int parts : {1, 2, 3, 4, 6})
    meshes.push_back(octahedralMesh(parts));
  // Turned by an eighth, edges go through vertices.
  Mapped turned = octahedralMesh(4);
  turned.sphere =
      (rotationBy(test::kPi / 4.0, Vector3d::UnitZ()) * turned.sphere).colwise().normalized();
  meshes.push_back(turned);
  for (const Mapped& first : meshes)
    for (const Mapped& second : meshes) {
      const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned());
      expectSound(morph);
      expectEnds(morph, first, second);
    }
}

TEST(Morphing, AMeshOverItselfIsItself) {
  const Mapped mesh = meshOf(firstBlob(), test::randomSphere(500, 2));
  const MorphResult morph = morphSurfaces(mesh.surface(), mesh.surface(), unaligned());
  EXPECT_EQ(morph.first, mesh.points);
  EXPECT_EQ(morph.second, mesh.points);
  EXPECT_EQ(test::canonical(morph.triangles), test::canonical(mesh.triangles));
  EXPECT_LT(morph.alignment_error, 1e-20);
}

TEST(Morphing, PairsAreOneVertex) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(1200));
  const Mapped second = meshOf(secondBlob(), test::randomSphere(1000, 7));
  std::mt19937_64 random(8);
  for (const std::size_t count : {1U, 2U, 7U, 60U}) {
    std::vector<PointPair> pairs;
    std::set<Index> used;
    while (pairs.size() < count) {
      // Each to one of those near it, but not the nearest.
      const auto a = static_cast<Index>(random() % 1200);
      std::vector<std::pair<double, Index>> near;
      for (Index b = 0; b < 1000; ++b)
        near.emplace_back((second.sphere.col(b) - first.sphere.col(a)).norm(), b);
      std::sort(near.begin(), near.end());
      const Index b = near[count < 10 ? 40 : 2].second;
      bool is_apart = true;
      for (const PointPair& pair : pairs)
        is_apart = is_apart && (first.sphere.col(a) - first.sphere.col(pair.first)).norm() > 0.15;
      if (is_apart && used.insert(b).second)
        pairs.push_back({a, b});
    }
    const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned(pairs));
    EXPECT_TRUE(morph.impossible.empty())
        << morph.impossible.size() << " of " << count << ", " << morph.impossible[0].reason;
    EXPECT_LT(morph.worst_pair, 1e-9);
    for (const PointPair& pair : pairs)
      EXPECT_EQ(countPair(morph, first.points.col(pair.first), second.points.col(pair.second)), 1);
    expectSound(morph);
    expectEnds(morph, first, second);
  }
}

TEST(Morphing, PairsMayBeFarApart) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(800));
  const Mapped second = meshOf(secondBlob(), test::spiralSphere(900));
  // The bumps of one to those of the other.
  const auto nearest = [](const Mapped& mesh, const Vector3d& place) {
    Eigen::Index i = 0;
    (mesh.sphere.transpose() * place).maxCoeff(&i);
    return static_cast<Index>(i);
  };
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < 3; ++i)
    pairs.push_back(
        {nearest(first, firstBlob().places[i]), nearest(second, secondBlob().places[i])});
  for (const bool align : {false, true}) {
    MorphOptions options = unaligned(pairs);
    options.align = align;
    const MorphResult morph = morphSurfaces(first.surface(), second.surface(), options);
    EXPECT_TRUE(morph.impossible.empty());
    for (const PointPair& pair : pairs)
      EXPECT_EQ(countPair(morph, first.points.col(pair.first), second.points.col(pair.second)), 1);
    expectSound(morph);
    expectEnds(morph, first, second);
  }
}

TEST(Morphing, TwoNeighborsMayChangePlaces) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(2000));
  const Mapped second = meshOf(firstBlob(), test::spiralSphere(2000));
  Eigen::Index other = 0;
  (first.sphere.colwise() - rotationBy(0.4, {1, 2, 3}) * first.sphere.col(1000))
      .colwise()
      .norm()
      .minCoeff(&other);
  const auto b = static_cast<Index>(other);
  const std::vector<PointPair> pairs{{1000, b}, {b, 1000}};
  const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned(pairs));
  // Around each other: they would meet half way.
  ASSERT_TRUE(morph.impossible.empty()) << morph.impossible[0].reason;
  for (const PointPair& pair : pairs)
    EXPECT_EQ(countPair(morph, first.points.col(pair.first), second.points.col(pair.second)), 1);
  expectSound(morph);
  expectEnds(morph, first, second);
}

TEST(Morphing, PairsThatCannotBeAreSaidToBe) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(300));
  const Mapped second = meshOf(secondBlob(), test::spiralSphere(200));
  const std::vector<PointPair> pairs{{10, 7}, {10, 7},  {10, 8},  {11, 7},   {-1, 3},
                                     {3, -1}, {300, 5}, {5, 200}, {250, 160}};
  const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned(pairs));
  std::vector<std::size_t> numbers;
  for (const ImpossiblePair& pair : morph.impossible) {
    numbers.push_back(pair.pair);
    EXPECT_FALSE(pair.reason.empty());
  }
  EXPECT_EQ(numbers, (std::vector<std::size_t>{2, 3, 4, 5, 6, 7}));
  EXPECT_NE(morph.impossible[0].reason.find("another partner in pair 0"), std::string::npos);
  EXPECT_NE(morph.impossible[4].reason.find("300"), std::string::npos);
  for (const PointPair& pair : {pairs[0], pairs[8]})
    EXPECT_EQ(countPair(morph, first.points.col(pair.first), second.points.col(pair.second)), 1);
  expectSound(morph);
}

TEST(Morphing, PairsThatCannotBeMetDoNotAffectTheOthers) {
  // All of a crowd to places that are mixed at random: some are in the way of others.
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(400));
  const Mapped second = meshOf(secondBlob(), test::spiralSphere(400));
  std::vector<PointPair> pairs;
  for (Index i = 0; i < 12; ++i)
    pairs.push_back({200 + i, 200 + (7 * i + 5) % 12});
  const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned(pairs));
  std::set<std::size_t> impossible;
  for (const ImpossiblePair& pair : morph.impossible)
    impossible.insert(pair.pair);
  EXPECT_LT(impossible.size(), pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    EXPECT_EQ(
        countPair(morph, first.points.col(pairs[i].first), second.points.col(pairs[i].second)),
        impossible.count(i) == 0 ? 1 : 0);
  expectSound(morph);
  expectEnds(morph, first, second);
}

TEST(Morphing, ResampledOnesLieOnBothShapes) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(3000));
  const Mapped second = meshOf(secondBlob(), test::spiralSphere(4000));
  const std::vector<PointPair> pairs{{100, 130}, {2000, 2700}};
  MorphOptions options = resampled(1000);
  options.align = false;
  options.pairs = pairs;
  const MorphResult morph = morphSurfaces(first.surface(), second.surface(), options);
  expectSound(morph);
  EXPECT_NEAR(static_cast<double>(morph.first.cols()), 1000.0, 100.0);
  EXPECT_TRUE(morph.impossible.empty());
  for (const PointPair& pair : pairs)
    EXPECT_EQ(countPair(morph, first.points.col(pair.first), second.points.col(pair.second)), 1);
  for (Eigen::Index i = 0; i < morph.first.cols(); ++i)
    for (const auto& [points, blob] :
         {std::pair(&morph.first, firstBlob()), std::pair(&morph.second, secondBlob())}) {
      const Vector3d point = points->col(i);
      EXPECT_NEAR(point.norm(), blob.radius(point.normalized()), 0.02);
    }
}

TEST(Morphing, TheSameBitsForAnyNumberOfThreads) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(3000));
  const Mapped second = meshOf(secondBlob(), test::spiralSphere(2500));
  MorphOptions options;
  options.pairs = {{100, 90}, {1500, 1240}, {2900, 2400}};
  std::vector<MorphResult> results;
  for (const int threads : {1, 2, 3}) {
    options.threads = threads;
    results.push_back(morphSurfaces(first.surface(), second.surface(), options));
  }
  for (const MorphResult& result : results) {
    EXPECT_EQ(result.rotation, results[0].rotation);
    EXPECT_EQ(result.alignment_error, results[0].alignment_error);
    EXPECT_EQ(result.first, results[0].first);
    EXPECT_EQ(result.second, results[0].second);
    EXPECT_EQ(result.sphere, results[0].sphere);
    EXPECT_EQ(result.triangles, results[0].triangles);
    EXPECT_EQ(result.worst_pair, results[0].worst_pair);
  }
}

TEST(Morphing, InBetweensAreLinear) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(50));
  const Mapped second = meshOf(secondBlob(), test::spiralSphere(60));
  const MorphResult morph = morphSurfaces(first.surface(), second.surface(), unaligned());
  EXPECT_EQ(inBetween(morph, 0.0), morph.first);
  EXPECT_EQ(inBetween(morph, 1.0), morph.second);
  EXPECT_LT((inBetween(morph, 0.25) - (0.75 * morph.first + 0.25 * morph.second)).norm(), 1e-12);
  EXPECT_LT((inBetween(morph, 2.0) - (2.0 * morph.second - morph.first)).norm(), 1e-12);
  EXPECT_THROW(inBetween(morph, std::numeric_limits<double>::quiet_NaN()), InvalidInput);
  EXPECT_THROW(inBetween(morph, std::numeric_limits<double>::infinity()), InvalidInput);
}

TEST(Morphing, OptionsOutOfRangeAreRefused) {
  const Mapped mesh = meshOf(firstBlob(), test::spiralSphere(50));
  const SphereSurface surface = mesh.surface();
  const auto refuses = [&](const MorphOptions& options, const std::string& word) {
    try {
      morphSurfaces(surface, surface, options);
    } catch (const InvalidInput& error) {
      return std::string(error.what()).find(word) != std::string::npos;
    }
    return false;
  };
  for (const std::size_t samples : {std::size_t{0}, std::size_t{11}, (std::size_t{1} << 24U) + 1})
    EXPECT_TRUE(refuses(resampled(samples), "samples"));
  for (const int threads : {-1, 1025}) {
    MorphOptions options;
    options.threads = threads;
    EXPECT_TRUE(refuses(options, "threads"));
  }
  EXPECT_TRUE(refuses(unaligned(std::vector<PointPair>(4097)), "pairs"));
}

TEST(Morphing, ProgressNeverFallsAndMayCancel) {
  const Mapped first = meshOf(firstBlob(), test::spiralSphere(300));
  const Mapped second = meshOf(secondBlob(), test::spiralSphere(400));
  MorphOptions options;
  options.pairs = {{1, 2}, {200, 300}};
  const std::vector<double> fractions = test::fractionsOf([&](const auto& progress) {
    options.progress = test::reportingTo(progress).progress;
    morphSurfaces(first.surface(), second.surface(), options);
  });
  EXPECT_TRUE(test::areFractions(fractions));
  EXPECT_EQ(fractions.back(), 1.0);
  for (const std::size_t calls : {std::size_t{1}, fractions.size() / 2}) {
    std::size_t count = 0;
    options.progress = [&](const Progress&) { return ++count < calls; };
    EXPECT_THROW(morphSurfaces(first.surface(), second.surface(), options), Cancelled);
  }
}

}  // namespace
}  // namespace spherical_param
