#pragma once

#include <array>
#include <cstdint>

/// The allocation functions of this program, which fail where they are told to.
///
/// Those of the C library, which C++ and all libraries use, are replaced by some that count and
/// pass on. All is for one thread.
namespace failing_allocation {

/// From now on, allocations are counted, and some of them fail: not those of the loader and of
/// OpenMP's runtime, which end the program themselves.
///
/// \param first the first one that fails, from 1; 0: none.
/// \param all_after all after it fail as well.
void begin(std::uint64_t first, bool all_after);

/// From now on, none fails and none is counted.
void end();

/// Allocations between begin() and end().
std::uint64_t counted();

/// Of these, those that failed.
std::uint64_t failed();

/// Bytes that are allocated in the whole program.
std::int64_t bytesInUse();

/// Where the first one failed: return addresses.
struct Place {
  std::array<void*, 24> frames{};
  int depth = 0;
};
const Place& firstFailure();

}  // namespace failing_allocation
