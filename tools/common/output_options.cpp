#include "common/output_options.h"

#include "common/console.h"
#include "common/errors.h"
#include "common/numbers.h"
#include "common/text.h"

namespace spherical_param::tools {

std::vector<OptionInfo> outputOptions() {
  return {
      {"json", "FILE", "write a report; -: to the standard output, which has nothing else then",
       false},
      {"verbose", "", "print options, stages and tables before the summary", false},
      {"quiet", "", "print only errors", true},
      {"offset", "X,Y,Z",
       "subtract this from the coordinates that are written; auto: what STL and GLB, in single "
       "precision, need (auto)",
       true},
      {"ascii", "", "write PLY, STL and VTK as text", true},
  };
}

namespace {

Point parseOffset(const std::string& text) {
  const std::vector<std::string_view> words = split(text, ", ");
  if (words.size() != 3) {
    throw UsageError("option -offset: " + inQuotes(text) + " is not three numbers",
                     "give -offset X,Y,Z, or auto");
  }
  Point offset{};
  for (std::size_t d = 0; d < 3; ++d) {
    offset[d] = parseReal("offset", std::string(words[d]), {-1e300, 1e300});
  }
  return offset;
}

}  // namespace

OutputSettings parseOutputOptions(const CommandLine& command_line) {
  OutputSettings settings;
  settings.json = command_line.value("json", "");
  if (command_line.has("json") && settings.json.empty()) {
    throw UsageError("option -json: the name of the file is empty", "give a file, or - ");
  }
  settings.encoding = command_line.has("ascii") ? Encoding::Ascii : Encoding::Binary;
  if (const std::string text = command_line.value("offset", "auto"); text != "auto") {
    settings.offset = parseOffset(text);
  }
  settings.quiet = command_line.has("quiet");
  settings.verbose = command_line.has("verbose");
  if (settings.quiet && settings.verbose) {
    throw UsageError("-quiet and -verbose exclude each other", "give one of them");
  }
  return settings;
}

Point offsetOf(const OutputSettings& settings, FileFormat format, const PointData& data) {
  return settings.offset ? *settings.offset : offsetFor(data, format, settings.encoding);
}

void addToJson(const OutputSettings& settings, Json& json) {
  json["json"] = settings.json;
  json["offset"] = settings.offset ? Json(*settings.offset) : Json("auto");
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
