#pragma once

#include "embedding.h"
#include "fuzz_input.h"
#include "spherical_param/mesh_measures.h"
#include "spherical_param/mesh_topology.h"
#include "spherical_param/sphere_triangulation.h"
#include "spherical_param/types.h"

#include <cstddef>
#include <cstdint>
#include <functional>

/// Calls of stages with everything made of bytes, and checks of what they answer. The watch is the
/// callback and has to outlive the call.
namespace fuzz {

using spherical_param::Execution;
using spherical_param::Triangles;

using Call = void (*)(Bytes& bytes, const Positions& points, Watch& watch);

void fuzzSurface(Bytes& bytes, const Positions& points, Watch& watch);
void fuzzTexture(Bytes& bytes, const Positions& points, Watch& watch);
void fuzzMorph(Bytes& bytes, const Positions& points, Watch& watch);
void fuzzHarmonics(Bytes& bytes, const Positions& points, Watch& watch);

/// Points on the sphere, unless they are not finite.
inline Positions normalized(const Positions& points) {
  return points.allFinite() ? spherical_param::internal::projectFromCentroid(points) : points;
}

/// A mesh on points on the sphere, sometimes spoiled.
inline Triangles trianglesFrom(Bytes& bytes, const Positions& sphere) {
  Triangles triangles(3, 0);
  if (sphere.cols() >= 4 && stress::areUnitVectors(sphere))
    triangles = spherical_param::triangulateSphere(sphere);
  const auto n = static_cast<std::size_t>(sphere.cols());
  const std::uint8_t how = bytes.byte();
  if (how < 160)
    return triangles;
  if (how < 200) {  // some other corners
    for (std::size_t i = bytes.below(8); i > 0 && triangles.cols() > 0; --i)
      triangles.data()[bytes.raw<std::uint16_t>() % triangles.size()] =
          bytes.index(n, how % 2 == 0);
  } else if (how < 220 && triangles.cols() > 0) {  // an open one
    const Eigen::Index left = triangles.cols() - 1 - bytes.byte() % triangles.cols();
    triangles.conservativeResize(Eigen::NoChange, left);
  } else if (how < 235) {
    spherical_param::flipOrientation(triangles);
  } else {
    triangles.resize(3, bytes.byte() % 64);
    for (Index& corner : triangles.reshaped())
      corner = bytes.index(n, how % 2 == 0);
  }
  return triangles;
}

/// Threads from bytes, and the watch as the callback.
inline Execution executionFrom(Bytes& bytes, Watch& watch) {
  Execution execution;
  execution.threads = bytes.integerOr(0);
  if (watch.listens())
    execution.progress = std::ref(watch);
  return execution;
}

/// Limits the time of the work; a value that is out of range is kept.
inline int atMost(int most, int value, int range) {
  return value > most && value <= range ? most : value;
}

inline bool isSphere(const Triangles& triangles, const Positions& points) {
  return spherical_param::test::isSphereOverAll(triangles, static_cast<Index>(points.cols()));
}

}  // namespace fuzz
