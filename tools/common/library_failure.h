#pragma once

#include "common/errors.h"
#include "spherical_param/errors.h"

#include <exception>
#include <string>

namespace spherical_param::tools {

/// An error of the library, "function: cause; remedy", as the user of a tool is told it: the name
/// of the function is nothing to him.
///
/// \param task   what could not be done, e.g. "cannot mesh 'file'".
/// \param remedy where the library has none.
Failure libraryFailure(const std::string& task, const std::exception& error,
                       const std::string& remedy);

/// Does some work with the library. \throw Failure as libraryFailure() has it, where the library
/// refuses its input or cannot do it.
template <typename Work>
void runLibrary(const std::string& task, const std::string& remedy, const Work& work) {
  try {
    work();
  } catch (const InvalidInput& error) {
    throw libraryFailure(task, error, remedy);
  } catch (const ComputeError& error) {
    throw libraryFailure(task, error, remedy);
  }
}

/// The remedy where there should be no failure.
inline constexpr const char* kReportIt = "this should not happen: please report it";

}  // namespace spherical_param::tools
