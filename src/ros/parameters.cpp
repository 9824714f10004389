#include "spherical_param_ros/parameters.h"

#include "spherical_param/errors.h"
#include "spherical_param/option_table.h"

#include <charconv>
#include <functional>
#include <limits>
#include <sstream>
#include <utility>

namespace spherical_param_ros {
namespace {

using spherical_param::InvalidInput;
using spherical_param::OptionRow;
using spherical_param::OptionValue;

/// A parameter and its place in the settings.
struct Parameter {
  ParameterInfo info;
  std::function<Value(const Settings&)> get;
  std::function<void(Settings&, const Value&)> set;  ///< throws InvalidInput
};

[[noreturn]] void refuse(const std::string& name, const Value& value, const std::string& range) {
  throw InvalidInput(name + " = " + textOf(value) + " cannot be used; use " + range);
}

bool isUnset(const Value& value) {
  return value == Value(std::int64_t{kUnset}) || value == Value(double{kUnset});
}

Value toValue(const OptionRow& row, const OptionValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return *integer;
  if (const auto* number = std::get_if<double>(&value))
    return *number;
  if (const auto* name = std::get_if<std::string>(&value))
    return *name;
  return row.is_integer ? Value(std::int64_t{kUnset}) : Value(double{kUnset});
}

OptionValue toOption(const OptionRow& row, const Value& value) {
  if (row.optional && isUnset(value))
    return {};
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return *integer;
  if (const auto* number = std::get_if<double>(&value))
    return *number;
  if (const auto* name = std::get_if<std::string>(&value))
    return *name;
  refuse(row.name, value, rangeOf(row));
}

/// The parameter of an option of the core.
Parameter option(const OptionRow& row) {
  const std::string unset = row.optional ? ", or -1: unset" : "";
  return {{row.name, row.help + "; " + rangeOf(row) + unset, toValue(row, row.get({})),
           row.optional ? kUnset : row.min, row.max, row.choices},
          [&row](const Settings& settings) { return toValue(row, row.get(settings.options)); },
          [&row](Settings& settings, const Value& value) {
            setOption(settings.options, row.name, toOption(row, value));
          }};
}

/// A parameter that is an integer from `min` up.
template <typename Field>
Parameter integer(const std::string& name, const std::string& description, int min, Field field) {
  constexpr int max = std::numeric_limits<int>::max();
  const std::string range = "an integer from " + std::to_string(min) + " up";
  Settings defaults;
  return {{name,
           description + "; " + range,
           static_cast<std::int64_t>(field(defaults)),
           double(min),
           double(max),
           {}},
          [field](const Settings& settings) {
            Settings copy = settings;
            return Value(static_cast<std::int64_t>(field(copy)));
          },
          [=](Settings& settings, const Value& value) {
            const auto* number = std::get_if<std::int64_t>(&value);
            if (number == nullptr || *number < min || *number > max)
              refuse(name, value, range);
            field(settings) = static_cast<std::decay_t<decltype(field(settings))>>(*number);
          }};
}

/// A number, or its text; NaN if it is none.
double numberOf(const Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return static_cast<double>(*integer);
  if (const auto* number = std::get_if<double>(&value))
    return *number;
  double number = std::numeric_limits<double>::quiet_NaN();
  if (const auto* text = std::get_if<std::string>(&value)) {
    const char* end = text->data() + text->size();
    if (std::from_chars(text->data(), end, number).ptr != end)
      return std::numeric_limits<double>::quiet_NaN();
  }
  return number;
}

/// The shortest text that is read as the same number.
std::string shortest(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof(text), number).ptr};
}

// Not "off": in YAML that is the truth value false.
constexpr const char* kNone = "none";

