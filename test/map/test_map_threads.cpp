// What holds of every function of the map that works on several threads, by one table: the result
// is the same, bit by bit, for any number of them; progress comes from the calling thread and can
// end the work. removeIntersections() and untangle(): beside what they do to a mesh.

#include "blobs.h"
#include "spherical_param/map/morphing.h"
#include "spherical_param/map/resampling.h"
#include "spherical_param/map/spherical_harmonics.h"
#include "spherical_param/map/texture_atlas.h"
#include "thread_checks.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace spherical_param::test {
namespace {

struct Function {
  std::string name;
  std::function<Numbers(const Execution&)> run;
  bool reports = false;
};

/// More vertices and directions than short passes leave to a single thread.
struct Inputs {
  Mapped bumps = bumpy(spiralSphere(4500));
  Positions random_points = randomPositions(4500, 4);
  Positions directions = randomSphere(4500, 2);
  Mapped few = firstBlob().over(spiralSphere(600));
  SphericalHarmonics harmonics = computeSphericalHarmonics(few.surface(), 12, 1);
};

Numbers numbersOf(const MapDistortion& distortion) {
  Numbers numbers(distortion.mean_angle_difference, distortion.stretch_efficiency);
  for (const DistortionStatistics& each : {distortion.angle, distortion.area})
    numbers.add(Numbers(each.mean, each.p95, each.max));
  return numbers;
}

std::vector<Function> functionsOf(const Inputs& in) {
  std::vector<Function> functions = {
      {"computeSphereMap()",
       [&](const Execution& e) {
         SphereMapOptions options;
         static_cast<Execution&>(options) = e;
         options.sweeps = 2;
         const Mapped& mesh = in.bumps;
         return Numbers(computeSphereMap(mesh.points, mesh.triangles, mesh.sphere, options).sphere);
       },
       true},
      {"measureMapDistortion()",
       [&](const Execution& e) {
         return numbersOf(measureMapDistortion(in.random_points, in.bumps.triangles,
                                               in.bumps.sphere, e.threads));
       }},
      {"SphereSurface",
       [&](const Execution& e) {
         const SphereSurface surface = in.bumps.surface(SurfaceFit::Smooth, e.threads);
         const SurfaceSamples samples = surface.evaluate(in.directions);
         Numbers numbers(surface.area(), samples.positions, samples.normals);
         for (const SphereLocation& location : samples.locations)
           numbers.add(location.weights);
         return numbers;
       }},
      {"sampleEvenly()",
       [&](const Execution& e) {
         const SurfacePoints samples =
             sampleEvenly(in.few.surface(SurfaceFit::Linear, e.threads), 1000, 7);
         return Numbers(samples.points, samples.normals);
       }},
      {"computeSphericalHarmonics()",
       [&](const Execution& e) {
         const SphericalHarmonics found =
             computeSphericalHarmonics(in.few.surface(), 12, e.threads);
         return Numbers(found.coefficients, found.rms_residual);
       }},
      {"evaluateSphericalHarmonics()",
       [&](const Execution& e) {
         return Numbers(evaluateSphericalHarmonics(in.harmonics, in.directions, e.threads));
       }},
      {"morphSurfaces()",
       [&](const Execution& e) {
         MorphOptions options;
         static_cast<Execution&>(options) = e;
         const Mapped many = firstBlob().over(spiralSphere(4300));
         for (Index i = 20; i < 600; i += 48)
           options.pairs.push_back({i, nearestTo(in.few.sphere.col(i), many)});
         const MorphResult morph = morphSurfaces(in.few.surface(), many.surface(), options);
         EXPECT_TRUE(morph.impossible.empty());
         return Numbers(morph.rotation, morph.alignment_error, morph.first, morph.second,
                        morph.sphere, morph.triangles, morph.worst_pair);
       },
       true}};
  for (const SphereChart chart :
       {SphereChart::Equirectangular, SphereChart::Octahedral, SphereChart::CubeMap})
    functions.push_back(
        {"textures", [&in, chart](const Execution& e) {
           const TextureAtlas atlas =
               makeTextureAtlas(in.few.triangles, in.few.sphere, {chart, 0.1});
           const BakeOptions options{100, 5, e.threads};
           const TextureImage colors = bakeColors(atlas, 100.0 * in.few.sphere.cwiseAbs(), options);
           return Numbers(colors.pixels, colors.covered,
                          bakeCheckerboard(atlas, in.few.sphere, 8, options).pixels);
         }});
  return functions;
}

TEST(MapThreads, ChangeNoBitOfAnyFunction) {
  const Inputs inputs;
  for (const Function& function : functionsOf(inputs)) {
    const Numbers alone = function.run(onThreads(1));
    EXPECT_GT(alone.size(), 0U) << function.name;
    for (const int threads : {2, 3})
      EXPECT_TRUE(alone == function.run(onThreads(threads))) << function.name << " " << threads;
  }
}

TEST(MapThreads, ThatCallReceiveTheProgressAndCanEndTheWork) {
  const Inputs inputs;
  for (const Function& function : functionsOf(inputs)) {
    if (!function.reports)
      continue;
    SCOPED_TRACE(function.name);
    const std::vector<double> fractions = expectProgressThatCanCancel(
        [&](const std::function<bool(double)>& callback) { function.run(reportingTo(callback)); });
    EXPECT_EQ(fractions.back(), 1.0);
  }
}

}  // namespace
}  // namespace spherical_param::test
