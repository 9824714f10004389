// A lack of memory comes out as std::bad_alloc. Full disks and killed tools are in test/tools.

#include "helpers.h"
#include "spherical_param/reconstruct.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

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

TEST(LackOfMemory, BadAllocIsPassedOnFromEveryAllocation) {
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

}  // namespace
