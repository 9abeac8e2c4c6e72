#include "client/replay/play.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>

#include "common/io/scenario/scenario_file.h"
#include "common/math/rotation.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr double kFastest = 100.0;            // what lies before the piece that is asked for
constexpr double kLeastPeriod_s = 1.0 / 120;  // between two increments of one user for one part
// A reply takes a tick and a round trip. After this the play goes on without it.
constexpr double kReplyWait_s = 1.0;
// Three ticks of 60 Hz. Who is later goes on from now instead of catching up in a burst.
constexpr double kMostLate_s = 0.05;
// As many as a person reads.
constexpr std::size_t kMostNotes = 10;

// The command that a user gave, where the decision came from one.
std::optional<CommandKind> command_of(Decision::Kind kind) {
  switch (kind) {
    case Decision::Kind::kGrab:
      return CommandKind::kGrab;
    case Decision::Kind::kRelease:
      return CommandKind::kRelease;
    case Decision::Kind::kUndo:
      return CommandKind::kUndo;
    case Decision::Kind::kReset:
      return CommandKind::kReset;
    case Decision::Kind::kRedo:
      return CommandKind::kRedo;
    case Decision::Kind::kAskHandOver:
      return CommandKind::kAskHandOver;
    case Decision::Kind::kHandOver:
      return CommandKind::kConsent;
    case Decision::Kind::kDecline:
      return CommandKind::kDecline;
    case Decision::Kind::kAskEnd:
      return CommandKind::kWithdraw;
    case Decision::Kind::kSetPolicy:
      return CommandKind::kSetPolicy;
    case Decision::Kind::kSetTolerance:
      return CommandKind::kSetTolerance;
    case Decision::Kind::kSetExclusion:
      return CommandKind::kSetExclusion;
    case Decision::Kind::kDropExclusion:
      return CommandKind::kDropExclusion;
    case Decision::Kind::kReview:
      return CommandKind::kReview;
    case Decision::Kind::kAddConstraint:
      return CommandKind::kAddConstraint;
    case Decision::Kind::kDropConstraint:
      return CommandKind::kDropConstraint;
    case Decision::Kind::kAddPart:
      return CommandKind::kAddPart;
    case Decision::Kind::kReplacePart:
      return CommandKind::kReplacePart;
    case Decision::Kind::kRemovePart:
      return CommandKind::kRemovePart;
    case Decision::Kind::kSetMoving:
      return CommandKind::kSetMoving;
    default:
      return std::nullopt;
  }
}

// Increments of one user for one part that were not sent yet, composed.
struct Pending {
  Vec3 translation_mm = Vec3::Zero();
  Quat turn = Quat::Identity();
  SteadyClock::time_point last;  // when one was sent
  bool any = false;
};

class Player {
 public:
  Player(const SessionLog& log, const Scenario& scenario, Client& client,
         const PlayOptions& options)
      : log_(log), scenario_(scenario), client_(client), options_(options) {}

  Result<PlayOutcome> run(const std::function<void(double)>& progress) {
    if (!until([&] { return client_.synced(); }, options_.wait_s))
      return fail(Code::kRuntime, "no session answers within " +
                                      std::to_string(options_.wait_s).substr(0, 4) + " s");
    if (const Status same = check_parts(); !same) return same.error();
    const auto began = SteadyClock::now();
    due_ = began;
    std::uint64_t before = log_.ticks.empty() ? 0 : log_.ticks.front().tick;
    const std::uint64_t first = before;
    for (const TickRecord& record : log_.ticks) {
      const double at_s = static_cast<double>(record.tick - first) / scenario_.tick_rate_hz;
      if (at_s > options_.to_s) break;
      const double speed = at_s < options_.from_s ? kFastest : options_.speed;
      wait_for(static_cast<double>(record.tick - before) / scenario_.tick_rate_hz / speed);
      before = record.tick;
      take(record, speed);
      if (progress) progress(at_s);
    }
    send_all();
    until([] { return false; }, 0.1);  // for the last answers
    for (const auto& [id, user] : users_) client_.leave(user);
    until([] { return false; }, 0.2);
    outcome_.took_s = seconds(SteadyClock::now() - began);
    return std::move(outcome_);
  }

 private:
  static double seconds(SteadyClock::duration d) {
    return std::chrono::duration<double>(d).count();
  }

  Status check_parts() const {
    const auto& parts = client_.parts();
    if (parts.size() != scenario_.parts.size())
      return fail(Code::kInvalidInput, "the session has " + std::to_string(parts.size()) +
                                           " parts, the log " +
                                           std::to_string(scenario_.parts.size()));
    for (std::size_t i = 0; i < scenario_.parts.size(); ++i) {
      const PartId id{static_cast<std::uint32_t>(i + 1)};
      const auto found = parts.find(id);
      const std::string there = found == parts.end() ? "nothing" : found->second.info.name;
      if (there != scenario_.parts[i].name)
        return fail(Code::kInvalidInput, "part " + std::to_string(id.value) + " is " + there +
                                             " in the session, " + scenario_.parts[i].name +
                                             " in the log");
    }
    return ok();
  }

  void listen() {
    const ClientUpdate update = client_.poll();
    outcome_.events += update.events.size();
    outcome_.increments_refused += update.refused.size();
    for (const RefusedIncrement& refused : update.refused)
      note("an increment was refused: " + std::string(name_of(refused.reason)));
    for (const Reply& reply : update.replies) {
      awaited_.erase({reply.user.value, reply.seq});
      if (reply.refusal == Refusal::kNone) continue;
      ++outcome_.commands_refused;
      note("a command was refused: " + std::string(name_of(reply.refusal)) +
           (reply.text.empty() ? "" : ", " + reply.text));
    }
  }

