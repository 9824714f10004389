#include "failing_allocation.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <malloc.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

// NOLINTBEGIN(bugprone-reserved-identifier): the names that the C library has for its own
// functions.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);
}
// NOLINTEND(bugprone-reserved-identifier)

namespace failing_allocation {
namespace {

struct State {
  bool active = false;
  bool looking = false;  ///< what finds the caller may allocate itself
  bool all_after = false;
  std::uint64_t first = 0;
  std::uint64_t counted = 0;
  std::uint64_t failed = 0;
  std::int64_t bytes = 0;
  Place place;
};

State state;

/// Whether the caller ends the program if it gets no memory, whatever anybody does.
bool isHopeless(const void* caller) {
  Dl_info info{};
  if (dladdr(caller, &info) == 0 || info.dli_fname == nullptr)
    return false;
  return std::strstr(info.dli_fname, "/ld-linux") != nullptr ||
         std::strstr(info.dli_fname, "/libgomp") != nullptr;
}

bool fails(const void* caller) {
  if (!state.active || state.looking)
    return false;
  ++state.counted;
  if (state.first == 0 || state.counted < state.first ||
      (state.counted > state.first && !state.all_after))
    return false;
  state.looking = true;
  bool hopeless = isHopeless(caller);
  // A search object of PCL's own queries FLANN in a parallel region, which no exception may leave.
  std::array<void*, 8> callers{};
  const int depth = backtrace(callers.data(), static_cast<int>(callers.size()));
  for (int i = 0; i < depth && !hopeless; ++i) {
    Dl_info info{};
    hopeless = dladdr(callers[static_cast<std::size_t>(i)], &info) != 0 &&
               info.dli_fname != nullptr &&
               std::strstr(info.dli_fname, "/libpcl_kdtree") != nullptr;
  }
  if (!hopeless && state.failed++ == 0)
    state.place.depth =
        backtrace(state.place.frames.data(), static_cast<int>(state.place.frames.size()));
  state.looking = false;
  return !hopeless;
}

void* noted(void* block) {
  if (block != nullptr)
    state.bytes += static_cast<std::int64_t>(malloc_usable_size(block));
  return block;
}

void* noMemory() {
  errno = ENOMEM;
  return nullptr;
}

}  // namespace

void begin(std::uint64_t first, bool all_after) {
  // Its first call allocates.
  std::array<void*, 1> frame{};
  backtrace(frame.data(), 1);
  state.first = first;
  state.all_after = all_after;
  state.counted = 0;
  state.failed = 0;
  state.place.depth = 0;
  state.active = true;
}

void end() {
  state.active = false;
}

std::uint64_t counted() {
  return state.counted;
}

std::uint64_t failed() {
  return state.failed;
}

std::int64_t bytesInUse() {
  return state.bytes;
}

const Place& firstFailure() {
  return state.place;
}

}  // namespace failing_allocation

using failing_allocation::fails;
using failing_allocation::noMemory;
using failing_allocation::noted;
using failing_allocation::state;

extern "C" {

void* malloc(std::size_t size) {
  return fails(__builtin_return_address(0)) ? noMemory() : noted(__libc_malloc(size));
}

void* calloc(std::size_t count, std::size_t size) {
  return fails(__builtin_return_address(0)) ? noMemory() : noted(__libc_calloc(count, size));
}

void* realloc(void* block, std::size_t size) {
  if (fails(__builtin_return_address(0)))
    return noMemory();
  const std::int64_t before =
      block == nullptr ? 0 : static_cast<std::int64_t>(malloc_usable_size(block));
  void* const moved = __libc_realloc(block, size);
  if (moved != nullptr || size == 0)
    state.bytes -= before;
  return noted(moved);
}

void* memalign(std::size_t alignment, std::size_t size) {
  return fails(__builtin_return_address(0)) ? noMemory() : noted(__libc_memalign(alignment, size));
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fails(__builtin_return_address(0)) ? noMemory() : noted(__libc_memalign(alignment, size));
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  void* const found =
      fails(__builtin_return_address(0)) ? nullptr : noted(__libc_memalign(alignment, size));
  if (found == nullptr)
    return ENOMEM;
  *block = found;
  return 0;
}

void free(void* block) {
  if (block != nullptr)
    state.bytes -= static_cast<std::int64_t>(malloc_usable_size(block));
  __libc_free(block);
}
}
