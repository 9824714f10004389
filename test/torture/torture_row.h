#pragma once

#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <string>

namespace torture {

/// One row of the table of tools/torture.sh.
struct Row {
  std::string part;            ///< e.g. "shapes"
  std::string load;            ///< what was held, in words
  std::uint64_t tried = 0;     ///< inputs
  std::uint64_t injected = 0;  ///< faults
  std::uint64_t found = 0;     ///< answers that are not what is guaranteed
  std::uint64_t lost = 0;      ///< points, files or bytes that should have been kept
};

/// Prints a row as tools/torture.sh reads it. \return the program's exit code: 0 if nothing was
/// found or lost.
inline int print(const Row& row) {
  std::printf("row: %s | %s | %" PRIu64 " | %" PRIu64 " | %" PRIu64 " | %" PRIu64 "\n",
              row.part.c_str(), row.load.c_str(), row.tried, row.injected, row.found, row.lost);
  std::fflush(stdout);
  return row.found + row.lost > 0 ? 1 : 0;
}

}  // namespace torture
