#include "client/client.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace mortise {
namespace {

/// Events beyond a gap that are kept; more are covered by the snapshot that the gap asks for.
constexpr std::size_t kMaxPendingEvents = 65536;

std::int64_t steady_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

Details of_group(std::vector<PartId> parts) {
  Details details;
  details.parts = std::move(parts);
  return details;
}

Details of_pair(PartId other, const std::string& text) {
  Details details;
  details.other_part = other;
  details.text = text;
  return details;
}

Details of_text(const std::string& text) {
  Details details;
  details.text = text;
  return details;
}

}  // namespace

Client::Client(ClientChannel& channel, const ClientOptions& options, Clock clock)
    : channel_(channel), options_(options), clock_(std::move(clock)) {
  if (!clock_) clock_ = steady_now_ns;
  now_ns_ = clock_();
}

LocalUser Client::add_user(const std::string& name, const std::string& role) {
  // The place of one who left, unless the server may still let that one in.
  auto free = std::find_if(users_.begin(), users_.end(), [](const LocalUserState& user) {
    return user.state == JoinState::kLeft && !user.awaits_answer;
  });
  if (free == users_.end()) free = users_.insert(free, LocalUserState{});
  statistics_.increments_repeated += free->unacknowledged.repeated();
  statistics_.increments_given_up += free->unacknowledged.given_up();
  *free = LocalUserState{};
  free->name = name;
  free->role = role;
  free->state = JoinState::kJoining;
  // The same nonce for every try: a server that has already said yes says it again.
  free->nonce = next_nonce_++;
  return static_cast<LocalUser>(free - users_.begin());
}

void Client::leave(LocalUser index) {
  LocalUserState& user = users_[index];
  if (user.id) {
    // Nobody will repeat them later.
    if (!user.unacknowledged.empty()) channel_.send(user.unacknowledged.repeat(now_ns_));
    channel_.leave(user.id);
  }
  user.awaits_answer = !user.id && user.join_sent_ns && user.state == JoinState::kJoining;
  user.state = JoinState::kLeft;
  user.id = UserId{};
}

JoinState Client::join_state(LocalUser user) const { return users_[user].state; }
UserId Client::user_id(LocalUser user) const { return users_[user].id; }
const std::string& Client::refusal_text(LocalUser user) const { return users_[user].refusal; }

std::uint64_t Client::send(LocalUser index, PartId part, const Vec3& translation_mm,
                           const Vec3& rotation_rad) {
  LocalUserState& user = users_[index];
  if (user.state != JoinState::kJoined) {
    ++statistics_.not_joined;
    return 0;
  }
  Increment increment;
  increment.user = user.id;
  increment.part = part;
  increment.seq = ++user.increment_seq;
  increment.translation_mm = translation_mm;
  increment.rotation_rad = rotation_rad;
  const std::int64_t sent_ns = clock_();
  if (!user.unacked_since_ns) user.unacked_since_ns = sent_ns;
  channel_.send(user.unacknowledged.add({increment, sent_ns}, sent_ns));
  ++statistics_.increments_sent;
  return increment.seq;
}

// What a user may ask for.

std::uint64_t Client::command(LocalUser index, CommandKind kind, PartId part, Details details) {
  LocalUserState& user = users_[index];
  if (user.state != JoinState::kJoined) {
    ++statistics_.not_joined;
    return 0;
  }
  // A release must not overtake the end of the drag: once more what is not acknowledged yet.
  if (!user.unacknowledged.empty()) channel_.send(user.unacknowledged.repeat(now_ns_));
  channel_.send(Command{user.id, part, ++user.command_seq, kind, std::move(details),
                        user.unacknowledged.newest()});
  return user.command_seq;
}

