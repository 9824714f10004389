#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace stress {

/// Ends the fuzzer if something does not hold, whatever the build.
inline void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "not so: %s\n", what);
    std::abort();
  }
}

/// A file in memory with a name that the tools take for one of theirs: a link in $TMPDIR.
class FuzzFile {
public:
  explicit FuzzFile(const std::string& extension) : descriptor_(memfd_create("input", 0)) {
    const char* const directory = std::getenv("TMPDIR");
    const std::string process = std::to_string(getpid());
    path_ = std::string(directory == nullptr ? "/tmp" : directory) + "/fuzz_" + process + extension;
    unlink(path_.c_str());
    const std::string file = "/proc/" + process + "/fd/" + std::to_string(descriptor_);
    require(descriptor_ >= 0 && symlink(file.c_str(), path_.c_str()) == 0, "a file can be made");
  }
  ~FuzzFile() {
    unlink(path_.c_str());
    close(descriptor_);
  }
  FuzzFile(const FuzzFile&) = delete;
  FuzzFile& operator=(const FuzzFile&) = delete;

  const std::string& path() const { return path_; }

  void fill(const std::uint8_t* bytes, std::size_t size) {
    require(ftruncate(descriptor_, 0) == 0 &&
                pwrite(descriptor_, bytes, size, 0) == static_cast<ssize_t>(size),
            "a file can be filled");
  }

  std::string content() const {
    std::string bytes(static_cast<std::size_t>(lseek(descriptor_, 0, SEEK_END)), '\0');
    require(pread(descriptor_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()),
            "a file can be read");
    return bytes;
  }

private:
  int descriptor_;
  std::string path_;
};

}  // namespace stress
