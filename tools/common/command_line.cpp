#include "common/command_line.h"

#include "common/errors.h"
#include "common/text.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace spherical_param::tools {
namespace {

constexpr std::size_t help_column = 39;
constexpr std::size_t help_width = 100;
constexpr const char* see_help = "run the tool with -h for the options and their values";

/// The smallest number of letters to insert, leave out or replace that makes one word of another.
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
[[noreturn]] void failUnknown(const std::string& word, const std::string& name,
                              const OptionTable& options) {
  const auto distance = [&name](const OptionInfo& a) { return editDistance(name, a.name); };
  const auto nearest =
      std::min_element(options.begin(), options.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  throw UsageError(
      "unrecognised option " + inQuotes(word),
      (2 * distance(*nearest) <= name.size() ? "did you mean -" + nearest->name + "? " : "") +
          "-h shows the options, -h expert all of them");
}

/// The name in a word such as -name, --name or --name=value.
std::string nameIn(const std::string& word) {
  const std::size_t begin = word.rfind("--", 0) == 0 ? 2 : 1;
  return word.substr(begin, word.find('=') - begin);
}

/// A word with a dash that stands for an option; a lone dash stands for none.
bool isOption(const std::string& word) {
  return word.size() > 1 && word[0] == '-';
}

const OptionInfo* knownOption(const std::string& name, const OptionTable& options) {
  const auto found = std::find_if(options.begin(), options.end(),
                                  [&](const OptionInfo& option) { return option.name == name; });
  return found == options.end() ? nullptr : &*found;
}

OptionValue parseValue(const OptionRow& row, const std::string& flag, const std::string& text) {
  if (std::find(row.choices.begin(), row.choices.end(), text) != row.choices.end() ||
      (row.is_point && spherical_param::toPoint(text))) {
    return text;
  }
  std::optional<double> number = row.is_number ? toReal(text) : std::nullopt;
  if (row.is_integer && !toInteger(text)) {
    number.reset();
  }
  if (!number || !(*number >= row.min && *number <= row.max) ||
      (row.min_excluded && *number == row.min)) {
    throw UsageError("option -" + flag + ": " + inQuotes(text) + " is not allowed",
                     "give -" + flag + " " + rangeOf(row));
  }
  return row.is_integer ? OptionValue(static_cast<std::int64_t>(*number)) : OptionValue(*number);
}

}  // namespace

OptionTable joined(const std::vector<OptionTable>& tables) {
  OptionTable all;
  for (const OptionTable& table : tables) {
    all.insert(all.end(), table.begin(), table.end());
  }
  return all;
}

OptionRow rowOf(const std::string& name, const std::string& help) {
  OptionRow row;
  row.name = name;
  row.help = help;
  return row;
}

OptionInfo optionOf(const OptionRow& row, const std::function<OptionValue()>& get,
                    const std::function<void(const OptionValue&)>& set) {
  std::vector<std::string> arguments = row.choices;
  if (row.is_number) {
    arguments.emplace_back(row.is_integer ? "N" : "X");
  }
  if (row.is_point) {
    arguments.emplace_back("X,Y,Z");
  }
  std::string argument;
  for (const std::string& each : arguments) {
    argument += (argument.empty() ? "" : "|") + each;
  }
  const std::string flag = replaced(row.name, '_', '-');
  return {flag,
          argument,
          row.help + (row.is_number ? "; " + rangeOf(row) : "") + " (" +
              spherical_param::textOf(get()) + ")",
          row.expert,
          [=](const std::string& text) { set(parseValue(row, flag, text)); },
          [=] { return toJson(get()); }};
}

Json toJson(const OptionValue& value) {
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

OptionInfo flagOption(const std::string& name, const std::string& help, bool& field) {
  return {name,
          "",
          help,
          false,
          [&field](const std::string& /*text*/) { field = true; },
          [&field] { return Json(field); }};
}

OptionInfo fileOption(const std::string& name, const std::string& help, std::string& field) {
  return {name,
          "FILE",
          help,
          false,
          [name, &field](const std::string& text) {
            if (text.empty()) {
              throw UsageError("option -" + name + ": the name of the file is empty",
                               "give a file");
            }
            field = text;
          },
          [&field] { return field.empty() ? Json(nullptr) : Json(field); }};
}

OptionInfo usedIf(const std::function<bool()>& condition, OptionInfo option) {
  option.value = [condition, value = option.value] { return condition() ? value() : Json(); };
  return option;
}

Json optionsToJson(const OptionTable& options) {
  Json json;
  for (const OptionInfo& option : options) {
    if (option.value) {
      json[replaced(option.name, '-', '_')] = option.value();
    }
  }
  return json;
}

std::string describeOptions(const OptionTable& options, bool with_experts) {
  std::string text;
  const auto list = [&](bool of_experts) {
    for (const OptionInfo& option : options) {
      if (option.expert != of_experts) {
        continue;
      }
      std::string line = "  -" + option.name + " " + option.argument;
      line.resize(std::max(line.size() + 1, help_column), ' ');
      for (const std::string_view word : split(option.help, " ")) {
        if (line.size() + word.size() > help_width) {
          text += line.substr(0, line.size() - 1) + "\n";
          line.assign(help_column, ' ');
        }
        line += std::string(word) + " ";
      }
      text += line.substr(0, line.size() - 1) + "\n";
    }
  };
  list(false);
  text += with_experts ? "\nExpert options:\n" : "\nAll options: -h expert, version: -version\n";
  if (with_experts) {
    list(true);
  }
  return text;
}

CommandLine::CommandLine(const std::vector<std::string>& words, OptionTable options)
    : words_(words) {
  for (const char* name : {"h", "help", "version"}) {
    options.push_back({name, "", ""});
  }
  for (auto word = words.begin(); word != words.end(); ++word) {
    if (*word == "--") {
      others_.insert(others_.end(), word + 1, words.end());
      break;
    }
    if (!isOption(*word)) {
      others_.push_back(*word);
      continue;
    }
    const std::string name = nameIn(*word);
    const OptionInfo* const option = knownOption(name, options);
    const std::size_t equals = word->find('=');
    std::string value = equals == std::string::npos ? "" : word->substr(equals + 1);
    if (option == nullptr) {
      failUnknown(*word, name, options);
    } else if (option->argument.empty() && equals != std::string::npos) {
      throw UsageError("option '-" + name + "' does not take any arguments", see_help);
    } else if (!option->argument.empty() && equals == std::string::npos) {
      if (++word == words.end()) {
        throw UsageError("the required argument for option '-" + name + "' is missing", see_help);
      }
      value = *word;
      if (isOption(value) && knownOption(nameIn(value), options) != nullptr) {
        throw UsageError("option -" + name + " has no value, as " + inQuotes(value) +
                             " is an option itself",
                         see_help);
      }
    }
    if (!values_.emplace(name, value).second) {
      throw UsageError("option -" + name + " is given more than once", "give it once");
    }
  }
}

void CommandLine::apply(const OptionTable& options) const {
  for (const OptionInfo& option : options) {
    if (option.take && has(option.name)) {
      option.take(value(option.name, ""));
    }
  }
}

void CommandLine::refuse(const std::vector<std::string>& options, const std::string& with,
                         const std::string& instead) const {
  for (const std::string& option : options) {
    if (has(option)) {
      throw UsageError("option -" + option + " does nothing with " + with,
                       "leave -" + option + " out, or give " + instead);
    }
  }
}

}  // namespace spherical_param::tools
