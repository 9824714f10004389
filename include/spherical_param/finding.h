#pragma once

#include <string>

namespace spherical_param {

/// \addtogroup checks
/// @{

/// What a user should know of a mesh, and what to do about it.
struct Finding {
  std::string text;  ///< a clause, e.g. "2 separate parts (395 and 5,633 points)"
  /// The option that deals with it: a name of optionTable(), or `parts`, `outliers` or `smoothing`
  /// of tools and Python; empty if there is none.
  std::string option;
  std::string value;      ///< of that option, e.g. "largest"
  bool is_fault = false;  ///< a self-intersection, fold, filled opening, cut handle or joined part
};

/// @}

}  // namespace spherical_param
