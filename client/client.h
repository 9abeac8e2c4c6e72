#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/client_commands.h"
#include "client/client_update.h"
#include "client/event_stream.h"
#include "client/known_features.h"
#include "client/known_parts.h"
#include "client/known_standing.h"
#include "client/own_uploads.h"
#include "client/own_users.h"
#include "common/messages/channel.h"

namespace mortise {

/// A participant of a session without an engine: sends requests to the server and keeps its
/// answers. Holds any number of logical users over one channel. Thread-compatible; call poll() at
/// least each heartbeat_s.
class Client final : public ClientCommands {
 public:
  /// Nanoseconds of a clock that never goes back.
  using Clock = std::function<std::int64_t()>;

  /// The channel must outlive the client. Without a clock: std::chrono::steady_clock.
  explicit Client(ClientChannel& channel, const ClientOptions& options = {}, Clock clock = {});
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Asks to join; the answer comes by poll(). role: designer | observer | bot.
  LocalUser add_user(const std::string& name, const std::string& role);
  void leave(LocalUser user);
  /// The person is out of reach for now: the user stays joined and keeps what it holds until the
  /// session's leases end.
  void set_away(LocalUser user, bool away) { own_.set_away(user, away); }

  JoinState join_state(LocalUser user) const { return own_.state(user); }
  UserId user_id(LocalUser user) const { return own_.id(user); }  ///< none while not joined
  const std::string& refusal_text(LocalUser user) const { return own_.refusal(user); }
  std::size_t user_count() const { return own_.count(); }  ///< those who left included

  /// Sends an increment (see increment.h), with the user's next sequence number, which is returned;
  /// 0 when the user has not joined (counted).
  std::uint64_t send(LocalUser user, PartId part, const Vec3& translation_mm,
                     const Vec3& rotation_rad = Vec3::Zero());

  /// Sends a mesh file to the server, piece by piece with each poll(). `name`: its ending says the
  /// format ("bracket.stl"). unit_mm: mm per unit of its numbers. Returns the number that
  /// ClientUpdate::uploads tells of it; 0 when the user has not joined (counted). A part can be
  /// made of it at once, by content_hash(bytes): see add_part().
  std::uint64_t upload(LocalUser user, const std::string& name, double unit_mm,
                       std::vector<std::byte> bytes);

  /// Takes what has arrived, never blocks, sends what is due (joins, heartbeats, snapshot
  /// requests).
  ClientUpdate poll();
  /// Returns when something may have come for poll(), or after so long (seconds) at the latest. No
  /// later than a fiftieth of a second, because poll() sends what is due meanwhile.
  void await_news(double at_most_s) {
    constexpr double kLongestWait_s = 0.02;  // see above
    channel_.await_input(static_cast<std::int64_t>(std::min(at_most_s, kLongestWait_s) * 1e9));
  }

  bool synced() const {
    return events_.synced();
  }  ///< a snapshot has come and no gap has stood for long
  bool server_present() const { return server_present_; }
  const std::string& session() const { return session_; }
  const std::string& policy() const { return policy_; }
  double tick_rate_hz() const { return tick_rate_hz_; }
  /// Before the first snapshot a part may be known by its pose alone, without a name.
  const std::map<PartId, KnownPart>& parts() const { return parts_.all(); }
  /// All users that the session knows, present or not, with their last role.
  const std::vector<UserInfo>& users() const { return session_users_; }
  /// What was found when meshes of the session were read.
  const std::vector<PartNote>& notes() const { return notes_; }
  /// What was said of open clashes up to the last snapshot and since, by their reviews.
  const std::vector<Remark>& remarks() const { return remarks_; }
  /// The decisions in force, as the session tells them: policy, tolerances, exclusions, constraints
  /// and hand-over requests without an answer.
  const std::vector<Decision>& standing() const { return standing_.decisions(); }
  const std::map<ClashId, ClashEvent>& open_clashes() const { return events_.open_clashes(); }
  /// The features that constraints can name. Arrives soon after the first snapshot, and once or
  /// twice more while the server still searches meshes.
  const KnownFeatures& features() const { return features_; }
  /// None when unknown.
  PartId find_part(const std::string& name) const { return parts_.find(name); }
  ClientStatistics statistics() const;

 private:
  std::uint64_t send_command(LocalUser user, CommandKind kind, PartId part,
                             Details details) override;
  void apply_decision(const Decision& decision, ClientUpdate& update);
  bool add_remark(const Decision& decision);
  UserInfo& known_user(UserId id);
  void forget_server();
  void take_snapshot(const Snapshot& snapshot, ClientUpdate& update);
  void apply_poses(const PoseBatch& batch, ClientUpdate& update);
  void note_missed_poses(std::uint64_t missed);
  void request_snapshot_when_due();

  ClientChannel& channel_;
  ClientOptions options_;
  Clock clock_;
  ClientStatistics statistics_;
  OwnUsers own_{channel_, options_, statistics_};
  OwnUploads uploads_{channel_, own_};
  EventStream events_{options_, statistics_};
  std::string session_, policy_;
  double tick_rate_hz_ = 0.0;
  KnownParts parts_;
  KnownFeatures features_;
  std::vector<UserInfo> session_users_;
  std::vector<PartNote> notes_;
  std::vector<Remark> remarks_;
  KnownStanding standing_;
  std::uint64_t stale_tick_ = 0;  ///< poses up to here may have been missed
  bool server_present_ = false;
  /// The time since when; absent: no such state.
  std::optional<std::int64_t> poses_stale_since_ns_, requested_at_ns_;
  std::int64_t now_ns_ = 0;
};

}  // namespace mortise
