// What public functions refuse, each with its reason: points, meshes and maps that are wrong,
// arguments that do not fit, numbers beyond their ranges, of which the ends are taken.

#include "public_functions.h"

namespace spherical_param::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr int kMax = std::numeric_limits<int>::max();

void expectReason(const std::string& reason, const std::function<void()>& call) {
  EXPECT_NE(refusalOf(call).find(reason), std::string::npos) << reason << ": " << refusalOf(call);
}

/// With a remedy.
void expectRefused(const std::string& what, const std::function<void()>& call) {
  EXPECT_NE(refusalOf(call).find("; "), std::string::npos) << what << ": " << refusalOf(call);
}

TEST(Refusals, OfPointsSayWhatIsMissingAndWhatWasLeftOut) {
  const auto expect = [](const std::string& reason, const Positions& points,
                         const Options& options = sphere()) {
    expectReason(reason, [&] { reconstruct(points, options); });
  };
  const Positions good = randomSphere(20, 1);
  for (Index n = 0; n < 4; ++n)
    expect("at least 4", good.leftCols(n));
  expect("but there are 3", good.leftCols(3).replicate(1, 5));
  Positions plane = good;
  plane.row(1).setConstant(3.0);
  expect("one plane", plane);
  expect("beyond 1e100", good * 1e101);
  Positions infinite = good.leftCols(5);
  infinite(1, 0) = infinite(2, 3) = kInfinity;
  expect("there are 3 (left out: 2 points that are not finite)", infinite, {});
  const Options large = given("parts", "each", "outliers", "auto", "min_points", 1000);
  expect("min_points = 1000 points (left out: 2 points that are not finite, 6 stray points)",
         horizontally(spiralSphere(300), 2.0 * spiralSphere(6), Positions::Constant(3, 2, kNan)),
         large);
  expectReason("normals", [&] { reconstruct(good, {}, {}, {good.leftCols(3), {}, {}}); });
}

TEST(Refusals, OfThreadsBeyondTheRangeWhoseEndIsTaken) {
  const Inputs inputs(100);
  for (const Function& function :
       functionsOf({addReconstructions, addFunctionsOfTheCore, addMaps})) {
    if (function.name == "triangulateSphere()")  // on one thread
      continue;
    SCOPED_TRACE(function.name);
    EXPECT_NO_THROW(function.run(inputs, Execution{1024}));
    for (const int threads : {-1, 1025})
      expectReason("threads", [&] { function.run(inputs, Execution{threads}); });
  }
}

TEST(Refusals, OfIndicesBeyondTheMeshNameTheTriangle) {
  using Call = std::function<void(const Positions&, const Triangles&)>;
  const std::vector<Call> functions{[](auto& /*p*/, auto& t) { checkTopology(t, 9); },
                                    [](auto& p, auto& t) { measureMesh(p, t); },
                                    [](auto& p, auto& t) { findSelfIntersections(p, t); },
                                    [](auto& p, auto& t) { findSelfIntersectionsOf(p, t, {0}); },
                                    [](auto& p, auto& t) { areaWeightedNormals(p, t); },
                                    [](auto& p, auto& t) { signedVolume(p, t); },
                                    [](auto& p, auto& t) { surfaceArea(p, t); }};
  const Positions points = spiralSphere(9);
  const Triangles triangles = triangulateSphere(points);
  for (const Call& call : functions)
    for (const Index vertex : {-1, 9}) {
      Triangles wrong = triangles;
      wrong(1, 3) = vertex;
      expectReason("triangle 3", [&] { call(points, wrong); });
    }
  for (const Index triangle : {-1, 14})
    expectReason("triangle", [&] { findSelfIntersectionsOf(points, triangles, {triangle}); });
  expectReason("at least 4", [&] { triangulateSphere(points.leftCols(3)); });
  for (const double factor : {1.1, kNan, kInfinity}) {
    Positions wrong = points;
    wrong.col(4) *= factor;
    expectReason("point 4", [&] { triangulateSphere(wrong); });
    if (factor != 1.1)
      expectReason("findSelfIntersections", [&] { findSelfIntersections(wrong, triangles); });
  }
}

