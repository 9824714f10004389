#include "common/output_options.h"

#include "common/console.h"
#include "common/errors.h"
#include "common/text.h"

namespace spherical_param::tools {

std::vector<OptionInfo> outputOptions() {
  return {
      {"json", "FILE", "write a report; -: to the standard output, which has nothing else then",
       false},
      {"verbose", "", "print options, stages and tables before the summary", false},
      {"quiet", "", "print only errors", true},
      {"ascii", "", "write PLY, STL and VTK as text", true},
  };
}

OutputSettings parseOutputOptions(const CommandLine& command_line) {
  OutputSettings settings;
  settings.json = command_line.value("json", "");
  if (command_line.has("json") && settings.json.empty()) {
    throw UsageError("option -json: the name of the file is empty", "give a file, or - ");
  }
  settings.encoding = command_line.has("ascii") ? Encoding::Ascii : Encoding::Binary;
  settings.quiet = command_line.has("quiet");
  settings.verbose = command_line.has("verbose");
  if (settings.quiet && settings.verbose) {
    throw UsageError("-quiet and -verbose exclude each other", "give one of them");
  }
  return settings;
}

void addToJson(const OutputSettings& settings, Json& json) {
  json["json"] = settings.json;
  json["ascii"] = settings.encoding == Encoding::Ascii;
  json["quiet"] = settings.quiet;
  json["verbose"] = settings.verbose;
}

void addReport(const OutputSettings& settings, std::vector<std::string>& outputs) {
  if (!settings.json.empty() && !settings.jsonToStandardOutput()) {
    outputs.push_back(settings.json);
  }
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

void publish(const OutputSettings& settings, std::vector<std::unique_ptr<OutputFile>>& files,
             Console& console, const std::function<Json()>& make_report,
             const std::function<void()>& print_verdict) {
  if (settings.jsonToStandardOutput()) {
    printAll(textOf(make_report()));
  } else if (!settings.json.empty()) {
    files.push_back(std::make_unique<OutputFile>(settings.json));
    files.back()->write(textOf(make_report()));
    files.back()->finish();
  }
  print_verdict();
  console.flush();
  for (const auto& file : files) {
    file->commit();
  }
}

}  // namespace spherical_param::tools
