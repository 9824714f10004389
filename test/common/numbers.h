#pragma once

#include "spherical_param/result_fields.h"

#include <optional>
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
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>)
      numbers_.push_back(static_cast<double>(value));
    else if constexpr (std::is_base_of_v<Eigen::DenseBase<Value>, Value>)
      for (const auto number : value.reshaped())
        add(number);
    else
      for (const auto& part : value)
        add(part);
  }
  template <typename Value>
  void add(const std::optional<Value>& value) {
    add(value.has_value());
    add(value.value_or(0));
  }
  bool operator==(const Numbers& other) const { return numbers_ == other.numbers_; }

private:
  std::vector<double> numbers_;
};

inline Numbers numbersOf(const Result& result) {
  Numbers numbers;
  const auto add = [&](const ResultField&, const auto& value) { numbers.add(value); };
  visitValues(result.left_out, add);
  for (const Surface& surface : result.surfaces)
    visitValues(surface, add);
  return numbers;
}

}  // namespace spherical_param::test
