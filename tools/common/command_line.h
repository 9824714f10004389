#pragma once

#include "common/json_report.h"
#include "spherical_param/option_table.h"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace spherical_param::tools {

/// An option of a tool.
struct OptionInfo {
  std::string name;      ///< without dash
  std::string argument;  ///< what follows it, e.g. "N"; empty for a switch
  std::string help;      ///< one line
  bool expert = false;   ///< listed by `-h expert` alone
  std::function<void(const std::string&)> take = {};  ///< sets it to a text. \throw UsageError
  std::function<Json()> value = {};  ///< in force; null: not set, or without effect
};
using OptionTable = std::vector<OptionInfo>;

/// Tables of options one after the other.
OptionTable joined(const std::vector<OptionTable>& tables);

/// A row like those of the library's table.
OptionRow rowOf(const std::string& name, const std::string& help);
/// A row as an option of a tool.
OptionInfo optionOf(const OptionRow& row, const std::function<OptionValue()>& get,
                    const std::function<void(const OptionValue&)>& set);

/// Options of fields, which must outlive them. The help ends with range and default.
OptionInfo flagOption(const std::string& name, const std::string& help, bool& field);
OptionInfo fileOption(const std::string& name, const std::string& help, std::string& field);

/// \param field a number, or an optional one.
template <typename Field>
OptionInfo numberOption(const std::string& name, const std::string& help, Field& field, double min,
                        double max) {
  using Value = typename decltype(std::optional(field))::value_type;
  using Wide = std::conditional_t<std::is_same_v<Value, double>, double, std::int64_t>;
  OptionRow row = rowOf(name, help);
  row.is_number = true;
  row.is_integer = std::is_same_v<Wide, std::int64_t>;
  row.min = min;
  row.max = max;
  return optionOf(
      row,
      [&field]() -> OptionValue {
        const std::optional<Value> value = field;
        return value ? OptionValue(static_cast<Wide>(*value)) : OptionValue();
      },
      [&field](const OptionValue& value) { field = static_cast<Value>(std::get<Wide>(value)); });
}

/// The values of an enumeration with the names that the user gives them.
template <typename Value>
using Names = std::vector<std::pair<std::string, Value>>;

/// The name of a value, empty if it has none.
template <typename Value>
std::string nameOf(Value value, const Names<Value>& names) {
  for (const auto& [name, known] : names) {
    if (known == value) {
      return name;
    }
  }
  return "";
}

template <typename Value>
OptionInfo choiceOption(const std::string& name, const std::string& help, Value& field,
                        const Names<Value>& names) {
  OptionRow row = rowOf(name, help);
  for (const auto& entry : names) {
    row.choices.push_back(entry.first);
  }
  return optionOf(
      row, [&field, names] { return nameOf(field, names); },
      [&field, names](const OptionValue& value) {
        for (const auto& [known, meaning] : names) {
          field = known == std::get<std::string>(value) ? meaning : field;
        }
      });
}

Json toJson(const OptionValue& value);

/// The option, whose value is null unless a condition holds.
OptionInfo usedIf(const std::function<bool()>& condition, OptionInfo option);

/// The values by name, where words are joined by underscores.
Json optionsToJson(const OptionTable& options);

/// The lines of a help text that list the options.
///
/// \param with_experts lists the options of experts, too; else the last line says how to list them.
std::string describeOptions(const OptionTable& options, bool with_experts);

/// A command line in the style of the PCL tools: `-opt value`, `--opt value`, `-opt=value` and
/// `--opt=value`, in any order with the other words.
class CommandLine {
public:
  /// Takes the words apart. The options -h, -help and -version are always known.
  /// \throw UsageError for an unknown or repeated option, or a missing or superfluous value.
  CommandLine(const std::vector<std::string>& words, OptionTable options);

  /// Whether the option was given.
  bool has(const std::string& option) const { return values_.count(option) > 0; }
  /// The option's value, or the fallback if it was not given.
  std::string value(const std::string& option, const std::string& fallback) const {
    return has(option) ? values_.at(option) : fallback;
  }
  /// All words, as they were given.
  const std::vector<std::string>& words() const { return words_; }
  /// The words that belong to no option, in their order.
  const std::vector<std::string>& others() const { return others_; }

  /// Sets all options that were given. \throw UsageError
  void apply(const OptionTable& options) const;
  /// \throw UsageError if one of the options was given: it has no effect with `with`.
  void refuse(const std::vector<std::string>& options, const std::string& with,
              const std::string& instead) const;

private:
  std::vector<std::string> words_;
  std::map<std::string, std::string> values_;
  std::vector<std::string> others_;
};

}  // namespace spherical_param::tools
