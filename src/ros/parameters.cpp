#include "spherical_param_ros/parameters.h"

#include "spherical_param/errors.h"
#include "spherical_param/option_table.h"

#include <charconv>
#include <limits>
#include <locale>
#include <sstream>
#include <type_traits>

namespace spherical_param_ros {
namespace {

using spherical_param::InvalidInput;
using spherical_param::OptionRow;
using spherical_param::OptionValue;

[[noreturn]] void refuse(const std::string& name, const Value& value, const std::string& range) {
  throw InvalidInput(name + " = " + textOf(value) + " cannot be used; use " + range);
}

bool isUnset(const Value& value) {
  return value == Value(std::int64_t{kUnset}) || value == Value(double{kUnset});
}

/// The shortest text that is read as the same number.
std::string shortest(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof(text), number).ptr};
}

/// Whether numbers are given as texts: a parameter of ROS has one type.
bool isText(const OptionRow& row) {
  return !row.choices.empty();
}

Value toValue(const OptionRow& row, const OptionValue& value) {
  if (const auto* name = std::get_if<std::string>(&value))
    return *name;
  const auto* integer = std::get_if<std::int64_t>(&value);
  const auto* number = std::get_if<double>(&value);
  if (isText(row))
    return shortest(number != nullptr ? *number : static_cast<double>(*integer));
  if (integer != nullptr)
    return *integer;
  if (number != nullptr)
    return *number;
  return row.is_integer ? Value(std::int64_t{kUnset}) : Value(double{kUnset});
}

OptionValue toOption(const OptionRow& row, const Value& value) {
  if (row.optional && isUnset(value))
    return {};
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return *integer;
  if (const auto* number = std::get_if<double>(&value))
    return *number;
  if (const auto* text = std::get_if<std::string>(&value)) {
    std::istringstream stream(*text);  // libc++ has no from_chars() of real numbers
    stream.imbue(std::locale::classic());
    double number = 0.0;
    if (row.is_number && stream >> std::noskipws >> number && stream.eof())
      return number;
    return *text;
  }
  refuse(row.name, value, rangeOf(row));
}

/// The parameter of an option of the core.
Parameter option(const OptionRow& row) {
  const std::string unset = row.optional ? ", or -1: unset" : "";
  Parameter parameter{
      row.name,
      row.help + "; " + rangeOf(row) + unset,
      toValue(row, row.get({})),
      row.optional ? kUnset : row.min,
      row.max,
      row.choices,
      [&row](const Settings& settings) { return toValue(row, row.get(settings.options)); },
      [&row](Settings& settings, const Value& value) {
        setOption(settings.options, row.name, toOption(row, value));
      }};
  if ((row.is_number || row.is_point) && isText(row)) {
    // Any text may be given: it may be a number or a point.
    parameter.choices.clear();
    parameter.min = parameter.max = 0.0;
  }
  return parameter;
}

/// A parameter that is a field of the settings: true or false, or an integer from `min` up.
template <typename Field>
Parameter own(const std::string& name, const std::string& description, Field Settings::*field,
              int min = 0) {
  constexpr bool is_flag = std::is_same_v<Field, bool>;
  using Known = std::conditional_t<is_flag, bool, std::int64_t>;
  constexpr std::int64_t max = is_flag ? 1 : std::numeric_limits<int>::max();
  const std::string range =
      is_flag ? "true or false" : "an integer from " + std::to_string(min) + " up";
  const auto get = [field](const Settings& settings) {
    return Value(static_cast<Known>(settings.*field));
  };
  return {name,
          description + "; " + range,
          get({}),
          double(min),
          double(max),
          {},
          get,
          [=](Settings& settings, const Value& value) {
            const auto* known = std::get_if<Known>(&value);
            if (known == nullptr || std::int64_t{*known} < min || std::int64_t{*known} > max)
              refuse(name, value, range);
            settings.*field = static_cast<Field>(*known);
          }};
}

std::vector<Parameter> makeParameters() {
  std::vector<Parameter> all;
  for (const OptionRow& row : spherical_param::optionTable())
    all.push_back(option(row));
  all.push_back(own("max_points", "larger clouds are refused; 0: no limit", &Settings::max_points));
  all.push_back(own("queue_depth", "maximum number of waiting clouds; the oldest is dropped",
                    &Settings::queue_depth, 1));
  all.push_back(own("cancel_running", "a newer cloud cancels the work on the current one",
                    &Settings::cancel_running));
  all.push_back(own("max_cancellations",
                    "maximum number of cancellations in a row; then a cloud is meshed to its end",
                    &Settings::max_cancellations));
  return all;
}

const Parameter& find(const std::string& name) {
  std::string names;
  for (const Parameter& parameter : parameters()) {
    if (parameter.name == name)
      return parameter;
    names += (names.empty() ? "" : ", ") + parameter.name;
  }
  throw InvalidInput("unknown parameter '" + name + "'; use one of " + names);
}

}  // namespace

const std::vector<Parameter>& parameters() {
  static const std::vector<Parameter> all = makeParameters();
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
  text << std::boolalpha;
  if (std::holds_alternative<std::string>(value))
    text << "'" << std::get<std::string>(value) << "'";
  else
    std::visit([&](const auto& known) { text << known; }, value);
  return text.str();
}

}  // namespace spherical_param_ros
