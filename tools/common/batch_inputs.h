#pragma once

#include <string>
#include <vector>

namespace spherical_param::tools {

/// One of the inputs of a batch.
struct BatchInput {
  std::string path;
  bool from_directory = false;  ///< found there, not named by the user
};

/// The files that words of a command line and the lines of a list name, in that order. A directory
/// stands for the files in it that clouds are read from, by their names, hidden ones not among
/// them. In the list, empty lines and those that begin with # do not count.
///
/// \param list a file with a path on each line, "-" for the standard input, empty: none.
/// \throw Failure for a list or a directory that cannot be read, UsageError if there is no input.
std::vector<BatchInput> collectInputs(const std::vector<std::string>& words,
                                      const std::string& list);

}  // namespace spherical_param::tools