TEST(Refusals, OfMeshesAndMapsThatAreWrong) {
  const Mapped good = mapped(randomSphere(50, 3));
  // Computing a map takes any start, and measuring one takes any triangles of vertices.
  const std::vector<std::pair<std::string, std::function<void(const Mapped&)>>> functions = {
      {"surface", [](const Mapped& m) { m.surface(); }},
      {"atlas", [](const Mapped& m) { makeTextureAtlas(m.triangles, m.sphere); }},
      {"map", [](const Mapped& m) { computeSphereMap(m.points, m.triangles, m.sphere); }},
      {"distortion",
       [](const Mapped& m) { measureMapDistortion(m.points, m.triangles, m.sphere); }}};
  struct Fault {
    std::string what;
    std::size_t count;  ///< of these functions, which refuse it
    std::function<void(Mapped&)> make;
  };
  const std::vector<Fault> faults = {
      {"too few", 4, [&](Mapped& m) { m.sphere = good.sphere.leftCols(49); }},
      {"not finite", 4, [](Mapped& m) { m.sphere(1, 7) = kNan; }},
      {"index", 4, [](Mapped& m) { m.triangles(1, 2) = 50; }},
      {"length", 3, [](Mapped& m) { m.sphere *= 1.1; }},
      {"nothing", 3, [](Mapped& m) { m = {}; }},
      {"turned", 3, [](Mapped& m) { std::swap(m.triangles(0, 3), m.triangles(1, 3)); }},
      {"unused", 3,
       [](Mapped& m) { m.points = m.sphere = horizontally(m.sphere, -m.sphere.col(0)); }},
      {"two surfaces", 3,
       [&](Mapped& m) {
         m.points = m.sphere = horizontally(good.sphere, good.sphere);
         m.triangles.resize(3, 2 * good.triangles.cols());
         m.triangles << good.triangles, (good.triangles.array() + 50).matrix();
       }},
      {"flipped", 2, [](Mapped& m) { m.sphere.col(3).swap(m.sphere.col(4)); }}};
  for (const Fault& fault : faults) {
    Mapped wrong = good;
    fault.make(wrong);
    for (std::size_t i = 0; i < fault.count; ++i)
      expectRefused(functions[i].first + ", " + fault.what, [&] { functions[i].second(wrong); });
  }
  Mapped wrong = good;
  wrong.points(0, 0) = kNan;
  for (const std::size_t i : {0U, 2U, 3U})
    expectRefused(functions[i].first, [&] { functions[i].second(wrong); });
  const Positions points = randomSphere(12 * 8, 5);
  expectReason("its genus is 1; cut its handles, by handles = none",
               [&] { computeSphereMap(points, torusTriangles(12, 8), points); });
}

TEST(Refusals, OfCapsAndPlacesThatDoNotFit) {
  const Mapped open = openBumpy(400);
  const Mapped closed = mapped(randomSphere(50, 3));
  const auto surface_of = [](const Mapped& mesh, const Positions& caps) {
    return SphereSurface(mesh.points, mesh.triangles, mesh.sphere, {SurfaceFit::Linear, 0, caps});
  };
  expectRefused("no caps", [&] { surface_of(open, {}); });
  expectRefused("too few caps", [&] { surface_of(open, open.caps.leftCols(3)); });
  expectRefused("caps of a closed mesh", [&] { surface_of(closed, open.caps); });

  const SphereSurface surface = closed.surface();
  for (const Vector3d& direction : {Vector3d(0.0, 0.0, 0.0), Vector3d(kNan, 0.0, 1.0)}) {
    expectRefused("locate()", [&] { surface.locate(direction); });
    expectRefused("evaluate()", [&] { surface.evaluate(Positions(direction)); });
    expectRefused("chartCoordinates()", [&] { chartCoordinates({}, direction); });
    expectRefused("harmonics", [&] { sphericalHarmonicsAt(direction, 3); });
  }
  for (const Index t : {Index{-1}, static_cast<Index>(closed.triangles.cols())})
    expectRefused("location", [&] { surface.evaluate(SphereLocation{t, Vector3d::UnitX()}); });
}

