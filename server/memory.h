#pragma once

namespace mortise {

/// Makes blocks of 64 kB and more (a large search, a checkpoint) return to the system when they are
/// freed, so that they leave no holes in the heap and a long session does not keep its peak memory.
/// Call it before any such block was freed. Up to 2 MB at the top of the heap are kept for ticks to
/// reuse. Settings of glibc (mallopt(3)); no effect elsewhere.
void give_back_large_memory();

}  // namespace mortise
