#include "common/output_file.h"
#include "common/run_tool.h"
#include "tool_runner.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <new>
#include <string>
#include <vector>

namespace {

using namespace spherical_param::tools;
using tool_test::readFile;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;

TEST(OutputFile, FollowsLinksToAFileThatDoesNotExistYet) {
  const TemporaryDirectory directory;
  std::filesystem::create_symlink("second.ply", directory.file("first.ply"));
  std::filesystem::create_symlink("mesh.ply", directory.file("second.ply"));
  checkOutputPath(directory.file("first.ply"));
  OutputFile file(directory.file("first.ply"));
  file.write("a mesh");
  file.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(directory.file("first.ply")));
  EXPECT_TRUE(std::filesystem::is_symlink(directory.file("second.ply")));
  EXPECT_FALSE(std::filesystem::is_symlink(directory.file("mesh.ply")));
  EXPECT_EQ(readFile(directory.file("mesh.ply")), "a mesh");
}

/// Runs a tool that does something, and ends the program as main() does.
[[noreturn]] void runAndExit(const std::function<void()>& work) {
  std::string name = "tool";
  std::vector<char*> words = {name.data(), nullptr};
  std::exit(runTool("tool", 1, words.data(), [&](const std::vector<std::string>&) { work(); }));
}

TEST(RunToolDeathTest, LackOfMemoryIsReportedAndFails) {
  EXPECT_EXIT(runAndExit([] { throw std::bad_alloc(); }), testing::ExitedWithCode(1),
              "tool: not enough memory\n  remedy: ");
}

/// As OpenMP's runtime does where it cannot start a thread.
TEST(RunToolDeathTest, AnEndByALibraryIsReportedAndLeavesNoFile) {
  const TemporaryDirectory directory;
  writeFile(directory.file("mesh.ply"), "kept");
  EXPECT_EXIT(runAndExit([&] {
                OutputFile file(directory.file("mesh.ply"));
                file.write("half a mesh");
                std::exit(0);
              }),
              testing::ExitedWithCode(1), "tool: .*ended the program\n  remedy: ");
  EXPECT_EQ(directory.listing(), (std::map<std::string, std::string>{{"mesh.ply", "kept"}}));
}

}  // namespace