TEST(Refusals, OfGridsResampledMeshesAndSeriesThatDoNotFit) {
  for (const SphereGrid kind : {SphereGrid::Icosahedral, SphereGrid::Octahedral}) {
    // The largest that there is, for any number.
    const int most = gridFrequency(kind, std::numeric_limits<std::size_t>::max());
    EXPECT_LE(gridVertices(kind, most), std::size_t{1} << 29);
    for (const int frequency : {0, most + 1, kMax}) {
      expectRefused("gridVertices()", [&] { gridVertices(kind, frequency); });
      expectRefused("makeGridSphere()", [&] { makeGridSphere(kind, frequency); });
    }
  }
  const SphereSurface surface = mapped(randomSphere(50, 3)).surface();
  const ResampledMesh good = resampleSurface(surface, makeGridSphere(SphereGrid::Octahedral, 3));
  std::vector<ResampledMesh> meshes(4, good);
  meshes[0].directions = good.directions.leftCols(5);
  meshes[1].triangles(0, 0) = 38;
  meshes[2].normals = good.normals.leftCols(5);
  for (ResampledMesh& mesh : meshes)
    expectRefused("untangle()", [&] { untangle(surface, mesh, &mesh == &meshes.back() ? -1 : 0); });
  expectRefused("octahedral", [&] {
    geometryImageOfMesh(resampleSurface(surface, makeGridSphere(SphereGrid::Icosahedral, 3)));
  });
  const Vector3d x = Vector3d::UnitX();
  expectRefused("degree", [&] { sphericalHarmonicsAt(x, 513); });
  SphericalHarmonics series = computeSphericalHarmonics(surface, 0);
  expectRefused("threads", [&] { evaluateSphericalHarmonics(series, x, -1); });
  expectRefused("zero", [&] { evaluateSphericalHarmonics(series, Positions::Zero(3, 1)); });
  series.degree = 1;
  expectRefused("coefficients", [&] { evaluateSphericalHarmonics(series, x); });
}

TEST(Refusals, OfTexturesAndMorphsThatDoNotFit) {
  using Colors = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  const Mapped mesh = mapped(spiralSphere(30));
  const TextureAtlas good = makeTextureAtlas(mesh.triangles, mesh.sphere);
  std::vector<TextureAtlas> atlases(5, good);
  atlases[0].vertices[3].vertices[1] = -1;
  atlases[1].triangles(0, 0) = static_cast<Index>(good.vertices.size());
  atlases[2].coordinate_triangles(2, 4) = -5;
  atlases[3].coordinates(0, 2) = kNan;
  atlases[4].chart = static_cast<SphereChart>(17);
  for (const TextureAtlas& atlas : atlases)
    expectRefused("atlas", [&] { bakeCheckerboard(atlas, mesh.sphere, 8, {16, 0, 0}); });
  expectRefused("directions", [&] { bakeCheckerboard(good, mesh.sphere.leftCols(29)); });
  expectRefused("values", [&] { atCutVertices(good, mesh.sphere.leftCols(29)); });
  EXPECT_NO_THROW(bakeColors(good, Colors::Constant(3, 30, 255.0), {16, 0, 1}));
  for (const Index count : {29, 31})
    expectRefused("colours", [&] { bakeColors(good, Colors::Constant(3, count, 100.0)); });
  for (const double bad : {-1.0, 255.1, kNan})
    expectRefused("a colour", [&] { bakeColors(good, Colors::Constant(3, 30, bad)); });
  MorphResult morph;
  morph.first.resize(3, 4);
  morph.second.resize(3, 5);
  expectRefused("shapes", [&] { inBetween(morph, 0.5); });
}

