#include "common/record_log.h"

#include "common/errors.h"
#include "common/input_file.h"
#include "common/output_file.h"
#include "common/text.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace spherical_param::tools {
namespace {

[[noreturn]] void failWriting(const std::string& path, int error_number) {
  throw Failure("cannot write " + inQuotes(path) + ": " + systemMessage(error_number),
                "choose a place for -jsonl that takes more bytes");
}

void writeAll(const std::string& path, int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      failWriting(path, count < 0 ? errno : ENOSPC);
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

std::string inUtf8(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Tells whether the last byte of a file ends a line.
bool endsWithLine(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) {
    return true;
  }
  char last = '\n';
  return pread(descriptor, &last, 1, status.st_size - 1) != 1 || last == '\n';
}

/// What is nested deeper is no record of ours, and would end the program as soon as it is copied.
bool isShallow(int depth, Json::parse_event_t /*event*/, Json& /*parsed*/) {
  constexpr int deepest = 64;
  return depth <= deepest;
}

/// Keeps others from adding to a file. Where the file system has no locks, lines are still written
/// at once.
class FileLock {
public:
  explicit FileLock(int descriptor) : descriptor_(descriptor) { flock(descriptor_, LOCK_EX); }
  ~FileLock() { flock(descriptor_, LOCK_UN); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

private:
  int descriptor_;
};

}  // namespace

RecordLog::RecordLog(const std::string& path) : path_(path) {
  if (path_.empty()) {
    return;
  }
  if (path_ == "-") {
    path_ = "the standard output";
    // Programs that are started must not hold it open.
    descriptor_ = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
  } else {
    checkOutputPath(path_);
    descriptor_ = open(path_.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno == EACCES) {
      // A pipe, or a file that may only be written.
      descriptor_ = open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    }
  }
  if (descriptor_ < 0) {
    failWriting(path, errno);
  }
}

RecordLog::~RecordLog() {
  if (descriptor_ >= 0) {
    close(descriptor_);
  }
}

void RecordLog::append(const Json& record) const {
  if (descriptor_ < 0) {
    return;
  }
  const std::string line = inUtf8(record) + "\n";
  const FileLock lock(descriptor_);
  writeAll(path_, descriptor_, endsWithLine(descriptor_) ? line : "\n" + line);
}

std::string asRecorded(const std::string& text) {
  return Json::parse(inUtf8(Json(text))).get<std::string>();
}

std::vector<Json> readRecords(const std::string& path) {
  std::vector<Json> records;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return records;
  }
  errno = 0;
  std::ifstream lines(path);
  if (!lines) {
    failReading(path, systemMessage(errno), "check the rights of the file");
  }
  for (std::string line; std::getline(lines, line);) {
    Json record = Json::parse(line, isShallow, false);
    if (record.is_object()) {
      records.push_back(std::move(record));
    }
  }
  return records;
}

}  // namespace spherical_param::tools
