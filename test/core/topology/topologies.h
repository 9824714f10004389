#pragma once

#include "graphs.h"
#include "openings.h"
#include "rotation_system.h"

/// What is known of a cloud before it is meshed.
namespace spherical_param::test {

inline Openings openingsOf(const Positions& points, const Graph& graph) {
  const Indexed<double> spacing = nodeSpacings(graph, 1);
  RotationSystem rotation(points, graph, spacing, 1);
  return findOpenings(points, graph, spacing, rotation);
}

}  // namespace spherical_param::test