template <typename Value>
void set(Value& option, double value) {
  if constexpr (std::is_enum_v<Value>)
    option = static_cast<Value>(static_cast<int>(value));
  else
    option = static_cast<Value>(value);
}

TEST(Refusals, OfOptionsNameThemAndEndsOfTheRangesAreTaken) {
  const std::vector<Function> functions = functionsOf({addMaps});
  using Set = void (*)(Inputs&, double);
  for (const Index n : {4, 150}) {
    Inputs valid(20);
    valid.few = valid.many = valid.bumps =
        mapped(n == 4 ? regularTetrahedron() : randomSphere(n, 7));
    valid.morph = {};
    valid.morph.align = false;
    valid.morph.samples = 100;
    valid.bake = {16, 0, 0};
    const auto expect = [&](const std::string& name, const std::string& option, const Set& set_to,
                            const std::vector<double>& good, const std::vector<double>& bad) {
      const auto function = std::find_if(functions.begin(), functions.end(),
                                         [&](const Function& f) { return f.name == name; });
      const auto refusal = [&](double value) {
        Inputs inputs = valid;
        set_to(inputs, value);
        return refusalOf([&] { function->run(inputs, {}); });
      };
      for (const double value : good)
        EXPECT_EQ(refusal(value), "") << option << " = " << value;
      for (const double value : bad)
        EXPECT_NE(refusal(value).find(option), std::string::npos) << option << " = " << value;
    };
    const char* const map = "computeSphereMap()";
    expect(map, "area_weight", [](Inputs& in, double x) { in.map.area_weight = x; }, {0, kTiny, 1},
           {-kTiny, 1.0000000000000002, kNan});
    expect(map, "sweeps", [](Inputs& in, double x) { set(in.map.sweeps, x); }, {0, 1},
           {-1, 1001, kMax});
    expect("SphereSurface", "fit", [](Inputs& in, double x) { set(in.fit, x); }, {0, 1}, {-1, 2});
    const char* const morph = "morphSurfaces()";
    expect(morph, "connectivity", [](Inputs& in, double x) { set(in.morph.connectivity, x); },
           {0, 1}, {-1, 2});
    expect(morph, "samples", [](Inputs& in, double x) { set(in.morph.samples, x); }, {12},
           {0, 11, (1 << 24) + 1});
    expect(morph, "t ", [](Inputs& in, double x) { in.time = x; }, {-1, 2}, {kNan, kInfinity});
    expect("spherical harmonics", "degree", [](Inputs& in, double x) { set(in.degree, x); }, {0},
           {-1, 513});
    const char* const texture = "textures";
    expect(texture, "margin", [](Inputs& in, double x) { in.chart_margin = x; }, {0, 0.2499},
           {-kTiny, 0.25, kNan});
    expect(texture, "height", [](Inputs& in, double x) { set(in.bake.height, x); }, {16, 17},
           {15, 16385, kMax});
    expect(texture, "gutter", [](Inputs& in, double x) { set(in.bake.gutter, x); }, {0, 256},
           {-1, 257, kMax});
    expect(texture, "cells", [](Inputs& in, double x) { set(in.cells, x); }, {1, 4096}, {0, 4097});
    for (const int chart : {-1, 3})
      expectReason("chart", [&] {
        makeTextureAtlas(valid.few.triangles, valid.few.sphere, {static_cast<SphereChart>(chart)});
      });
    const SphereSurface surface = valid.few.surface();
    valid.morph.pairs.assign(4097, {});
    expectReason("pairs", [&] { morphSurfaces(surface, surface, valid.morph); });
    valid.morph.pairs = {{std::numeric_limits<Index>::min(), 0}, {0, kMax}, {-1, -1}, {0, 0}};
    EXPECT_EQ(morphSurfaces(surface, surface, valid.morph).impossible.size(), 3U);
  }
}

}  // namespace
}  // namespace spherical_param::test
