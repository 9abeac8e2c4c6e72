#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "client/client_update.h"

namespace mortise {

/// What is known of the open clashes after an event. A review tells who looked, not who moved: that
/// stays as it was.
void note_event(const ClashEvent& event, std::map<ClashId, ClashEvent>& open);

/// The clash events of a session without gap and repeat, and the clashes that are open after them.
/// Waits for the events of a gap for a short time, and then for a snapshot that covers them.
class EventStream {
 public:
  /// Both must outlive this.
  EventStream(const ClientOptions& options, ClientStatistics& statistics)
      : options_(options), statistics_(statistics) {}

  void collect(const std::vector<ClashEvent>& events);
  /// Applies what is in order now.
  void apply(ClientUpdate& update);
  void take(const Snapshot& snapshot, ClientUpdate& update);
  /// The server has announced the event with this number.
  void expect(std::uint64_t seq);
  /// At the end of a poll: a snapshot takes the place of a gap that has lasted too long.
  void watch_gap(std::int64_t now_ns, ClientUpdate& update);
  /// Another user has this id now.
  void forget_user(UserId id);
  void forget_server();

  const std::map<ClashId, ClashEvent>& open_clashes() const { return open_clashes_; }
  bool has_snapshot() const { return has_snapshot_; }
  /// No gap has lasted for long.
  bool synced() const { return synced_; }
  std::uint64_t highest_announced() const;

 private:
  void apply_snapshot(const Snapshot& snapshot, ClientUpdate& update);

  const ClientOptions& options_;
  ClientStatistics& statistics_;
  std::map<ClashId, ClashEvent> open_clashes_;
  std::map<std::uint64_t, ClashEvent> pending_;  ///< events beyond a gap, by seq
  std::optional<Snapshot> held_snapshot_;        ///< ahead of events that may still arrive
  std::uint64_t seq_ = 0;                        ///< applied up to here
  std::uint64_t known_seq_ = 0;                  ///< highest event that the server has announced
  bool has_snapshot_ = false, synced_ = false;
  std::optional<std::int64_t> gap_since_ns_;
};

}  // namespace mortise
