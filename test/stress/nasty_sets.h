#pragma once

#include "spherical_param/reconstruct.h"
#include "spherical_param/types.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace stress {

using namespace spherical_param;

/// Numbers that are the same with every standard library.
class Random {
public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [low, high].
  int integer(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  /// In [0, 1).
  double share() { return std::ldexp(static_cast<double>(engine_() >> 11U), -53); }
  double real(double low, double high) { return low + (high - low) * share(); }
  bool chance(double probability) { return share() < probability; }
  template <typename Container>
  auto one(const Container& of) {
    return of.begin()[integer(0, static_cast<int>(of.size()) - 1)];
  }
  Eigen::Vector3d onLattice(int low, int high) {
    const Eigen::Vector3i place{integer(low, high), integer(low, high), integer(low, high)};
    return place.cast<double>();
  }
  Eigen::Vector3d inCube() { return {real(-1, 1), real(-1, 1), real(-1, 1)}; }
  Eigen::Vector3d onSphere() {
    for (;;) {
      const Eigen::Vector3d p = inCube();
      if (p.norm() > 0.1 && p.norm() <= 1.0)
        return p.normalized();
    }
  }
  template <typename T>
  void shuffle(std::vector<T>& values) {
    for (int i = static_cast<int>(values.size()) - 1; i > 0; --i)
      std::swap(values.begin()[i], values.begin()[integer(0, i)]);
  }

private:
  std::mt19937_64 engine_;
};

/// Points and options that a mesher may fail on.
struct NastySet {
  std::string family;
  Positions points;  ///< 3 x n, not always finite, not always in space
  Options options;   ///< of both topologies; their defaults for half of the sets; one thread
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
