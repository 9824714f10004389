#pragma once

#include <string>
#include <vector>

namespace spherical_param::tools {

/// Names of numbered files. A placeholder in the pattern's file name, %d or %03d with any number of
/// digits up to 9, is replaced by the number of the frame; without one, it goes before the
/// extension: morph.ply gives morph_000.ply. Frames begin at 0.
///
/// \throw UsageError for a pattern with another or a second %.
std::vector<std::string> frameNames(const std::string& pattern, int frames);

}  // namespace spherical_param::tools
