#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/messages/channel.h"

namespace mortise {

struct InboxLimits {
  /// Increments and commands a second and user, as a bucket of one second. A designer's device
  /// sends at most 240 Hz; a flood of one user must not take the tick of the others.
  double messages_per_s = 1000.0;
  /// The same for all users together: what a tick can take in without being late for all.
  double session_messages_per_s = 100'000.0;
  /// A session with more is refused: one user costs up to one broad-phase move a tick.
  std::uint32_t max_users = 256;
  /// Names that the session remembers, of present and absent users: an id each, in every snapshot.
  /// A further name gets the id of the user who has been absent longest. At least max_users.
  std::uint32_t names_kept = 1024;
  /// Refusals sent to one user in one tick; further ones are only counted, so that a flood is not
  /// amplified.
  std::uint32_t refusals_told_per_tick = 8;
  /// Increments of one user in one tick; more wait for the next ticks, in order. Twice what the
  /// user sends in the time of a tick, but at least so many: a backlog shrinks as fast as it grew,
  /// at whatever rate the session ticks. Without it the increments that piled up in one slow tick
  /// would make the next one a single long leap, slower still.
  std::uint32_t increments_per_tick = 8;
  /// Increments of one user that may wait; more are refused (kRateTooHigh). One second of the
  /// highest rate, or four of a 240 Hz device: the session may stand still for that long.
  std::uint32_t increments_waiting = 1000;
  /// Parts that one user may hold; more are refused at the grab, because a user who holds all parts
  /// keeps the others from working.
  std::uint32_t parts_per_user = 64;
  /// How long a command waits for earlier increments of its sender that have not arrived: ten
  /// repetitions. Then it is applied without them, and counted.
  double after_wait_s = 0.5;
  /// Bytes of one mesh file that a user uploads, of all files of a user, and how many may be under
  /// way. What was uploaded stays in the memory of the session, and in its log once it is used.
  std::uint64_t upload_bytes = 128'000'000, upload_bytes_of_user = 512'000'000;
  std::uint32_t uploads_at_once = 4;
  /// Commands of a user that wait for a mesh.
  std::uint32_t edits_waiting = 64;
};

/// What one user has sent since the session began here, and its outcome.
struct UserCounters {
  std::uint64_t received = 0;  ///< increments without repetitions
  std::uint64_t accepted = 0, refused = 0;
  std::uint64_t repaired = 0;  ///< arrived only by repetition
  std::uint64_t lost = 0;      ///< numbered by the user, and never arrived
  std::uint64_t commands = 0, commands_refused = 0;
};

struct InboxCounters {
  std::uint64_t joins = 0, joins_refused = 0, leaves = 0, liveliness_lost = 0, lease_ends = 0;
  std::uint64_t joins_put_off = 0;  ///< not answered by a server that is about to end
  std::uint64_t commands = 0, commands_refused = 0, commands_deferred = 0;
  std::uint64_t commands_overdue = 0;  ///< applied without increments that were sent before them
  std::uint64_t increments = 0, accepted = 0;  ///< arrived for the first time; of these taken
  std::uint64_t repeats = 0;                   ///< arrived again: repetition repairs a lossy link
  std::uint64_t repaired = 0;                  ///< arrived only by repetition
  std::uint64_t lost = 0;                      ///< numbered by their sender, and never arrived
  std::uint64_t foreign = 0;  ///< sent for a user that another participant joined as
  std::array<std::uint64_t, kRefusalCount> refused{};  ///< increments, by Refusal
  std::uint64_t refusals_untold = 0;
  std::uint64_t longest_backlog = 0;  ///< increments that waited for a later tick, at most

  std::uint64_t refused_in_all() const;
};

/// The result of one drain for the tick. The decisions are already applied, in this order.
struct Intake {
  std::vector<Decision> decisions;
  std::vector<Increment> increments;  ///< checked; per user in rising sequence
  std::vector<JoinReply> join_replies;
  std::vector<Reply> replies;
  std::vector<RefusedIncrement> refused;
  std::vector<UploadState> uploads;                ///< news of them
  std::vector<Ack> acks;                           ///< one per user that sent increments, by user
  std::vector<std::string> turned_away;            ///< by the transport, in words
  bool follower_came = false, superseded = false;  ///< see ServerInput
  std::string superseded_by;
  bool joined = false;  ///< a user has joined: a snapshot is due

  void clear();
};

}  // namespace mortise
