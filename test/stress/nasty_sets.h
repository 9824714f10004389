#pragma once

#include "random.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/types.h"

#include <string>

namespace stress {

using namespace spherical_param;

/// Points and options that a mesher may fail on.
struct NastySet {
  std::string family;
  Positions points;  ///< 3 x n, not always finite, not always in space
  Options options;   ///< the defaults for half of the sets; one thread
};

/// Some options of the method, the points and the parts that are meshed.
Options someOptions(Random& random, bool is_large);

/// The same set for the same seed.
NastySet makeNastySet(std::uint64_t seed);

struct Answer {
  Result result;
  std::string bytes;  ///< of the result, or the message of a rejection
  std::string fault;  ///< what is wrong with it; empty if nothing is
};

/// What reconstruct() makes of a set, checked.
Answer answerTo(const NastySet& set, int threads = 1, const NeighborSearchFactory& search_of = {});

}  // namespace stress
