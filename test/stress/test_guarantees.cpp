// What holds when something fails: lack of memory comes out as std::bad_alloc, a killed tool leaves
// no half-written file, a full device is reported in two lines.

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
#include <string>

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

void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace {

using namespace spherical_param;

TEST(Guarantees, BadAllocIsPassedOnFromEveryAllocation) {
  const Positions points = test::spiralSphere(5000);  // enough for several threads
  Options options;
  options.retries = 0;
  options.threads = 2;
  constexpr long many = 1L << 40;
  left = many;
  const Triangles expected = reconstruct(points, options).triangles;
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
  EXPECT_EQ(reconstruct(points, options).triangles, expected);
}

void writeScan(const tool_test::TemporaryDirectory& directory, Index points) {
  const Positions sphere = test::spiralSphere(points);
  std::string text;
  for (Eigen::Index i = 0; i < sphere.cols(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      text += std::to_string(sphere(axis, i)) + (axis < 2 ? " " : "\n");
  tool_test::writeFile(directory.file("scan.xyz"), text);
}

TEST(Guarantees, AKilledToolLeavesNoHalfWrittenFile) {
  const tool_test::TemporaryDirectory directory;
  writeScan(directory, 5000);
  tool_test::RunOptions how;
  how.directory = directory.path();
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(tool_test::run(RECONSTRUCTION_TOOL, {"scan.xyz", "whole.obj"}, how).exit_code, 0);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  const std::string whole = tool_test::readFile(directory.file("whole.obj"));
  std::mt19937_64 random(1);
  for (int i = 0; i < 12; ++i) {
    tool_test::writeFile(directory.file("mesh.obj"), "kept");
    if (i % 3 == 0) {  // while the file is written
      how.signal_when_temporary = SIGKILL;
      tool_test::run(RECONSTRUCTION_TOOL, {"scan.xyz", "mesh.obj"}, how);
    } else {
      how.signal_when_temporary = 0;
      const double seconds = time.count() * static_cast<double>(1 + random() % 110) / 100.0;
      tool_test::run(
          "/usr/bin/timeout",
          {"-s", "KILL", std::to_string(seconds), RECONSTRUCTION_TOOL, "scan.xyz", "mesh.obj"},
          how);
    }
    const std::string mesh = tool_test::readFile(directory.file("mesh.obj"));
    EXPECT_TRUE(mesh == "kept" || mesh == whole) << mesh.size() << " bytes";
  }
}

TEST(Guarantees, AFullDeviceIsReportedWithCauseAndRemedy) {
  const tool_test::TemporaryDirectory directory;
  writeScan(directory, 500);
  tool_test::RunOptions how;
  how.directory = directory.path();
  how.standard_output = "/dev/full";
  const auto result =
      tool_test::run(RECONSTRUCTION_TOOL, {"scan.xyz", "mesh.ply", "-json", "-"}, how);
  EXPECT_EQ(result.exit_code, 1);
  ASSERT_EQ(result.errorLines().size(), 2U) << result.errors;
  EXPECT_NE(result.errorLines()[1].find("remedy: "), std::string::npos);
}

}  // namespace
