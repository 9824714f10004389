#pragma once

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace stress {

/// What the programs of tools/stress.sh take.
struct Arguments {
  bool quick = false;
  unsigned long long seed = 1;
};

inline Arguments parse(int count, char** values) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    if (std::strcmp(values[i], "--quick") == 0) {
      arguments.quick = true;
    } else if (std::strcmp(values[i], "--seed") == 0 && i + 1 < count) {
      arguments.seed = std::strtoull(values[++i], nullptr, 10);
    } else {
      std::fprintf(stderr, "usage: %s [--quick] [--seed N]\n", values[0]);
      std::exit(2);
    }
  }
  return arguments;
}

/// Prints a row of the script's table. \return the program's exit code.
inline int finish(const std::string& part, std::size_t tried, std::size_t found) {
  std::printf("row: %s | %zu | %zu\n", part.c_str(), tried, found);
  return found > 0 ? 1 : 0;
}

}  // namespace stress
