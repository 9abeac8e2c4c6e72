#include "server/tick_loop.h"

#include <algorithm>
#include <utility>

namespace mortise {
namespace {

std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

/// a - b, also when a sender's clock says nonsense and the difference does not fit.
std::int64_t difference_ns(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

/// No datagram is so late; a clock that was set is.
constexpr double kClockJump_s = 10.0;

// Seats are told when they change; again now and then, for one that follows from a later tick on.
constexpr std::uint64_t kSeatsEvery_ticks = 60;

}  // namespace

TickLoop::TickLoop(World& world, ServerChannel& channel, Clock& clock, SessionLogWriter* log,
                   const TickLoopOptions& options)
    : world_(world),
      channel_(channel),
      clock_(clock),
      log_(log),
      options_(options),
      inbox_(options.inbox),
      scratch_(options.threads),
      recorder_(world, log, options.checkpoints),
      publisher_(world, channel, clock, options) {
  statistics_.keep_ended_rows(SessionStatistics::kMostEndedRows);
  inbox_.uploads().publish_with(
      [&channel](const std::string& hash, std::span<const std::byte> mesh) {
        channel.publish_coming_mesh(hash, mesh);
      },
      options.threads);
}

void TickLoop::resume(SessionStatistics statistics, std::vector<Decision> departures) {
  statistics_ = std::move(statistics);
  statistics_.keep_ended_rows(SessionStatistics::kMostEndedRows);
  departures_ = std::move(departures);
}

void TickLoop::adopt(SessionStatistics statistics, const std::vector<SeatRecord>& seats) {
  resume(std::move(statistics), {});
  inbox_.adopt(seats, clock_.now_ns());
}

void TickLoop::open() {
  now_ns_ = opened_ns_ = pulse_ns_ = clock_.now_ns();
  recorder_.open(now_ns_);
  publisher_.open(now_ns_);
}

void TickLoop::tick() {
  hand_over_record();
  now_ns_ = clock_.now_ns();

  // 0. drain and decide
  ServerInput input = channel_.take();
  if (!input.snapshot_requests.empty()) publisher_.want_snapshot();
  inbox_.uploads().note_follower(channel_.has_follower(), input.follower_came);
  inbox_.admit(std::move(input), world_, now_ns_, intake_);
  inbox_.uploads().settle(world_, intake_);
  if (!departures_.empty()) {
    intake_.decisions.insert(intake_.decisions.begin(), departures_.begin(), departures_.end());
    departures_.clear();
  }
  measure_delay();

  // 1-6. the engine
  const std::int64_t step_start_ns = clock_.now_ns();
  report_ = step(world_, intake_.increments, scratch_);
  const std::int64_t step_ns = clock_.now_ns() - step_start_ns;
  metrics_.step.add(step_ns);
  statistics_.forget_users(intake_.decisions);
  statistics_.add(report_);
  note_unexamined();

  // 7. out
  begin_record(step_ns);
  if (intake_.superseded && !superseded_) superseded_by_ = intake_.superseded_by;
  superseded_ = superseded_ || intake_.superseded;
  if (channel_.has_follower()) tell_follower();
  publisher_.publish(intake_, report_, now_ns_);
  if (last_ || now_ns_ - pulse_ns_ >= in_ns(options_.pulse_s)) {
    pulse_ns_ = now_ns_;
    if (publisher_.has_readers()) channel_.publish_pulse(pulse());
    unexamined_.clear();
  }
  ++metrics_.ticks;
  metrics_.tick.add(clock_.now_ns() - now_ns_);
}

void TickLoop::begin_record(std::int64_t step_ns) {
  if (log_ == nullptr) return;
  recorder_.begin({.tick = report_.tick,
                   .wall_ns = clock_.wall_ns(),
                   .now_ns = now_ns_,
                   .step_ns = step_ns,
                   .changed = !intake_.decisions.empty() || !intake_.increments.empty(),
                   .last = last_});
}

void TickLoop::tell_follower() {
  const auto changes_seats = [](const Decision& d) {
    return d.kind == Decision::Kind::kJoin || d.kind == Decision::Kind::kLeave ||
           d.kind == Decision::Kind::kLivelinessLost;
  };
  FollowedTick followed;
  followed.tick = report_.tick;
  followed.state_hash = report_.state_hash;
  followed.time_ns = clock_.wall_ns();
  followed.decisions = intake_.decisions;
  followed.increments = intake_.increments;
  followed.mesh = inbox_.uploads().next_piece();
  followed.hands_over = hands_over_;
  followed.logged_tick = log_ != nullptr ? log_->flushed_tick() : report_.tick;
  followed.has_seats =
      hands_over_ || intake_.follower_came || report_.tick % kSeatsEvery_ticks == 0 ||
      std::any_of(intake_.decisions.begin(), intake_.decisions.end(), changes_seats);
  if (followed.has_seats) followed.seats = inbox_.seats();
  channel_.publish_tick({report_.tick, encode(followed)});
}

void TickLoop::measure_delay() {
  for (const Ack& ack : intake_.acks) {
    if (ack.sent_ns == 0) continue;
    const std::int64_t took_ns = difference_ns(now_ns_, ack.sent_ns);
    const auto [fastest, is_first] = fastest_ns_.emplace(ack.user, took_ns);
    const std::int64_t later_ns = difference_ns(took_ns, fastest->second);
    // The sender's clock was set: what was fastest before means nothing any more.
    const bool clock_was_set = later_ns > in_ns(kClockJump_s) || later_ns < -in_ns(kClockJump_s);
    if (clock_was_set || later_ns < 0) fastest->second = took_ns;
    if (!is_first && !clock_was_set) metrics_.delay.add(std::max<std::int64_t>(later_ns, 0));
  }
  for (const Decision& decision : intake_.decisions) {
    if (decision.kind == Decision::Kind::kJoin) fastest_ns_.erase(decision.user);  // another clock
  }
}

// A part that has moved on with a verdict takes what was told of its pairs before.
void TickLoop::note_unexamined() {
  const auto has_moved = [&](PartId part) {
    return std::ranges::any_of(report_.moved, [&](auto& moved) { return moved.part == part; });
  };
  std::erase_if(unexamined_, [&](const auto& entry) {
    return has_moved(entry.first.first) || has_moved(entry.first.second);
  });
  for (const UnexaminedPair& pair : report_.unexamined) {
    UnexaminedRow& row = unexamined_[{pair.a, pair.b}];
    row = {pair.a, pair.b, pair.why, row.ticks + 1};
  }
}

void TickLoop::run(const std::function<bool()>& stop, const std::function<void()>& after_tick) {
  const std::int64_t period_ns = in_ns(1.0 / world_.tick_rate_hz);
  std::int64_t deadline_ns = clock_.now_ns();
  while (!stop()) {
    while (channel_.rest(deadline_ns - clock_.now_ns())) {
    }
    clock_.sleep_until_ns(deadline_ns);
    const std::int64_t start_ns = clock_.now_ns();
    if (start_ns < deadline_ns) continue;  // woken by a signal
    metrics_.lateness.add(start_ns - deadline_ns);
    channel_.note_progress(0.0);
    tick();
    if (after_tick) after_tick();
    hand_over_record();
    deadline_ns += period_ns;
    const std::int64_t behind_ns = clock_.now_ns() - deadline_ns;
    if (behind_ns > 0) {
      ++metrics_.overloads;
      const std::int64_t passed_over = behind_ns / period_ns;
      metrics_.missed_deadlines += static_cast<std::uint64_t>(passed_over);
      deadline_ns += passed_over * period_ns;
    }
    channel_.note_progress(static_cast<double>(deadline_ns - clock_.now_ns()) * 1e-9);
  }
}

void TickLoop::begin_drain() {
  draining_ = true;
  inbox_.put_off_newcomers();
  pulse_ns_ -= in_ns(options_.pulse_s);  // with the next tick
}

void TickLoop::last_tick(bool hands_over) {
  last_ = true;
  hands_over_ = hands_over;
  tick();
  hand_over_record();
}

void TickLoop::close() {
  hand_over_record();
  now_ns_ = clock_.now_ns();
  publisher_.publish_snapshot(now_ns_);
  draining_ = true;
  if (publisher_.has_readers()) channel_.publish_pulse(pulse());
}

SessionPulse TickLoop::pulse() const {
  SessionPulse pulse;
  pulse.tick = report_.tick;
  for (int c = 1; c < 4; ++c) {
    pulse.clashes_open[c] = statistics_.clashes_open(static_cast<CollisionClass>(c));
    pulse.clashes_total[c] = statistics_.clashes_total(static_cast<CollisionClass>(c));
  }
  pulse.tick_p50_us = metrics_.tick.percentile_us(0.5);
  pulse.tick_p99_us = metrics_.tick.percentile_us(0.99);
  pulse.tick_max_us = metrics_.tick.max_us();
  pulse.lateness_p99_us = metrics_.lateness.percentile_us(0.99);
  pulse.missed_deadlines = metrics_.missed_deadlines;
  pulse.refused = inbox_.counters().refused_in_all();
  for (std::uint64_t count : statistics_.counters().refused) pulse.refused += count;
  pulse.not_examined = statistics_.counters().not_examined;
  pulse.users = inbox_.users_present();
  pulse.draining = draining_;
  for (const auto& [pair, row] : unexamined_)
    if (pulse.unexamined.size() < kMostUnexaminedRows) pulse.unexamined.push_back(row);
  pulse.unexamined_left_out = unexamined_.size() - pulse.unexamined.size();
  return pulse;
}

}  // namespace mortise
