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

/// Names the sender of a message as the transport knows it (DDS: hex of the GUID prefix). Messages
/// for a user that the sender did not join as are refused.
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
/// The content of one datagram: increments of one user, in rising sequence. Increments that are not
/// acknowledged yet are repeated together with new ones.
struct IncrementBatch {
  std::uint64_t kept_from = 0;   ///< the sender can repeat from here on; 0: it never repeats
  std::uint64_t fresh_from = 0;  ///< from here on: sent for the first time
  std::vector<SentIncrement> increments;
};
/// One increment of a sender that never repeats.
inline IncrementBatch batch_of(const Increment& increment, std::int64_t sent_ns) {
  return {0, increment.seq, {{increment, sent_ns}}};
}
/// More in one batch could exceed one Ethernet frame, and a datagram of several frames is lost more
/// often.
inline constexpr std::size_t kMaxBatchIncrements = 16;
/// Increments of a user that are kept for repetition by the sender, and behind a gap by the server:
/// 4 s at 240 Hz.
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

/// A piece of a mesh file on its way to the server. The pieces of an upload come in order, without
/// a gap. At most kUploadAhead_bytes are under way beyond what UploadState says was received.
struct UploadPiece {
  UserId user;
  std::uint64_t upload = 0;  ///< its number, of the user: 1, 2, 3 ...
  std::string name;          ///< of the file; its ending says the format ("bracket.stl")
  double unit_mm = 1.0;      ///< mm per unit of the numbers in the file
  std::string hash;          ///< content_hash() of the whole file
  std::uint64_t length = 0;  ///< bytes of the whole file
  std::uint64_t offset = 0;  ///< of this piece
  std::vector<std::byte> bytes;
};
inline constexpr std::size_t kUploadPiece_bytes = 49'152;  ///< fits a sample (idl/topics.h)
inline constexpr std::uint64_t kUploadAhead_bytes = 8 * kUploadPiece_bytes;  ///< chosen

struct ReceivedPiece {
  ClientKey client;
  UploadPiece piece;
};

/// How far an upload is, told to everybody whenever it changes.
struct UploadState {
  UserId user;
  std::uint64_t upload = 0;
  std::uint64_t received = 0;        ///< bytes
  bool ready = false;                ///< read and prepared: a part made of it appears at once
  std::string mesh_hash;             ///< once ready: PartInfo::mesh_hash of its mesh
  std::string text;                  ///< once ready: what was found in the file; may be empty
  Refusal refusal = Refusal::kNone;  ///< it has ended; `text` says why
};

/// A tick as a server sends it to its standby. The transport does not interpret the bytes.
struct ToldTick {
  std::uint64_t tick = 0;
  std::vector<std::byte> bytes;
};
/// Which ticks a standby has.
struct TakenTicks {
  std::uint64_t received = 0;  ///< it has all up to here; 0: it has not reported yet
  std::uint64_t computed = 0;  ///< computed up to here; the rest is computed before it leads
  ClientKey by = {};           ///< which standby
};
/// Value of `received` of a standby that leaves and needs nothing more.
inline constexpr std::uint64_t kTakenAll = ~std::uint64_t{0};

/// What the transport dropped at the door, by reason; never silent.
struct ChannelCounters {
  std::uint64_t received = 0, malformed = 0, foreign = 0, lost = 0, send_failed = 0,
                guard_dropped = 0;
  std::uint64_t trailers_cut = 0;  ///< statistics of the sender's DDS, cut off; harmless
  std::uint64_t turned_away = 0;   ///< participants without a valid identity or permission
};

