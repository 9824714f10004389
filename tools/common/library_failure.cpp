#include "common/library_failure.h"

#include <cstddef>

namespace spherical_param::tools {

Failure libraryFailure(const std::string& task, const std::exception& error,
                       const std::string& remedy) {
  const std::string message = error.what();
  const std::size_t name = message.find(": ");
  // The name of a function is one word.
  const std::string text = name < message.find(' ') ? message.substr(name + 2) : message;
  const std::size_t end = text.find("; ");
  return {task + ": " + text.substr(0, end),
          end == std::string::npos ? remedy : text.substr(end + 2)};
}

}  // namespace spherical_param::tools
