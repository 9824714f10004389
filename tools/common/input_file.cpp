#include "common/input_file.h"

#include "common/errors.h"
#include "common/text.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>

namespace spherical_param::tools {

void failReading(const std::string& path, const std::string& reason, const std::string& remedy) {
  throw Failure("cannot read " + inQuotes(path) + ": " + reason, remedy);
}

void failContent(const std::string& path, const std::string& reason) {
  failReading(path, reason, "check that the file is complete and what its extension says");
}

std::uint64_t checkInputFile(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    failReading(path, systemMessage(errno), "check the name of the file");
  }
  if (S_ISDIR(status.st_mode)) {
    failReading(path, "it is a directory", "give a file");
  }
  if (!S_ISREG(status.st_mode)) {
    failReading(path, "it is not a regular file", "save the data to a file first");
  }
  if (status.st_size == 0) {
    failContent(path, "it is empty");
  }
  readBeginning(path, 1);
  return static_cast<std::uint64_t>(status.st_size);
}

std::string readBeginning(const std::string& path, std::size_t size) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             std::fclose);
  if (!file) {
    failReading(path, systemMessage(errno), "check the rights of the file");
  }
  struct stat status {};
  if (fstat(fileno(file.get()), &status) == 0 && S_ISREG(status.st_mode)) {
    size = std::min(size, static_cast<std::size_t>(status.st_size));
  }
  std::string content(size, '\0');
  content.resize(std::fread(content.data(), 1, size, file.get()));
  if (std::ferror(file.get()) != 0) {
    failReading(path, systemMessage(errno), "check the disk that holds the file");
  }
  return content;
}

}  // namespace spherical_param::tools
