#include "common/output_file.h"

#include "common/errors.h"
#include "common/system.h"
#include "common/text.h"

#include <cerrno>
#include <mutex>
#include <random>
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
  constexpr int max_links = 40;
  for (int i = 0; i < max_links && fs::is_symlink(fs::symlink_status(current, error)); ++i) {
    current = current.parent_path() / fs::read_symlink(current, error);
  }
  const fs::path resolved = fs::weakly_canonical(current, error);
  return error ? path : resolved.string();
}

std::string directoryOf(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? "." : parent.string();
}

/// The error of the last call of the C library.
std::error_code lastError() {
  return {errno, std::generic_category()};
}

constexpr const char* another_place = "choose a place that exists and that you may write to";

[[noreturn]] void failPath(const std::string& path, const std::string& reason,
                           const std::string& remedy) {
  throw Failure("cannot write " + inQuotes(path) + ": " + reason, remedy);
}

}  // namespace

void checkOutputPath(const std::string& path) {
  const std::string target = resolveLinks(path);
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status)) {
    if (fs::is_directory(status)) {
      failPath(path, "it is a directory", "add the name of a file");
    }
    if (const int refusal = writeRefusal(target)) {
      failPath(path, systemMessage(refusal), "make the file writable or choose another name");
    }
    if (!fs::is_regular_file(status)) {
      return;  // a device or pipe is written in its place: its directory does not matter
    }
  } else if (error && error != std::errc::no_such_file_or_directory) {
    failPath(path, error.message(), another_place);
  }
  const std::string directory = directoryOf(target);
  if (const int refusal = writeRefusal(directory)) {
    failPath(path,
             refusal == ENOENT ? "missing directory " + inQuotes(directory)
                               : systemMessage(refusal),
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
  std::error_code error;
  const fs::file_status old = fs::status(target_, error);
  if (fs::exists(old) && !fs::is_regular_file(old)) {
    file_ = openDevice(target_);
  } else {
    if (fs::exists(old)) {
      rights_ = old.permissions();
    }
    createTemporary();
  }
  if (file_ == nullptr) {
    fail("write", lastError());
  }
  // Each write goes to the system at once, so that its error is known.
  std::setvbuf(file_, nullptr, _IONBF, 0);
}

void OutputFile::createTemporary() {
  // The name does not grow with the file's, which may be as long as a name can be.
  const std::string start = directoryOf(target_) + "/.spherical_param.";
  std::random_device random;
  const std::lock_guard<std::mutex> lock(registry().mutex);
  std::set<std::string>::node_type node;
  std::string path;
  do {
    // All memory before there is a file, which would stay if there were none.
    path = start + std::to_string(random());
    std::set<std::string> made = {path};
    node = made.extract(made.begin());
    // What replaces a file that others may not read is not theirs to read before.
    file_ = createFile(path, rights_ ? fs::perms{0600} : fs::perms{0666});
  } while (file_ == nullptr && errno == EEXIST);
  if (file_ != nullptr) {
    temporary_ = std::move(path);
    registry().paths.insert(std::move(node));
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) {
    std::fclose(file_);
  }
  if (!temporary_.empty()) {
    const std::lock_guard<std::mutex> lock(registry().mutex);
    std::remove(temporary_.c_str());
    registry().paths.erase(temporary_);
  }
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    errno = 0;
    const std::size_t count = std::fwrite(bytes.data(), 1, bytes.size(), file_);
    bytes.remove_prefix(count);
    written_ += count;
    if (!bytes.empty() && errno != EINTR) {
      fail("write", errno != 0 ? lastError() : std::make_error_code(std::errc::io_error));
    }
  }
}

void OutputFile::finish() {
  if (file_ == nullptr) {
    return;
  }
  std::error_code error;
  if (rights_) {
    fs::permissions(temporary_, *rights_, error);
    if (error) {
      fail("set the rights of", error);
    }
  }
  // Network file systems report a full disk only here.
  if (std::fclose(std::exchange(file_, nullptr)) != 0) {
    fail("write", lastError());
  }
  if (!temporary_.empty() && fs::file_size(temporary_, error) != written_) {
    fail("write", error ? error : std::make_error_code(std::errc::io_error));
  }
}

void OutputFile::commit() {
  finish();
  if (temporary_.empty()) {
    return;
  }
  const std::lock_guard<std::mutex> lock(registry().mutex);
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) {
    fail("write", error);
  }
  registry().paths.erase(temporary_);
  temporary_.clear();
}

void OutputFile::fail(const std::string& action, const std::error_code& error) const {
  throw Failure("cannot " + action + " " + inQuotes(path_) + ": " + error.message(),
                isLackOfSpace(error) ? "free space there or write to another place"
                                     : another_place);
}

void removeTemporaryFiles(const std::function<void()>& afterwards) {
  const std::lock_guard<std::mutex> lock(registry().mutex);
  for (const std::string& path : registry().paths) {
    std::remove(path.c_str());
  }
  afterwards();
}

}  // namespace spherical_param::tools
