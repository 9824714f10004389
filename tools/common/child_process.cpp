#include "common/child_process.h"

#include "common/errors.h"
#include "common/text.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace spherical_param::tools {
namespace {

/// Nothing that is meant to be read is longer.
constexpr std::size_t output_limit = std::size_t{1} << 28;
constexpr std::size_t errors_limit = std::size_t{1} << 16;

[[noreturn]] void failStarting(const std::string& program, int error_number) {
  throw Failure("cannot start " + inQuotes(program) + ": " + systemMessage(error_number),
                "end other programs, or ask for fewer jobs at a time");
}

void closeOnce(int& descriptor) {
  if (descriptor >= 0) {
    close(descriptor);
    descriptor = -1;
  }
}

/// Ends of pipes, closed with the object unless they were taken out.
struct Pipes {
  std::array<int, 2> output = {-1, -1};
  std::array<int, 2> errors = {-1, -1};

  Pipes() = default;
  Pipes(const Pipes&) = delete;
  Pipes& operator=(const Pipes&) = delete;
  ~Pipes() {
    for (int* end : {&output[0], &output[1], &errors[0], &errors[1]}) {
      closeOnce(*end);
    }
  }
};

/// Between fork() and exec(): other threads may have held any lock, so that only what signal
/// handlers may do is allowed.
[[noreturn]] void becomeProgram(char* const* arguments, const Pipes& pipes, pid_t parent) {
  const auto above_standard = [](int descriptor) {
    return descriptor > STDERR_FILENO ? descriptor
                                      : fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  };
#ifdef __linux__
  // What kills this program without a word must not leave others working.
  prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
  if (getppid() != parent) {
    _exit(exit_code_not_run);
  }
  // The parent may have taken the last numbers there are.
  close(pipes.output[0]);
  close(pipes.errors[0]);
  // If this program was started with any of the three closed, pipes may have their numbers.
  const int null = above_standard(open("/dev/null", O_RDONLY | O_CLOEXEC));
  const int output = above_standard(pipes.output[1]);
  const int errors = above_standard(pipes.errors[1]);
  if (dup2(null, STDIN_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0 ||
      dup2(errors, STDERR_FILENO) < 0) {
    _exit(exit_code_not_run);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  execv(arguments[0], arguments);
  _exit(exit_code_not_run);
}

/// Reads what there is. \return false at the end.
bool readSome(int descriptor, std::string& text) {
  std::array<char, 65536> block;
  const ssize_t count = read(descriptor, block.data(), block.size());
  if (count < 0) {
    return errno == EINTR || errno == EAGAIN;
  }
  text.append(block.data(), static_cast<std::size_t>(count));
  return count > 0;
}

}  // namespace

ChildProcesses::~ChildProcesses() {
  signalAll(SIGKILL);
  for (auto& [process, child] : children_) {
    closeOnce(child.output);
    closeOnce(child.errors);
    waitpid(process, nullptr, 0);
  }
}

pid_t ChildProcesses::start(const std::vector<std::string>& words) {
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  arguments.reserve(copies.size() + 1);
  for (std::string& word : copies) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  // All memory before there is a process, for which nobody would wait if there were none.
  std::map<pid_t, Child> made;
  auto node = made.extract(made.emplace(0, Child()).first);
  Pipes pipes;
  if (pipe2(pipes.output.data(), O_CLOEXEC) != 0 || pipe2(pipes.errors.data(), O_CLOEXEC) != 0) {
    failStarting(words.front(), errno);
  }
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process < 0) {
    failStarting(words.front(), errno);
  }
  if (process == 0) {
    becomeProgram(arguments.data(), pipes, parent);
  }
  Child& child = node.mapped();
  child.result.process = process;
  std::swap(child.output, pipes.output[0]);
  std::swap(child.errors, pipes.errors[0]);
  node.key() = process;
  children_.insert(std::move(node));
  return process;
}

std::optional<ChildResult> ChildProcesses::wait(int wake, double seconds) {
  const int timeout = seconds < 0.0 ? -1 : static_cast<int>(std::min(seconds, 1e6) * 1e3);
  for (;;) {
    std::vector<pollfd> polled;
    std::vector<Child*> owners;
    for (auto& [process, child] : children_) {
      for (const int descriptor : {child.output, child.errors}) {
        if (descriptor >= 0) {
          polled.push_back({descriptor, POLLIN, 0});
          owners.push_back(&child);
        }
      }
      if (child.output >= 0 || child.errors >= 0) {
        continue;
      }
      // Both pipes are closed: it has ended, or is about to.
      ChildResult result = std::move(child.result);
      int status = 0;
      rusage usage{};
      while (wait4(process, &status, 0, &usage) < 0 && errno == EINTR) {
      }
      children_.erase(process);
      result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
      result.peak_memory = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
      return result;
    }
    if (wake >= 0) {
      polled.push_back({wake, POLLIN, 0});
    }
    const int ready = poll(polled.data(), polled.size(), timeout);
    if (ready == 0 || (wake >= 0 && ready > 0 && polled.back().revents != 0)) {
      return std::nullopt;
    }
    for (std::size_t i = 0; ready > 0 && i < owners.size(); ++i) {
      Child& child = *owners[i];
      if (polled[i].revents == 0) {
        continue;
      }
      const bool is_output = polled[i].fd == child.output;
      std::string& text = is_output ? child.result.output : child.result.errors;
      if (!readSome(polled[i].fd, text)) {
        closeOnce(is_output ? child.output : child.errors);
      }
      if (is_output && text.size() > output_limit) {
        text.resize(output_limit);
      }
      if (!is_output && text.size() > errors_limit) {
        text.erase(0, text.size() - errors_limit);
      }
    }
  }
}

void ChildProcesses::signalAll(int signal) const {
  for (const auto& entry : children_) {
    kill(entry.first, signal);
  }
}

std::string signalName(int signal) {
  struct Named {
    int signal;
    const char* name;
  };
  constexpr std::array<Named, 13> names = {{{SIGHUP, "SIGHUP"},
                                            {SIGINT, "SIGINT"},
                                            {SIGQUIT, "SIGQUIT"},
                                            {SIGILL, "SIGILL"},
                                            {SIGABRT, "SIGABRT"},
                                            {SIGFPE, "SIGFPE"},
                                            {SIGKILL, "SIGKILL"},
                                            {SIGBUS, "SIGBUS"},
                                            {SIGSEGV, "SIGSEGV"},
                                            {SIGPIPE, "SIGPIPE"},
                                            {SIGTERM, "SIGTERM"},
                                            {SIGXCPU, "SIGXCPU"},
                                            {SIGXFSZ, "SIGXFSZ"}}};
  const auto* const found = std::find_if(
      names.begin(), names.end(), [signal](const Named& named) { return named.signal == signal; });
  const char* const meaning = strsignal(signal);
  return (found == names.end() ? "signal " + std::to_string(signal) : found->name) +
         (meaning == nullptr ? "" : " (" + std::string(meaning) + ")");
}

std::string pathOfThisProgram() {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) {
    throw Failure("cannot find the file of this program: " + error.message(),
                  "run it where /proc is mounted, or run the inputs one by one");
  }
  return path.string();
}

}  // namespace spherical_param::tools