std::uint64_t Client::grab(LocalUser user, PartId part) {
  return command(user, CommandKind::kGrab, part);
}
std::uint64_t Client::grab(LocalUser user, std::vector<PartId> parts) {
  return command(user, CommandKind::kGrab, PartId{}, of_group(std::move(parts)));
}
std::uint64_t Client::release(LocalUser user, PartId part) {
  return command(user, CommandKind::kRelease, part);
}
std::uint64_t Client::release(LocalUser user, std::vector<PartId> parts) {
  return command(user, CommandKind::kRelease, PartId{}, of_group(std::move(parts)));
}
std::uint64_t Client::undo(LocalUser user, PartId part) {
  return command(user, CommandKind::kUndo, part);
}
std::uint64_t Client::redo(LocalUser user, PartId part) {
  return command(user, CommandKind::kRedo, part);
}
std::uint64_t Client::reset(LocalUser user, PartId part) {
  return command(user, CommandKind::kReset, part);
}
std::uint64_t Client::ask_hand_over(LocalUser user, PartId part) {
  return command(user, CommandKind::kAskHandOver, part);
}
std::uint64_t Client::consent(LocalUser user, PartId part) {
  return command(user, CommandKind::kConsent, part);
}
std::uint64_t Client::decline(LocalUser user, PartId part, const std::string& why) {
  return command(user, CommandKind::kDecline, part, of_text(why));
}
std::uint64_t Client::set_policy(LocalUser user, const std::string& policy) {
  return command(user, CommandKind::kSetPolicy, PartId{}, of_text(policy));
}
std::uint64_t Client::set_tolerance(LocalUser user, PartId part, const std::string& feature,
                                    const std::string& text) {
  Details details = of_text(text);
  details.feature = feature;
  return command(user, CommandKind::kSetTolerance, part, std::move(details));
}
std::uint64_t Client::set_fit(LocalUser user, const FeatureOf& a, const FeatureOf& b,
                              const std::string& text) {
  Details details = of_pair(b.part, text);
  details.feature = a.feature;
  details.other_feature = b.feature;
  return command(user, CommandKind::kSetTolerance, a.part, std::move(details));
}
std::uint64_t Client::exclude(LocalUser user, PartId a, PartId b, const std::string& reason) {
  return command(user, CommandKind::kSetExclusion, a, of_pair(b, reason));
}
std::uint64_t Client::include(LocalUser user, PartId a, PartId b) {
  return command(user, CommandKind::kDropExclusion, a, of_pair(b, ""));
}
std::uint64_t Client::review(LocalUser user, ClashId clash, ReviewStatus status,
                             const std::string& comment) {
  Details details = of_text(comment);
  details.clash = clash;
  details.status = status;
  return command(user, CommandKind::kReview, PartId{}, std::move(details));
}
std::uint64_t Client::add_constraint(LocalUser user, const Constraint& constraint) {
  Details details;
  details.constraint = constraint;
  return command(user, CommandKind::kAddConstraint, constraint.held.part, std::move(details));
}
std::uint64_t Client::snap(LocalUser user, PartId held, const FeatureOf& other,
                           const std::string& feature, ConstraintKind kind) {
  Details details;
  details.constraint = {kind, {held, feature}, other, 0.0, true};
  return command(user, CommandKind::kSnap, held, std::move(details));
}
std::uint64_t Client::drop_constraint(LocalUser user, PartId held, ConstraintId constraint) {
  Details details;
  details.constraint_id = constraint;
  return command(user, CommandKind::kDropConstraint, held, std::move(details));
}

// What is known of the session.

ClientStatistics Client::statistics() const {
  ClientStatistics statistics = statistics_;
  for (const LocalUserState& user : users_) {
    statistics.increments_repeated += user.unacknowledged.repeated();
    statistics.increments_given_up += user.unacknowledged.given_up();
  }
  return statistics;
}

PartId Client::find_part(const std::string& name) const {
  for (const auto& [id, part] : parts_) {
    if (part.info.name == name) return id;
  }
  return {};
}

ClientUpdate Client::poll() {
  ClientUpdate update;
  ClientInput input = channel_.take();
  now_ns_ = clock_();
  update.at_ns = now_ns_;
  changed_.clear();
  server_present_ = input.server_present;
  if (input.server_lost) {
    update.server_lost = true;
    forget_server();
  }
  for (const JoinReply& reply : input.join_replies) apply_join(reply, update);
  for (const Reply& reply : input.replies) apply_reply(reply, update);
  for (const RefusedIncrement& refused : input.refused) apply_refusal(refused, update);
  // Snapshots after them: what they say is of the same tick or later.
  for (const Decision& decision : input.decisions) apply_decision(decision, update);
  for (const StandingChange& change : input.standing) update.standing |= standing_.take(change);
  // Events before snapshots: a snapshot that only repeats them must not hide them.
  collect_events(input.events);
  apply_events(update);
  for (const Snapshot& snapshot : input.snapshots) offer_snapshot(snapshot, update);
  for (const PoseBatch& batch : input.poses) apply_poses(batch, update);
  if (input.poses_missed > 0) {
    statistics_.poses_missed += input.poses_missed;
    stale_tick_ = statistics_.highest_tick;
    if (!poses_stale_since_ns_) poses_stale_since_ns_ = now_ns_;
  }
  apply_events(update);
  watch_gap(update);
  statistics_.known_event_seq = std::max(known_event_seq_, event_seq_);
  if (!input.pulses.empty()) update.pulse = input.pulses.back();
  update.meshes = std::move(input.meshes);
  update.features = !input.features.empty();
  if (update.features) features_.take(input.features.back());
  update.changed.assign(changed_.begin(), changed_.end());
  send_what_is_due();
  return update;
}

