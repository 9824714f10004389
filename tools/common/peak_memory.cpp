#include "common/peak_memory.h"

#include <fstream>
#include <string>

namespace spherical_param::tools {

std::optional<std::uint64_t> peakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::uint64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) {
      return kibibytes * 1024;
    }
  }
  return std::nullopt;
}

}  // namespace spherical_param::tools
