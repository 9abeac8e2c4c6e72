#include "server/held_channel.h"

#include <algorithm>
#include <utility>

namespace mortise {
namespace {

// One turn counts for no longer: in the rest of it this process may not have run.
constexpr double kTurn_s = 0.005;
constexpr std::int64_t kLook_ns = 2'000'000;
constexpr std::uint64_t kNear_ticks = 60;
// Users who do nothing say so each 0.2 s.
constexpr double kLately_s = 0.3;
static_assert(kLately_s < HeldChannel::kPatience_s);

template <class Entry>
std::vector<Entry> copy_of(std::span<const Entry> entries) {
  return {entries.begin(), entries.end()};
}

}  // namespace

void HeldChannel::await(const std::vector<SeatRecord>& seats) {
  for (const SeatRecord& seat : seats) awaited_.emplace(seat.client, seat.nonce);
  awaited_enough_ = awaited_.size() / 2;
  waited_s_ = 0.0;
}

ServerInput HeldChannel::heard() {
  ServerInput input = inner_.take();
  if (const auto& told = input.superseding) {
    FollowedTick tick;
    input.superseded = decode(told->bytes, tick) && tick.tick == told->tick;
  }
  return input;
}

ServerInput HeldChannel::take() {
  ServerInput input = heard();
  note_heard(input);
  if (!input.superseded) let_go();
  return input;
}

void HeldChannel::note_heard(const ServerInput& input) {
  for (const ReceivedIncrement& received : input.increments) note_heard(received.increment.user);
  for (const ReceivedCommand& received : input.commands) note_heard(received.command.user);
  for (const UserId user : input.heartbeats) note_heard(user);
  for (const JoinRequest& join : input.joins) awaited_.erase({join.client, join.nonce});
  if (awaited_.size() <= awaited_enough_) awaited_.clear();
}

bool HeldChannel::rest(std::int64_t at_most_ns) {
  if (kept_.empty() || at_most_ns <= 0) return false;
  inner_.await_taken(std::min(at_most_ns, kLook_ns));
  let_go();
  return !kept_.empty();
}

void HeldChannel::let_go() {
  const TakenTicks taken = inner_.taken_up_to();
  if (taken.received == kTakenAll) {
    waited_for_ = false;
    backlog_.forget();
    if (fencing_) fencing_->ask({});
  } else if (taken.received != 0) {
    // Only one that is near is waited for: it may have the ticks of seconds to take first.
    waited_for_ = waited_for_ || taken.received + kNear_ticks >= tick_;
    follower_ = taken.by;
    if (fencing_ && waited_for_ && taken.received >= said_) fencing_->ask(follower_);
    if (waited_for_) to_lead_anew_ = false;
    note_backlog(taken);
    say_up_to(taken.received, follower_);
  }
  if (taken.received == kTakenAll || (fencing_ && !waited_for_)) say_alone();
  const std::int64_t now_ns = clock_.now_ns();
  const double turn_s = std::min(static_cast<double>(now_ns - turned_ns_) * 1e-9, kTurn_s);
  turned_ns_ = now_ns;
  if (!kept_.empty()) wait_on(turn_s);
}

void HeldChannel::note_backlog(const TakenTicks& taken) {
  const std::uint64_t ticks = taken.received - std::min(taken.received, taken.computed);
  const Backlog::News news = backlog_.now_is(ticks);
  if (news == Backlog::News::kBehind) {
    notes_.push_back("the server that stands by has " + std::to_string(ticks) +
                     " ticks that it has not computed yet: if this one were gone, users would wait "
                     "for that");
  } else if (news == Backlog::News::kInStepAgain) {
    notes_.push_back("the server that stands by is in step again");
  }
}

void HeldChannel::wait_on(double turn_s) {
  waited_s_ += turn_s;
  if (!awaited_.empty()) {
    if (waited_s_ < kPatienceCutOff_s) return;
    awaited_.clear();
    notes_.push_back(
        "fewer than half of the users have come: they may be with the server of "
        "before, and what is done here may be lost when that one is met again");
  }
  if (!waited_for_) return say_alone();
  if (waited_s_ < kPatience_s) return;
  // Whoever else might lead, it does not while the etcd of the site says so.
  const bool heard_by_most = fencing_ || most_users_are_heard();
  if (heard_by_most || waited_s_ >= kPatienceCutOff_s) go_alone(heard_by_most);
}

void HeldChannel::note_heard(UserId user) {
  Heard& heard = heard_[user];
  heard.steady = heard.steady && waited_s_ - heard.at_s < kLately_s;
  heard.at_s = waited_s_;
}

bool HeldChannel::most_users_are_heard() const {
  // All along: who is heard again may be with another server since.
  const auto steadily = [&](const auto& entry) {
    return entry.second.steady && waited_s_ - entry.second.at_s < kLately_s;
  };
  const auto heard = std::count_if(heard_.begin(), heard_.end(), steadily);
  return static_cast<std::size_t>(heard) * 2 > users_then_;
}

void HeldChannel::go_alone(bool heard_by_most) {
  waited_for_ = false;
  backlog_.forget();
  // Whoever took over meanwhile, and has most of the users against it, is not to lead when it is
  // met again.
  to_lead_anew_ = heard_by_most;
  if (fencing_) fencing_->ask({});
  notes_.push_back(heard_by_most
                       ? "the server that stands by is silent: it is not waited for any more"
                       : "neither the server that stands by nor most users are heard: going on "
                         "without them; what is done here may be lost when they are met again");
  say_alone();
}

void HeldChannel::say_alone() {
  if (!may_say({})) return;
  if (std::exchange(to_lead_anew_, false)) inner_.lead_anew();
  say_up_to(kTakenAll, {});
}

void HeldChannel::say_up_to(std::uint64_t tick, const ClientKey& has_it) {
  if (!awaited_.empty() || !may_say(has_it)) return;
  for (; !kept_.empty() && kept_.front().tick <= tick; kept_.pop_front()) {
    said_ = kept_.front().tick;
    kept_.front().say();
    waited_s_ = 0.0;
    heard_.clear();
    users_then_ = users_();
  }
}

void HeldChannel::say(std::function<void()> what) {
  if (!keeps() && may_say({})) {
    said_ = tick_;
    return what();
  }
  if (kept_.empty()) {
    waited_s_ = 0.0;
    heard_.clear();
    users_then_ = users_();
  }
  kept_.push_back({tick_, std::move(what)});
}

bool HeldChannel::hand_over(const std::function<bool()>& goes_on) {
  const std::int64_t begun_ns = clock_.now_ns();
  while (static_cast<double>(clock_.now_ns() - begun_ns) * 1e-9 < kHandOver_s) {
    // Not given up as let_go() does: who raises its term now would lead against the other.
    const std::uint64_t taken = inner_.taken_up_to().received;
    if (taken != kTakenAll) say_up_to(taken, follower_);
    if (heard().superseded) {
      say_up_to(kTakenAll, follower_);
      return true;
    }
    if (!inner_.has_follower() || !goes_on()) break;
    inner_.note_progress(0.0);
    inner_.await_taken(kLook_ns);
  }
  kept_.clear();
  return false;
}

void HeldChannel::finish() {
  for (int turn = 0; turn < 100 && rest(kLook_ns); ++turn) {
  }
  awaited_.clear();
  say_alone();
}

void HeldChannel::publish_tick(const ToldTick& told) {
  tick_ = told.tick;
  inner_.publish_tick(told);
}
void HeldChannel::publish_join_reply(const JoinReply& reply) {
  say([this, reply] { inner_.publish_join_reply(reply); });
}
void HeldChannel::publish_replies(std::span<const Reply> replies) {
  say([this, all = copy_of(replies)] { inner_.publish_replies(all); });
}
void HeldChannel::publish_decisions(std::span<const Decision> decisions) {
  say([this, all = copy_of(decisions)] { inner_.publish_decisions(all); });
}
void HeldChannel::publish_standing(std::span<const StandingChange> changes) {
  say([this, all = copy_of(changes)] { inner_.publish_standing(all); });
}
void HeldChannel::publish_refusals(std::span<const RefusedIncrement> refused) {
  say([this, all = copy_of(refused)] { inner_.publish_refusals(all); });
}
void HeldChannel::publish_poses(const PoseBatch& batch) {
  say([this, batch] { inner_.publish_poses(batch); });
}
void HeldChannel::publish_events(std::span<const ClashEvent> events) {
  say([this, all = copy_of(events)] { inner_.publish_events(all); });
}
void HeldChannel::publish_snapshot(Snapshot snapshot) {
  say([this, kept = std::move(snapshot)]() mutable { inner_.publish_snapshot(std::move(kept)); });
}
void HeldChannel::publish_mesh(const std::string& hash, std::span<const std::byte> bytes) {
  say([this, hash, all = copy_of(bytes)] { inner_.publish_mesh(hash, all); });
}
void HeldChannel::publish_features(const FeatureTable& table) {
  say([this, table] { inner_.publish_features(table); });
}
void HeldChannel::publish_pulse(const SessionPulse& pulse) {
  say([this, pulse] { inner_.publish_pulse(pulse); });
}

}  // namespace mortise
