#pragma once

#include "graphs.h"
#include "handles.h"
#include "neighbor_search.h"
#include "openings.h"
#include "rotation_system.h"

#include <gtest/gtest.h>

/// What is known of a cloud before it is meshed.
namespace spherical_param::test {

inline Openings openingsOf(const Positions& points, const Graph& graph) {
  const internal::Indexed<double> spacing = internal::nodeSpacings(graph, 1);
  internal::RotationSystem rotation(points, graph, spacing, 1);
  return internal::findOpenings(points, graph, spacing, rotation);
}

struct Topology {
  explicit Topology(const Positions& cloud, const Execution& execution = {})
      : points(cloud), graph(graphOf(points, findNearestNeighbors(points, 24),
                                     makeNeighborSearch(points), execution)
                                 .graph),
        spacing(internal::nodeSpacings(graph, execution.threads)),
        rotation(points, graph, spacing, execution.threads),
        openings(internal::findOpenings(points, graph, spacing, rotation)),
        handles(internal::findHandles(rotation, openings.openings, execution)) {}
  Topology(const Topology&) = delete;
  Topology& operator=(const Topology&) = delete;

  Positions points;
  Graph graph;
  internal::Indexed<double> spacing;
  internal::RotationSystem rotation;
  Openings openings;
  internal::Handles handles;
};

}  // namespace spherical_param::test
