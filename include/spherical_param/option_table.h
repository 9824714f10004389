#pragma once

#include "spherical_param/options.h"

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace spherical_param {

/// \addtogroup pipeline
/// @{

/// The value of an option: nothing (unset), an integer, a number or the name of a choice.
using OptionValue = std::variant<std::monostate, std::int64_t, double, std::string>;

/// One row of the table of options.
struct OptionRow {
  std::string name;                  ///< the same in tools, Python and ROS
  std::string field;                 ///< of Options, such as "graph.k"
  std::string help;                  ///< one line
  bool expert;                       ///< most users need not know it
  bool optional;                     ///< may be unset
  std::vector<std::string> choices;  ///< names of values; empty for plain numbers
  bool is_number;                    ///< takes numbers, whether there are choices or not
  bool is_integer;                   ///< of numbers
  double min;                        ///< of numbers
  double max;                        ///< of numbers
  bool min_excluded;                 ///< of numbers: `min` itself is out of range
  /// Options and the values of which they must have one for this option to have an effect.
  std::vector<std::pair<std::string, std::vector<std::string>>> used_with;

  std::function<OptionValue(const Options&)> get;  ///< the value
  /// Sets a value that is in range; an integer is a number, too.
  std::function<void(Options&, const OptionValue&)> set;
};

/// All options that have a name, in the order of the stages: what tools, the Python module, the ROS
/// nodes and the reference page list. A new option is one more row.
///
/// \return the rows; the same object in each call.
const std::vector<OptionRow>& optionTable();

/// The row of an option.
///
/// \param name of the option.
/// \return its row.
/// \throw InvalidInput if there is none.
const OptionRow& findOption(const std::string& name);

/// Sets an option.
///
/// \param options to be changed.
/// \param name    of the option.
/// \param value   of the kind of the option; nothing unsets an optional one.
/// \throw InvalidInput for a name that does not exist, or a value of another kind or out of range.
void setOption(Options& options, const std::string& name, const OptionValue& value);

/// The range of an option in words, such as "an integer from 3 up" or "delaunay or knn".
///
/// \param row of the option.
/// \return the words.
std::string rangeOf(const OptionRow& row);

/// A value in words.
///
/// \param value of an option.
/// \return the words; "unset" for nothing.
std::string textOf(const OptionValue& value);

/// @}

}  // namespace spherical_param
