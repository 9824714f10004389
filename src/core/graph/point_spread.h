#pragma once

#include "graph.h"
#include "spherical_param/types.h"
#include "tangent_stars.h"

#include <vector>

// How the points of a cloud are spread, where they do not sample a surface evenly. The thresholds
// are between the values of 80 clouds of surfaces, with and without noise, and those of such
// clouds.

namespace spherical_param::internal {

/// The neighbours of a node, and theirs, without itself; ascending.
std::vector<Index> withinTwoSteps(const Graph& graph, Index node);

/// What points sample.
enum class PointSpread {
  Surface,  ///< or too few points to tell
  Volume,   ///< as dense everywhere inside; not of fewer than 500 points
  Layers,   ///< voxels, three or more of them across the surface
  Curves,   ///< in all directions, without a surface between them, like centre lines
};

/// Finds what points sample, from the neighbourhoods of some. Cost: O(n log n).
PointSpread spreadOf(const Positions& points);

/// The steps along the axes that single precision leaves of coordinates with a large offset; 0:
/// none that are wider than a number of spacings, the distance to the sixth neighbour. An elevation
/// grid may have such steps as well. Cost: O(n log n) if there are some.
Eigen::Vector3d coarseSteps(const Positions& points, double min_spacings);

/// Whether 20 to 100 points are too few or too noisy to show a surface: the nearest are in no
/// plane, and their stars do not agree. \param stars of the points.
bool areScattered(const Positions& points, const Stars& stars);

/// Whether points lie along lines which are farther apart: the nearest neighbours of most points
/// are in line with them. False of fewer than 100 points. \param graph of the points.
bool areOnLines(const Positions& points, const Graph& graph);

/// Whether points are on a grid, like those of an elevation model or of voxels: as many as half of
/// the pairs of coordinates along two axes. Cost: O(n log n).
bool areOnGrid(const Positions& points);

}  // namespace spherical_param::internal
