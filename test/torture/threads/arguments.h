#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

namespace torture {

struct Arguments {
  bool quick = false;
  std::uint64_t seed = 1;
};

/// --quick and --seed N. \return nothing for anything else, after having said so.
inline std::optional<Arguments> parse(int count, char** values) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string argument = values[i];
    if (argument == "--quick") {
      arguments.quick = true;
    } else if (argument == "--seed" && i + 1 < count) {
      arguments.seed = std::strtoull(values[++i], nullptr, 10);
    } else {
      std::fprintf(stderr, "usage: %s [--quick] [--seed N]\n", values[0]);
      return {};
    }
  }
  std::printf("seed %llu\n", static_cast<unsigned long long>(arguments.seed));
  return arguments;
}

}  // namespace torture
