#include "client/client.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace mortise {
namespace {

std::int64_t steady_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// A snapshot and the decision that it holds already come within so long.
constexpr std::uint64_t kSameRemark_ticks = 120;

std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace

Client::Client(ClientChannel& channel, const ClientOptions& options, Clock clock)
    : channel_(channel), options_(options), clock_(std::move(clock)) {
  if (!clock_) clock_ = steady_now_ns;
  now_ns_ = clock_();
}

LocalUser Client::add_user(const std::string& name, const std::string& role) {
  return own_.add(name, role);
}

void Client::leave(LocalUser user) { own_.leave(user, now_ns_); }

std::uint64_t Client::send(LocalUser user, PartId part, const Vec3& translation_mm,
                           const Vec3& rotation_rad) {
  return own_.send(user, Increment{{}, part, 0, translation_mm, rotation_rad}, clock_());
}

std::uint64_t Client::send_command(LocalUser user, CommandKind kind, PartId part, Details details) {
  return own_.send(user, Command{{}, part, 0, kind, std::move(details)}, now_ns_);
}

std::uint64_t Client::upload(LocalUser user, const std::string& name, double unit_mm,
                             std::vector<std::byte> bytes) {
  if (own_.state(user) == JoinState::kJoined)
    return uploads_.begin(user, name, unit_mm, std::move(bytes));
  ++statistics_.not_joined;
  return 0;
}

ClientStatistics Client::statistics() const {
  ClientStatistics statistics = statistics_;
  own_.add_to(statistics);
  return statistics;
}

ClientUpdate Client::poll() {
  ClientUpdate update;
  ClientInput input = channel_.take();
  now_ns_ = clock_();
  update.at_ns = now_ns_;
  server_present_ = input.server_present;
  if (input.server_lost) {
    update.server_lost = true;
    forget_server();
  }
  for (const JoinReply& reply : input.join_replies) own_.take(reply, now_ns_, update);
  own_.tell_given_up(update);
  for (const Reply& reply : input.replies) {
    if (reply.part) parts_.set_holder(reply.part, reply.holder);
    if (own_.owns(reply.user)) update.replies.push_back(reply);
  }
  for (const RefusedIncrement& refused : input.refused) {
    if (own_.owns(refused.user)) update.refused.push_back(refused);
    own_.take(refused);
  }
  uploads_.take(input.uploads, update);
  // Snapshots after them: what they say is of the same tick or later.
  for (const Decision& decision : input.decisions) apply_decision(decision, update);
  for (const StandingChange& change : input.standing) update.standing |= standing_.take(change);
  // Events before snapshots: a snapshot that only repeats them must not hide them.
  events_.collect(input.events);
  events_.apply(update);
  for (const Snapshot& snapshot : input.snapshots) take_snapshot(snapshot, update);
  for (const PoseBatch& batch : input.poses) apply_poses(batch, update);
  if (input.poses_missed > 0) note_missed_poses(input.poses_missed);
  events_.apply(update);
  events_.watch_gap(now_ns_, update);
  statistics_.known_event_seq = events_.highest_announced();
  if (!input.pulses.empty()) update.pulse = input.pulses.back();
  update.meshes = std::move(input.meshes);
  update.features = !input.features.empty();
  if (update.features) features_.take(input.features.back());
  update.changed = parts_.take_changed();
  if (server_present_) {
    own_.send_what_is_due(now_ns_);
    uploads_.send_what_is_due();
    request_snapshot_when_due();
  }
  return update;
}

void Client::forget_server() {
  ++statistics_.server_losses;
  own_.forget_server();
  uploads_.forget_server();
  parts_.forget_server();
  features_.clear();
  standing_.expect_another_server();
  events_.forget_server();
  stale_tick_ = 0;
  poses_stale_since_ns_.reset();
  requested_at_ns_.reset();
}

UserInfo& Client::known_user(UserId id) {
  const auto found = std::find_if(session_users_.begin(), session_users_.end(),
                                  [id](const UserInfo& user) { return user.user == id; });
  if (found != session_users_.end()) return *found;
  session_users_.push_back({id, "", false, Role::kUnknown});
  return session_users_.back();
}

void Client::apply_decision(const Decision& decision, ClientUpdate& update) {
  switch (decision.kind) {
    case Decision::Kind::kJoin: {
      if (takes_over_id(decision)) events_.forget_user(decision.user);
      UserInfo& user = known_user(decision.user);
      user.present = true;
      user.role = decision.role;
      user.name = decision.user_name;
      own_.doubt(user);
      break;
    }
    case Decision::Kind::kLeave:
    case Decision::Kind::kLivelinessLost:
      known_user(decision.user).present = false;
      break;
    case Decision::Kind::kSetPolicy:
      policy_ = decision.details.text;
      break;
    case Decision::Kind::kReview:
      update.remarks |= add_remark(decision);
      break;
    default:
      update.scene |= parts_.apply_edit(decision);
      break;
  }
  update.decisions.push_back(decision);
}

// Snapshots and decisions come by ways of their own: what a snapshot has told is not added again.
bool Client::add_remark(const Decision& decision) {
  const Details& said = decision.details;
  Remark remark{said.clash, decision.user, said.other_user, said.status, statistics_.highest_tick,
                said.text};
  for (const Remark& known : remarks_) {
    Remark same = known;
    same.tick = remark.tick;
    if (same == remark && known.tick + kSameRemark_ticks >= remark.tick) return false;
  }
  remarks_.push_back(std::move(remark));
  return true;
}

void Client::take_snapshot(const Snapshot& snapshot, ClientUpdate& update) {
  requested_at_ns_.reset();  // answered
  session_ = snapshot.session;
  policy_ = snapshot.policy;
  tick_rate_hz_ = snapshot.tick_rate_hz;
  session_users_ = snapshot.users;
  notes_ = snapshot.notes;
  update.remarks |= remarks_ != snapshot.remarks;
  remarks_ = snapshot.remarks;
  update.standing |= standing_.take(snapshot);
  for (const UserInfo& info : snapshot.users) own_.doubt(info);
  update.scene |= parts_.take(snapshot);
  if (snapshot.tick >= stale_tick_) poses_stale_since_ns_.reset();
  statistics_.highest_tick = std::max(statistics_.highest_tick, snapshot.tick);
  events_.take(snapshot, update);
}

void Client::apply_poses(const PoseBatch& batch, ClientUpdate& update) {
  for (const PartPose& pose : batch.parts)
    if (!parts_.take(pose, batch.tick, !events_.has_snapshot())) ++statistics_.poses_stale;
  for (const Ack& ack : batch.acks) own_.take(ack, batch.tick, now_ns_, update);
  if (batch.keyframe && batch.tick >= stale_tick_) poses_stale_since_ns_.reset();
  events_.expect(batch.event_seq);
  statistics_.highest_tick = std::max(statistics_.highest_tick, batch.tick);
}

void Client::note_missed_poses(std::uint64_t missed) {
  statistics_.poses_missed += missed;
  stale_tick_ = statistics_.highest_tick;
  if (!poses_stale_since_ns_) poses_stale_since_ns_ = now_ns_;
}

void Client::request_snapshot_when_due() {
  const bool gap = !events_.synced() && events_.has_snapshot();
  const bool stale =
      poses_stale_since_ns_ && now_ns_ - *poses_stale_since_ns_ >= in_ns(options_.pose_resync_s);
  // A kept snapshot comes by itself soon after the server is found.
  if (!events_.has_snapshot() && !requested_at_ns_) requested_at_ns_ = now_ns_;
  if ((gap || stale || !events_.has_snapshot()) &&
      (!requested_at_ns_ || now_ns_ - *requested_at_ns_ >= in_ns(options_.resync_retry_s))) {
    requested_at_ns_ = now_ns_;
    channel_.request_snapshot();
    ++statistics_.snapshots_requested;
  }
}

}  // namespace mortise
