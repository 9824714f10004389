#pragma once

#include "graph.h"
#include "spherical_param/types.h"

#include <vector>

// How the points of a cloud are spread, where they do not sample a surface evenly. The thresholds
// are between the values of 80 clouds of surfaces, with and without noise, and those of such
// clouds.

namespace spherical_param::internal {

/// The neighbours of a node, and theirs, without itself; ascending.
std::vector<Index> withinTwoSteps(const Graph& graph, Index node);

/// Whether points fill a volume: the number of points within a distance grows faster than its power
/// 2.55. False of fewer than 500 points. Cost: O(n), of a sample.
bool fillVolume(const Positions& points);

/// Whether points lie along lines which are farther apart: the nearest neighbours of most points
/// are in line with them. False of fewer than 100 points. \param graph of the points.
bool areOnLines(const Positions& points, const Graph& graph);

/// Whether points are on a grid, like those of an elevation model or of voxels: as many as half of
/// the pairs of coordinates along two axes. Cost: O(n log n).
bool areOnGrid(const Positions& points);

}  // namespace spherical_param::internal
