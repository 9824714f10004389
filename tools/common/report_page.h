/// The page that -report puts its data into. Both texts are empty in a build without three.js:
/// there is no -report then.
#pragma once

#include <string_view>

namespace spherical_param::tools {

/// HTML with one line `<!--DATA-->`, in place of which the program and the data come.
std::string_view reportPage();

/// The JavaScript that shows the data, with three.js.
std::string_view reportProgram();

}  // namespace spherical_param::tools
