#include "common/tool_run.h"

#include "common/errors.h"
#include "common/numbers.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace spherical_param::tools {
namespace {

Point parseOffset(const std::string& text) {
  const std::vector<std::string_view> words = split(text, ", ");
  Point offset{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::optional<double> number = words.size() == 3 ? toReal(words[d]) : std::nullopt;
    if (!number || !std::isfinite(*number)) {
      throw UsageError("option -offset: " + inQuotes(text) + " is not three numbers",
                       "give -offset X,Y,Z, or auto");
    }
    offset[d] = *number;
  }
  return offset;
}

/// Prints what is set.
void print(const OptionTable& options, Console& console) {
  for (const OptionInfo& option : options) {
    const Json value = option.value ? option.value() : Json();
    if (!value.is_null() && value != false && value != "") {
      console.entry(option.name, value == true             ? "yes"
                                 : value.is_string()       ? oneLine(value.get<std::string>())
                                 : value.is_number_float() ? formatted(value.get<double>(), 6)
                                                           : value.dump());
    }
  }
}

Detail detailOf(const OutputSettings& settings) {
  return settings.quiet || settings.json == "-" ? Detail::Nothing
         : settings.verbose                     ? Detail::All
                                                : Detail::Summary;
}

}  // namespace

OptionTable outputOptions(OutputSettings& settings) {
  OptionTable options = {
      fileOption("json", "write a report; -: to the standard output, which has nothing else then",
                 settings.json),
      {"offset", "X,Y,Z",
       "subtract this from the coordinates that are written; auto: what STL and GLB, in single "
       "precision, need (auto)",
       true,
       [&settings](const std::string& text) {
         if (text != "auto") {
           settings.offset = parseOffset(text);
         }
       },
       [&settings] { return settings.offset ? Json(*settings.offset) : Json("auto"); }},
      flagOption("ascii", "write PLY, STL and VTK as text", settings.ascii),
      flagOption("quiet", "print only errors", settings.quiet),
      flagOption("verbose", "print options, stages and tables before the summary",
                 settings.verbose)};
  options[0].value = [&settings] { return Json(settings.json); };
  options[2].expert = true;
  options[3].expert = true;
  return options;
}

std::vector<std::string> outputsOf(const OutputSettings& settings,
                                   const std::vector<std::string>& names) {
  std::vector<std::string> outputs;
  std::copy_if(names.begin(), names.end(), std::back_inserter(outputs),
               [](const std::string& name) { return !name.empty(); });
  if (!settings.json.empty() && settings.json != "-") {
    outputs.push_back(settings.json);
  }
  return outputs;
}

void checkOutputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs) {
  std::vector<std::string> files = inputs;
  for (const std::string& output : outputs) {
    for (const std::string& file : files) {
      if (isSameFile(file, output)) {
        throw UsageError(inQuotes(output) + " would overwrite " + inQuotes(file),
                         "give each file its own name");
      }
    }
    files.push_back(output);
  }
  for (const std::string& output : outputs) {
    checkOutputPath(output);
  }
}

ToolRun::ToolRun(const OutputSettings& settings, bool strict, const std::string& tool,
                 const std::vector<std::pair<std::string, std::string>>& files,
                 const OptionTable& options)
    : console(detailOf(settings)), settings_(settings), strict_(strict) {
  if (settings.quiet && settings.verbose) {
    throw UsageError("-quiet and -verbose exclude each other", "give one of them");
  }
  console.heading(tool + " " + SPHERICAL_PARAM_VERSION);
  for (const auto& [label, file] : files) {
    console.entry(label, oneLine(file));
  }
  print(options, console);
}

void ToolRun::publish(const std::function<Json()>& make_report,
                      const std::function<void()>& print_verdict) {
  for (OutputFile& file : files_) {
    file.finish();
  }
  if (settings_.json == "-") {
    printAll(textOf(make_report()));
  } else if (!settings_.json.empty()) {
    open(settings_.json).write(textOf(make_report()));
    files_.back().finish();
  }
  print_verdict();
  console.flush();
  for (OutputFile& file : files_) {
    file.commit();
  }
}

void ToolRun::add(const std::string& of, const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    // What is true of several inputs is said once.
    const auto same = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
      return entry.finding.text == finding.text && entry.finding.value == finding.value &&
             entry.finding.is_consequence == finding.is_consequence;
    });
    if (same == entries_.end()) {
      entries_.push_back({of, finding});
    } else {
      same->of += ", " + of;
    }
  }
}

void ToolRun::addFailure(const std::string& failure) {
  entries_.push_back({"", {failure, "", "", true}, true});
}

void ToolRun::conclude(bool is_usable, const std::string& page_option) {
  constexpr std::size_t most_printed = 12;
  std::size_t count = 0;
  std::string faults;
  std::fflush(stdout);
  for (const auto& [of, finding, is_failure] : entries_) {
    std::string line = (of.empty() ? "" : of + ": ") + finding.text;
    if (!finding.option.empty()) {
      std::string flag = finding.option;
      std::replace(flag.begin(), flag.end(), '_', '-');
      line += ": try -" + flag + " " + finding.value;
    } else if (finding.is_fault && !is_failure && !page_option.empty()) {
      line += ": try " + page_option + " to see where";
    }
    if (strict_ && finding.is_fault) {
      faults += (faults.empty() ? "" : "; ") + oneLine(line);
    } else if (!settings_.quiet && !finding.is_consequence && ++count <= most_printed) {
      std::fprintf(stderr, "warning: %s\n", oneLine(line).c_str());
    }
  }
  if (count > most_printed) {
    std::fprintf(stderr, "warning: %zu more, which -json lists\n", count - most_printed);
  }
  if (!faults.empty()) {
    throw ToolError(is_usable ? ExitCode::Failed : ExitCode::NotUsable, faults,
                    "the files were written; look at them, or leave out -strict");
  }
  if (!is_usable) {
    throw ToolError(
        ExitCode::NotUsable,
        "the mesh was written but is not usable: more than 1 % of its triangles intersect",
        "follow the warnings, or crop the cloud to the object");
  }
}

}  // namespace spherical_param::tools
