#pragma once

#include "helpers.h"
#include "spherical_param/errors.h"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <cstddef>
#include <type_traits>
#include <vector>

/// What the tables of functions that work on several threads share.
namespace spherical_param::test {

/// All numbers of some values, one after the other: equal if the values are, bit by bit.
class Numbers {
public:
  template <typename... Values>
  explicit Numbers(const Values&... values) {
    (add(values), ...);
  }

  template <typename Value>
  void add(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value>)
      numbers_.push_back(static_cast<double>(value));
    else if constexpr (std::is_base_of_v<Eigen::DenseBase<Value>, Value>)
      for (const auto number : value.reshaped())
        add(number);
    else
      for (const auto& part : value)
        add(part);
  }
  std::size_t size() const { return numbers_.size(); }
  auto begin() const { return numbers_.begin(); }
  auto end() const { return numbers_.end(); }
  bool operator==(const Numbers& other) const { return numbers_ == other.numbers_; }

private:
  std::vector<double> numbers_;
};

/// Expects that run(callback) reports fractions from the calling thread, and that the first, a
/// middle and the last report can end the work. Returns the fractions.
template <typename Run>
std::vector<double> expectProgressThatCanCancel(const Run& run) {
  const std::vector<double> fractions = fractionsOf(run);
  EXPECT_TRUE(areFractions(fractions));
  for (const std::size_t last : {std::size_t{1}, (fractions.size() + 1) / 2, fractions.size()}) {
    std::size_t calls = 0;
    EXPECT_THROW(run([&](double) { return ++calls < last; }), Cancelled);
    EXPECT_EQ(calls, last);
  }
  return fractions;
}

}  // namespace spherical_param::test