Parameter outliers() {
  const std::string name = "outliers";
  const std::string range = "none, auto or a number from 0 to 1000";
  return {{name,
           "points that are left out: stray ones (auto), or those that many deviations off the "
           "others; " +
               range,
           std::string(kNone),
           0.0,
           0.0,
           {}},
          [](const Settings& settings) -> Value {
            if (!settings.outliers)
              return std::string(kNone);
            const std::optional<double>& sigma = settings.outliers->sigma;
            return sigma ? shortest(*sigma) : std::string("auto");
          },
          [=](Settings& settings, const Value& value) {
            if (value == Value(std::string(kNone))) {
              settings.outliers.reset();
            } else if (value == Value(std::string("auto"))) {
              settings.outliers = OutlierChoice();
            } else {
              const double sigma = numberOf(value);
              if (!(sigma >= 0.0 && sigma <= 1000.0))
                refuse(name, value, range);
              settings.outliers = OutlierChoice{sigma};
            }
          }};
}

Parameter parts() {
  const std::string name = "parts";
  // In the order of PartsMode.
  const std::vector<std::string> names = {"all", "largest", "each"};
  return {{name,
           "which parts are meshed: all as one surface, that of most points, or each by itself; "
           "all, largest or each",
           names.front(), 0.0, 0.0, names},
          [=](const Settings& settings) {
            return Value(names[static_cast<std::size_t>(settings.parts)]);
          },
          [=](Settings& settings, const Value& value) {
            for (std::size_t i = 0; i < names.size(); ++i)
              if (value == Value(names[i])) {
                settings.parts = static_cast<spherical_param::PartsMode>(i);
                return;
              }
            refuse(name, value, "all, largest or each");
          }};
}

Parameter cancelRunning() {
  const std::string name = "cancel_running";
  return {{name,
           "a newer cloud cancels the one that is being meshed; true or false",
           Settings().cancel_running,
           0.0,
           0.0,
           {}},
          [](const Settings& settings) { return Value(settings.cancel_running); },
          [=](Settings& settings, const Value& value) {
            if (!std::holds_alternative<bool>(value))
              refuse(name, value, "true or false");
            settings.cancel_running = std::get<bool>(value);
          }};
}

std::vector<Parameter> makeParameters() {
  std::vector<Parameter> all;
  for (const OptionRow& row : spherical_param::optionTable())
    all.push_back(option(row));
  all.push_back(outliers());
  all.push_back(parts());
  all.push_back(integer(
      "min_points", "points of a part, at least, unless parts is all", 4,
      [](Settings & s) -> auto& { return s.min_points; }));
  all.push_back(integer(
      "max_points", "larger clouds are refused; 0: none is", 0,
      [](Settings & s) -> auto& { return s.max_points; }));
  all.push_back(integer(
      "queue_depth", "clouds that wait, at most; the oldest is dropped", 1,
      [](Settings & s) -> auto& { return s.queue_depth; }));
  all.push_back(cancelRunning());
  all.push_back(integer(
      "max_cancellations", "cancellations in a row, at most; the next cloud is meshed to its end",
      0, [](Settings & s) -> auto& { return s.max_cancellations; }));
  return all;
}

const std::vector<Parameter>& table() {
  static const std::vector<Parameter> all = makeParameters();
  return all;
}

const Parameter& find(const std::string& name) {
  std::string names;
  for (const Parameter& parameter : table()) {
    if (parameter.info.name == name)
      return parameter;
    names += (names.empty() ? "" : ", ") + parameter.info.name;
  }
  throw InvalidInput("there is no parameter '" + name + "'; there are " + names);
}

}  // namespace

const std::vector<ParameterInfo>& parameters() {
  static const std::vector<ParameterInfo> all = [] {
    std::vector<ParameterInfo> infos;
    for (const Parameter& parameter : table())
      infos.push_back(parameter.info);
    return infos;
  }();
  return all;
}

void setParameter(Settings& settings, const std::string& name, const Value& value) {
  find(name).set(settings, value);
}

Value parameterOf(const Settings& settings, const std::string& name) {
  return find(name).get(settings);
}

std::string textOf(const Value& value) {
  std::ostringstream text;
  if (const auto* truth_value = std::get_if<bool>(&value))
    text << (*truth_value ? "true" : "false");
  else if (const auto* number = std::get_if<std::int64_t>(&value))
    text << *number;
  else if (const auto* real_number = std::get_if<double>(&value))
    text << *real_number;
  else
    text << "'" << std::get<std::string>(value) << "'";
  return text.str();
}

}  // namespace spherical_param_ros