struct ServerInput {
  std::vector<JoinRequest> joins;
  std::vector<ReceivedCommand> commands;
  std::vector<ReceivedIncrement> increments;
  std::vector<ReceivedPiece> pieces;
  std::vector<LostUser> lost;
  std::vector<UserId> heartbeats;
  std::vector<ClientKey> snapshot_requests;  ///< clients that missed something: publish a snapshot
  std::vector<std::string> turned_away;      ///< participants that the transport refused, in words
  bool follower_came = false;                ///< a new standby has appeared
  bool superseded = false;                   ///< another server has taken over: this one must end
  std::string superseded_by;                 ///< its address; may be empty
  std::optional<ToldTick> superseding;       ///< what it told last
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

/// A pair that had no verdict in some ticks since the last pulse, and why in the last of them.
struct UnexaminedRow {
  PartId a, b;  ///< a < b
  Unexamined why = Unexamined::kUnknown;
  std::uint32_t ticks = 0;
  friend bool operator==(const UnexaminedRow&, const UnexaminedRow&) = default;
};
/// Most rows of one pulse.
inline constexpr std::size_t kMostUnexaminedRows = 64;

/// Figures of the running session, once a second.
struct SessionPulse {
  std::uint64_t tick = 0;
  std::uint64_t clashes_open[4] = {0, 0, 0, 0};  ///< by CollisionClass
  std::uint64_t clashes_total[4] = {0, 0, 0, 0};
  double tick_p50_us = 0.0, tick_p99_us = 0.0, tick_max_us = 0.0, lateness_p99_us = 0.0;
  std::uint64_t missed_deadlines = 0;  ///< that ticks ran past wholly
  std::uint64_t refused = 0, not_examined = 0;
  std::uint32_t users = 0;
  bool draining = false;  ///< this server ends soon; the session continues on another one, or later
  std::vector<UnexaminedRow> unexamined;  ///< by pair
  std::uint64_t unexamined_left_out = 0;  ///< rows beyond kMostUnexaminedRows
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
  virtual void publish_standing(std::span<const StandingChange> changes) = 0;
  virtual void publish_refusals(std::span<const RefusedIncrement> refused) = 0;
  virtual void publish_uploads(std::span<const UploadState> uploads) = 0;
  virtual void publish_poses(const PoseBatch& batch) = 0;
  virtual void publish_events(std::span<const ClashEvent> events) = 0;
  virtual void publish_snapshot(Snapshot snapshot) = 0;  ///< kept for late joiners
  virtual void publish_mesh(const std::string& hash,
                            std::span<const std::byte> bytes) = 0;  ///< kept
  /// A mesh that a part may be made of soon; kept as well. May be called by any thread.
  virtual void publish_coming_mesh(const std::string& hash, std::span<const std::byte> bytes) = 0;
  virtual void publish_features(const FeatureTable& table) = 0;  ///< kept; the last one counts
  virtual void publish_pulse(const SessionPulse& pulse) = 0;
  virtual bool has_readers() const = 0;
  virtual ChannelCounters counters() const = 0;

  /// Is there a standby? Then publish_tick() sends it each tick before anything that the tick
  /// acknowledges is published.
  virtual bool has_follower() const { return false; }
  virtual void publish_tick(const ToldTick&) {}
  /// What the standby has reported since the last call.
  virtual TakenTicks taken_up_to() { return {}; }
  /// Returns when the standby has reported since the last call, or after the given time.
  virtual void await_taken(std::int64_t /*at_most_ns*/) {}
  /// The tick thread goes on, and will again within so long. One that does not, and does not
  /// compute either, is no leader for other servers any more, whatever its other threads do.
  virtual void note_progress(double /*next_within_s*/) {}
  /// The standby may have taken over elsewhere: takes a new term, higher than the standby's.
  virtual void lead_anew() {}
  /// The term under which this server leads, ms since 1970 or later; 0: the transport knows no
  /// other servers.
  virtual std::uint64_t term_ms() const { return 0; }

  /// The name of this server among those of the session; empty: the transport knows none.
  virtual ClientKey own_key() const { return {}; }

  /// Why this server must end, as found by take() and follow(); empty: it may continue.
  virtual std::string barred() const { return {}; }

  /// Does work that is due between two ticks, for at most the given time; false: nothing is due.
  virtual bool rest(std::int64_t /*at_most_ns*/) { return false; }
};

/// The channel of a standby: it receives the leader's ticks and publishes nothing. After a
/// take-over it is the channel of an ordinary server.
class StandbyChannel : public ServerChannel {
 public:
  virtual std::vector<ToldTick> follow() = 0;
  /// Returns when the leader has told something since the last call, or after so long.
  virtual void await_told(std::int64_t at_most_ns) = 0;
  /// Tells the leader which ticks are here. The leader publishes a tick to clients only after its
  /// standby has received it.
  virtual void confirm(const TakenTicks& taken) = 0;
  /// Is the leader alive, and do its ticks go on? Known within 0.15 s, and within 1.15 s.
  virtual bool leader_present() const = 0;
  /// Does the leader count on another standby? Only that one may take over.
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
  std::vector<Decision> decisions;       ///< in the order in which they were made
  std::vector<StandingChange> standing;  ///< likewise
  std::vector<RefusedIncrement> refused;
  std::vector<UploadState> uploads;
  std::vector<Snapshot> snapshots;
  std::vector<PoseBatch> poses;
  std::vector<ClashEvent> events;
  std::vector<SessionPulse> pulses;
  std::vector<MeshBytes> meshes;
  std::vector<FeatureTable> features;  ///< the last one counts
  std::uint64_t poses_missed = 0;      ///< pose batches known to be lost since the last take()
  bool server_lost = false;            ///< noticed since the last take()
  bool server_present = false;
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
  virtual void send(const UploadPiece& piece) = 0;
  virtual void request_snapshot() = 0;  ///< after a gap, or when none has arrived
  virtual ClientInput take() = 0;
  /// Returns when there may be something to take that was not there at the last call, or after so
  /// long at the latest.
  virtual void await_input(std::int64_t at_most_ns) = 0;
  virtual ChannelCounters counters() const = 0;
};

}  // namespace mortise
