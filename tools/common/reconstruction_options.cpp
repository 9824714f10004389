#include "common/reconstruction_options.h"

#include "common/cloud_reader.h"
#include "common/text.h"
#include "parallel.h"
#include "spherical_param/option_table.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace spherical_param::tools {
namespace {

/// The condition of an option that does not hold, if any: the other option and the value it needs.
std::optional<std::pair<std::string, std::string>> failedCondition(const OptionRow& row,
                                                                   const Options& options) {
  for (const auto& [other, values] : row.used_with) {
    const std::string value = spherical_param::textOf(findOption(other).get(options));
    if (std::find(values.begin(), values.end(), value) == values.end()) {
      return std::pair(other, values.front());
    }
  }
  return std::nullopt;
}

}  // namespace

OptionTable reconstructionOptions(ReconstructionSettings& settings) {
  OptionTable options;
  for (const OptionRow& row : optionTable()) {
    OptionInfo option = optionOf(
        row, [row, &settings] { return row.get(settings.options); },
        [row, &settings](const OptionValue& value) { row.set(settings.options, value); });
    option.value = [row, &settings] {
      const Options in_force = withTopology(settings.options);
      return failedCondition(row, in_force) ? Json() : toJson(row.get(in_force));
    };
    options.push_back(option);
  }
  options.push_back(
      {"columns", "NAMES",
       "of a text file, from the first on: x,y,z,-,red,green,blue,nx,ny,nz; - leaves one "
       "out, other names are kept as numbers (as the file says)",
       false, [&settings](const std::string& text) { settings.columns = parseColumns(text); },
       [&settings] { return settings.columns.empty() ? Json() : Json(settings.columns); }});
  options.push_back(
      flagOption("strict",
                 "end with exit code 1 if the mesh has self-intersections or folds, fills "
                 "openings, cuts handles or joins parts",
                 settings.strict));
  return options;
}

void parseReconstructionOptions(const CommandLine& command_line, ReconstructionSettings& settings) {
  const Options in_force = withTopology(settings.options);
  for (const OptionRow& row : optionTable()) {
    if (const auto failed = failedCondition(row, in_force)) {
      const auto& [other, needed] = *failed;
      command_line.refuse({replaced(row.name, '_', '-')},
                          "-" + other + " " +
                              spherical_param::textOf(findOption(other).get(in_force)),
                          "-" + other + " " + needed);
    }
  }
  int& threads = settings.options.threads;
  threads = threads == 0 ? internal::processorCount() : threads;
}

}  // namespace spherical_param::tools
