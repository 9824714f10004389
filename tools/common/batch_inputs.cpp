#include "common/batch_inputs.h"

#include "common/errors.h"
#include "common/file_formats.h"
#include "common/input_file.h"
#include "common/text.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <system_error>

namespace spherical_param::tools {
namespace {

namespace fs = std::filesystem;

void addDirectory(const std::string& directory, std::vector<BatchInput>& inputs) {
  std::error_code error;
  std::vector<std::string> paths;
  fs::directory_iterator entry(directory, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path path = entry->path();
    const std::optional<FileFormat> format = formatOf(path.string());
    std::error_code ignored;
    if (format && isUsable(*format, FileUse::ReadCloud) && path.filename().string()[0] != '.' &&
        entry->is_regular_file(ignored)) {
      paths.push_back(path.string());
    }
  }
  if (error) {
    failReading(directory, error.message(), "check the rights of the directory");
  }
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) {
    inputs.push_back({path, true});
  }
}

void addPath(const std::string& path, std::vector<BatchInput>& inputs) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    addDirectory(path, inputs);
  } else {
    inputs.push_back({path, false});
  }
}

void addLines(std::istream& lines, std::vector<BatchInput>& inputs) {
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) {
      line.pop_back();
    }
    if (!line.empty() && line[0] != '#') {
      addPath(line, inputs);
    }
  }
}

}  // namespace

std::vector<BatchInput> collectInputs(const std::vector<std::string>& words,
                                      const std::string& list) {
  std::vector<BatchInput> inputs;
  for (const std::string& word : words) {
    addPath(word, inputs);
  }
  if (list == "-") {
    addLines(std::cin, inputs);
  } else if (!list.empty()) {
    errno = 0;
    std::ifstream lines(list);
    std::error_code error;
    if (!lines || fs::is_directory(list, error)) {
      failReading(list, systemMessage(errno != 0 ? errno : EISDIR),
                  "give -inputs a file with a path on each line, or - for the standard input");
    }
    addLines(lines, inputs);
  }
  if (inputs.empty()) {
    throw UsageError("there is no input: no file is named, and directories hold none to read",
                     "give files, directories with " + extensionsFor(FileUse::ReadCloud) +
                         ", or -inputs FILE with a path on each line");
  }
  return inputs;
}

}  // namespace spherical_param::tools
