#pragma once
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace mortise::bvh {

/// Calls body(i) for every i below count, on up to `threads` threads. body(i) may only write data
/// of i.
template <class Body>
void for_each(std::size_t count, int threads, const Body& body) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) body(i);
  };
  std::vector<std::jthread> others;
  for (int k = 1; k < threads && static_cast<std::size_t>(k) < count; ++k)
    others.emplace_back(work);
  work();
}

}  // namespace mortise::bvh
