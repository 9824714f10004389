#pragma once

#include "spherical_param/reconstruct.h"

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace spherical_param_ros {

/// A parameter that cannot be taken: the message is "cause; remedy".
class ParameterError : public std::invalid_argument {
public:
  using std::invalid_argument::invalid_argument;
};

/// How outliers are told from the points of a surface, as the command line tool has it.
enum class OutlierMethod { Paper, Statistical };

/// How clouds are meshed, and how they wait for it.
struct Settings {
  spherical_param::Options options;     ///< `progress` has no say
  std::optional<double> outlier_sigma;  ///< none: outliers are not looked for
  OutlierMethod outlier_method = OutlierMethod::Paper;
  /// Larger clouds are refused, so that no cloud takes all memory; 0: none is.
  std::size_t max_points = 5000000;
  std::size_t queue_depth = 1;  ///< clouds that wait, at most; 1 and up
  bool cancel_running = true;   ///< when a newer cloud arrives
  int max_cancellations = 3;    ///< in a row; the next cloud is then meshed to its end
};

/// A value as middleware has it. An integer does where a real number is wanted.
using Value = std::variant<bool, int, double, std::string>;

/// A parameter, for declarations and documentation.
struct ParameterInfo {
  std::string name;  ///< that of the tool's option, with _ for -
  std::string description;
  Value default_value;
  /// Of numbers. Integers have the additional value 0 or -1 where the description says so.
  double min = 0.0;
  double max = 0.0;
  std::vector<std::string> choices;  ///< of strings
};

/// All parameters, in the order of the tool's help, then those of the queue.
const std::vector<ParameterInfo>& parameters();

/// Changes one setting; the others stay. \throw ParameterError for a name that there is not, the
/// wrong type, a value out of range; the settings are then unchanged.
void setParameter(Settings& settings, const std::string& name, const Value& value);

/// The value that setParameter() would take.
Value parameterOf(const Settings& settings, const std::string& name);

/// A value as a user would write it.
std::string textOf(const Value& value);

}  // namespace spherical_param_ros
