#include "common/run_tool.h"

#include "common/output_file.h"
#include "tool_runner.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <map>
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
  std::exit(runTool("tool", 1, words.data(), [&](const std::vector<std::string>&) { work(); }));
}

TEST(RunToolDeathTest, WhateverIsThrownIsReportedAndFails) {
  EXPECT_EXIT(runAndExit([] { throw std::bad_alloc(); }), testing::ExitedWithCode(1),
              "tool: not enough memory\n  remedy: ");
  EXPECT_EXIT(runAndExit([] { throw std::runtime_error("two\nlines"); }),
              testing::ExitedWithCode(1), "tool: two lines\n  remedy: ");
  EXPECT_EXIT(runAndExit([] {}), testing::ExitedWithCode(0), "^$");
}

/// As OpenMP's runtime does where it cannot start a thread.
TEST(RunToolDeathTest, AnEndByALibraryIsReportedAndLeavesNoFile) {
  const tool_test::TemporaryDirectory directory;
  tool_test::writeFile(directory.file("mesh.ply"), "kept");
  EXPECT_EXIT(runAndExit([&] {
                OutputFile file(directory.file("mesh.ply"));
                file.write("half a mesh");
                std::exit(0);
              }),
              testing::ExitedWithCode(1), "tool: .*ended the program\n  remedy: ");
  EXPECT_EQ(directory.listing(), (std::map<std::string, std::string>{{"mesh.ply", "kept"}}));
}

}  // namespace
}  // namespace spherical_param::tools
