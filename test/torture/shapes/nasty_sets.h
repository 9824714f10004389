#pragma once

#include "spherical_param/types.h"

#include <cstdint>
#include <string>
#include <vector>

namespace torture {

/// Points that a mesher may trip over.
struct NastySet {
  std::string family;                  ///< what they are
  std::vector<std::string> treatment;  ///< what was done to them after that, e.g. "offset by 1e7"
  spherical_param::Positions points;   ///< 3 x n, not always finite
};

/// The set of a seed: always the same. Some are no valid input: see Truth.
///
/// \param seed any.
/// \return the set.
NastySet makeNastySet(std::uint64_t seed);

}  // namespace torture
