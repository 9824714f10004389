#pragma once

#include "common/cloud_reconstruction.h"
#include "spherical_param/map/morphing.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// Two points that are to be one, of two clouds.
struct FilePair {
  std::size_t line = 0;                   ///< where the file has it, from 1
  std::array<int, 2> points{};            ///< one of each cloud: its number in the file, from 0
  std::array<Index, 2> vertices{-1, -1};  ///< of their meshes; -1: the point is not a vertex
};

/// Reads pairs of points from a text file: two numbers of points in a line, from 0, or six
/// coordinates, to which the nearest points count. # begins a comment.
///
/// \throw Failure with the line, for other contents, or an index out of range
std::vector<FilePair> readPointPairs(const std::string& path, const CloudReconstruction& first,
                                     const CloudReconstruction& second);

}  // namespace spherical_param::tools
