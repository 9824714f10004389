#pragma once

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace stress {

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
    const int x = integer(low, high);
    const int y = integer(low, high);
    return {static_cast<double>(x), static_cast<double>(y),
            static_cast<double>(integer(low, high))};
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
      std::swap(values[static_cast<std::size_t>(i)],
                values[static_cast<std::size_t>(integer(0, i))]);
  }

private:
  std::mt19937_64 engine_;
};

}  // namespace stress
