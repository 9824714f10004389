#include "library_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

namespace spherical_param::benchmark {
namespace {

void flushAll() {
  std::cout.flush();
  std::cerr.flush();
  std::fflush(stdout);
  std::fflush(stderr);
}

int replaceByNull(int descriptor) {
  const int saved = fcntl(descriptor, F_DUPFD_CLOEXEC, 3);
  if (saved < 0) {
    return saved;  // better what a library prints than nothing ever after
  }
  const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (null >= 0) {
    dup2(null, descriptor);
    close(null);
  }
  return saved;
}

void restore(int descriptor, int saved) {
  if (saved >= 0) {
    dup2(saved, descriptor);
    close(saved);
  }
}

}  // namespace

LibraryOutputSilencer::LibraryOutputSilencer() {
  flushAll();
  standard_output_ = replaceByNull(STDOUT_FILENO);
  standard_error_ = replaceByNull(STDERR_FILENO);
}

LibraryOutputSilencer::~LibraryOutputSilencer() {
  flushAll();
  restore(STDOUT_FILENO, standard_output_);
  restore(STDERR_FILENO, standard_error_);
}

}  // namespace spherical_param::benchmark
