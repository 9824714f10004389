#pragma once

#include "common/errors.h"

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

}  // namespace spherical_param::tools
