#include "common/reconstruction_options.h"

#include "common/cloud_reader.h"
#include "common/errors.h"
#include "common/numbers.h"
#include "common/text.h"
#include "parallel.h"
#include "spherical_param/option_table.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <variant>

namespace spherical_param::tools {
namespace {

/// The condition of an option that does not hold, if any: the other option and the value it needs.
std::optional<std::pair<std::string, std::string>> failedCondition(const OptionRow& row,
                                                                   const Options& options) {
  const auto failed =
      std::find_if(row.used_with.begin(), row.used_with.end(), [&](const auto& condition) {
        const auto& [other, values] = condition;
        return std::find(values.begin(), values.end(), optionText(options, other)) == values.end();
      });
  if (failed == row.used_with.end()) {
    return std::nullopt;
  }
  return std::pair(failed->first, failed->second.front());
}

/// The name of an option on the command line, where words are joined by dashes.
std::string flagOf(const OptionRow& row) {
  std::string flag = row.name;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

OptionValue parseValue(const OptionRow& row, const std::string& text) {
  const auto value_of = [](const auto& parsed) {
    return parsed ? OptionValue(*parsed) : OptionValue();
  };
  const bool is_choice =
      std::find(row.choices.begin(), row.choices.end(), text) != row.choices.end();
  OptionValue value = is_choice || !row.is_number ? OptionValue(text)
                      : row.is_integer            ? value_of(toInteger(text))
                                                  : value_of(toReal(text));
  if (value.index() != 0) {
    try {
      Options scratch;
      setOption(scratch, row.name, value);
      return value;
    } catch (const InvalidInput&) {
      // Reported below, in the words of the command line.
    }
  }
  throw UsageError("option -" + flagOf(row) + ": " + inQuotes(text) + " is not allowed",
                   "give -" + flagOf(row) + " " + rangeOf(row));
}

/// The rows of the table that tools have. Only the page of -report shows a history, and sets how
/// much of it is kept.
std::vector<OptionRow> toolRows() {
  std::vector<OptionRow> rows = optionTable();
  rows.erase(std::remove_if(rows.begin(), rows.end(),
                            [](const OptionRow& row) {
                              return row.field.rfind("embedding.history_", 0) == 0;
                            }),
             rows.end());
  return rows;
}

Options parseOptions(const CommandLine& command_line, Options options) {
  for (const OptionRow& row : toolRows()) {
    if (command_line.has(flagOf(row))) {
      setOption(options, row.name, parseValue(row, command_line.value(flagOf(row), "")));
    }
  }
  const Options in_force = withTopology(options);
  for (const OptionRow& row : toolRows()) {
    const auto failed = failedCondition(row, in_force);
    if (failed && command_line.has(flagOf(row))) {
      const auto& [other, needed] = *failed;
      throw UsageError("option -" + flagOf(row) + " does nothing with -" + other + " " +
                           optionText(in_force, other),
                       "leave -" + flagOf(row) + " out, or give -" + other + " " + needed);
    }
  }
  options.threads = options.threads == 0 ? internal::processorCount() : options.threads;
  return options;
}

Json jsonOf(const OptionValue& value) {
  return std::visit(
      [](const auto& content) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(content)>, std::monostate>) {
          return nullptr;
        } else {
          return content;
        }
      },
      value);
}

}  // namespace

std::string optionText(const Options& options, const std::string& name) {
  return spherical_param::textOf(findOption(name).get(options));
}

std::vector<OptionInfo> reconstructionOptions(const Options& defaults) {
  std::vector<OptionInfo> lines;
  for (const OptionRow& row : toolRows()) {
    std::string argument;
    for (const std::string& choice : row.choices) {
      argument += (argument.empty() ? "" : "|") + choice;
    }
    if (row.is_number) {
      argument += (argument.empty() ? "" : "|") + std::string(row.is_integer ? "N" : "X");
    }
    lines.push_back({flagOf(row), argument,
                     row.help + (row.is_number ? "; " + rangeOf(row) : "") + " (" +
                         spherical_param::textOf(row.get(defaults)) + ")",
                     row.expert});
  }
  lines.push_back(
      {"columns", "NAMES",
       "of a text file, from the first on: x,y,z,-,red,green,blue,nx,ny,nz; - leaves one "
       "out, other names are kept as numbers (as the file says)",
       false});
  lines.push_back(
      {"strict", "",
       "end with exit code 1 if the mesh has self-intersections or folds, fills openings, "
       "cuts handles or joins parts",
       false});
  return lines;
}

ReconstructionSettings parseReconstructionOptions(const CommandLine& command_line,
                                                  const Options& defaults) {
  ReconstructionSettings settings;
  settings.options = parseOptions(command_line, defaults);
  settings.strict = command_line.has("strict");
  if (command_line.has("columns")) {
    settings.columns = parseColumns(command_line.value("columns", ""));
  }
  return settings;
}

void printReconstructionOptions(const ReconstructionSettings& settings, Console& console) {
  const Options in_force = withTopology(settings.options);
  for (const OptionRow& row : toolRows()) {
    const OptionValue value = row.get(in_force);
    if (value.index() != 0 && !failedCondition(row, in_force)) {
      console.entry(flagOf(row), spherical_param::textOf(value));
    }
  }
  if (settings.strict) {
    console.entry("strict", "faults are a failure");
  }
}

Json reconstructionOptionsToJson(const ReconstructionSettings& settings) {
  Json json;
  const Options in_force = withTopology(settings.options);
  for (const OptionRow& row : toolRows()) {
    json[row.name] = failedCondition(row, in_force) ? Json(nullptr) : jsonOf(row.get(in_force));
  }
  json["columns"] = settings.columns.empty() ? Json(nullptr) : Json(settings.columns);
  json["strict"] = settings.strict;
  return json;
}

}  // namespace spherical_param::tools
