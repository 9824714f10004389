#pragma once

#include <cstdint>

namespace spherical_param::internal {

/// Bits that look random and are the same on every platform: one step of splitmix64 (G. L. Steele,
/// D. Lea and C. H. Flood, 2014).
inline std::uint64_t splitmix64(std::uint64_t state) {
  std::uint64_t z = state + 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

}  // namespace spherical_param::internal
