#pragma once

#include "spherical_param/types.h"

#include <cstdint>
#include <string>

namespace stress {

/// Points that a mesher may fail on.
struct NastySet {
  std::string family;
  spherical_param::Positions points;  ///< 3 x n, not always finite, not always in space
};

/// The same set for the same seed.
NastySet makeNastySet(std::uint64_t seed);

}  // namespace stress
