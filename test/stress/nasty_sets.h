#pragma once

#include "random.h"
#include "spherical_param/reconstruct.h"
#include "spherical_param/types.h"

#include <cstdint>
#include <string>

namespace stress {

/// Points and options that a mesher may fail on.
struct NastySet {
  std::string family;
  spherical_param::Positions points;  ///< 3 x n, not always finite, not always in space
  spherical_param::Options options;   ///< the defaults for half of the sets; one thread
};

/// Some options of the method, the points and the parts that are meshed.
spherical_param::Options someOptions(Random& random, bool is_large);

/// The same set for the same seed.
NastySet makeNastySet(std::uint64_t seed);

struct Answer {
  spherical_param::Result result;
  std::string bytes;  ///< of the result, or the message of a rejection
  std::string fault;  ///< what is wrong with it; empty if nothing is
};

/// What reconstruct() makes of a set, checked.
Answer answerTo(const NastySet& set, int threads = 1,
                const spherical_param::NeighborSearchFactory& search_of = {});

}  // namespace stress
