#pragma once

#include <cstdint>
#include <optional>

namespace spherical_param::tools {

/// Largest resident memory of this program so far [bytes]; nothing where the system does not report
/// it.
///
/// Unlike ru_maxrss of getrusage(), it does not begin with the memory of the process that started
/// this one.
std::optional<std::uint64_t> peakMemory();

}  // namespace spherical_param::tools
