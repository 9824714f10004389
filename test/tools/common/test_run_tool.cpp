#include "common/run_tool.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace spherical_param::tools {
namespace {

/// Runs a tool that does something, and ends the program as main() does.
[[noreturn]] void runAndExit(const std::function<void()>& work) {
  std::string name = "tool";
  std::vector<char*> words = {name.data(), nullptr};
  std::exit(
      runTool({"tool", "", "", {}}, 1, words.data(), {}, [&](const CommandLine&) { work(); }));
}

TEST(RunToolDeathTest, WhateverIsThrownIsReportedAndFails) {
  EXPECT_EXIT(runAndExit([] { throw std::bad_alloc(); }), testing::ExitedWithCode(1),
              "tool: not enough memory\n  remedy: ");
  EXPECT_EXIT(runAndExit([] { throw std::runtime_error("two\nlines"); }),
              testing::ExitedWithCode(1), "tool: two lines\n  remedy: ");
  EXPECT_EXIT(runAndExit([] {}), testing::ExitedWithCode(0), "^$");
}

}  // namespace
}  // namespace spherical_param::tools
