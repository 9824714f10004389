#pragma once

#include <map>
#include <string>
#include <vector>

namespace spherical_param::tools {

/// An option as the help shows it.
struct OptionInfo {
  std::string name;      ///< without dash
  std::string argument;  ///< what follows it, e.g. "N"; empty for a switch
  std::string help;      ///< one line
};

/// A command line in the style of the PCL tools: `-opt value`, `--opt value`, `-opt=value` and
/// `--opt=value`, in any order with the other words.
class CommandLine {
public:
  /// Takes the words apart. The options -h, -help and -version are always known.
  /// \throw UsageError for an unknown or repeated option, or a missing or superfluous value.
  CommandLine(const std::vector<std::string>& words, const std::vector<OptionInfo>& options);

  /// Tells whether the option was given.
  bool has(const std::string& option) const { return values_.count(option) > 0; }
  /// The option's value, or the fallback if it was not given.
  std::string value(const std::string& option, const std::string& fallback) const;
  /// The words that belong to no option, in their order.
  const std::vector<std::string>& others() const { return others_; }

  bool wantsHelp() const { return has("h") || has("help"); }
  bool wantsVersion() const { return has("version"); }

private:
  std::map<std::string, std::string> values_;
  std::vector<std::string> others_;
};

/// The lines of a help text that list the options, with -h and -version.
std::string describeOptions(const std::vector<OptionInfo>& options);

}  // namespace spherical_param::tools
