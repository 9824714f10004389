#include "common/command_line.h"

#include "common/errors.h"
#include "common/text.h"

#include <boost/program_options/errors.hpp>
#include <boost/program_options/options_description.hpp>
#include <boost/program_options/parsers.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace spherical_param::tools {
namespace {

namespace po = boost::program_options;

constexpr std::size_t help_width = 100;

/// Options that every tool has.
std::vector<OptionInfo> commonOptions() {
  return {{"h", "", "", false}, {"help", "", "", false}, {"version", "", "", false}};
}

/// The least number of letters to insert, leave out or replace that makes one word of another.
std::size_t editDistance(const std::string& from, const std::string& to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = std::exchange(row[j + 1], std::min({replaced, row[j] + 1, row[j + 1] + 1}));
    }
  }
  return row.back();
}

/// \param word as it was given, with dashes and perhaps a value.
UsageError unknownOption(const std::string& word, const std::vector<OptionInfo>& options) {
  const std::size_t begin = std::min(word.find_first_not_of('-'), word.size());
  const std::string name = word.substr(begin, word.find('=') - begin);
  const auto nearest = std::min_element(
      options.begin(), options.end(), [&name](const OptionInfo& a, const OptionInfo& b) {
        return editDistance(name, a.name) < editDistance(name, b.name);
      });
  const bool is_near = 2 * editDistance(name, nearest->name) <= name.size();
  return {"unrecognised option " + inQuotes(word),
          (is_near ? "did you mean -" + nearest->name + "? " : "") +
              "-h shows the options, -h expert all of them"};
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
                          const std::vector<std::string>& others,
                          const std::vector<OptionInfo>& options) {
  const auto terminator = std::find(words.begin(), words.end(), "--");
  const auto after = terminator == words.end() ? 0 : words.end() - terminator - 1;
  const auto end = others.end() - std::min<std::ptrdiff_t>(after, others.end() - others.begin());
  const auto unknown = std::find_if(others.begin(), end, [](const std::string& word) {
    return word.size() > 1 && word[0] == '-';
  });
  if (unknown != end) {
    throw unknownOption(*unknown, options);
  }
}

}  // namespace

CommandLine::CommandLine(const std::vector<std::string>& words,
                         const std::vector<OptionInfo>& options) {
  std::vector<OptionInfo> known = commonOptions();
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
  } catch (const po::unknown_option& error) {
    throw unknownOption(error.get_option_name(), known);
  } catch (const po::error& error) {
    // Boost writes all names with two dashes.
    std::string message = error.what();
    const std::size_t dashes = message.find("'--");
    if (dashes != std::string::npos) {
      message.erase(dashes + 1, 1);
    }
    throw UsageError(message, "run the tool with -h for the options and their values");
  }
  refuseUnknownOptions(words, others_, known);
}

std::pair<std::string, std::string> inputAndOutput(const CommandLine& command_line,
                                                   const std::string& tool) {
  const std::vector<std::string>& files = command_line.others();
  if (files.size() != 2) {
    throw UsageError(files.empty()       ? "the input file is missing"
                     : files.size() == 1 ? "the output file is missing"
                                         : "one file too many: " + inQuotes(files[2]),
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

std::string describeOptions(const std::vector<OptionInfo>& options, bool with_experts) {
  std::size_t width = 0;
  for (const OptionInfo& option : options) {
    if (with_experts || !option.expert) {
      width = std::max(width, option.name.size() + option.argument.size());
    }
  }
  const auto list = [&](bool of_experts) {
    std::string text;
    for (const OptionInfo& option : options) {
      if (option.expert == of_experts) {
        const std::string left =
            "  -" + option.name + (option.argument.empty() ? "" : " " + option.argument);
        text += left + std::string(width + 6 - left.size(), ' ');
        std::size_t column = width + 6;
        for (const std::string_view word : split(option.help, " ")) {
          if (column + word.size() > help_width) {
            text.pop_back();
            text += "\n" + std::string(width + 6, ' ');
            column = width + 6;
          }
          text += std::string(word) + " ";
          column += word.size() + 1;
        }
        text.back() = '\n';
      }
    }
    return text;
  };
  const bool has_experts = std::any_of(options.begin(), options.end(),
                                       [](const OptionInfo& option) { return option.expert; });
  return list(false) + (!has_experts   ? ""
                        : with_experts ? "\nExpert options:\n" + list(true)
                                       : "\nAll options: -h expert, version: -version\n");
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
