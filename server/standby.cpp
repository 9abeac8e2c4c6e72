#include "server/standby.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <string>
#include <thread>
#include <utility>

#include "server/silence.h"

namespace mortise {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kTurn = std::chrono::milliseconds(1);
// A log is flushed each second; the disk may take its time.
constexpr auto kLogIsWritten = std::chrono::milliseconds(2500);

void hear(StandbyChannel& channel, std::deque<ToldTick>& told) {
  for (ToldTick& tick : channel.follow()) told.push_back(std::move(tick));
}

double process_cpu_s() {
  timespec used{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// Tells a silence how the turns of this process went.
class Turns {
 public:
  void end(Silence& silence) {
    const Clock::time_point now = Clock::now();
    const double cpu_s = process_cpu_s();
    silence.turn(std::chrono::duration<double>(now - at_).count(), cpu_s - cpu_s_);
    at_ = now;
    cpu_s_ = cpu_s;
  }

 private:
  Clock::time_point at_ = Clock::now();
  double cpu_s_ = process_cpu_s();
};

void hear_and_confirm(StandbyChannel& channel, std::deque<ToldTick>& told, Silence& silence) {
  const std::size_t before = told.size();
  hear(channel, told);
  if (told.size() == before) return;
  silence.heard();
  channel.confirm(told.back().tick);
}

}  // namespace

Status Follower::take(const ToldTick& told) {
  FollowedTick tick;
  if (!decode(told.bytes, tick)) {
    return fail(Code::kMismatch, "tick " + std::to_string(told.tick) +
                                     " was told in words that this build does not know");
  }
  if (tick.has_seats) seats_ = std::move(tick.seats);
  time_ns_ = std::max(time_ns_, tick.time_ns);
  if (tick.tick <= world_.tick) return ok();
  // Between the log and what was told nothing went in, or it would be in one of them.
  if (ticks_ > 0 && tick.tick != world_.tick + 1) {
    return fail(Code::kRuntime, "ticks after " + std::to_string(world_.tick) + " and before " +
                                    std::to_string(tick.tick) +
                                    " were not told to this one: start it again");
  }
  while (world_.tick + 1 < tick.tick) {
    FollowedTick idle;
    idle.time_ns = tick.time_ns;
    step_once(idle);
  }
  step_once(tick);
  ++ticks_;
  handed_over_ = tick.hands_over;
  if (state_hash_ == tick.state_hash) return ok();
  return fail(Code::kMismatch, "at tick " + std::to_string(tick.tick) +
                                   " this engine computes something else than the one that leads");
}

void Follower::step_once(const FollowedTick& tick) {
  for (const Decision& decision : tick.decisions) apply_decision(world_, decision);
  TickRecord record;
  record.report = step(world_, tick.increments, scratch_);
  state_hash_ = record.report.state_hash;
  statistics_.forget_users(tick.decisions);
  statistics_.add(record.report);
  if (log_ == nullptr) return;
  record.tick = record.report.tick;
  record.time_ns = tick.time_ns;
  record.decisions = tick.decisions;
  record.increments = tick.increments;
  log_->record(std::move(record));
}

bool await_leader(StandbyChannel& channel, std::deque<ToldTick>& told,
                  const std::function<bool()>& stop) {
  std::optional<Clock::time_point> heard;
  while (!stop()) {
    hear(channel, told);
    if (!heard && !told.empty()) heard = Clock::now();
    if (heard && Clock::now() - *heard > kLogIsWritten) return true;
    std::this_thread::sleep_for(kTurn);
  }
  return false;
}

Result<bool> follow(StandbyChannel& channel, std::deque<ToldTick> told, Follower& follower,
                    const std::function<bool()>& stop) {
  Silence silence;
  Turns turns;
  if (!told.empty()) channel.confirm(told.back().tick);
  while (!stop()) {
    // Asked first: what it told before it was gone is here by then.
    const bool is_gone = !channel.leader_present();
    for (hear_and_confirm(channel, told, silence); !told.empty(); told.pop_front()) {
      if (Status taken = follower.take(told.front()); !taken) return taken.error();
      hear_and_confirm(channel, told, silence);
    }
    if (follower.handed_over() || (is_gone && silence.is_believed())) return true;
    turns.end(silence);
    std::this_thread::sleep_for(kTurn);
  }
  channel.confirm(kTakenAll);
  return false;
}

}  // namespace mortise
