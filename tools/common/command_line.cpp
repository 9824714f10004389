#include "common/command_line.h"

#include "common/errors.h"
#include "common/text.h"

#include <boost/program_options/errors.hpp>
#include <boost/program_options/options_description.hpp>
#include <boost/program_options/parsers.hpp>

#include <algorithm>
#include <cstddef>

namespace spherical_param::tools {
namespace {

namespace po = boost::program_options;

/// Options that every tool has.
std::vector<OptionInfo> commonOptions() {
  return {{"h", "", "show this help (also -help)", false},
          {"version", "", "show the version", false}};
}

/// Whether a word is one of the options. Boost would take it for the value of the one before.
bool isKnown(const std::string& word, const std::vector<OptionInfo>& options) {
  return std::any_of(options.begin(), options.end(), [&word](const OptionInfo& option) {
    return word == "-" + option.name || word == "--" + option.name;
  });
}

/// Boost takes an unknown option with one dash for a word like any other. Words after "--" may
/// begin with a dash, and a lone dash is no option.
void refuseUnknownOptions(const std::vector<std::string>& words,
                          const std::vector<std::string>& others) {
  const auto terminator = std::find(words.begin(), words.end(), "--");
  const auto after = terminator == words.end() ? 0 : words.end() - terminator - 1;
  const auto end = others.end() - std::min<std::ptrdiff_t>(after, others.end() - others.begin());
  const auto unknown = std::find_if(others.begin(), end, [](const std::string& word) {
    return word.size() > 1 && word[0] == '-';
  });
  if (unknown != end) {
    throw UsageError("unrecognised option " + inQuotes(*unknown),
                     "run the tool with -h for the options and their values");
  }
}

}  // namespace

CommandLine::CommandLine(const std::vector<std::string>& words,
                         const std::vector<OptionInfo>& options) {
  std::vector<OptionInfo> known = commonOptions();
  known.push_back({"help", "", "", false});
  known.insert(known.end(), options.begin(), options.end());
  po::options_description description;
  for (const OptionInfo& option : known) {
    if (option.argument.empty()) {
      description.add_options()(option.name.c_str(), "");
    } else {
      description.add_options()(option.name.c_str(), po::value<std::string>(), "");
    }
  }

  // No short options: "-k" is the long option k with one dash, as "-graph" is.
  namespace style = po::command_line_style;
  const int accepted = style::allow_long | style::long_allow_adjacent | style::long_allow_next |
                       style::allow_long_disguise;
  try {
    const auto parsed = po::command_line_parser(words).options(description).style(accepted).run();
    for (const po::option& option : parsed.options) {
      const std::string value = option.value.empty() ? std::string() : option.value.front();
      if (option.position_key >= 0 || option.string_key.empty()) {
        others_.push_back(value);
      } else if (isKnown(value, known)) {
        throw UsageError("option -" + option.string_key + " has no value, as " + inQuotes(value) +
                             " is an option itself",
                         "run the tool with -h for the options and their values");
      } else if (!values_.emplace(option.string_key, value).second) {
        throw UsageError("option -" + option.string_key + " is given more than once",
                         "give it once");
      }
    }
  } catch (const po::error& error) {
    // Boost writes all names with two dashes.
    std::string message = error.what();
    const std::size_t dashes = message.find("'--");
    if (dashes != std::string::npos) {
      message.erase(dashes + 1, 1);
    }
    throw UsageError(message, "run the tool with -h for the options and their values");
  }
  refuseUnknownOptions(words, others_);
}

std::string CommandLine::value(const std::string& option, const std::string& fallback) const {
  const auto found = values_.find(option);
  return found == values_.end() ? fallback : found->second;
}

std::pair<std::string, std::string> inputAndOutput(const CommandLine& command_line,
                                                   const std::string& tool) {
  const std::vector<std::string>& files = command_line.others();
  if (files.size() != 2) {
    throw UsageError(files.empty()       ? "there is no input file"
                     : files.size() == 1 ? "there is no output file"
                                         : "there is one file too many: " + inQuotes(files[2]),
                     "run '" + tool + " input output [options]', -h shows the options");
  }
  return {files[0], files[1]};
}

std::vector<OptionInfo> joined(std::initializer_list<std::vector<OptionInfo>> tables) {
  std::vector<OptionInfo> all;
  for (const std::vector<OptionInfo>& table : tables) {
    all.insert(all.end(), table.begin(), table.end());
  }
  return all;
}

std::string describeOptions(const std::vector<OptionInfo>& options) {
  std::vector<OptionInfo> listed = options;
  for (OptionInfo& option : commonOptions()) {
    listed.push_back(std::move(option));
  }
  std::size_t width = 0;
  for (const OptionInfo& option : listed) {
    width = std::max(width, option.name.size() + option.argument.size());
  }
  std::stable_partition(listed.begin(), listed.end(),
                        [](const OptionInfo& option) { return !option.expert; });
  std::string text;
  bool expert = false;
  for (const OptionInfo& option : listed) {
    if (option.expert && !expert) {
      text += "\nExpert options:\n";
    }
    expert = option.expert;
    const std::string left =
        "  -" + option.name + (option.argument.empty() ? "" : " " + option.argument);
    text += left + std::string(width + 6 - left.size(), ' ') + option.help + "\n";
  }
  return text;
}

std::string describeExamples(const std::string& tool,
                             const std::vector<std::pair<std::string, std::string>>& examples) {
  std::string text = "Examples:\n";
  for (const auto& [remark, words] : examples) {
    text += "  " + remark + "\n    " + tool + " " + words + "\n";
  }
  return text;
}

}  // namespace spherical_param::tools
