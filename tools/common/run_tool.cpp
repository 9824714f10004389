#include "common/run_tool.h"

#include "common/console.h"
#include "common/errors.h"
#include "common/output_file.h"
#include "common/text.h"
#include "spherical_param/version.h"

#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>
#include <thread>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace spherical_param::tools {
namespace {

/// Ends the tool as the signal would have, so that the caller sees what happened.
[[noreturn]] void endBySignal(int signal_number) {
  removeTemporaryFiles([signal_number] {
    std::signal(signal_number, SIG_DFL);
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, signal_number);
    pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    std::raise(signal_number);
  });
  std::abort();
}

/// Leaves the signals that end a program to a thread of their own: a handler could interrupt the
/// making of a file, in one thread or another, and may do next to nothing. The signals must be
/// blocked before there are other threads.
void handleSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    // One that is ignored, as nohup does, stays ignored.
    if (sigaction(signal_number, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) {
      sigaddset(&signals, signal_number);
    }
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] {
    int signal_number = 0;
    if (sigwait(&signals, &signal_number) == 0) {
      endBySignal(signal_number);
    }
  }).detach();
  // A closed pipe or a size limit is an error of the write like any other.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

constexpr const char* no_memory = "not enough memory";
constexpr const char* fewer_points = "use fewer points or a smaller -k";

/// Prints a failure; needs no memory.
int print(const char* tool, const char* cause, const char* remedy) noexcept {
  std::fflush(stdout);
  std::fprintf(stderr, "%s: %s\n  remedy: %s\n", tool, cause, remedy);
  return static_cast<int>(ExitCode::Failed);
}

int report(const std::string& tool, const ToolError& error) {
  std::fflush(stdout);
  std::fprintf(stderr, "%s: %s\n  remedy: %s\n", tool.c_str(), oneLine(error.what()).c_str(),
               oneLine(error.remedy()).c_str());
  return static_cast<int>(error.exitCode());
}

/// A standard stream that the caller has closed stays so, but no file gets its number: what is
/// meant for the terminal would be written into a mesh.
void occupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) == -1) {
      // The lowest number that is free; the wrong way round, so that its use still fails.
      [[maybe_unused]] const int opened =
          open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
  }
}

/// Leaves memory that is freed with the process: to give it back and to take it anew is a tenth of
/// the time of ten million points.
void keepMemory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
#endif
}

}  // namespace

int runTool(const std::string& tool, int argc, char** argv,
            const std::function<void(const std::vector<std::string>&)>& body) {
  occupyStandardStreams();
  keepMemory();
  try {
    try {
      handleSignals();
      body(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
      return static_cast<int>(ExitCode::Done);
    } catch (const ToolError& error) {
      return report(tool, error);
    } catch (const std::bad_alloc&) {
      return print(tool.c_str(), no_memory, fewer_points);
    } catch (const std::filesystem::filesystem_error& error) {
      return report(tool, Failure(error.what(), "check that the directories of all paths, and the "
                                                "one you are in, exist"));
    } catch (const std::system_error& error) {
      return report(tool, Failure("the system refuses a resource: " + std::string(error.what()),
                                  "allow more memory or processes"));
    } catch (const std::exception& error) {
      return report(tool, Failure(error.what(), kReportIt));
    }
  } catch (const std::bad_alloc&) {
    // Not even enough for the message.
    return print(tool.c_str(), no_memory, fewer_points);
  }
}

bool answerHelpOrVersion(const CommandLine& command_line, const std::string& tool,
                         const std::function<std::string(bool with_experts)>& help) {
  if (command_line.wantsHelp()) {
    printAll(help(command_line.wantsExpertHelp()));
    return true;
  }
  if (command_line.wantsVersion()) {
    printAll(tool + " " + SPHERICAL_PARAM_VERSION + "\n");
    return true;
  }
  return false;
}

}  // namespace spherical_param::tools
