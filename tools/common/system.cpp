#include "common/system.h"

#include <fcntl.h>
#ifdef _WIN32
#include <io.h>
#include <windows.h>
#else
#include <unistd.h>
#endif
#ifdef __APPLE__
#include <xlocale.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <thread>

namespace spherical_param::tools {

#ifdef _WIN32

bool isTerminal() {
  const HANDLE console = GetStdHandle(STD_OUTPUT_HANDLE);
  DWORD mode = 0;
  return GetConsoleMode(console, &mode) != 0 &&
         SetConsoleMode(console, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

void occupyStandardStreams() {}

void handleSignals(const std::function<void(const std::function<void()>&)>& at_end) {
  static const auto call_at_end = at_end;
  // Windows calls it in a thread of its own.
  const auto end = [](DWORD) -> BOOL {
    call_at_end([] { TerminateProcess(GetCurrentProcess(), STATUS_CONTROL_C_EXIT); });
    return TRUE;
  };
  SetConsoleCtrlHandler(end, TRUE);
}

std::FILE* createFile(const std::string& path, std::filesystem::perms) {
  // As opposed to those of fopen(), it can be removed before it is closed.
  const HANDLE handle =
      CreateFileW(std::filesystem::path(path).c_str(), GENERIC_WRITE,
                  FILE_SHARE_READ | FILE_SHARE_DELETE, nullptr, CREATE_NEW, 0, nullptr);
  if (handle == INVALID_HANDLE_VALUE) {
    errno = GetLastError() == ERROR_FILE_EXISTS ? EEXIST : EACCES;
    return nullptr;
  }
  return _fdopen(_open_osfhandle(reinterpret_cast<std::intptr_t>(handle), _O_BINARY), "wb");
}

std::FILE* openDevice(const std::string& path) {
  return std::fopen(path.c_str(), "wb");
}

int writeRefusal(const std::string& path) {
  return _waccess(std::filesystem::path(path).c_str(), 2) == 0 ? 0 : errno;
}

#else

namespace {

std::FILE* openToWrite(const std::string& path, int flags, mode_t rights) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC | flags, rights);
  if (descriptor < 0) {
    return nullptr;
  }
  std::FILE* const file = fdopen(descriptor, "wb");
  if (file == nullptr) {  // no memory
    close(descriptor);
    if ((flags & O_EXCL) != 0) {
      unlink(path.c_str());
    }
  }
  return file;
}

}  // namespace

bool isTerminal() {
  return isatty(STDOUT_FILENO) == 1;
}

void occupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) == -1) {
      // The lowest number that is free; the wrong way round, so that its use still fails.
      [[maybe_unused]] const int opened =
          open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
  }
}

void handleSignals(const std::function<void(const std::function<void()>&)>& at_end) {
  // A thread of its own waits for them: a handler could interrupt the making of a file, in one
  // thread or another, and may do next to nothing.
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
  std::thread([signals, at_end] {
    int number = 0;
    sigwait(&signals, &number);
    at_end([&] {
      // Ends the tool as the signal would have, so that the caller sees what happened.
      pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
      std::raise(number);
    });
  }).detach();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

std::FILE* createFile(const std::string& path, std::filesystem::perms rights) {
  return openToWrite(path, O_CREAT | O_EXCL, static_cast<mode_t>(rights));
}

std::FILE* openDevice(const std::string& path) {
  return openToWrite(path, 0, 0);
}

int writeRefusal(const std::string& path) {
  std::error_code error;
  const int wanted = std::filesystem::is_directory(path, error) ? W_OK | X_OK : W_OK;
  return access(path.c_str(), wanted) == 0 ? 0 : errno;
}

#ifndef __cpp_lib_to_chars
double strtodInC(const char* text, char** end) {
  static const locale_t classic = newlocale(LC_ALL_MASK, "C", nullptr);
  return strtod_l(text, end, classic);
}
#endif

#endif

void keepMemory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
#endif
}

bool isLackOfSpace(const std::error_code& error) {
#ifdef EDQUOT
  if (error.value() == EDQUOT) {
    return true;
  }
#endif
  return error == std::errc::no_space_on_device || error == std::errc::file_too_large;
}

}  // namespace spherical_param::tools
