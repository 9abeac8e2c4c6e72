// What is freed goes back to the system. (Sanitizers bring an allocator of their own.)
#include "server/memory.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstddef>
#include <cstdlib>

namespace mortise {
namespace {

// More than lies free in the heap of this program, less than the 32 MB up to which glibc adapts.
constexpr std::size_t kLarge = 8 << 20;

/// Does a large block lie apart from the heap, where a larger one was freed before?
bool lies_apart() {
  void* volatile larger = std::malloc(2 * kLarge);
  std::free(larger);  // by itself glibc counts what is no larger as small from now on
  const std::size_t before = mallinfo2().hblkhd;
  void* volatile block = std::malloc(kLarge);
  const std::size_t apart = mallinfo2().hblkhd - before;
  std::free(block);
  return apart >= kLarge && mallinfo2().hblkhd == before;
}

// Each in a process of its own: the settings stay.
TEST(Memory, LargeBlocksGoBack) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizer: not the allocator of glibc";
#endif
  EXPECT_EXIT(std::exit(lies_apart() ? 1 : 0), ::testing::ExitedWithCode(0), "")
      << "glibc does so by itself: the settings are not needed any more";
  EXPECT_EXIT(
      {
        give_back_large_memory();
        std::exit(lies_apart() ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace mortise
