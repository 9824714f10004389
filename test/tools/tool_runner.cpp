#include "tool_runner.h"

#include <fcntl.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace tool_test {
namespace {

namespace fs = std::filesystem;

constexpr uid_t nobody = 65534;

/// The file must exist: a missing device is not to be replaced by a file of that name.
void redirect(const std::string& path, int descriptor) {
  const int file = open(path.c_str(), O_WRONLY);
  if (file < 0 || dup2(file, descriptor) < 0) {
    _exit(126);
  }
  close(file);
}

[[noreturn]] void becomeTool(const std::string& program, std::vector<char*>& arguments,
                             const RunOptions& options) {
  if (options.file_size_limit > 0) {
    const rlimit limit = {options.file_size_limit, options.file_size_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (options.address_space_limit > 0) {
    const rlimit limit = {options.address_space_limit, options.address_space_limit};
    setrlimit(RLIMIT_AS, &limit);
  }
  if (chdir(options.directory.c_str()) != 0) {
    _exit(126);
  }
  if (options.unprivileged && geteuid() == 0 && setuid(nobody) != 0) {
    _exit(126);
  }
  alarm(options.time_limit);
  execv(program.c_str(), arguments.data());
  _exit(127);
}

/// Reads what is printed on a terminal until its other end is closed.
std::string readTerminal(int terminal) {
  std::string text;
  std::array<char, 4096> part;
  for (;;) {
    const ssize_t count = read(terminal, part.data(), part.size());
    if (count <= 0) {
      return text;
    }
    text.append(part.data(), static_cast<std::size_t>(count));
  }
}

bool hasTemporary(const std::string& directory) {
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    if (entry.path().filename().string().rfind(".spherical_param.", 0) == 0) {
      return true;
    }
  }
  return false;
}

}  // namespace

TemporaryDirectory::TemporaryDirectory() {
  std::string pattern = (fs::temp_directory_path() / "spherical_param_test.XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr || chmod(pattern.c_str(), 0777) != 0) {
    throw std::runtime_error("no temporary directory");
  }
  path_ = fs::canonical(pattern).string();
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_, ignored)) {
    if (entry.is_directory()) {
      fs::permissions(entry.path(), fs::perms::owner_all, ignored);
    }
  }
  fs::remove_all(path_, ignored);
}

std::map<std::string, std::string> TemporaryDirectory::listing() const {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path_)) {
    files[fs::relative(entry.path(), path_).string()] =
        entry.is_regular_file() ? readFile(entry.path().string()) : "";
  }
  return files;
}

std::vector<std::string> RunResult::errorLines() const {
  std::vector<std::string> lines;
  std::istringstream stream(errors);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) {
      lines.push_back(line);
    }
  }
  return lines;
}

RunResult run(const std::string& program, const std::vector<std::string>& arguments,
              const RunOptions& options) {
  std::vector<std::string> words = {program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);

  const TemporaryDirectory capture;
  const std::string output =
      options.standard_output.empty() ? capture.file("out") : options.standard_output;
  writeFile(capture.file("out"), "");
  writeFile(capture.file("err"), "");
  int terminal = -1;
  const pid_t child = options.terminal ? forkpty(&terminal, nullptr, nullptr, nullptr) : fork();
  if (child < 0) {
    throw std::runtime_error("cannot start a process");
  }
  if (child == 0) {
    if (!options.terminal) {
      redirect(output, STDOUT_FILENO);
    }
    redirect(capture.file("err"), STDERR_FILENO);
    becomeTool(program, pointers, options);
  }

  RunResult result;
  if (options.terminal) {
    result.output = readTerminal(terminal);
    close(terminal);
  }
  int status = 0;
  if (options.signal_when_temporary != 0) {
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (hasTemporary(options.directory)) {
        kill(child, options.signal_when_temporary);
        waitpid(child, &status, 0);
        break;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  } else {
    waitpid(child, &status, 0);
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (!options.terminal && options.standard_output.empty()) {
    result.output = readFile(output);
  }
  result.errors = readFile(capture.file("err"));
  return result;
}

std::string readFile(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

void writeFile(const std::string& path, const std::string& content) {
  std::ofstream stream(path, std::ios::binary);
  stream << content;
}

}  // namespace tool_test
