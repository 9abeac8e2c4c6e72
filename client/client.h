#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "client/known_features.h"
#include "client/known_standing.h"
#include "client/unacknowledged.h"
#include "common/messages/channel.h"

namespace mortise {

struct ClientOptions {
  double heartbeat_s = 0.2;   ///< a quarter to a half of the liveliness lease
  double join_retry_s = 1.0;  ///< an unanswered join is sent again after this
  double resync_after_s =
      0.2;  ///< time that a gap of events may last before a snapshot is requested
  double resync_retry_s = 1.0;   ///< between two requests for a snapshot
  double repeat_after_s = 0.05;  ///< increments unacknowledged for so long are sent again
  double ack_timeout_s = 2.0;    ///< increments unanswered for so long: ask to join again
  double pose_resync_s = 2.0;    ///< time that lost poses may wait for a keyframe
};

/// A user of this client, in the order of add_user(); the number of a user who left is reused.
using LocalUser = std::size_t;

enum class JoinState : std::uint8_t { kUnknown = 0, kJoining, kJoined, kRefused, kLeft };

/// What a client knows of a part.
struct KnownPart {
  PartInfo info;           ///< pose and holder are the latest known
  std::uint64_t tick = 0;  ///< of that pose
};

/// The server has taken increments of one of our users up to `seq`, in this tick.
struct SeenAck {
  LocalUser user = 0;
  std::uint64_t seq = 0, tick = 0;
  std::int64_t sent_ns = 0;  ///< when that increment was sent, by our clock; 0: not known
};

/// What one poll() brought.
struct ClientUpdate {
  std::vector<PartId> changed;            ///< parts with a new pose or holder, by id, each once
  std::vector<ClashEvent> events;         ///< in order of seq, without gap and repeat
  std::vector<Reply> replies;             ///< to our users
  std::vector<Decision> decisions;        ///< of the server about all users, in order
  bool standing = false;                  ///< standing() may be another list
  std::vector<RefusedIncrement> refused;  ///< of our users
  std::vector<LocalUser> joined;          ///< joined, or joined again
  std::vector<double> latency_ms;         ///< from send() to the ack seen here
  std::vector<SeenAck> acks;              ///< new ones, in order
  std::int64_t at_ns = 0;                 ///< our clock when this was taken
  std::optional<SessionPulse> pulse;      ///< the latest
  std::vector<MeshBytes> meshes;          ///< arrived
  bool features = false;                  ///< features() is new
  bool resynced = false;                  ///< a snapshot has replaced what was known
  bool server_lost = false;               ///< users join again by themselves when it is back
};

/// What was missed, repeated or repaired.
struct ClientStatistics {
  std::uint64_t events_applied = 0, events_duplicate = 0,
                events_skipped = 0;  ///< skipped: covered by a snapshot
  std::uint64_t gaps = 0, snapshots_requested = 0, snapshots_applied = 0, snapshots_stale = 0;
  std::uint64_t poses_missed = 0, poses_stale = 0;
  std::uint64_t joins_sent = 0, server_losses = 0, increments_sent = 0, not_joined = 0;
  std::uint64_t increments_repeated = 0;  ///< sent again in case the first was lost
  std::uint64_t increments_given_up = 0;  ///< never acknowledged, and no longer kept
  std::uint64_t highest_event_seq = 0, highest_tick = 0;
  std::uint64_t known_event_seq = 0;  ///< highest event that the server has announced
};

/// A participant of a session without an engine: sends requests to the server and keeps its
/// answers. Holds any number of logical users over one channel. Thread-compatible; call poll() at
/// least each heartbeat_s.
class Client {
 public:
  /// Nanoseconds of a clock that never goes back.
  using Clock = std::function<std::int64_t()>;

  /// The channel must outlive the client. Without a clock: std::chrono::steady_clock.
  explicit Client(ClientChannel& channel, const ClientOptions& options = {}, Clock clock = {});

  /// Asks to join; the answer comes by poll(). role: designer | observer | bot.
  LocalUser add_user(const std::string& name, const std::string& role);
  void leave(LocalUser user);

  JoinState join_state(LocalUser user) const;
  UserId user_id(LocalUser user) const;  ///< none while not joined
  const std::string& refusal_text(LocalUser user) const;
  std::size_t user_count() const { return users_.size(); }  ///< those who left included

  /// Commands return the sequence number that the reply will echo, or 0 when the user has not
  /// joined (counted). The reason of a refusal is in the reply; what was done is in
  /// ClientUpdate::decisions.
  std::uint64_t command(LocalUser user, CommandKind kind, PartId part, Details details = {});
  std::uint64_t grab(LocalUser user, PartId part);
  std::uint64_t grab(LocalUser user, std::vector<PartId> parts);  ///< all or none, as one body
  std::uint64_t release(LocalUser user, PartId part);
  std::uint64_t release(LocalUser user, std::vector<PartId> parts);
  std::uint64_t undo(LocalUser user, PartId part);
  std::uint64_t redo(LocalUser user, PartId part);
  std::uint64_t reset(LocalUser user, PartId part);
  /// Asks its holder for a part; the answer is a decision kHandOver, kDecline or kAskEnd.
  std::uint64_t ask_hand_over(LocalUser user, PartId part);
  std::uint64_t consent(LocalUser user, PartId part);  ///< to the user who asked for it
  std::uint64_t decline(LocalUser user, PartId part, const std::string& why = "");
  std::uint64_t set_policy(LocalUser user, const std::string& policy);
  /// text as in a scenario ("±0.05", "H7"), of the whole part or one feature; empty: nothing.
  std::uint64_t set_tolerance(LocalUser user, PartId part, const std::string& feature,
                              const std::string& text);
  /// Of a pair, as a fit of a scenario ("H7/g6", "±0.05"); features may be empty.
  std::uint64_t set_fit(LocalUser user, const FeatureOf& a, const FeatureOf& b,
                        const std::string& text);
  std::uint64_t exclude(LocalUser user, PartId a, PartId b, const std::string& reason);
  std::uint64_t include(LocalUser user, PartId a, PartId b);  ///< drops the exclusion
  std::uint64_t review(LocalUser user, ClashId clash, ReviewStatus status,
                       const std::string& comment = "");
  std::uint64_t add_constraint(LocalUser user, const Constraint& constraint);
  /// Constrains a held part to the nearest feature that fits, and moves it there. The server
  /// chooses what is left empty; the reply says in words what it chose, the decision kAddConstraint
  /// in values.
  std::uint64_t snap(LocalUser user, PartId held, const FeatureOf& other = {},
                     const std::string& feature = "",
                     ConstraintKind kind = ConstraintKind::kUnknown);
  std::uint64_t drop_constraint(LocalUser user, PartId held, ConstraintId constraint);