Client::LocalUserState* Client::own_user(UserId id) {
  if (!id) return nullptr;
  const auto found = std::find_if(users_.begin(), users_.end(),
                                  [id](const LocalUserState& user) { return user.id == id; });
  return found == users_.end() ? nullptr : &*found;
}

void Client::forget_server() {
  ++statistics_.server_losses;
  for (LocalUserState& user : users_) {
    user.awaits_answer = false;
    if (user.state != JoinState::kJoined) continue;
    user.state = JoinState::kJoining;
    user.id = UserId{};
    user.in_doubt = false;
    user.join_sent_ns.reset();
    user.unacknowledged.clear();
  }
  for (auto& [id, part] : parts_) part.tick = 0;  // another server counts anew
  features_.clear();
  standing_.expect_another_server();
  pending_.clear();
  held_snapshot_.reset();
  event_seq_ = known_event_seq_ = stale_tick_ = 0;
  have_snapshot_ = synced_ = false;
  gap_since_ns_.reset();
  poses_stale_since_ns_.reset();
  requested_at_ns_.reset();
}

void Client::apply_join(const JoinReply& reply, ClientUpdate& update) {
  for (LocalUser index = 0; index < users_.size(); ++index) {
    LocalUserState& user = users_[index];
    if (user.nonce != reply.nonce) continue;
    if (user.state == JoinState::kLeft) {
      // Let in after it had gone: it would stay there for as long as this client.
      if (reply.refusal == Refusal::kNone && user.awaits_answer) channel_.leave(reply.user);
      user.awaits_answer = false;
    }
    if (user.state != JoinState::kJoining && user.state != JoinState::kJoined) continue;
    if (reply.refusal == Refusal::kNone) {
      user.in_doubt = false;
      if (user.state == JoinState::kJoined && user.id == reply.user) continue;
      user.state = JoinState::kJoined;
      user.id = reply.user;
      user.was_joined = true;
      user.refusal.clear();
      user.unacked_since_ns.reset();
      user.unacknowledged.clear();
      user.heartbeat_at_ns = now_ns_ - in_ns(options_.heartbeat_s);
      update.joined.push_back(index);
    } else {
      user.refusal = reply.text;
      user.id = UserId{};
      // Who had joined keeps trying: the server may not have noticed yet that its old self is gone.
      user.state = user.was_joined ? JoinState::kJoining : JoinState::kRefused;
    }
  }
}

UserInfo& Client::known_user(UserId id) {
  const auto found = std::find_if(session_users_.begin(), session_users_.end(),
                                  [id](const UserInfo& user) { return user.user == id; });
  if (found != session_users_.end()) return *found;
  session_users_.push_back({id, "", false, Role::kUnknown});
  return session_users_.back();
}

// Somebody else has the id now: what it stands for in clashes is nobody's.
void Client::forget_user(UserId id) {
  const auto forget = [id](UserId& by) {
    if (by == id) by = UserId{};
  };
  for (auto& [clash, event] : open_clashes_) {
    forget(event.user);
    forget(event.review.user);
  }
}

void Client::doubt(const UserInfo& who) {
  LocalUserState* user = own_user(who.user);
  if (user != nullptr && (!who.present || who.name != user->name)) user->in_doubt = true;
}

void Client::apply_decision(const Decision& decision, ClientUpdate& update) {
  switch (decision.kind) {
    case Decision::Kind::kJoin: {
      if (takes_over_id(decision)) forget_user(decision.user);
      UserInfo& user = known_user(decision.user);
      user.present = true;
      user.role = decision.role;
      user.name = decision.user_name;
      doubt(user);
      break;
    }
    case Decision::Kind::kLeave:
    case Decision::Kind::kLivelinessLost:
      known_user(decision.user).present = false;
      break;
    case Decision::Kind::kSetPolicy:
      policy_ = decision.details.text;
      break;
    default:
      break;
  }
  update.decisions.push_back(decision);
}

