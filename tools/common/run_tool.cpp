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

/// Leaves the signals that end a program to a thread of their own: a handler could interrupt the
/// making of a file, in one thread or another, and may do next to nothing. The signals must be
/// blocked before there are other threads.
void handleSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    // One that is ignored, as nohup does, stays ignored.
    if (std::signal(number, SIG_DFL) == SIG_IGN) {
      std::signal(number, SIG_IGN);
    } else {
      sigaddset(&signals, number);
    }
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] {
    int number = 0;
    sigwait(&signals, &number);
    removeTemporaryFiles([&] {
      // Ends the tool as the signal would have, so that the caller sees what happened.
      pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
      std::raise(number);
    });
  }).detach();
  // A closed pipe or a size limit is an error of the write like any other.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int fail(const std::string& tool, const ToolError& error) {
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
      return fail(tool, error);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::filesystem::filesystem_error& error) {
      return fail(tool, Failure(error.what(), "check that the directories of all paths, and the "
                                              "one you are in, exist"));
    } catch (const std::system_error& error) {
      return fail(tool, Failure("the system refuses a resource: " + std::string(error.what()),
                                "allow more memory or processes"));
    } catch (const std::exception& error) {
      return fail(tool, Failure(error.what(), kReportIt));
    }
  } catch (const std::bad_alloc&) {
    // There may not be enough for a message either.
    std::fflush(stdout);
    std::fprintf(stderr, "%s: not enough memory\n  remedy: use fewer points or a smaller -k\n",
                 tool.c_str());
    return static_cast<int>(ExitCode::Failed);
  }
}

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

}  // namespace spherical_param::tools
