#include "spherical_param/map/morphing.h"

#include "map_shapes.h"
#include "spherical_param/mesh_topology.h"

#include <gtest/gtest.h>

namespace spherical_param {
namespace {

using Eigen::Vector3d;
using test::firstBlob;
using test::Mapped;
using test::nearestTo;
using test::secondBlob;

using Pairs = std::vector<PointPair>;

MorphOptions unaligned(const Pairs& pairs = {}) {
  MorphOptions options;
  options.align = false;
  options.pairs = pairs;
  return options;
}

MorphResult morphOf(const Mapped& first, const Mapped& second, const MorphOptions& options) {
  return morphSurfaces(first.surface(), second.surface(), options);
}

void expectSound(const MorphResult& morph) {
  const auto w = static_cast<Index>(morph.first.cols());
  EXPECT_EQ(morph.second.cols(), w);
  EXPECT_EQ(morph.sphere.cols(), w);
  EXPECT_EQ(morph.first_places.size(), static_cast<std::size_t>(w));
  EXPECT_EQ(morph.second_places.size(), static_cast<std::size_t>(w));
  EXPECT_TRUE(morph.first.allFinite() && morph.second.allFinite());
  EXPECT_LT((morph.sphere.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-12);
  EXPECT_TRUE(test::isSphereOverAll(morph.triangles, w));
}

/// One end of a morph with all vertices is a mesh: each triangle is a part of one of its own. Areas
/// and volumes tell, and that all vertices are there.
void expectEnd(const MorphResult& morph, bool is_first, const Mapped& mesh) {
  const Positions& end = is_first ? morph.first : morph.second;
  const auto& places = is_first ? morph.first_places : morph.second_places;
  for (const auto& point : mesh.points.colwise())
    EXPECT_EQ((end.colwise() - point).colwise().squaredNorm().minCoeff(), 0.0);
  const double area = surfaceArea(mesh.points, mesh.triangles);
  EXPECT_NEAR(surfaceArea(end, morph.triangles), area, 1e-10 * area);
  EXPECT_NEAR(test::volumeOf(end, morph.triangles), test::volumeOf(mesh.points, mesh.triangles),
              1e-10 * area * std::sqrt(area));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Matrix3d corners = mesh.points(Eigen::all, mesh.triangles.col(places[i].triangle));
    ASSERT_LT((corners * places[i].weights - end.col(static_cast<Eigen::Index>(i))).norm(), 1e-12);
  }
}

/// Expects each pair that is possible to be one vertex, and the others none.
void expectPairs(const MorphResult& morph, const Pairs& pairs, const Mapped& first,
                 const Mapped& second) {
  std::set<std::size_t> impossible;
  for (const ImpossiblePair& pair : morph.impossible) {
    impossible.insert(pair.pair);
    EXPECT_NE(pair.reason, "");
  }
  EXPECT_LT(morph.worst_pair, 1e-9);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].first < 0 || pairs[i].first >= first.points.cols() || pairs[i].second < 0 ||
        pairs[i].second >= second.points.cols())
      continue;
    int count = 0;
    for (Eigen::Index v = 0; v < morph.first.cols(); ++v)
      if (morph.first.col(v) == first.points.col(pairs[i].first) &&
          morph.second.col(v) == second.points.col(pairs[i].second))
        ++count;
    EXPECT_EQ(count, impossible.count(i) == 0 ? 1 : 0) << i;
  }
}

/// A morph with all vertices, which has to be sound and to end at both meshes.
MorphResult soundMorphOf(const Mapped& first, const Mapped& second, const MorphOptions& options) {
  MorphResult morph = morphOf(first, second, options);
  expectSound(morph);
  expectEnd(morph, true, first);
  expectEnd(morph, false, second);
  expectPairs(morph, options.pairs, first, second);
  return morph;
}

TEST(Morphing, EndsAreTheMeshes) {
  for (const auto& [a, b] : {std::pair(40, 40), {4, 300}, {300, 8}, {150, 90}}) {
    // The tetrahedron keeps the centre inside.
    const auto mesh_of = [](const test::Blob& blob, Index n, std::uint64_t seed) {
      return blob.over(
          test::horizontally(test::regularTetrahedron(), test::randomSphere(n, seed)).leftCols(n));
    };
    const Mapped first = mesh_of(firstBlob(), a, 5);
    const Mapped second =
        transformed(mesh_of(secondBlob(), b, 6), test::rotationBy(0.3, {1, 2, 3}));
    const MorphResult morph = soundMorphOf(first, second, unaligned());
    EXPECT_TRUE(morph.impossible.empty());
    EXPECT_EQ(morph.rotation, Eigen::Matrix3d::Identity());
    EXPECT_GT(morph.alignment_error, 0.0);
  }
}

TEST(Morphing, ATurnedCopyIsTheSameMesh) {
  const Mapped mesh = firstBlob().over(test::spiralSphere(700));
  const Eigen::Matrix3d rotation = test::rotationBy(2.5, {0.3, 1, 0.5});
  const MorphResult morph = soundMorphOf(mesh, transformed(mesh, rotation), {});
  EXPECT_LT((morph.rotation - rotation).norm(), 1e-6);
  EXPECT_LT(morph.alignment_error, 1e-12);
  // The same place on both: the vertices are one.
  EXPECT_EQ(test::canonical(morph.triangles), test::canonical(mesh.triangles));
  EXPECT_EQ(morph.first, mesh.points);
  EXPECT_EQ(morph.second, mesh.points);
}

