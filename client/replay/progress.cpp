#include "client/replay/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace mortise {
namespace {

// Often enough to be seen to move, and too seldom to cost anything.
constexpr auto kEvery = std::chrono::milliseconds(200);

}  // namespace

Progress::Progress(std::string what, double all)
    : what_(std::move(what)), all_(all), on_(isatty(STDERR_FILENO) != 0) {}

void Progress::show(double done) {
  if (!on_) return;
  const auto now = std::chrono::steady_clock::now();
  if (shown_ && now - last_ < kEvery) return;
  last_ = now;
  shown_ = true;
  if (all_ > 0.0)
    std::fprintf(stderr, "\r\033[K%s: %.0f %%", what_.c_str(), 100.0 * done / all_);
  else
    std::fprintf(stderr, "\r\033[K%s: %.1f", what_.c_str(), done);
  std::fflush(stderr);
}

void Progress::end() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
  shown_ = false;
}

}  // namespace mortise
