#pragma once

#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace spherical_param::tools {

/// An option as the help shows it.
struct OptionInfo {
  std::string name;      ///< without dash
  std::string argument;  ///< what follows it, e.g. "N"; empty for a switch
  std::string help;      ///< one line
  bool expert = false;   ///< listed by `-h expert` alone
};

/// A command line in the style of the PCL tools: `-opt value`, `--opt value`, `-opt=value` and
/// `--opt=value`, in any order with the other words.
class CommandLine {
public:
  /// Takes the words apart. The options -h, -help and -version are always known.
  /// \throw UsageError for an unknown or repeated option, or a missing or superfluous value.
  CommandLine(const std::vector<std::string>& words, const std::vector<OptionInfo>& options);

  /// Whether the option was given.
  bool has(const std::string& option) const { return values_.count(option) > 0; }
  /// The option's value, or the fallback if it was not given.
  std::string value(const std::string& option, const std::string& fallback) const {
    const auto found = values_.find(option);
    return found == values_.end() ? fallback : found->second;
  }
  /// All options that were given, with their values; those of switches are empty.
  const std::map<std::string, std::string>& values() const { return values_; }
  /// The words that belong to no option, in their order.
  const std::vector<std::string>& others() const { return others_; }

  bool wantsHelp() const { return has("h") || has("help"); }
  /// Whether that of all options is wanted: `-h expert`.
  bool wantsExpertHelp() const {
    return wantsHelp() && others_.size() == 1 && others_.front() == "expert";
  }
  bool wantsVersion() const { return has("version"); }

private:
  std::map<std::string, std::string> values_;
  std::vector<std::string> others_;
};

/// The words of a command line that has an input and an output, and no other word.
/// \throw UsageError
std::pair<std::string, std::string> inputAndOutput(const CommandLine& command_line,
                                                   const std::string& tool);

/// Tables of options one after the other.
std::vector<OptionInfo> joined(std::initializer_list<std::vector<OptionInfo>> tables);

/// The lines of a help text that list the options.
///
/// \param with_experts those of experts, too, in a list of their own; else a line that leads to it.
std::string describeOptions(const std::vector<OptionInfo>& options, bool with_experts);

/// The lines of a help text with examples: of each what it does, and the words after the tool's
/// name.
std::string describeExamples(const std::string& tool,
                             const std::vector<std::pair<std::string, std::string>>& examples);

}  // namespace spherical_param::tools
