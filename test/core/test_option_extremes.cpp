// Values at the ends of their ranges and beyond, of stages that are called by themselves, and data
// that do not fit. Options of reconstruct(): see test_option_table.cpp.

#include "helpers.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/sphere_map.h"
#include "spherical_param/map/texture_atlas.h"
#include "outliers.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/self_intersection.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr int kLeastInt = std::numeric_limits<int>::min();
constexpr int kMostInt = std::numeric_limits<int>::max();

/// What came of a call: empty if it went well, else the message of InvalidInput.
template <typename Call>
std::string refusalOf(const Call& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

/// A setting of one stage, with values that are taken and values that are refused by name.
struct Setting {
  std::string name;
  std::function<void(double)> use;
  std::vector<double> good;
  std::vector<double> bad;
};

void expectRanges(const std::vector<Setting>& settings) {
  for (const Setting& setting : settings) {
    for (const double value : setting.good)
      EXPECT_EQ(refusalOf([&] { setting.use(value); }), "") << setting.name << " = " << value;
    for (const double value : setting.bad)
      EXPECT_NE(refusalOf([&] { setting.use(value); }).find(setting.name), std::string::npos)
          << setting.name << " = " << value;
  }
}

/// Sets one member of options and uses them.
template <typename Options, typename Base, typename Member, typename Use>
std::function<void(double)> with(Options options, Member Base::*member, const Use& use) {
  return [=](double value) mutable {
    if constexpr (std::is_enum_v<Member>)
      options.*member = static_cast<Member>(static_cast<int>(value));
    else
      options.*member = static_cast<Member>(value);
    use(options);
  };
}

Positions onSphere(Index n) {
  constexpr double a = 0.57735026918962576;
  return n == 4 ? Positions{{a, a, -a, -a}, {a, -a, a, -a}, {a, -a, -a, a}}
                : test::randomSphere(n, 7);
}

/// A cloud with its sphere, its triangles and its graph.
struct Cloud {
  explicit Cloud(Index n)
      : points(onSphere(n)), lists(test::bruteForceNeighbors(points, 8)),
        graph(test::graphOf(points, lists).graph),
        triangles(triangulateSphere(points)), surface(points, triangles, points),
        atlas(makeTextureAtlas(triangles, points)) {}
  Positions points;
  NeighborLists lists;
  Graph graph;
  Triangles triangles;
  SphereSurface surface;
  TextureAtlas atlas;
};

class Extremes : public testing::TestWithParam<Index> {
protected:
  const Cloud cloud{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Clouds, Extremes, testing::Values(4, 150),
                         testing::PrintToStringParamName());

TEST_P(Extremes, AreTakenOrRefusedByName) {
  const auto build = [this](const GraphOptions& o) {
    test::graphOf(cloud.points, cloud.lists, o);
  };
  const auto outliers = [this](const OutlierOptions& o) {
    findOutliers(cloud.points, cloud.lists, o);
  };
  const auto smooth = [this](const SmoothingOptions& o) {
    EXPECT_TRUE(smoothSurface(cloud.points, cloud.triangles, o).points.allFinite());
  };
  const auto map = [this](const SphereMapOptions& o) {
    const SphereMap made = computeSphereMap(cloud.points, cloud.triangles, cloud.points, o);
    EXPECT_EQ(made.distortion.flipped_triangles, 0);
  };
  const auto continued = [this](const SphereSurfaceOptions& o) {
    const SphereSurface made(cloud.points, cloud.triangles, cloud.points, o);
    made.evaluate(Eigen::Vector3d(kTiny, 0.0, 0.0));
    made.evaluate(Eigen::Vector3d(1e308, -1e308, kTiny));
  };
  const auto morph = [this](const MorphOptions& o) {
    const MorphResult made = morphSurfaces(cloud.surface, cloud.surface, o);
    EXPECT_TRUE(test::isSphereOverAll(made.triangles, static_cast<Index>(made.first.cols())));
  };
  const auto lay_out = [this](const TextureAtlasOptions& o) {
    makeTextureAtlas(cloud.triangles, cloud.points, o);
    chartCoordinates(o, Eigen::Vector3d(0.0, kTiny, -1e308));
  };
  const auto bake = [this](const BakeOptions& o) {
    bakeCheckerboard(cloud.atlas, cloud.points, 8, o);
  };
  SphereMapOptions few;
  few.sweeps = 2;
  MorphOptions plain;
  plain.align = false;
  plain.samples = 100;
  const BakeOptions small{16, 0, 0};
  const std::vector<double> no_threads{-1, 1025, kLeastInt, kMostInt};
  const std::vector<double> past_2{-1, 2, kLeastInt, kMostInt};
  expectRanges({
      {"k",
       [&](double k) {
         build({GraphMethod::LocalDelaunay, static_cast<int>(k)});
       },
       {3, kMostInt},
       {2, kLeastInt}},
      {"agreement", with(GraphOptions(), &GraphOptions::agreement, build), {0, 1}, past_2},
      {"sigma",
       with(OutlierOptions(), &OutlierOptions::sigma, outliers),
       {0, 1000},
       {-kTiny, 1000.1, kInfinity, kNan}},
      {"k", with(OutlierOptions(), &OutlierOptions::k, outliers), {3, kMostInt}, {2, kLeastInt}},
      {"least_score",
       with(OutlierOptions(), &OutlierOptions::least_score, outliers),
       {0, 1e308},
       {-kTiny, kInfinity, kNan}},
      {"method", with(SmoothingOptions(), &SmoothingOptions::method, smooth), {0, 1}, past_2},
      {"smoothing",
       with(SmoothingOptions(), &SmoothingOptions::steps, smooth),
       {0, 10000},
       {-1, 10001, kLeastInt, kMostInt}},
      {"area_weight",
       with(few, &SphereMapOptions::area_weight, map),
       {0, kTiny, 1},
       {-kTiny, 1.0000000000000002, kInfinity, kNan}},
      {"sweeps",
       with(few, &SphereMapOptions::sweeps, map),
       {0, 1},
       {-1, 1001, kLeastInt, kMostInt}},
      {"threads", with(few, &SphereMapOptions::threads, map), {0, 1, 1024}, no_threads},
      {"fit", with(SphereSurfaceOptions(), &SphereSurfaceOptions::fit, continued), {0, 1}, past_2},
      {"threads",
       with(SphereSurfaceOptions(), &SphereSurfaceOptions::threads, continued),
       {0, 1, 1024},
       no_threads},
      {"connectivity", with(plain, &MorphOptions::connectivity, morph), {0, 1}, past_2},
      {"threads", with(plain, &MorphOptions::threads, morph), {0, 1, 1024}, no_threads},
      {"samples", with(plain, &MorphOptions::samples, morph), {12}, {0, 11, (1 << 24) + 1, 1e19}},
      {"chart",
       with(TextureAtlasOptions(), &TextureAtlasOptions::chart, lay_out),
       {0, 2},
       {-1, 3, kLeastInt, kMostInt}},
      {"margin",
       with(TextureAtlasOptions(), &TextureAtlasOptions::margin, lay_out),
       {0, 0.2499},
       {-kTiny, 0.25, kInfinity, kNan}},
      {"height",
       with(small, &BakeOptions::height, bake),
       {16, 17},
       {15, 16385, kLeastInt, kMostInt}},
      {"gutter", with(small, &BakeOptions::gutter, bake), {0, 256}, {-1, 257, kLeastInt, kMostInt}},
      {"threads", with(small, &BakeOptions::threads, bake), {0, 1, 1024}, no_threads},
  });
  plain.pairs.assign(4097, {});
  EXPECT_NE(refusalOf([&] { morph(plain); }).find("pairs"), std::string::npos);
  plain.pairs = {{kLeastInt, 0}, {0, kMostInt}, {-1, -1}, {0, 0}};
  EXPECT_EQ(morphSurfaces(cloud.surface, cloud.surface, plain).impossible.size(), 3U);
}

TEST(Threads, OutOfRangeAreRefusedByEveryStageWhateverItsInput) {
  const Cloud c(150);
  const Positions no_points(3, 0);
  const Triangles none(3, 0);
  const std::vector<std::function<void(const Execution&)>> stages{
      [&](const Execution& e) { findNearestNeighbors(no_points, 12, e); },
      [&](const Execution& e) { makeNeighborSearch(c.points, e); },
      [&](const Execution& e) { findNearestNeighbors(c.points, 12, e); },
      [&](const Execution& e) { test::graphOf(c.points, c.lists, {}, {}, e); },
      [&](const Execution& e) { test::graphOf(c.points, c.lists, test::nearest(), {}, e); },
      [&](const Execution& e) { embed(c.graph, c.points, {}, 1, e); },
      [&](const Execution& e) { embed(Graph(), no_points, {}, 1, e); },
      [&](const Execution& e) { triangulateSphere(c.points, {}, e); },
      [&](const Execution& e) { optimizeMesh(c.points, c.triangles, c.graph, {}, 1, e); },
      [&](const Execution& e) { findSelfIntersections(c.points, c.triangles, e); },
      [&](const Execution& e) { findSelfIntersections(c.points, none, e); },
      [&](const Execution& e) { findSelfIntersectionsOf(c.points, c.triangles, {}, e); },
      [&](const Execution& e) { findOutliers(c.points, c.lists, {}, e); },
      [&](const Execution& e) { findOutliers(no_points, {}, e); },
      [&](const Execution& e) { smoothSurface(c.points, c.triangles, {}, e.threads); },
      [&](const Execution& e) { smoothSurface(c.points, none, {}, e.threads); },
      [&](const Execution& e) { checkTopology(c.triangles, 150, e.threads); },
      [&](const Execution& e) { measureMesh(c.points, c.triangles, e.threads); },
      [&](const Execution& e) {
        diagnoseSurface(c.points, c.triangles, c.graph, {}, {}, e.threads);
      },
      [&](const Execution& e) { measureMapDistortion(c.points, none, c.points, e.threads); }};
  for (std::size_t i = 0; i < stages.size(); ++i) {
    SCOPED_TRACE(i);
    expectRanges({{"threads",
                   [&](double threads) {
                     stages[i]({static_cast<int>(threads), {}});
                   },
                   {0, 1, 1024},
                   {-1, 1025, kLeastInt, kMostInt}}});
  }
}

TEST(BrokenData, GraphsMeshesAndAtlasesThatDoNotFitAreInvalidInput) {
  const Cloud good(30);
  std::vector<Graph> graphs(10, good.graph);
  graphs[0].offsets.clear();
  graphs[1].lengths.pop_back();
  graphs[2].neighbors[5] = 30;
  graphs[3].neighbors[5] = -1;
  std::swap(graphs[4].offsets[3], graphs[4].offsets[4]);
  graphs[5].offsets[0] = 1;
  // Paths over negative lengths would get shorter forever.
  graphs[6].lengths[7] = -1.0;
  graphs[7].lengths[7] = -std::numeric_limits<double>::min();
  graphs[8].lengths[7] = kInfinity;
  graphs[9].lengths[7] = kNan;
  for (std::size_t i = 0; i < graphs.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_THROW(embed(graphs[i], good.points), InvalidInput);
    EXPECT_THROW(meanTangentialLaplacian(graphs[i], good.points, {}), InvalidInput);
    EXPECT_THROW(optimizeMesh(good.points, good.triangles, graphs[i]), InvalidInput);
  }
  for (const Index index : {-1, 30, kLeastInt, kMostInt}) {
    Triangles triangles = good.triangles;
    triangles(1, 7) = index;
    EXPECT_THROW(signedVolume(good.points, triangles), InvalidInput) << index;
    EXPECT_THROW(surfaceArea(good.points, triangles), InvalidInput) << index;
    EXPECT_THROW(areaWeightedNormals(good.points, triangles), InvalidInput) << index;
  }
  std::vector<TextureAtlas> atlases(5, good.atlas);
  atlases[0].vertices[3].vertices[1] = -1;
  atlases[1].triangles(0, 0) = static_cast<Index>(good.atlas.vertices.size());
  atlases[2].coordinate_triangles(2, 4) = -5;
  atlases[3].coordinates(0, 2) = kNan;
  atlases[4].chart = static_cast<SphereChart>(17);
  for (const TextureAtlas& atlas : atlases)
    EXPECT_THROW(bakeCheckerboard(atlas, good.points, 8, {16, 0, 0}), InvalidInput);
  MorphResult morph;
  morph.first.resize(3, 4);
  morph.second.resize(3, 5);
  EXPECT_THROW(inBetween(morph, 0.5), InvalidInput);
  EXPECT_THROW(makeNeighborSearch(Positions(3, 0)), InvalidInput);
  const NeighborSearch search = makeNeighborSearch(good.points);
  EXPECT_EQ(search({0, 29}, 3).size(), 2U);
  for (const Index query : {-1, 30})
    EXPECT_THROW(search({query}, 3), InvalidInput) << query;
}

}  // namespace
}  // namespace spherical_param
