#pragma once

#include "spherical_param/options.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace spherical_param_ros {

/// How clouds are meshed, and how they are queued.
struct Settings {
  spherical_param::Options options;  ///< `progress` is ignored
  /// Larger clouds are refused, so that no cloud takes all memory; 0: no limit.
  std::size_t max_points = 5000000;
  std::size_t queue_depth = 1;  ///< maximum number of waiting clouds; >= 1
  bool cancel_running = true;   ///< when a newer cloud arrives
  int max_cancellations = 3;    ///< in a row; then one cloud is meshed to its end
};

/// A value of a parameter. An integer is also a number.
using Value = std::variant<bool, std::int64_t, double, std::string>;

/// The value of an unset optional parameter.
inline constexpr int kUnset = -1;

/// A parameter, and its place in the settings.
struct Parameter {
  std::string name;
  std::string description;  ///< meaning and range
  Value default_value;
  double min = 0.0;                  ///< of numbers; kUnset if optional
  double max = 0.0;                  ///< of numbers
  std::vector<std::string> choices;  ///< of strings
  std::function<Value(const Settings&)> get;
  std::function<void(Settings&, const Value&)> set;  ///< as setParameter()
};

/// All parameters: the rows of spherical_param::optionTable(), then those of Settings.
const std::vector<Parameter>& parameters();

/// Changes one setting; the others stay.
///
/// \throw spherical_param::InvalidInput ("cause; remedy") for an unknown name, the wrong type or a
///        value out of range. The settings are unchanged then.
void setParameter(Settings& settings, const std::string& name, const Value& value);

/// The value that setParameter() would take.
Value parameterOf(const Settings& settings, const std::string& name);

/// A value as a user would write it.
std::string textOf(const Value& value);

}  // namespace spherical_param_ros
