#include "common/output_file.h"

#include "common/errors.h"
#include "common/text.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <set>
#include <utility>

namespace spherical_param::tools {
namespace {

namespace fs = std::filesystem;

/// The temporary files there are. Files are made, renamed and removed under the lock only.
struct Registry {
  std::mutex mutex;
  std::set<std::string> paths;
};

/// Never destroyed: the thread that waits for signals may need it until the very end.
Registry& registry() {
  static Registry& instance = *new Registry;
  return instance;
}

/// The path behind symbolic links, so that the link survives the renaming.
std::string resolveLinks(const std::string& path) {
  std::error_code error;
  // Of a relative path that does not exist, weakly_canonical() alone would leave "./" or not.
  fs::path current = fs::absolute(path, error);
  // Nor does it follow a link to a file that is not there yet.
  constexpr int most_links = 40;
  for (int i = 0; i < most_links && fs::is_symlink(fs::symlink_status(current, error)); ++i) {
    current = current.parent_path() / fs::read_symlink(current, error);
  }
  const fs::path resolved = fs::weakly_canonical(current, error);
  return error ? path : resolved.string();
}

std::string directoryOf(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent.string();
}

/// Rights of the finished file: those of the file it replaces, else what the umask leaves.
mode_t wantedMode(const std::string& target) {
  struct stat status {};
  if (stat(target.c_str(), &status) == 0) {
    return status.st_mode & 07777;
  }
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

bool isRegularOrAbsent(const std::string& target) {
  struct stat status {};
  return stat(target.c_str(), &status) != 0 || S_ISREG(status.st_mode);
}

constexpr const char* another_place = "choose a place that exists and that you may write to";

[[noreturn]] void failPath(const std::string& path, const std::string& reason,
                           const std::string& remedy) {
  throw Failure("cannot write " + inQuotes(path) + ": " + reason, remedy);
}

}  // namespace

void checkOutputPath(const std::string& path) {
  struct stat status {};
  const std::string target = resolveLinks(path);
  if (stat(target.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) {
      failPath(path, "it is a directory", "add the name of a file");
    }
    if (access(target.c_str(), W_OK) != 0) {
      failPath(path, systemMessage(errno), "make the file writable or choose another name");
    }
    if (!S_ISREG(status.st_mode)) {
      return;  // a device or pipe is written in its place: its directory does not matter
    }
  } else if (errno != ENOENT) {
    failPath(path, systemMessage(errno), another_place);
  }
  const std::string directory = directoryOf(target);
  if (access(directory.c_str(), W_OK | X_OK) != 0) {
    failPath(path,
             errno == ENOENT ? "missing directory " + inQuotes(directory) : systemMessage(errno),
             another_place);
  }
}

bool isSameFile(const std::string& first, const std::string& second) {
  std::error_code error;
  if (fs::equivalent(first, second, error) && !error) {
    return true;
  }
  return resolveLinks(first) == resolveLinks(second);
}

OutputFile::OutputFile(const std::string& path) : path_(path), target_(resolveLinks(path)) {
  if (!isRegularOrAbsent(target_)) {
    descriptor_ = open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) {
      fail("write", errno);
    }
    return;
  }
  // The name does not grow with the file's, which may be as long as a name can be.
  std::string pattern = directoryOf(target_) + "/.spherical_param.XXXXXX";
  // All memory before there is a file, which would stay if there were none.
  std::set<std::string> made = {pattern};
  auto node = made.extract(made.begin());
  temporary_.reserve(pattern.size());
  const std::lock_guard<std::mutex> lock(registry().mutex);
  descriptor_ = mkostemp(pattern.data(), O_CLOEXEC);
  if (descriptor_ < 0) {
    fail("write", errno);
  }
  temporary_ = pattern;
  node.value() = std::move(pattern);
  registry().paths.insert(std::move(node));
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) {
    close(descriptor_);
  }
  if (!temporary_.empty()) {
    const std::lock_guard<std::mutex> lock(registry().mutex);
    unlink(temporary_.c_str());
    registry().paths.erase(temporary_);
  }
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      fail("write", count < 0 ? errno : ENOSPC);
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
    written_ += static_cast<std::size_t>(count);
  }
}

void OutputFile::finish() {
  if (descriptor_ < 0) {
    return;
  }
  struct stat status {};
  const bool known = fstat(descriptor_, &status) == 0;
  if (!temporary_.empty() && fchmod(descriptor_, wantedMode(target_)) != 0) {
    fail("set the rights of", errno);
  }
  // Network file systems report a full disk only here.
  if (close(std::exchange(descriptor_, -1)) != 0) {
    fail("write", errno);
  }
  if (!temporary_.empty() && (!known || static_cast<std::size_t>(status.st_size) != written_)) {
    fail("write", EIO);
  }
}

void OutputFile::commit() {
  finish();
  if (temporary_.empty()) {
    return;
  }
  const std::lock_guard<std::mutex> lock(registry().mutex);
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) {
    fail("write", errno);
  }
  registry().paths.erase(temporary_);
  temporary_.clear();
}

void OutputFile::fail(const std::string& action, int error_number) const {
  const bool full = error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
  throw Failure("cannot " + action + " " + inQuotes(path_) + ": " + systemMessage(error_number),
                full ? "free space there or write to another place" : another_place);
}

void removeTemporaryFiles(const std::function<void()>& afterwards) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  for (const std::string& path : registry().paths) {
    unlink(path.c_str());
  }
  afterwards();
}

}  // namespace spherical_param::tools
