#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/messages/feature_info.h"
#include "common/messages/identity.h"
#include "common/messages/increment.h"
#include "common/messages/report.h"
#include "common/messages/scene.h"

namespace mortise {

/// Names the sender of a message as the transport knows it (DDS: hex of the GUID prefix). What it
/// sends for a user that it did not join as is refused.
using ClientKey = std::string;

struct JoinRequest {
  ClientKey client;
  std::uint64_t nonce =
      0;  ///< chosen by the client, echoed in the reply: several users of one process
  std::string name;
  std::string role;                       ///< designer | observer | bot
  std::optional<Identity> identity = {};  ///< proven by the transport; none: it proves none
};
struct JoinReply {
  ClientKey client;
  std::uint64_t nonce = 0;
  UserId user;  ///< none when refused
  Refusal refusal = Refusal::kNone;
  std::string text;
};

struct SentIncrement {
  Increment increment;
  std::int64_t sent_ns = 0;  ///< sender's clock, only for latency figures
};
/// What one datagram holds: increments of one user, in rising sequence; those that were not
/// acknowledged yet are repeated beside what is new.
struct IncrementBatch {
  std::uint64_t kept_from = 0;   ///< the sender can repeat from here on; 0: it never repeats
  std::uint64_t fresh_from = 0;  ///< from here on: sent for the first time
  std::vector<SentIncrement> increments;
};
/// One increment of a sender that never repeats.
inline IncrementBatch batch_of(const Increment& increment, std::int64_t sent_ns) {
  return {0, increment.seq, {{increment, sent_ns}}};
}
/// More in one batch could pass one Ethernet frame, and a datagram of several is lost more often.
inline constexpr std::size_t kMaxBatchIncrements = 16;
/// So many increments of a user are kept for repetition, by the sender and, beyond a hole, by the
/// server: 4 s at 240 Hz.
inline constexpr std::size_t kMaxKeptIncrements = 1024;

struct ReceivedIncrement {
  ClientKey client;
  Increment increment;
  std::int64_t sent_ns = 0;
  std::uint64_t kept_from = 0;       ///< of its batch
  bool repeated = false;             ///< was sent before
  Refusal at_door = Refusal::kNone;  ///< not finite and the like: only user, part, seq are known
};
struct ReceivedCommand {
  ClientKey client;
  Command command;
};
struct LostUser {
  UserId user;  ///< none: all users of the client
  ClientKey client;
  bool said_goodbye = false;  ///< left, as against lost liveliness
};

/// What a server tells of a tick to one that stands by; what the bytes say is the servers' affair.
struct ToldTick {
  std::uint64_t tick = 0;
  std::vector<std::byte> bytes;
};
/// How far one that stands by has the ticks that it was told.
struct TakenTicks {
  std::uint64_t received = 0;  ///< all up to here are with it; 0: it has said nothing
  std::uint64_t computed = 0;  ///< and up to here computed; the rest comes before it could lead
};
/// Of `received`: it goes, and needs nothing more.
inline constexpr std::uint64_t kTakenAll = ~std::uint64_t{0};

/// What the transport dropped at the door, by reason; never silent.
struct ChannelCounters {
  std::uint64_t received = 0, malformed = 0, foreign = 0, lost = 0, send_failed = 0,
                guard_dropped = 0;
  std::uint64_t trailers_cut = 0;  ///< statistics of the sender's DDS, cut off: no sign of trouble
  std::uint64_t turned_away = 0;  ///< participants that could not prove who they are, or may not be
};

struct ServerInput {
  std::vector<JoinRequest> joins;
  std::vector<ReceivedCommand> commands;
  std::vector<ReceivedIncrement> increments;
  std::vector<LostUser> lost;
  std::vector<UserId> heartbeats;
  std::vector<ClientKey> snapshot_requests;  ///< who missed something: publish a snapshot again
  std::vector<std::string> turned_away;      ///< who was not let in by the transport, in words
  bool follower_came = false;                ///< a server stands by that did not before
  bool superseded = false;                   ///< another server has taken the session over: end
};

struct Ack {
  UserId user;
  std::uint64_t seq = 0;     ///< all increments up to here were applied, refused or given up
  std::int64_t sent_ns = 0;  ///< of that increment, echoed
};

/// Changed parts of one tick. A part that a client missed is in the next snapshot.
struct PoseBatch {
  std::uint64_t tick = 0;
  std::uint64_t event_seq = 0;  ///< of the last event up to this tick
  std::int64_t sent_ns = 0;     ///< server's clock
  std::vector<PartPose> parts;
  std::vector<Ack> acks;
  bool keyframe = false;  ///< holds all parts
};

/// Figures of the running session, once a second.
struct SessionPulse {
  std::uint64_t tick = 0;
  std::uint64_t clashes_open[4] = {0, 0, 0, 0};  ///< by CollisionClass
  std::uint64_t clashes_total[4] = {0, 0, 0, 0};
  double tick_p50_us = 0.0, tick_p99_us = 0.0, tick_max_us = 0.0, lateness_p99_us = 0.0;
  std::uint64_t missed_deadlines = 0;  ///< that ticks ran past wholly
  std::uint64_t refused = 0, not_examined = 0;
  std::uint32_t users = 0;
  bool draining = false;  ///< this server ends soon: the session goes on with another, or later
};

/// The server's end of a transport. take() and publish_*() never block and are called from the tick
/// thread.
class ServerChannel {
 public:
  virtual ~ServerChannel() = default;
  virtual ServerInput take() = 0;
  virtual void publish_join_reply(const JoinReply& reply) = 0;
  virtual void publish_replies(std::span<const Reply> replies) = 0;
  virtual void publish_decisions(std::span<const Decision> decisions) = 0;  ///< to everybody
  virtual void publish_refusals(std::span<const RefusedIncrement> refused) = 0;
  virtual void publish_poses(const PoseBatch& batch) = 0;
  virtual void publish_events(std::span<const ClashEvent> events) = 0;
  virtual void publish_snapshot(const Snapshot& snapshot) = 0;  ///< kept for late joiners
  virtual void publish_mesh(const std::string& hash,
                            std::span<const std::byte> bytes) = 0;  ///< kept
  virtual void publish_features(const FeatureTable& table) = 0;     ///< kept; the last one counts
  virtual void publish_pulse(const SessionPulse& pulse) = 0;
  virtual bool has_readers() const = 0;
  virtual ChannelCounters counters() const = 0;

