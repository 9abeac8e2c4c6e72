#pragma once
#include <time.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "common/messages/channel.h"
#include "idl/bell.h"
#include "idl/chunks.h"
#include "idl/participant.h"
#include "idl/tick_watch.h"

/// What the servers of a session tell each other, and which of them counts.
namespace mortise {

/// Hears which other servers of the session tell ticks and are alive, and which listen to ours.
class PeerServers final : public dds::DataReaderListener, public dds::DataWriterListener {
 public:
  /// Before any thread of Fast DDS calls.
  void know_own(const ClientKey& own) { own_ = own; }
  bool is_alive(const ClientKey& server) const;
  bool has_follower() const;
  bool follows(const ClientKey& server) const;
  /// One listens that did not at the last call.
  bool take_came();
  /// Returns when a tick was told since the last call, or after so long.
  void await_told(std::int64_t at_most_ns) { told_.await(at_most_ns); }

  void on_data_available(dds::DataReader*) override { told_.ring(); }
  void on_liveliness_changed(dds::DataReader*, const dds::LivelinessChangedStatus& status) override;
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override;
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override;

 private:
  mutable std::mutex mutex_;
  std::set<ClientKey> alive_, followers_;
  ClientKey own_;
  bool came_ = false;
  Bell told_;
};

/// What the server that leads tells of its ticks: of all that are heard the one with the highest
/// term, of equal ones the highest key.
class LeaderTold {
 public:
  struct Heard {
    std::optional<ToldTick> tick;  ///< once it is whole; pieces come in order
    bool superseding = false;      ///< that one leads instead of `own`
  };
  /// `own`: a term (0: it does not lead) and a key.
  Heard hear(const wire::ServerTick& sample, const ClientKey& key,
             const std::pair<std::uint64_t, ClientKey>& own);
  /// A leader that is revoked ends once it has the list, too. What it tells until then is heard,
  /// for some seconds since it was first asked for: who works with it holds that for safe.
  bool may_be_ending(const ClientKey& revoked);
  std::uint64_t term() const { return term_; }
  const ClientKey& leader() const { return leader_; }        ///< empty: none was heard
  const ClientKey& counts_on() const { return counts_on_; }  ///< the one that stands by, for it
  std::uint64_t dropped() const { return collector_.dropped(); }  ///< pieces

 private:
  std::uint64_t term_ = 0;
  ClientKey leader_, counts_on_;
  ClientKey revoked_;  ///< of whom it was asked last
  std::chrono::steady_clock::time_point revoked_at_{};
  TickCollector collector_;
};

/// The one that stands by and counts: the first that says what it has and listens to our ticks,
/// until it is gone or revoked.
class FollowerTold {
 public:
  /// What was said since the last call. `identities` may be null: no security.
  TakenTicks take(dds::DataReader& reader, std::uint64_t term, const PeerServers& servers,
                  Participant& own, const PeerIdentities* identities);
  /// Empty: none.
  const ClientKey& follower(const PeerServers& servers);

 private:
  ClientKey follower_;
};

/// Says that the one that leads lives, while its ticks go on (TickWatch). Fast DDS goes on saying
/// it by itself for the lease, and no longer.
class Heartbeat {
 public:
  explicit Heartbeat(dds::DataWriter& writer);
  /// Of the thread that ticks, always the same one.
  void progress(double next_within_s);

 private:
  bool ticks_go_on();

  std::mutex mutex_, watched_;  ///< the second is held for a moment only: a tick waits for it
  std::condition_variable_any stopped_;
  TickWatch watch_;
  clockid_t cpu_clock_ = 0;
  bool has_clock_ = false;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace mortise
