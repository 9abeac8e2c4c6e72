#pragma once

namespace mortise {

/// Memory of 64 kB and more that the process needs for a moment (a large search, a checkpoint) goes
/// back to the system when it is freed, and leaves no holes among what stays: what a long session
/// holds does not grow with the largest moment it has had. To be called before any such block was
/// freed. What is free at the top of the heap, up to 2 MB, is kept for ticks to use again. Settings
/// of glibc (mallopt(3)); elsewhere they do nothing.
void give_back_large_memory();

}  // namespace mortise
