#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <type_traits>
#include <vector>

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

}  // namespace spherical_param::test
