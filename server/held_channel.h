#pragma once
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/channel.h"
#include "server/backlog.h"
#include "server/clock.h"
#include "server/fencing.h"
#include "server/tick_bytes.h"

namespace mortise {

/// Between a tick and those who hear of it. While another server stands by, what a tick says to
/// clients is kept until that server has said to have the tick: so what a client knows to be taken
/// outlives either server, also where the first is taken for gone and is not. One that stands by
/// and is silent is not waited for longer than kPatience_s of the time in which this process ran.
class HeldChannel final : public ServerChannel {
 public:
  /// Longer than a user who does nothing is silent (0.3 s), short enough to be felt as one hitch.
  static constexpr double kPatience_s = 0.5;
  /// Longer, where fewer than half of the users are heard either: it may be us who are cut off.
  static constexpr double kPatienceCutOff_s = 4.0;
  /// Across a net that loses, Fast DDS tells of new topics again each second or so.
  static constexpr double kHandOver_s = 8.0;

  /// All must outlive this. `users` says how many are in the session. `fencing` may be null: then a
  /// silent standby is given up by patience alone.
  HeldChannel(ServerChannel& inner, Clock& clock, std::function<std::size_t()> users,
              Fencing* fencing = nullptr)
      : inner_(inner), clock_(clock), users_(std::move(users)), fencing_(fencing) {}

  /// Of one that has taken over: says nothing until half of `seats` have asked to join again, for
  /// at most kPatienceCutOff_s; those who do not may be with the server of before.
  void await(const std::vector<SeatRecord>& seats);
  /// Waits until the one that stands by leads the session, at most kHandOver_s and while it is
  /// there, and while `goes_on`, which is asked each turn; then all that is kept is with it, and
  /// goes out. If it does not lead, what is kept is never said.
  bool hand_over(const std::function<bool()>& goes_on);
  /// All that is kept goes out, after a last moment for the one that stands by.
  void finish();
  std::vector<std::string> take_notes() { return std::exchange(notes_, {}); }
  /// It has the ticks and has computed them: it could lead at once.
  bool follower_in_step() const { return follower_backlog().in_step(); }
  /// Of nobody who could lead now where that one is gone or given up; what was counted stays.
  Backlog follower_backlog() const {
    Backlog backlog = backlog_;
    if (!waited_for_ || !inner_.has_follower()) backlog.forget();
    return backlog;
  }

  ServerInput take() override;
  bool rest(std::int64_t at_most_ns) override;
  void publish_tick(const ToldTick& told) override;
  void publish_join_reply(const JoinReply& reply) override;
  void publish_replies(std::span<const Reply> replies) override;
  void publish_decisions(std::span<const Decision> decisions) override;
  void publish_standing(std::span<const StandingChange> changes) override;
  void publish_refusals(std::span<const RefusedIncrement> refused) override;
  /// Acknowledges nothing that could be lost with this server: an upload begins anew elsewhere.
  void publish_uploads(std::span<const UploadState> uploads) override {
    inner_.publish_uploads(uploads);
  }
  void publish_poses(const PoseBatch& batch) override;
  void publish_events(std::span<const ClashEvent> events) override;
  void publish_snapshot(Snapshot snapshot) override;
  void publish_mesh(const std::string& hash, std::span<const std::byte> bytes) override;
  /// It says nothing of the session.
  void publish_coming_mesh(const std::string& hash, std::span<const std::byte> bytes) override {
    inner_.publish_coming_mesh(hash, bytes);
  }
  void publish_features(const FeatureTable& table) override;
  void publish_pulse(const SessionPulse& pulse) override;
  bool has_readers() const override { return inner_.has_readers(); }
  bool has_follower() const override { return waited_for_ || inner_.has_follower(); }
  ChannelCounters counters() const override { return inner_.counters(); }
  void note_progress(double next_within_s) override { inner_.note_progress(next_within_s); }

 private:
  struct Kept {
    std::uint64_t tick = 0;
    std::function<void()> say;
  };
  struct Heard {
    double at_s = 0.0;   ///< of waited_s_
    bool steady = true;  ///< never silent for long
  };
  /// What came in; one that says to lead and tells what is no tick leads nobody.
  ServerInput heard();
  bool keeps() const { return waited_for_ || !awaited_.empty() || !kept_.empty(); }
  /// Says it, now or later.
  void say(std::function<void()> what);
  /// What the one that stands by has goes out; gives it up when it has been silent for too long.
  void let_go();
  void note_backlog(const TakenTicks& taken);
  void wait_on(double seconds);
  void note_heard(const ServerInput& input);
  void note_heard(UserId user);
  bool most_users_are_heard() const;
  void go_alone(bool heard_by_most);
  bool may_say(const ClientKey& has_it) const { return !fencing_ || fencing_->may_say(has_it); }
  /// `has_it`: the standby that has all up to that tick; empty: none.
  void say_up_to(std::uint64_t tick, const ClientKey& has_it);
  void say_alone();

  ServerChannel& inner_;
  Clock& clock_;
  std::function<std::size_t()> users_;
  Fencing* fencing_;
  ClientKey follower_;         ///< that spoke last
  std::uint64_t said_ = 0;     ///< up to this tick, some of it perhaps
  bool to_lead_anew_ = false;  ///< once it may speak alone
  std::deque<Kept> kept_;
  std::uint64_t tick_ = 0;   ///< the last that was told
  bool waited_for_ = false;  ///< one that stands by says what it has
  Backlog backlog_;          ///< of that one
  /// See await(): a client may hold many users, who count like any others.
  std::set<std::pair<ClientKey, std::uint64_t>> awaited_;
  std::size_t awaited_enough_ = 0;  ///< so few may still be missing
  double waited_s_ = 0.0;           ///< for the oldest that is kept
  std::size_t users_then_ = 0;      ///< when that wait began
  std::map<UserId, Heard> heard_;   ///< since then
  std::int64_t turned_ns_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace mortise
