#pragma once

#include "nasty_sets.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace torture {

/// What came of a set.
struct Answer {
  std::string family;               ///< that of the set
  std::string how;                  ///< the set's size and treatment, the options, the way
  std::size_t points = 0;           ///< of the set
  bool refused = false;             ///< InvalidInput
  bool through_pcl = false;         ///< in single precision
  bool twice = false;               ///< with another number of threads, too
  std::size_t triangles = 0;        ///< of the mesh
  std::vector<std::string> faults;  ///< what is not as guaranteed
  std::size_t lost = 0;             ///< distinct points that are no vertex
  double seconds = 0.0;             ///< of computing, by the calling thread
};

/// Meshes the set of a seed, in one of the ways and with some options that the seed tells, and
/// checks the answer.
///
/// \param seed any.
/// \return the same for the same seed, but for the time.
Answer tryOut(std::uint64_t seed);

/// Shows that wrong numbers of vertices are found. \return what was not found.
std::vector<std::string> overlookedNumbers();

}  // namespace torture
