#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>

namespace mortise::test {

/// The wall clock of this process, and of those that it starts while one of these lives: as the
/// machine's, but for steps. The monotonic clock stays as it is, and waits until a time of the wall
/// clock end when they would have.
class WallClock {
 public:
  explicit WallClock(const std::filesystem::path& folder);  ///< for a file that all share
  ~WallClock();
  WallClock(const WallClock&) = delete;
  WallClock& operator=(const WallClock&) = delete;
  void step(std::int64_t seconds);  ///< at once, in all of them

 private:
  std::atomic<std::int64_t>* ahead_s_ = nullptr;
};

}  // namespace mortise::test
