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
  const Indexed<double> spacing = nodeSpacings(graph, 1);
  RotationSystem rotation(points, graph, spacing, 1);
  return findOpenings(points, graph, spacing, rotation);
}

struct Topology {
  explicit Topology(const Positions& cloud, const Execution& execution = {})
      : points(cloud), graph(graphOf(points, findNearestNeighbors(points, 24),
                                     makeNeighborSearch(points), execution)
                                 .graph),
        spacing(nodeSpacings(graph, execution.threads)),
        rotation(points, graph, spacing, execution.threads),
        openings(findOpenings(points, graph, spacing, rotation)),
        handles(findHandles(rotation, openings.openings, execution)) {}
  Topology(const Topology&) = delete;
  Topology& operator=(const Topology&) = delete;

  Positions points;
  Graph graph;
  Indexed<double> spacing;
  RotationSystem rotation;
  Openings openings;
  Handles handles;
};

}  // namespace spherical_param::test
