#pragma once

#include "triangle_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace spherical_param::internal {

/// Boxes of a group: fills the vector registers.
inline constexpr std::size_t kGroupSize = 8;
inline constexpr unsigned kGroupBits = 3;

/// A box of floats that contains a box of doubles: half the memory, twice as many in a register.
struct WideBox {
  std::array<float, 3> lower;
  std::array<float, 3> upper;

  explicit WideBox(const Box& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto low = static_cast<float>(box.lower[static_cast<Eigen::Index>(axis)]);
      const auto high = static_cast<float>(box.upper[static_cast<Eigen::Index>(axis)]);
      lower[axis] = low - margin(low);
      upper[axis] = high + margin(high);
    }
  }
  WideBox(const std::array<float, 3>& low, const std::array<float, 3>& high)
      : lower(low), upper(high) {}

  Box box() const { return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}}; }
  float size() const {
    return std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  }

private:
  /// More than the rounding to a float and that of adding the margin.
  static float margin(float value) { return std::abs(value) * 3e-7F + 1e-37F; }
};

/// Boxes side by side, to compare a box with all of them at once.
struct BoxGroup {
  std::array<std::array<float, kGroupSize>, 3> lower;
  std::array<std::array<float, kGroupSize>, 3> upper;

  BoxGroup() {
    for (std::size_t lane = 0; lane < kGroupSize; ++lane)
      clear(lane);
  }
  void set(std::size_t lane, const WideBox& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis][lane] = box.lower[axis];
      upper[axis][lane] = box.upper[axis];
    }
  }
  /// Nothing overlaps it then.
  void clear(std::size_t lane) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis][lane] = std::numeric_limits<float>::infinity();
      upper[axis][lane] = -std::numeric_limits<float>::infinity();
    }
  }
  WideBox at(std::size_t lane) const {
    return {{lower[0][lane], lower[1][lane], lower[2][lane]},
            {upper[0][lane], upper[1][lane], upper[2][lane]}};
  }
  WideBox all() const {
    WideBox box = at(0);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t lane = 1; lane < kGroupSize; ++lane) {
        box.lower[axis] = std::min(box.lower[axis], lower[axis][lane]);
        box.upper[axis] = std::max(box.upper[axis], upper[axis][lane]);
      }
    return box;
  }
};

/// Lanes of a group whose boxes overlap a box.
class Overlaps {
public:
  Overlaps(const BoxGroup& group, const WideBox& box) {
    // No branches: a few instructions for all lanes.
    std::array<float, kGroupSize> gaps;
    for (std::size_t lane = 0; lane < kGroupSize; ++lane) {
      const float x =
          std::max(group.lower[0][lane] - box.upper[0], box.lower[0] - group.upper[0][lane]);
      const float y =
          std::max(group.lower[1][lane] - box.upper[1], box.lower[1] - group.upper[1][lane]);
      const float z =
          std::max(group.lower[2][lane] - box.upper[2], box.lower[2] - group.upper[2][lane]);
      gaps[lane] = std::max(std::max(x, y), z);
    }
    // Boxes are wider than their contents: touching contents have gaps below 0. Collect the signs
    // as bits, half by half.
    std::array<std::int32_t, kGroupSize> signs;
    static_assert(sizeof(signs) == sizeof(gaps), "a sign for each gap");
    std::memcpy(signs.data(), gaps.data(), sizeof(gaps));
    std::array<std::int32_t, kGroupSize / 2> halves;
    for (std::size_t lane = 0; lane < kGroupSize / 2; ++lane)
      halves[lane] = (signs[lane] < 0 ? kBits[lane] : 0) |
                     (signs[lane + kGroupSize / 2] < 0 ? kBits[lane + kGroupSize / 2] : 0);
    bits_ = static_cast<std::uint32_t>((halves[0] | halves[1]) | (halves[2] | halves[3]));
  }

  class Iterator {
  public:
    explicit Iterator(std::uint32_t bits) : bits_(bits) {}
    std::size_t operator*() const { return kLowestBits[bits_]; }
    Iterator& operator++() {
      bits_ &= bits_ - 1U;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return bits_ != other.bits_; }

  private:
    std::uint32_t bits_;
  };
  Iterator begin() const { return Iterator(bits_); }
  Iterator end() const { return Iterator(0); }

private:
  static constexpr std::array<std::uint8_t, 1U << kGroupSize> lowestBits() {
    std::array<std::uint8_t, 1U << kGroupSize> lowest{};
    for (std::size_t bits = 1; bits < lowest.size(); ++bits)
      lowest[bits] =
          bits % 2 != 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(lowest[bits / 2] + 1);
    return lowest;
  }
  static const std::array<std::uint8_t, 1U << kGroupSize> kLowestBits;
  static constexpr std::array<std::int32_t, kGroupSize> kBits{1, 2, 4, 8, 16, 32, 64, 128};

  std::uint32_t bits_ = 0;
};

inline constexpr std::array<std::uint8_t, 1U << kGroupSize> Overlaps::kLowestBits =
    Overlaps::lowestBits();

}  // namespace spherical_param::internal
