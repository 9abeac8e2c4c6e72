#include "client/event_stream.h"

#include <algorithm>
#include <utility>

namespace mortise {
namespace {

/// Events beyond a gap that are kept; more are covered by the snapshot that the gap asks for.
constexpr std::size_t kMaxPendingEvents = 65536;

std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace

void note_event(const ClashEvent& event, std::map<ClashId, ClashEvent>& open) {
  if (event.kind == ClashEvent::Kind::kEnd) {
    open.erase(event.clash);
    return;
  }
  ClashEvent& clash = open[event.clash];
  const ClashEvent before = std::exchange(clash, event);
  if (event.kind != ClashEvent::Kind::kReview) return;
  clash.user = before.user;
  clash.cause = before.cause;
}

void EventStream::collect(const std::vector<ClashEvent>& events) {
  for (const ClashEvent& event : events) {
    if ((has_snapshot_ && event.seq <= seq_) || !pending_.emplace(event.seq, event).second) {
      ++statistics_.events_duplicate;
    }
    expect(event.seq);
  }
  while (pending_.size() > kMaxPendingEvents) pending_.erase(pending_.begin());
}

void EventStream::apply(ClientUpdate& update) {
  if (!has_snapshot_) return;
  while (!pending_.empty() && pending_.begin()->first == seq_ + 1) {
    ClashEvent event = std::move(pending_.begin()->second);
    pending_.erase(pending_.begin());
    seq_ = event.seq;
    note_event(event, open_clashes_);
    update.events.push_back(std::move(event));
    ++statistics_.events_applied;
  }
  statistics_.highest_event_seq = seq_;
  if (held_snapshot_ && held_snapshot_->event_seq <= seq_) held_snapshot_.reset();
}

void EventStream::take(const Snapshot& snapshot, ClientUpdate& update) {
  if (!has_snapshot_) return apply_snapshot(snapshot, update);
  if (snapshot.event_seq < seq_) {
    ++statistics_.snapshots_stale;
  } else if (snapshot.event_seq > seq_) {
    // The events in between may still be on their way; watch_gap() decides.
    expect(snapshot.event_seq);
    held_snapshot_ = snapshot;
  }
}

void EventStream::apply_snapshot(const Snapshot& snapshot, ClientUpdate& update) {
  if (has_snapshot_) {
    statistics_.events_skipped += snapshot.event_seq - seq_;
  }
  has_snapshot_ = true;
  seq_ = snapshot.event_seq;
  statistics_.highest_event_seq = seq_;
  known_seq_ = std::max(known_seq_, seq_);
  open_clashes_.clear();
  for (const ClashEvent& clash : snapshot.open_clashes) open_clashes_[clash.clash] = clash;
  // What the snapshot covers is no event any more.
  pending_.erase(pending_.begin(), pending_.upper_bound(seq_));
  held_snapshot_.reset();
  update.resynced = true;
  ++statistics_.snapshots_applied;
}

void EventStream::expect(std::uint64_t seq) { known_seq_ = std::max(known_seq_, seq); }

std::uint64_t EventStream::highest_announced() const { return std::max(known_seq_, seq_); }

void EventStream::watch_gap(std::int64_t now_ns, ClientUpdate& update) {
  const bool open = has_snapshot_ && known_seq_ > seq_;
  if (!open) {
    gap_since_ns_.reset();
    synced_ = has_snapshot_;
    return;
  }
  if (!gap_since_ns_) gap_since_ns_ = now_ns;
  if (now_ns - *gap_since_ns_ < in_ns(options_.resync_after_s)) return;
  if (synced_) ++statistics_.gaps;
  synced_ = false;
  if (!held_snapshot_ || held_snapshot_->event_seq <= seq_) return;
  const Snapshot snapshot = std::move(*held_snapshot_);
  apply_snapshot(snapshot, update);
  apply(update);
  if (known_seq_ == seq_) {
    gap_since_ns_.reset();
    synced_ = true;
  }
}

void EventStream::forget_user(UserId id) {
  const auto forget = [id](UserId& by) {
    if (by == id) by = UserId{};
  };
  for (auto& [clash, event] : open_clashes_) {
    forget(event.user);
    forget(event.review.user);
  }
}

void EventStream::forget_server() {
  pending_.clear();
  held_snapshot_.reset();
  seq_ = known_seq_ = 0;
  has_snapshot_ = synced_ = false;
  gap_since_ns_.reset();
}

}  // namespace mortise
