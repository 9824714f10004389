#pragma once

#include "common/errors.h"
#include "common/text.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {

/// The values of an enumeration with the names that the user gives them.
template <typename Value>
using Names = std::vector<std::pair<std::string, Value>>;

/// The value that an option names. \throw UsageError that lists all names.
template <typename Value>
Value parseName(const std::string& option, const std::string& text, const Names<Value>& names) {
  std::string known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].first == text) {
      return names[i].second;
    }
    known += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i].first;
  }
  throw UsageError("option -" + option + ": " + inQuotes(text) + " is unknown",
                   "give -" + option + " " + known);
}

/// The name of a value, empty if it has none.
template <typename Value>
std::string nameOf(Value value, const Names<Value>& names) {
  for (const auto& [name, known] : names) {
    if (known == value) {
      return name;
    }
  }
  return "";
}

}  // namespace spherical_param::tools
