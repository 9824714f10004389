#pragma once

#include "spherical_param/options.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <optional>
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
  std::string field;                 ///< of Options, such as "paper.k"
  std::string help;                  ///< one line
  bool expert = false;               ///< most users do not need it
  bool optional = false;             ///< may be unset
  std::vector<std::string> choices;  ///< names of values; empty for plain numbers
  bool is_number = false;            ///< takes numbers, perhaps besides choices
  bool is_point = false;             ///< takes texts of toPoint() besides choices
  bool is_integer = false;           ///< of numbers
  double min = 0.0;                  ///< of numbers
  double max = 0.0;                  ///< of numbers
  bool min_excluded = false;         ///< of numbers: `min` itself is out of range
  /// The option has an effect only if each of these options has one of the listed values.
  std::vector<std::pair<std::string, std::vector<std::string>>> used_with;

  std::function<OptionValue(const Options&)> get;  ///< the value
  /// Sets a value, which must be in range; an integer is also a number.
  std::function<void(Options&, const OptionValue&)> set;
};

/// All named options in the order of the stages. Tools, the Python module, ROS nodes and the
/// reference page are made from it. A new option is one more row.
///
/// \return the rows; always the same object.
const std::vector<OptionRow>& optionTable();

/// The row of an option.
///
/// \param name of the option.
/// \return its row.
/// \throw InvalidInput for an unknown name.
const OptionRow& findOption(const std::string& name);

/// Sets an option.
///
/// \param options to be changed.
/// \param name    of the option.
/// \param value   of the kind of the option; std::monostate unsets an optional one.
/// \throw InvalidInput for an unknown name, or a value of another kind or out of range.
void setOption(Options& options, const std::string& name, const OptionValue& value);

/// The range of an option in words, such as "an integer from 3 up" or "default or paper".
///
/// \param row of the option.
/// \return the words.
std::string rangeOf(const OptionRow& row);

/// The coordinates of a point.
///
/// \param text such as "1.5,0,-2".
/// \return them; empty for another text, or numbers that are not finite.
std::optional<Eigen::Vector3d> toPoint(const std::string& text);

/// A value in words.
///
/// \param value of an option.
/// \return the words; "unset" for std::monostate.
std::string textOf(const OptionValue& value);

/// @}

}  // namespace spherical_param
