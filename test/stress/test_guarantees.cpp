// What holds when something fails: lack of memory comes out as std::bad_alloc, and a killed tool
// leaves no half-written file. Full disks are in test/tools/test_bad_input.cpp.

#include "helpers.h"
#include "spherical_param/reconstruct.h"
#include "tool_runner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace {

/// Allocations until one fails; below 0: none fails.
std::atomic<long> left{-1};

void* allocate(std::size_t size) {
  if (left.load() >= 0 && left.fetch_sub(1) == 0)
    throw std::bad_alloc();
  void* const memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr)
    throw std::bad_alloc();
  return memory;
}

}  // namespace

// All other forms of new and delete call these.
void* operator new(std::size_t size) {
  return allocate(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace {

using namespace spherical_param;

TEST(Guarantees, BadAllocIsPassedOnFromEveryAllocation) {
  const Positions points = test::spiralSphere(5000);  // enough for several threads
  Options options;
  options.threads = 2;
  constexpr long many = 1L << 40;
  left = many;
  const Triangles expected = reconstruct(points, options).surface().triangles;
  const long allocations = many - left;
  ASSERT_GT(allocations, 1000);
  std::mt19937_64 random(1);
  for (int i = 0; i < 12; ++i) {
    const auto which =
        static_cast<long>(random() % static_cast<std::uint64_t>(allocations * 9 / 10));
    left = which;
    EXPECT_THROW(reconstruct(points, options), std::bad_alloc) << "allocation " << which;
  }
  left = -1;
  EXPECT_EQ(reconstruct(points, options).surface().triangles, expected);
}

TEST(Guarantees, AKilledToolLeavesNoHalfWrittenFile) {
  const tool_test::TemporaryDirectory directory;
  std::ostringstream scan;
  scan << test::spiralSphere(5000).transpose();
  tool_test::writeFile(directory.file("scan.xyz"), scan.str());
  tool_test::RunOptions how;
  how.directory = directory.path();
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(tool_test::run(RECONSTRUCTION_TOOL, {"scan.xyz", "whole.obj"}, how).exit_code, 0);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  const std::string whole = tool_test::readFile(directory.file("whole.obj"));
  std::mt19937_64 random(1);
  for (int i = 0; i < 12; ++i) {
    tool_test::writeFile(directory.file("mesh.obj"), "kept");
    std::vector<std::string> words{RECONSTRUCTION_TOOL, "scan.xyz", "mesh.obj"};
    how.signal_when_temporary = i % 3 == 0 ? SIGKILL : 0;  // while the file is written
    if (i % 3 != 0) {                                      // at any time
      const double seconds = time.count() * static_cast<double>(1 + random() % 110) / 100.0;
      words.insert(words.begin(), {"/usr/bin/timeout", "-s", "KILL", std::to_string(seconds)});
    }
    tool_test::run(words.front(), {words.begin() + 1, words.end()}, how);
    const std::string mesh = tool_test::readFile(directory.file("mesh.obj"));
    EXPECT_TRUE(mesh == "kept" || mesh == whole) << mesh.size() << " bytes";
  }
}

}  // namespace
