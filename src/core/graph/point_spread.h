#pragma once

#include "graph.h"
#include "spherical_param/types.h"
#include "tangent_stars.h"

#include <vector>

// How the points of a cloud are spread, where they do not sample a surface evenly. The thresholds
// are between the values of surfaces, with and without noise, and those of such clouds.

namespace spherical_param::internal {

/// The neighbours of a node, and theirs, without itself; ascending.
std::vector<Index> withinTwoSteps(const Graph& graph, Index node);

/// What points sample.
enum class PointSpread {
  Surface,  ///< or too few points to tell
  Volume,   ///< equally dense everywhere inside; at least 500 points
  Layers,   ///< voxels, at least three of them across the surface
  Curves,   ///< curves in all directions without a surface between them, like centre lines
};

/// Finds what points sample, from the neighbourhoods of some. Cost: O(n log n).
PointSpread spreadOf(const Positions& points);

/// The steps along the axes to which single precision rounded coordinates with a large offset; 0
/// for steps of at most `min_spacings`, the distance to the sixth neighbour. An elevation grid may
/// have such steps as well. Cost: O(n log n) if there are some.
Eigen::Vector3d coarseSteps(const Positions& points, double min_spacings);

/// Whether 20 to 100 points are too few or too noisy to show a surface: the nearest points are in
/// no plane, and their stars do not agree. \param stars of the points.
bool areScattered(const Positions& points, const Stars& stars);

/// Whether points lie along lines that are farther apart than the points on them: the nearest
/// neighbours of most points are in line with them. False for fewer than 100 points.
bool areOnLines(const Positions& points, const Graph& graph);

/// Whether points are on a grid, like those of an elevation model or voxels: they take at least
/// half of its places, seen along an axis. Cost: O(n log n).
bool areOnGrid(const Positions& points);

}  // namespace spherical_param::internal
