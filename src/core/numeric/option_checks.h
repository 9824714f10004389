#pragma once

#include "spherical_param/errors.h"

#include <string>

namespace spherical_param::internal {

/// Throws InvalidInput for a value outside an enumeration whose values count from 0.
///
/// \param what the public function and its option, for the message.
template <typename Enum>
void checkEnum(const char* what, Enum value, Enum last) {
  const auto number = static_cast<long long>(value);
  if (number < 0 || number > static_cast<long long>(last))
    throw InvalidInput(std::string(what) + " = " + std::to_string(number) +
                       " is not a value of its type; use one of its enumerators");
}

}  // namespace spherical_param::internal