  /// Does another server stand by? Then publish_tick() tells it each tick, before anything that
  /// the tick acknowledges is published.
  virtual bool has_follower() const { return false; }
  virtual void publish_tick(const ToldTick&) {}
  /// What the one that stands by has said since the last call.
  virtual TakenTicks taken_up_to() { return {}; }
  /// Returns when it has said something since the last call, or after so long.
  virtual void await_taken(std::int64_t /*at_most_ns*/) {}
  /// The one that stood by may have taken over elsewhere: from now on this one is the later leader.
  virtual void lead_anew() {}
  /// Under which this one leads, ms since 1970 or later; 0: its transport knows no other servers.
  virtual std::uint64_t term_ms() const { return 0; }

  /// Why this one may no longer be a server of its session, found by take() and follow(): it is to
  /// end. Empty: it may.
  virtual std::string barred() const { return {}; }

  /// Does what is due between two ticks, for at most so long; false: nothing is due.
  virtual bool rest(std::int64_t /*at_most_ns*/) { return false; }
};

/// The end of a server that stands by: it hears what the one that leads tells of its ticks. Once it
/// has taken over it is the end of a server like any other; before, it publishes nothing.
class StandbyChannel : public ServerChannel {
 public:
  virtual std::vector<ToldTick> follow() = 0;
  /// Tells the one that leads what is here; it waits for what is received before it lets clients
  /// know.
  virtual void confirm(const TakenTicks& taken) = 0;
  /// Is the one that leads alive? Known within 0.15 s.
  virtual bool leader_present() const = 0;
  /// Does the one that leads count on another one that stands by? Only that one may take over.
  virtual bool another_stands_by() const = 0;
  virtual Status take_over() = 0;
};

/// A mesh as publish_mesh() gave it.
struct MeshBytes {
  std::string hash;
  std::vector<std::byte> bytes;
};

struct ClientInput {
  std::vector<JoinReply> join_replies;  ///< only those for this client
  std::vector<Reply> replies;
  std::vector<Decision> decisions;  ///< in the order in which they were made
  std::vector<RefusedIncrement> refused;
  std::vector<Snapshot> snapshots;
  std::vector<PoseBatch> poses;
  std::vector<ClashEvent> events;
  std::vector<SessionPulse> pulses;
  std::vector<MeshBytes> meshes;
  std::vector<FeatureTable> features;  ///< the last one counts
  std::uint64_t poses_missed = 0;      ///< pose batches known to be lost since the last take()
  bool server_lost = false;            ///< noticed since the last take()
  bool server_present = false;         ///< as of now
};

/// A participant's end. Thread-compatible; take() never blocks.
class ClientChannel {
 public:
  virtual ~ClientChannel() = default;
  virtual void join(std::uint64_t nonce, const std::string& name, const std::string& role) = 0;
  virtual void leave(UserId user) = 0;
  virtual void heartbeat(UserId user) = 0;
  virtual void send(const IncrementBatch& batch) = 0;
  virtual void send(const Command& command) = 0;
  virtual void request_snapshot() = 0;  ///< after a gap, or when none has come
  virtual ClientInput take() = 0;
  virtual ChannelCounters counters() const = 0;
};

}  // namespace mortise
