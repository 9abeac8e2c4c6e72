#include "server/memory.h"

#include <malloc.h>

namespace mortise {
namespace {

// By default glibc raises the first of these to the largest block that was ever freed, up to 32 MB.
constexpr int kLarge = 64 << 10;
constexpr int kMostAtTop = 2 << 20;

}  // namespace

void give_back_large_memory() {
#ifdef __GLIBC__
  (void)mallopt(M_MMAP_THRESHOLD, kLarge);
  (void)mallopt(M_TRIM_THRESHOLD, kMostAtTop);
#endif
}

}  // namespace mortise
