#include "common/errors.h"
#include "common/output_file.h"
#include "common/reconstruction_options.h"
#include "common/run_tool.h"
#include "tool_runner.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace {

using namespace spherical_param::tools;
using tool_test::readFile;
using tool_test::TemporaryDirectory;
using tool_test::writeFile;

/// The id of a process that has ended.
pid_t endedProcess() {
  const pid_t child = fork();
  if (child == 0) {
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  return child;
}

void makeOlder(const std::string& path, std::chrono::minutes age) {
  std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() - age);
}

TEST(OutputFile, TakesAlongWhatAKilledRunHasLeft) {
  const TemporaryDirectory directory;
  const std::string left = directory.file(temporaryPrefix(endedProcess()) + "abcdef");
  const std::string young = directory.file(temporaryPrefix(endedProcess()) + "ghijkl");
  const std::string of_another = directory.file(temporaryPrefix(getppid()) + "abcdef");
  for (const std::string& path : {left, young, of_another}) {
    writeFile(path, "half a mesh");
  }
  makeOlder(left, std::chrono::minutes(11));
  makeOlder(of_another, std::chrono::minutes(11));
  OutputFile file(directory.file("mesh.ply"));
  file.write("a mesh");
  file.commit();
  EXPECT_EQ(readFile(directory.file("mesh.ply")), "a mesh");
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(std::filesystem::exists(young));
  EXPECT_TRUE(std::filesystem::exists(of_another));
}

TEST(OutputFile, FollowsLinksToAFileThatIsNotThereYet) {
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

TEST(OutputFile, RefusesLinksThatLeadNowhere) {
  const TemporaryDirectory directory;
  std::filesystem::create_symlink("missing/mesh.ply", directory.file("nowhere.ply"));
  std::filesystem::create_symlink("loop.ply", directory.file("loop.ply"));
  for (const char* name : {"nowhere.ply", "loop.ply"}) {
    EXPECT_THROW(checkOutputPath(directory.file(name)), Failure) << name;
    EXPECT_TRUE(std::filesystem::is_symlink(directory.file(name)));
    std::filesystem::remove(directory.file(name));
  }
}

/// Runs a tool that does something, and ends the program as main() does.
[[noreturn]] void runAndExit(const std::function<void()>& work) {
  std::string name = "tool";
  std::vector<char*> words = {name.data(), nullptr};
  std::exit(runTool("tool", 1, words.data(), [&](const std::vector<std::string>&) { work(); }));
}

TEST(RunToolDeathTest, LackOfMemoryIsTold) {
  EXPECT_EXIT(runAndExit([] { throw std::bad_alloc(); }), testing::ExitedWithCode(1),
              "tool: not enough memory\n  remedy: ");
}

TEST(RunToolDeathTest, PathsThatAreNoneAreNoLackOfMemory) {
  EXPECT_EXIT(runAndExit([] { std::filesystem::copy("/no/such/file", "/no/such/other"); }),
              testing::ExitedWithCode(1), "tool: .*No such file.*\n  remedy: check .*paths");
}

TEST(RequireNoWarnings, TellsThoseOfAllInputs) {
  ReconstructionSettings settings;
  const std::vector<std::pair<std::string, std::vector<std::string>>> warnings = {
      {"a.ply", {"It is open.", "It is noisy."}}, {"b.ply", {}}, {"c.ply", {"It is folded."}}};
  EXPECT_NO_THROW(requireNoWarnings(settings, warnings));
  settings.strict = true;
  EXPECT_NO_THROW(requireNoWarnings(settings, {{"b.ply", {}}}));
  try {
    requireNoWarnings(settings, warnings);
    ADD_FAILURE() << "no failure";
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(),
                 "'a.ply': 2 warnings: It is open. It is noisy. 'c.ply': It is folded.");
  }
}

TEST(RunToolDeathTest, LackOfThreadsIsTold) {
  EXPECT_EXIT(runAndExit([] {
                throw std::system_error(
                    std::make_error_code(std::errc::resource_unavailable_try_again));
              }),
              testing::ExitedWithCode(1), "tool: .*unavailable\n  remedy: allow more");
}

/// As OpenMP's runtime does where it cannot start a thread.
TEST(RunToolDeathTest, WhatALibraryEndsIsToldAndLeavesNothing) {
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

TEST(RunToolDeathTest, AWorkThatIsDoneEndsWithoutAWord) {
  EXPECT_EXIT(runAndExit([] {}), testing::ExitedWithCode(0), "^$");
}

}  // namespace
