// Ranges of the options of the maps: their ends are taken, what is beyond is refused by name.

#include "map_shapes.h"
#include "spherical_param/errors.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/texture_atlas.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace spherical_param::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr int kMax = std::numeric_limits<int>::max();

/// Of the call: empty, or the message of InvalidInput.
std::string refusalOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

/// Sets an option to values that are taken and to values that are refused by its name.
template <typename Options, typename Base, typename Member>
void expectRange(const std::string& name, Options options, Member Base::*member,
                 const std::function<void(const Options&)>& use, const std::vector<double>& good,
                 const std::vector<double>& bad) {
  const auto refusal = [&](double value) {
    if constexpr (std::is_enum_v<Member>)
      options.*member = static_cast<Member>(static_cast<int>(value));
    else
      options.*member = static_cast<Member>(value);
    return refusalOf([&] { use(options); });
  };
  for (const double value : good)
    EXPECT_EQ(refusal(value), "") << name << " = " << value;
  for (const double value : bad)
    EXPECT_NE(refusal(value).find(name), std::string::npos) << name << " = " << value;
}

TEST(MapOptions, EndsOfTheRangesAreTakenAndWhatIsBeyondIsRefusedByName) {
  for (const Index n : {4, 150}) {
    const Mapped mesh =
        mapped(n == 4 ? Positions(cubeGrid(2)(Eigen::all, std::vector{0, 3, 5, 6}).array() - 0.5)
                            .colwise()
                            .normalized()
                      : randomSphere(n, 7));
    const SphereSurface surface = mesh.surface();
    const TextureAtlas atlas = makeTextureAtlas(mesh.triangles, mesh.sphere);
    const std::function<void(const SphereMapOptions&)> map = [&](const SphereMapOptions& o) {
      computeSphereMap(mesh.points, mesh.triangles, mesh.sphere, o);
    };
    const std::function<void(const SphereSurfaceOptions&)> fit =
        [&](const SphereSurfaceOptions& o) {
          SphereSurface(mesh.points, mesh.triangles, mesh.sphere, o);
        };
    const std::function<void(const MorphOptions&)> morph = [&](const MorphOptions& o) {
      morphSurfaces(surface, surface, o);
    };
    const std::function<void(const TextureAtlasOptions&)> lay_out =
        [&](const TextureAtlasOptions& o) { makeTextureAtlas(mesh.triangles, mesh.sphere, o); };
    const std::function<void(const BakeOptions&)> bake = [&](const BakeOptions& o) {
      bakeCheckerboard(atlas, mesh.sphere, 8, o);
    };
    SphereMapOptions few;
    few.sweeps = 2;
    MorphOptions plain;
    plain.align = false;
    plain.samples = 100;
    const BakeOptions small{16, 0, 0};
    expectRange("area_weight", few, &SphereMapOptions::area_weight, map, {0, kTiny, 1},
                {-kTiny, 1.0000000000000002, kNan});
    expectRange("sweeps", few, &SphereMapOptions::sweeps, map, {0, 1}, {-1, 1001, kMax});
    expectRange("threads", few, &SphereMapOptions::threads, map, {0, 1, 1024}, {-1, 1025, kMax});
    expectRange("fit", SphereSurfaceOptions(), &SphereSurfaceOptions::fit, fit, {0, 1}, {-1, 2});
    expectRange("connectivity", plain, &MorphOptions::connectivity, morph, {0, 1}, {-1, 2});
    expectRange("samples", plain, &MorphOptions::samples, morph, {12}, {0, 11, (1 << 24) + 1});
    expectRange("chart", TextureAtlasOptions(), &TextureAtlasOptions::chart, lay_out, {0, 2},
                {-1, 3});
    expectRange("margin", TextureAtlasOptions(), &TextureAtlasOptions::margin, lay_out, {0, 0.2499},
                {-kTiny, 0.25, kNan});
    expectRange("height", small, &BakeOptions::height, bake, {16, 17}, {15, 16385, kMax});
    expectRange("gutter", small, &BakeOptions::gutter, bake, {0, 256}, {-1, 257, kMax});
    plain.pairs.assign(4097, {});
    EXPECT_NE(refusalOf([&] { morph(plain); }).find("pairs"), std::string::npos);
    plain.pairs = {{std::numeric_limits<Index>::min(), 0}, {0, kMax}, {-1, -1}, {0, 0}};
    EXPECT_EQ(morphSurfaces(surface, surface, plain).impossible.size(), 3U);
  }
}

TEST(MapOptions, AtlasesAndMorphsThatDoNotFitAreInvalidInput) {
  const Mapped mesh = mapped(spiralSphere(30));
  const TextureAtlas good = makeTextureAtlas(mesh.triangles, mesh.sphere);
  std::vector<TextureAtlas> atlases(5, good);
  atlases[0].vertices[3].vertices[1] = -1;
  atlases[1].triangles(0, 0) = static_cast<Index>(good.vertices.size());
  atlases[2].coordinate_triangles(2, 4) = -5;
  atlases[3].coordinates(0, 2) = kNan;
  atlases[4].chart = static_cast<SphereChart>(17);
  for (const TextureAtlas& atlas : atlases)
    EXPECT_THROW(bakeCheckerboard(atlas, mesh.sphere, 8, {16, 0, 0}), InvalidInput);
  MorphResult morph;
  morph.first.resize(3, 4);
  morph.second.resize(3, 5);
  EXPECT_THROW(inBetween(morph, 0.5), InvalidInput);
}

}  // namespace
}  // namespace spherical_param::test
