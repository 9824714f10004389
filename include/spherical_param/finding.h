#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace spherical_param {

/// \addtogroup checks
/// @{

/// What a user should know of a mesh, and what to do about it.
struct Finding {
  std::string text;  ///< a clause, e.g. "2 separate parts (395 and 5,633 points)"
  /// The option that deals with it: a name of optionTable(), or `parts` or `outliers` of tools,
  /// Python and ROS; empty if there is none.
  std::string option;
  std::string value;      ///< of that option, e.g. "largest"
  bool is_fault = false;  ///< a self-intersection, fold, filled opening, cut handle or joined part
};

/// Whether one of them is a fault.
///
/// \param findings of a result.
/// \return false if there are none.
inline bool hasFault(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& finding) { return finding.is_fault; });
}

/// @}

}  // namespace spherical_param
