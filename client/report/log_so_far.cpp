#include "client/report/log_so_far.h"

namespace mortise {
namespace {

// A kept log has a kilobyte or two for each: 100 MB.
constexpr std::size_t kMostKeptTicks = 50'000;

}  // namespace

Result<std::string> LogSoFar::answer(std::uint64_t until_tick, const Answer& make) {
  const bool has_it = log_ && !log_->ticks.empty() && log_->ticks.back().tick >= until_tick;
  if (!has_it && !(log_ && log_->complete)) {
    auto read = read_();
    if (!read) return read.error();
    log_ = std::move(*read);
  }
  Result<std::string> made = make(*log_);
  if (log_->ticks.size() > kMostKeptTicks) log_.reset();
  return made;
}

}  // namespace mortise
