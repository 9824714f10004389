#include "common/run_tool.h"

#include "common/errors.h"
#include "common/system.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iterator>
#include <new>
#include <system_error>

namespace spherical_param::tools {
namespace {

int fail(const std::string& tool, const ToolError& error) {
  std::fflush(stdout);
  std::fprintf(stderr, "%s: %s\n  remedy: %s\n", tool.c_str(), oneLine(error.what()).c_str(),
               oneLine(error.remedy()).c_str());
  return static_cast<int>(error.exitCode());
}

/// \return whether help or version was what the user wants.
bool answerHelpOrVersion(const CommandLine& command_line, const ToolText& text,
                         const OptionTable& options) {
  const std::vector<std::string>& others = command_line.others();
  if (command_line.has("h") || command_line.has("help")) {
    std::string examples;
    for (const auto& [remark, words] : text.examples) {
      examples += "  " + remark + "\n    " + text.name + " " + words + "\n";
    }
    printAll("Usage: " + text.name + " " + text.files + " [options]\n\n" + text.about +
             "\nOptions (-name value, --name value or --name=value; defaults in brackets):\n" +
             describeOptions(options, others.size() == 1 && others.front() == "expert") +
             "\nExamples:\n" + examples + "\nExit code: " + text.exit_codes + "\n");
    return true;
  }
  if (command_line.has("version")) {
    printAll(text.name + " " + SPHERICAL_PARAM_VERSION + "\n");
    return true;
  }
  return false;
}

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
    const bool is_empty = value.is_string() && value.get_ref<const std::string&>().empty();
    if (!value.is_null() && value != false && !is_empty) {
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

int runTool(const ToolText& text, int argc, char** argv, const OptionTable& options,
            const std::function<void(const CommandLine&)>& body) {
  occupyStandardStreams();
  keepMemory();
  try {
    try {
      handleSignals(removeTemporaryFiles);
      const std::vector<std::string> words(argv + (argc > 0 ? 1 : 0), argv + argc);
      const CommandLine command_line(words, options);
      if (!answerHelpOrVersion(command_line, text, options)) {
        command_line.apply(options);
        body(command_line);
      }
      return static_cast<int>(ExitCode::Done);
    } catch (const ToolError& error) {
      return fail(text.name, error);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::filesystem::filesystem_error& error) {
      return fail(text.name,
                  Failure(error.what(), "check that the directories of all paths, and the "
                                        "one you are in, exist"));
    } catch (const std::system_error& error) {
      return fail(text.name, Failure("the system refuses a resource: " + std::string(error.what()),
                                     "allow more memory or processes"));
    } catch (const std::exception& error) {
      return fail(text.name, Failure(error.what(), kReportIt));
    }
  } catch (const std::bad_alloc&) {
    // There may not be enough for a message either.
    std::fflush(stdout);
    std::fprintf(stderr, "%s: not enough memory\n  remedy: use fewer points or a smaller -k\n",
                 text.name.c_str());
    return static_cast<int>(ExitCode::Failed);
  }
}

std::vector<std::string> filesOf(const CommandLine& command_line, const ToolText& text) {
  const std::vector<std::string_view> names = split(text.files, " ");
  const std::vector<std::string>& files = command_line.others();
  if (files.size() != names.size()) {
    throw UsageError(files.size() > names.size()
                         ? "one file too many: " + inQuotes(files[names.size()])
                         : "the " + std::string(names[files.size()]) + " file is missing",
                     "run '" + text.name + " " + text.files + " [options]', -h shows the options");
  }
  return files;
}

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

void ToolRun::write(const std::string& path, const MeshView& mesh, const FileProgress& progress) {
  OutputFile& file = open(path);
  writeMesh(file, mesh, formatOf(path), settings_.encoding(), progress);
  file.finish();  // not all of them are open at a time
}

void ToolRun::publish(const std::function<Json()>& make_report, const Summary& summary) {
  for (OutputFile& file : files_) {
    file.finish();
  }
  if (settings_.json == "-") {
    printAll(textOf(make_report()));
  } else if (!settings_.json.empty()) {
    open(settings_.json).write(textOf(make_report()));
    files_.back().finish();
  }
  console.summary(summary);
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
  constexpr std::size_t max_printed = 12;
  std::size_t count = 0;
  std::string faults;
  std::fflush(stdout);
  for (const auto& [of, finding, is_failure] : entries_) {
    std::string line = (of.empty() ? "" : of + ": ") + finding.text;
    if (!finding.option.empty()) {
      line += ": try -" + replaced(finding.option, '_', '-') + " " + finding.value;
    } else if (finding.is_fault && !is_failure && !page_option.empty()) {
      line += ": try " + page_option + " to see where";
    }
    if (strict_ && finding.is_fault) {
      faults += (faults.empty() ? "" : "; ") + oneLine(line);
    } else if (!settings_.quiet && !finding.is_consequence && ++count <= max_printed) {
      std::fprintf(stderr, "warning: %s\n", oneLine(line).c_str());
    }
  }
  if (count > max_printed) {
    std::fprintf(stderr, "warning: %zu more, which -json lists\n", count - max_printed);
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
