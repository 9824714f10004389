/// The page that -report puts its data into.
#pragma once

#include <string_view>

namespace spherical_param::tools {

/// HTML with one line `<!--DATA-->`, in place of which the data come. Empty if the build had no
/// npm: there is no -report then.
std::string_view reportPage();

}  // namespace spherical_param::tools