void Client::set_holder(PartId id, UserId holder) {
  const auto found = parts_.find(id);
  if (found == parts_.end() || found->second.info.holder == holder) return;
  found->second.info.holder = holder;
  changed_.insert(id);
}

void Client::apply_reply(const Reply& reply, ClientUpdate& update) {
  if (reply.part) set_holder(reply.part, reply.holder);
  LocalUserState* user = own_user(reply.user);
  if (user == nullptr) return;
  update.replies.push_back(reply);
}

void Client::apply_refusal(const RefusedIncrement& refused, ClientUpdate& update) {
  LocalUserState* user = own_user(refused.user);
  if (user == nullptr) return;
  update.refused.push_back(refused);
  if (refused.reason == Refusal::kUnknownUser) user->in_doubt = true;
}

void Client::apply_scene(const Snapshot& snapshot, ClientUpdate& update) {
  session_ = snapshot.session;
  policy_ = snapshot.policy;
  tick_rate_hz_ = snapshot.tick_rate_hz;
  session_users_ = snapshot.users;
  update.standing |= standing_.take(snapshot);
  for (const UserInfo& info : snapshot.users) doubt(info);
  std::map<PartId, KnownPart> parts;
  for (const PartInfo& info : snapshot.parts) {
    KnownPart& part = parts[info.part];
    part.info = info;
    part.tick = snapshot.tick;
    const auto known = parts_.find(info.part);
    if (known != parts_.end() && known->second.tick > snapshot.tick) {
      part.info.X_WP = known->second.info.X_WP;
      part.info.holder = known->second.info.holder;
      part.tick = known->second.tick;
    }
    if (known == parts_.end() || known->second.info.holder != part.info.holder ||
        !identical(known->second.info.X_WP, part.info.X_WP)) {
      changed_.insert(info.part);
    }
  }
  parts_ = std::move(parts);
  if (snapshot.tick >= stale_tick_) poses_stale_since_ns_.reset();
  statistics_.highest_tick = std::max(statistics_.highest_tick, snapshot.tick);
}

void Client::apply_snapshot(const Snapshot& snapshot, ClientUpdate& update) {
  if (have_snapshot_) {
    statistics_.events_skipped += snapshot.event_seq - event_seq_;
  }
  have_snapshot_ = true;
  event_seq_ = snapshot.event_seq;
  statistics_.highest_event_seq = event_seq_;
  known_event_seq_ = std::max(known_event_seq_, event_seq_);
  open_clashes_.clear();
  for (const ClashEvent& clash : snapshot.open_clashes) open_clashes_[clash.clash] = clash;
  // What the snapshot covers is no event any more.
  pending_.erase(pending_.begin(), pending_.upper_bound(event_seq_));
  held_snapshot_.reset();
  update.resynced = true;
  ++statistics_.snapshots_applied;
}

void Client::offer_snapshot(const Snapshot& snapshot, ClientUpdate& update) {
  requested_at_ns_.reset();  // answered
  if (have_snapshot_ && snapshot.event_seq < event_seq_) {
    ++statistics_.snapshots_stale;  // of its clashes; its poses are compared by tick
    apply_scene(snapshot, update);
    return;
  }
  apply_scene(snapshot, update);
  if (!have_snapshot_) {
    apply_snapshot(snapshot, update);
  } else if (snapshot.event_seq > event_seq_) {
    // The events in between may still be on their way; watch_gap() decides.
    known_event_seq_ = std::max(known_event_seq_, snapshot.event_seq);
    held_snapshot_ = snapshot;
  }
}

void Client::apply_poses(const PoseBatch& batch, ClientUpdate& update) {
  for (const PartPose& pose : batch.parts) {
    if (have_snapshot_ && !parts_.contains(pose.part)) continue;
    KnownPart& part = parts_[pose.part];
    part.info.part = pose.part;
    if (batch.tick < part.tick) {
      ++statistics_.poses_stale;
      continue;
    }
    part.tick = batch.tick;
    part.info.X_WP = pose.X_WP;
    part.info.holder = pose.holder;
    changed_.insert(pose.part);
  }
  for (const Ack& ack : batch.acks) {
    LocalUserState* user = own_user(ack.user);
    if (user == nullptr || ack.seq <= user->acked_seq) continue;
    user->acked_seq = ack.seq;
    user->unacknowledged.acknowledge(ack.seq);
    user->unacked_since_ns.reset();
    if (ack.seq < user->increment_seq) user->unacked_since_ns = now_ns_;
    update.acks.push_back(
        {static_cast<LocalUser>(user - users_.data()), ack.seq, batch.tick, ack.sent_ns});
    if (ack.sent_ns != 0) {
      update.latency_ms.push_back(static_cast<double>(now_ns_ - ack.sent_ns) * 1e-6);
    }
  }
  if (batch.keyframe && batch.tick >= stale_tick_) poses_stale_since_ns_.reset();
  known_event_seq_ = std::max(known_event_seq_, batch.event_seq);
  statistics_.highest_tick = std::max(statistics_.highest_tick, batch.tick);
}