TEST(Morphing, MeshesOnCommonGreatCirclesAreLaidOverEachOther) {
  std::vector<Mapped> meshes;
  for (const int parts : {1, 2, 3, 4})
    meshes.push_back(test::octasphere(parts));
  // Turned by an eighth, edges go through vertices.
  meshes.push_back(
      transformed(meshes.back(), test::rotationBy(test::kPi / 4.0, Vector3d::UnitZ())));
  for (const Mapped& first : meshes)
    for (const Mapped& second : meshes) {
      const MorphResult morph = soundMorphOf(first, second, unaligned());
      EXPECT_TRUE(&first != &second || morph.first.cols() == first.points.cols());
    }
}

TEST(Morphing, PairsMayBeFarApartButNotChangePlaces) {
  const Mapped first = firstBlob().over(test::spiralSphere(400));
  const Mapped second = secondBlob().over(test::spiralSphere(500));
  // The bumps of one to those of the other; the motion begins where the rotation ends.
  Pairs pairs;
  for (std::size_t i = 0; i < 3; ++i)
    pairs.push_back(
        {nearestTo(firstBlob().places[i], first), nearestTo(secondBlob().places[i], second)});
  MorphOptions options = unaligned(pairs);
  EXPECT_TRUE(soundMorphOf(first, second, options).impossible.empty());
  options.align = true;
  EXPECT_TRUE(soundMorphOf(first, second, options).impossible.empty());
  // They would meet half way.
  const Mapped dense = firstBlob().over(test::spiralSphere(1000));
  const Index b = nearestTo(test::rotationBy(0.4, {1, 2, 3}) * dense.sphere.col(500), dense);
  const MorphResult morph = soundMorphOf(dense, dense, unaligned({{500, b}, {b, 500}}));
  ASSERT_EQ(morph.impossible.size(), 1U);
  EXPECT_EQ(morph.impossible[0].pair, 1U);
}

TEST(Morphing, PairsThatCannotBeAreSaidToBeAndDoNotAffectTheOthers) {
  const Mapped first = firstBlob().over(test::spiralSphere(300));
  const Mapped second = secondBlob().over(test::spiralSphere(200));
  const MorphResult morph = soundMorphOf(
      first, second,
      unaligned(
          {{10, 7}, {10, 7}, {10, 8}, {11, 7}, {-1, 3}, {3, -1}, {300, 5}, {5, 200}, {250, 160}}));
  std::vector<std::size_t> numbers;
  for (const ImpossiblePair& pair : morph.impossible)
    numbers.push_back(pair.pair);
  EXPECT_EQ(numbers, (std::vector<std::size_t>{2, 3, 4, 5, 6, 7}));
  EXPECT_NE(morph.impossible[0].reason.find("another partner in pair 0"), std::string::npos);
  EXPECT_NE(morph.impossible[4].reason.find("300"), std::string::npos);
  // All of a crowd to places that are mixed: some are in the way of others.
  Pairs crowd;
  for (Index i = 0; i < 12; ++i)
    crowd.push_back({200 + i, 200 + (7 * i + 5) % 12});
  EXPECT_LT(soundMorphOf(firstBlob().over(test::spiralSphere(400)),
                         secondBlob().over(test::spiralSphere(400)), unaligned(crowd))
                .impossible.size(),
            crowd.size());
}

TEST(Morphing, ResampledOnesLieOnBothShapes) {
  const Mapped first = firstBlob().over(test::spiralSphere(2000));
  const Mapped second = secondBlob().over(test::spiralSphere(3000));
  MorphOptions options = unaligned({{100, 200}, {1000, 1500}});
  options.connectivity = MorphConnectivity::Resampled;
  options.samples = 1000;
  const MorphResult morph = morphOf(first, second, options);
  expectSound(morph);
  EXPECT_NEAR(static_cast<double>(morph.first.cols()), 1000.0, 100.0);
  EXPECT_TRUE(morph.impossible.empty());
  expectPairs(morph, options.pairs, first, second);
  for (Eigen::Index i = 0; i < morph.first.cols(); ++i) {
    const Vector3d a = morph.first.col(i);
    const Vector3d b = morph.second.col(i);
    EXPECT_NEAR(a.norm(), firstBlob().radius(a.normalized()), 0.03);
    EXPECT_NEAR(b.norm(), secondBlob().radius(b.normalized()), 0.03);
    EXPECT_LT(a.normalized().cross(morph.sphere.col(i)).norm(), 1e-2);
  }
}

TEST(Morphing, InBetweensAreLinear) {
  const MorphResult morph = morphOf(firstBlob().over(test::spiralSphere(50)),
                                    secondBlob().over(test::spiralSphere(60)), unaligned());
  EXPECT_EQ(inBetween(morph, 0.0), morph.first);
  EXPECT_EQ(inBetween(morph, 1.0), morph.second);
  EXPECT_LT((inBetween(morph, 0.25) - (0.75 * morph.first + 0.25 * morph.second)).norm(), 1e-12);
  EXPECT_LT((inBetween(morph, 2.0) - (2.0 * morph.second - morph.first)).norm(), 1e-12);
}

}  // namespace
}  // namespace spherical_param
