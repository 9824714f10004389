#pragma once

#include <stdexcept>

namespace spherical_param {

/// \addtogroup types
/// @{

/// The caller's mistake, found at entry; the message names function, value and remedy.
class InvalidInput : public std::invalid_argument {
public:
  using std::invalid_argument::invalid_argument;
};

/// The computation failed on valid input. Not converging is a result, never a ComputeError.
class ComputeError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The progress callback asked to stop.
class Cancelled : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// @}

}  // namespace spherical_param
