#include "handle_shapes.h"
#include "reconstructions.h"

namespace spherical_param::test {
namespace {

Positions elevationModel(int side) {
  return gridOf(side, side, [](int y, int x) {
    return Eigen::Vector3d(x, y, std::sin(7.0 * x * x + 3.0 * y));
  });
}

Positions ballOfGrid() {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3i& p : latticeOf({11, 11, 11}))
    if ((p.array() - 5).matrix().squaredNorm() <= 26)
      points.emplace_back(p.cast<double>());
  return positionsOf(points);
}

/// Voxels of a curved sheet three thick.
Positions membrane() {
  return gridOf(75, 25, [](int row, int x) {
    return Eigen::Vector3d(x, row / 3, std::floor(4.0 * std::sin(x / 8.0)) + row % 3);
  });
}

/// Straight lines across each other.
Positions segments() {
  const Positions from = randomCube(20, 1);
  const Positions to = randomCube(20, 2);
  return gridOf(20, 60, [&](int line, int i) -> Eigen::Vector3d {
    return from.col(line) + i / 59.0 * (to.col(line) - from.col(line));
  });
}

/// Terrain whose northing went through single precision.
Positions coarseTerrain() {
  const Positions fine = 0.5 * withNoise(elevationModel(20), 0.3, 1);
  const Positions far = fine.colwise() + Eigen::Vector3d(0.0, 4.5e6, 0.0);
  return far.cast<float>().cast<double>();
}

/// A capped tube by rings, `ratio` times as far apart as the points on them.
Positions contours(double ratio, int rings) {
  const double step = 2.0 * kPi / 120;
  return gridOf(rings, 120, [=](int ring, int i) {
    return onCircle(step * (i + 0.5 * (ring % 2)), 1.0, ratio * step * ring);
  });
}

const std::map<std::string, Positions>& clouds() {
  static const std::map<std::string, Positions> all = {
      {"whole", ellipsoid(800)},
      {"two", twoSpheres(400, 300, 6.0)},
      {"eight", inARow(8, 3.0, spiralSphere(200))},
      {"two too small", twoSpheres(30, 30, 6.0)},
      {"bowl", hemisphere(800)},
      {"no base", pointsWhere(ellipsoid(3000), [](const auto& p) { return p.z() > -0.4; })},
      {"holes", sphereWithHoles(1500, 3, 0.4)},
      {"patch", flatPatch(15)},
      {"torus", torusCloud(40, 16)},
      {"double torus", doubleTorus(0.12)},
      {"strays inside", horizontally(spiralSphere(1500),
                                     0.9 * randomCube(60, 3) - Positions::Constant(3, 60, 0.45))},
      {"strays outside", horizontally(spiralSphere(800), 1.6 * spiralSphere(5))},
      {"noisy", noisySphere(1000, 0.5)},
      {"very noisy", noisySphere(1500, 1.7)},
      {"corners", cubeGrid(2)},
      {"elevations", elevationModel(10)},
      {"volume", ballOfGrid()},
      {"membrane", membrane()},
      {"segments", segments()},
      {"coarse", coarseTerrain()},
      {"scattered", randomCube(50, 1)},
      {"contours", contours(5.0, 12)},
      {"rings far apart", contours(20.0, 6)}};
  return all;
}

/// 0: sound; 1: with faults; 2: with intersections; 3: not usable; 4: there is no mesh.
int gravityOf(const Positions& points, const Options& options, std::vector<Finding>& findings) {
  try {
    const Result result = reconstruct(points, options);
    findings = result.findings;
    const bool intersects =
        std::any_of(result.surfaces.begin(), result.surfaces.end(),
                    [](const Surface& surface) { return surface.intersecting_triangles > 0; });
    return !result.isUsable() ? 3 : intersects ? 2 : hasFault(findings) ? 1 : 0;
  } catch (const InvalidInput&) {
    return 4;
  }
}

/// Applies all findings of a cloud, and those after that.
void expectHelp(const std::string& name, const Options& start) {
  const Positions& points = clouds().at(name);
  std::vector<std::pair<Options, int>> todo{{start, 4}};  // and the gravity before
  for (std::size_t i = 0; i < todo.size(); ++i) {
    const auto [options, before] = todo[i];
    std::vector<Finding> findings;
    const int gravity = gravityOf(points, options, findings);
    EXPECT_LE(gravity, before) << name;
    for (const Finding& finding : findings) {
      if (finding.option.empty())
        continue;
      SCOPED_TRACE(name + ": " + finding.text + ": " + finding.option + " " + finding.value);
      const OptionRow& row = findOption(finding.option);
      ASSERT_NE(textOf(row.get(withTopology(options))), finding.value);
      Options with = options;
      setOption(with, finding.option,
                row.choices.empty() ? OptionValue(std::int64_t{std::stoi(finding.value)})
                                    : OptionValue(finding.value));
      ASSERT_LT(todo.size(), 20U) << "they lead in circles";
      todo.emplace_back(with, gravity);
    }
  }
}

TEST(EveryFinding, OfEveryCloudHelpsOrDoesNoHarmAndNoneRepeatsAnOption) {
  for (const auto& [name, points] : clouds()) {
    expectHelp(name, Options());
    expectHelp(name, sphere());
  }
}

TEST(EveryFinding, OfWhatAnOptionForbidsNamesThatOption) {
  const auto named = [](const std::string& name, const Options& options) {
    expectHelp(name, options);
    return reconstruct(clouds().at(name), options).findings.at(0).option;
  };
  for (Options options : {Options(), sphere()}) {
    options.surface = SurfaceMode::Closed;
    EXPECT_EQ(named("bowl", options), "surface");
    options.parts = PartsMode::All;
    EXPECT_EQ(named("two", options), "parts");
    EXPECT_EQ(named("two too small", options), "");
    options.handles = HandleMode::None;
    EXPECT_EQ(named("torus", options), "handles");
    options.outliers = OutlierMode::None;
    EXPECT_EQ(named("strays outside", options), "outliers");
  }
}

TEST(EveryFinding, TellsVolumesLinesAndGridsFromNoise) {
  const auto texts_of = [](const std::string& name, const Options& options = {}) {
    std::string texts;
    for (const Finding& finding : reconstruct(clouds().at(name), options).findings)
      texts += finding.text + "; ";
    return texts;
  };
  EXPECT_NE(texts_of("noisy", given("consolidation", "none")).find("the points are noisy"),
            std::string::npos);
  EXPECT_NE(texts_of("volume").find("the points fill a volume"), std::string::npos);
  EXPECT_NE(texts_of("membrane").find("several layers of voxels"), std::string::npos);
  EXPECT_NE(texts_of("segments").find("the points lie along curves"), std::string::npos);
  EXPECT_NE(texts_of("coarse").find("y has steps of 0.5"), std::string::npos);
  EXPECT_NE(texts_of("scattered").find("too few or too noisy"), std::string::npos);
  EXPECT_NE(texts_of("contours").find("the points lie along lines"), std::string::npos);
  for (const char* name : {"whole", "corners", "elevations", "torus", "patch"})
    EXPECT_EQ(texts_of(name), "") << name;
}

}  // namespace
}  // namespace spherical_param::test