void Client::collect_events(const std::vector<ClashEvent>& events) {
  for (const ClashEvent& event : events) {
    if ((have_snapshot_ && event.seq <= event_seq_) || !pending_.emplace(event.seq, event).second) {
      ++statistics_.events_duplicate;
    }
    known_event_seq_ = std::max(known_event_seq_, event.seq);
  }
  while (pending_.size() > kMaxPendingEvents) pending_.erase(pending_.begin());
}

void Client::apply_events(ClientUpdate& update) {
  if (!have_snapshot_) return;
  while (!pending_.empty() && pending_.begin()->first == event_seq_ + 1) {
    ClashEvent event = std::move(pending_.begin()->second);
    pending_.erase(pending_.begin());
    event_seq_ = event.seq;
    if (event.kind == ClashEvent::Kind::kEnd) {
      open_clashes_.erase(event.clash);
    } else {
      open_clashes_[event.clash] = event;
    }
    update.events.push_back(std::move(event));
    ++statistics_.events_applied;
  }
  statistics_.highest_event_seq = event_seq_;
  if (held_snapshot_ && held_snapshot_->event_seq <= event_seq_) held_snapshot_.reset();
}

void Client::watch_gap(ClientUpdate& update) {
  const bool open = have_snapshot_ && known_event_seq_ > event_seq_;
  if (!open) {
    gap_since_ns_.reset();
    synced_ = have_snapshot_;
    return;
  }
  if (!gap_since_ns_) gap_since_ns_ = now_ns_;
  if (now_ns_ - *gap_since_ns_ < in_ns(options_.resync_after_s)) return;
  if (synced_) ++statistics_.gaps;
  synced_ = false;
  if (!held_snapshot_ || held_snapshot_->event_seq <= event_seq_) return;
  const Snapshot snapshot = std::move(*held_snapshot_);
  apply_snapshot(snapshot, update);
  apply_events(update);
  if (known_event_seq_ == event_seq_) {
    gap_since_ns_.reset();
    synced_ = true;
  }
}

void Client::send_what_is_due() {
  if (!server_present_) return;
  for (LocalUserState& user : users_) {
    if (user.unacked_since_ns &&
        now_ns_ - *user.unacked_since_ns >= in_ns(options_.ack_timeout_s)) {
      user.in_doubt = true;
      user.unacked_since_ns = now_ns_;
    }
    const bool wants =
        user.state == JoinState::kJoining || (user.state == JoinState::kJoined && user.in_doubt);
    if (wants &&
        (!user.join_sent_ns || now_ns_ - *user.join_sent_ns >= in_ns(options_.join_retry_s))) {
      user.join_sent_ns = now_ns_;
      channel_.join(user.nonce, user.name, user.role);
      ++statistics_.joins_sent;
    }
    if (user.state == JoinState::kJoined &&
        now_ns_ - user.heartbeat_at_ns >= in_ns(options_.heartbeat_s)) {
      user.heartbeat_at_ns = now_ns_;
      channel_.heartbeat(user.id);
    }
    if (user.state == JoinState::kJoined && !user.unacknowledged.empty() &&
        now_ns_ - user.unacknowledged.last_sent_ns() >= in_ns(options_.repeat_after_s)) {
      channel_.send(user.unacknowledged.repeat(now_ns_));
    }
  }
  const bool gap = !synced_ && have_snapshot_;
  const bool stale =
      poses_stale_since_ns_ && now_ns_ - *poses_stale_since_ns_ >= in_ns(options_.pose_resync_s);
  // A kept snapshot comes by itself soon after the server is found.
  if (!have_snapshot_ && !requested_at_ns_) requested_at_ns_ = now_ns_;
  if ((gap || stale || !have_snapshot_) &&
      (!requested_at_ns_ || now_ns_ - *requested_at_ns_ >= in_ns(options_.resync_retry_s))) {
    requested_at_ns_ = now_ns_;
    channel_.request_snapshot();
    ++statistics_.snapshots_requested;
  }
}

}  // namespace mortise