  /// Sends an increment (see increment.h), with the user's next sequence number, which is returned;
  /// 0 when the user has not joined (counted).
  std::uint64_t send(LocalUser user, PartId part, const Vec3& translation_mm,
                     const Vec3& rotation_rad = Vec3::Zero());

  /// Takes what has arrived, never blocks, sends what is due (joins, heartbeats, snapshot
  /// requests).
  ClientUpdate poll();

  bool synced() const { return synced_; }  ///< a snapshot has come and no gap has stood for long
  bool server_present() const { return server_present_; }
  const std::string& session() const { return session_; }
  const std::string& policy() const { return policy_; }
  double tick_rate_hz() const { return tick_rate_hz_; }
  /// Before the first snapshot a part may be known by its pose alone, without a name.
  const std::map<PartId, KnownPart>& parts() const { return parts_; }
  /// All users that the session knows, present or not, with their last role.
  const std::vector<UserInfo>& users() const { return session_users_; }
  /// The decisions in force, as the session tells them: policy, tolerances, exclusions, constraints
  /// and hand-over requests without an answer.
  const std::vector<Decision>& standing() const { return standing_.decisions(); }
  const std::map<ClashId, ClashEvent>& open_clashes() const { return open_clashes_; }
  /// The features that constraints can name. Arrives soon after the first snapshot, and once or
  /// twice more while the server still searches meshes.
  const KnownFeatures& features() const { return features_; }
  PartId find_part(const std::string& name) const;  ///< none when unknown
  ClientStatistics statistics() const;

 private:
  struct LocalUserState {
    std::string name, role;
    JoinState state = JoinState::kUnknown;
    UserId id;
    std::uint64_t nonce = 0, increment_seq = 0, command_seq = 0, acked_seq = 0;
    Unacknowledged unacknowledged;
    bool was_joined = false;     ///< joins again by itself, also when refused
    bool awaits_answer = false;  ///< left while a join was not answered yet
    bool in_doubt = false;       ///< the server may count us as absent: ask to join again
    std::optional<std::int64_t> join_sent_ns, unacked_since_ns;
    std::int64_t heartbeat_at_ns = 0;
    std::string refusal;
  };

  void apply_decision(const Decision& decision, ClientUpdate& update);
  UserInfo& known_user(UserId id);
  void forget_user(UserId id);
  /// If one of our users is absent, or its id belongs to another user now, it has to join again.
  void doubt(const UserInfo& who);
  LocalUserState* own_user(UserId id);
  void forget_server();
  void apply_join(const JoinReply& reply, ClientUpdate& update);
  void apply_reply(const Reply& reply, ClientUpdate& update);
  void apply_refusal(const RefusedIncrement& refused, ClientUpdate& update);
  void apply_snapshot(const Snapshot& snapshot, ClientUpdate& update);
  void offer_snapshot(const Snapshot& snapshot, ClientUpdate& update);
  void apply_scene(const Snapshot& snapshot, ClientUpdate& update);
  void apply_poses(const PoseBatch& batch, ClientUpdate& update);
  void collect_events(const std::vector<ClashEvent>& events);
  void apply_events(ClientUpdate& update);
  void watch_gap(ClientUpdate& update);
  void send_what_is_due();
  void set_holder(PartId part, UserId holder);

  ClientChannel& channel_;
  ClientOptions options_;
  Clock clock_;
  std::vector<LocalUserState> users_;
  std::uint64_t next_nonce_ = 1;
  std::string session_, policy_;
  double tick_rate_hz_ = 0.0;
  std::map<PartId, KnownPart> parts_;
  KnownFeatures features_;
  std::vector<UserInfo> session_users_;
  KnownStanding standing_;
  std::map<ClashId, ClashEvent> open_clashes_;
  std::map<std::uint64_t, ClashEvent> pending_;  ///< events beyond a gap, by seq
  std::optional<Snapshot> held_snapshot_;        ///< ahead of the events, which may still come
  std::uint64_t event_seq_ = 0;                  ///< applied up to here
  std::uint64_t known_event_seq_ = 0;            ///< highest event that the server has announced
  std::uint64_t stale_tick_ = 0;                 ///< poses up to here may have been missed
  bool have_snapshot_ = false, synced_ = false, server_present_ = false;
  /// The time since when; absent: no such state.
  std::optional<std::int64_t> gap_since_ns_, poses_stale_since_ns_, requested_at_ns_;
  std::set<PartId> changed_;  ///< in this poll()
  std::int64_t now_ns_ = 0;
  ClientStatistics statistics_;
};

}  // namespace mortise
