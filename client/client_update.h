#pragma once
#include <cstdint>
#include <optional>
#include <vector>

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

/// Increments of one of our users up to `seq` that were not acknowledged are not repeated any more:
/// too many are under way, or the server is another. A later acknowledgement says nothing of them;
/// they may have been taken or not.
struct GivenUp {
  LocalUser user = 0;
  std::uint64_t seq = 0;
};

/// The server has taken increments of one of our users up to `seq`, in this tick, those excepted
/// that it refused (`refused`) and those that were given up before.
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
  bool remarks = false;                   ///< remarks() may be another list
  std::vector<RefusedIncrement> refused;  ///< of our users
  std::vector<UploadState> uploads;       ///< of our users, in order
  bool scene = false;                     ///< parts were added, removed or changed
  std::vector<LocalUser> joined;          ///< joined, or joined again
  std::vector<double> latency_ms;         ///< from send() to the ack seen here
  std::vector<GivenUp> given_up;          ///< before what else is here
  std::vector<SeenAck> acks;              ///< new ones, in order
  std::int64_t at_ns = 0;                 ///< our clock when this was taken
  std::optional<SessionPulse> pulse;      ///< the latest
  std::vector<MeshBytes> meshes;          ///< arrived
  bool features = false;                  ///< features() is new
  bool resynced = false;                  ///< a snapshot has replaced what was known
  /// Users join again by themselves when it is back. Commands that it has not answered never will
  /// be: they were carried out or not.
  bool server_lost = false;
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

}  // namespace mortise
