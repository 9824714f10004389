// The public functions of the table in test/contract, each with any arguments: the first byte picks
// one. The watch is the callback and has to outlive the call.

#include "contract/public_functions.h"
#include "embedding.h"
#include "fuzz_input.h"

namespace fuzz {
namespace {

using test::Inputs;
using test::Mapped;

/// Changes some of the corners, seldom.
void spoil(Bytes& bytes, Triangles& triangles, std::size_t n) {
  const std::uint8_t how = bytes.byte();
  if (how < 160 || triangles.cols() == 0)
    return;
  if (how < 220)
    for (std::size_t i = bytes.below(8); i > 0; --i)
      triangles.data()[bytes.raw<std::uint16_t>() % triangles.size()] =
          bytes.index(n, how % 2 == 0);
  else if (how < 235)  // an opening
    triangles.conservativeResize(Eigen::NoChange,
                                 triangles.cols() - 1 - bytes.byte() % triangles.cols());
  else
    flipOrientation(triangles);
}

/// A morph of large shapes takes too long.
constexpr Eigen::Index kMaxOfSecond = 20;

/// A mesh of points with a map, either of which may be wrong.
Mapped mappedFrom(Bytes& bytes, const Positions& points) {
  Mapped mesh{points, {}, points.allFinite() ? internal::projectFromCentroid(points) : points};
  if (points.cols() >= 4 && areUnitVectors(mesh.sphere))
    mesh.triangles = triangulateSphere(mesh.sphere);
  spoil(bytes, mesh.triangles, static_cast<std::size_t>(points.cols()));
  if (bytes.oneIn(16) && points.cols() > 0)
    mesh.sphere(bytes.byte() % 3, bytes.byte() % points.cols()) = bytes.real();
  if (!bytes.oneIn(4))  // else the start, which may be folded
    try {
      mesh.sphere = computeSphereMap(points, mesh.triangles, mesh.sphere, {{}, 0.85, 2}).sphere;
    } catch (const InvalidInput&) {
      // The function under test must refuse it, too.
    }
  return mesh;
}

Inputs inputsFrom(Bytes& bytes, const Positions& points) {
  static const Inputs valid(20);
  Inputs in = valid;
  const Mapped mesh = mappedFrom(bytes, points);
  const auto count = static_cast<std::size_t>(mesh.triangles.cols());
  in.size = static_cast<Index>(points.cols());
  in.cloud = in.scattered = points;
  in.directions = bytes.oneIn(8) ? points : mesh.sphere;
  in.triangles = in.damaged = mesh.triangles;
  in.knot = {points, mesh.triangles};
  in.bumps = in.few = mesh;
  Bytes of_second = bytes;
  const Positions second = pointsFrom(of_second);
  in.many =
      mappedFrom(of_second, second.leftCols(std::min<Eigen::Index>(second.cols(), kMaxOfSecond)));

  in.options.outliers = bytes.choice<OutlierMode>(4);
  in.options.outlier_sigma = bytes.realOr(4.0);
  in.options.min_points = bytes.integerOr(8);
  in.chosen.clear();
  for (std::size_t i = bytes.below(8); i > 0; --i)
    in.chosen.push_back(bytes.index(count));
  in.map.area_weight = bytes.realOr(0.85);
  in.map.sweeps = atMost(20, bytes.integerOr(3), 1000);
  in.fit = bytes.choice<SurfaceFit>(2);
  in.morph.align = bytes.oneIn(32);  // as long as all the rest together
  in.morph.pairs.clear();
  for (std::size_t i = bytes.below(4); i > 0; --i)
    in.morph.pairs.push_back({bytes.index(static_cast<std::size_t>(points.cols())),
                              bytes.index(static_cast<std::size_t>(in.many.points.cols()))});
  in.morph.connectivity = bytes.choice<MorphConnectivity>(2);
  in.morph.samples = bytes.oneIn(8) ? bytes.raw<std::size_t>() : 12U + bytes.byte();
  if (in.morph.samples > 1000 && in.morph.samples <= std::size_t{1} << 24)
    in.morph.samples = 1000;
  in.grid = bytes.choice<SphereGrid>(2);
  in.frequency = atMost(4, bytes.integerOr(2), 1 << 15);
  in.degree = atMost(8, bytes.integerOr(4), 512);
  in.chart_margin = bytes.realOr(1.0 / 64);
  in.bake = {atMost(40, bytes.integerOr(16), 16384), bytes.integerOr(2), 0};
  in.cells = bytes.integerOr(8);
  in.direction = {bytes.real(), bytes.real(), bytes.real()};
  in.location = {bytes.index(count), {bytes.real(), bytes.real(), bytes.real()}};
  in.time = bytes.real();
  return in;
}

}  // namespace
}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fuzz;
  static const std::vector<test::Function> functions =
      test::functionsOf({test::addFunctionsOfTheCore, test::addMaps});
  Bytes bytes(data, size);
  const test::Function& function = functions[bytes.byte() % functions.size()];
  Watch watch(bytes);
  const std::size_t before = bytes.byte();
  // The points come last: a change of them moves no other byte.
  const std::size_t head = std::min<std::size_t>(size, 3 + 8 + before % 64);
  Bytes of_points(data + head, size - head);
  const Positions points = pointsFrom(of_points);
  Execution execution;
  execution.threads = bytes.integerOr(0);
  if (watch.listens())
    execution.progress = std::ref(watch);
  std::string message;
  endingOf(
      watch, [&] { function.run(inputsFrom(bytes, points), execution); }, message);
  return 0;
}