  void note(const std::string& what) {
    const auto& notes = outcome_.notes;
    if (notes.size() < kMostNotes && std::find(notes.begin(), notes.end(), what) == notes.end())
      outcome_.notes.push_back(what);
  }

  template <class Done>
  bool until(const Done& done, double limit_s) {
    const auto end = SteadyClock::now() + in(limit_s);
    for (;;) {
      listen();
      if (done()) return true;
      const double left_s = seconds(end - SteadyClock::now());
      if (left_s <= 0.0) return false;
      client_.await_news(left_s);
    }
  }
  static SteadyClock::duration in(double s) {
    return std::chrono::duration_cast<SteadyClock::duration>(std::chrono::duration<double>(s));
  }

  // What waiting for answers took is not made up for: increments that come in a heap are composed
  // to other paths than those of the log.
  void wait_for(double s) {
    due_ += in(s);
    if (const double late_s = seconds(SteadyClock::now() - due_); late_s > kMostLate_s) {
      outcome_.waited_s += late_s;
      due_ += in(late_s);
    }
    while (SteadyClock::now() < due_) {
      listen();
      send_due();
      const double left_s = seconds(due_ - SteadyClock::now());
      if (left_s > 0.0) client_.await_news(left_s);
    }
  }

  void take(const TickRecord& record, double speed) {
    ++outcome_.ticks;
    for (const Decision& decision : record.decisions) take(decision);
    for (const Increment& increment : record.increments) {
      const auto& refused = record.report.refused;
      if (std::any_of(refused.begin(), refused.end(), [&](const RefusedIncrement& r) {
            return r.user == increment.user && r.seq == increment.seq;
          }))
        continue;  // it did nothing then
      ++outcome_.increments;
      add(increment);
      if (speed <= 1.0) send(increment.user, increment.part);
    }
    send_due();
  }

  void take(const Decision& decision) {
    if (decision.kind == Decision::Kind::kJoin) return join(decision);
    const auto user = users_.find(decision.user);
    const auto command = command_of(decision.kind);
    if (decision.kind == Decision::Kind::kLeave ||
        decision.kind == Decision::Kind::kLivelinessLost) {
      send_all();
      if (user != users_.end()) client_.leave(user->second), users_.erase(user);
      return;
    }
    if (!command || user == users_.end()) {
      ++outcome_.not_playable;
      return;
    }
    send_all();  // what was done before the command
    ++outcome_.commands;
    const std::uint64_t seq =
        client_.command(user->second, *command, decision.part, decision.details);
    const std::pair key(client_.user_id(user->second).value, seq);
    awaited_.insert(key);
    // A grab has to hold before the part can be moved.
    until([&] { return !awaited_.contains(key); }, kReplyWait_s);
  }

  void join(const Decision& decision) {
    // Logs of format 1 know no roles.
    const Role role = decision.role == Role::kUnknown ? Role::kDesigner : decision.role;
    const LocalUser user = client_.add_user(decision.user_name, std::string(name_of(role)));
    users_[decision.user] = user;
    until([&] { return client_.join_state(user) != JoinState::kJoining; }, options_.wait_s);
    if (client_.join_state(user) == JoinState::kJoined) return;
    ++outcome_.users_not_let_in;
    note(decision.user_name + " was not let in" +
         (client_.refusal_text(user).empty() ? std::string() : ": " + client_.refusal_text(user)));
  }

  void add(const Increment& increment) {
    Pending& pending = pending_[{increment.user, increment.part}];
    const Quat turn = (rotation_exp(increment.rotation_rad) * pending.turn).normalized();
    const Vec3 shift = pending.translation_mm + increment.translation_mm;
    // Not beyond what one increment may be.
    if (pending.any &&
        (shift.norm() > 0.9 * scenario_.max_jump_mm || rotation_log(turn).norm() > 3.0)) {
      send(increment.user, increment.part);
      pending.translation_mm = increment.translation_mm;
      pending.turn = rotation_exp(increment.rotation_rad);
    } else {
      pending.translation_mm = shift;
      pending.turn = turn;
    }
    pending.any = true;
  }

  void send(UserId user, PartId part) {
    Pending& pending = pending_[{user, part}];
    const auto local = users_.find(user);
    if (!pending.any) return;
    if (local != users_.end()) {
      client_.send(local->second, part, pending.translation_mm, rotation_log(pending.turn));
      ++outcome_.increments_sent;
    }
    pending = {};
    pending.last = SteadyClock::now();
  }

  void send_due() {
    const auto now = SteadyClock::now();
    for (const auto& [key, pending] : pending_)
      if (pending.any && now - pending.last >= in(kLeastPeriod_s)) send(key.first, key.second);
  }
  void send_all() {
    for (const auto& [key, pending] : pending_)
      if (pending.any) send(key.first, key.second);
  }

  const SessionLog& log_;
  const Scenario& scenario_;
  Client& client_;
  PlayOptions options_;
  PlayOutcome outcome_;
  SteadyClock::time_point due_;
  std::map<UserId, LocalUser> users_;  // by their ids in the log
  std::map<std::pair<UserId, PartId>, Pending> pending_;
  std::set<std::pair<std::uint32_t, std::uint64_t>> awaited_;
};

}  // namespace

Result<PlayOutcome> play_log(const SessionLog& log, Client& client, const PlayOptions& options,
                             const std::function<void(double)>& progress) {
  const auto reading = scenario_of(log);
  if (!reading) return reading.error();
  return Player(log, reading->scenario, client, options).run(progress);
}

}  // namespace mortise
