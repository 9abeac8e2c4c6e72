#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "client/client.h"

namespace mortise {

/// Time from an increment to the events that it caused. An event names its mover and tick; the
/// acknowledgement of that tick names the newest increment in it and when it was sent. The two
/// arrive by different topics, in either order.
class EventDelay {
 public:
  /// Delays of this poll, ms. Events of others are not looked at.
  std::vector<double> add(const ClientUpdate& update, const Client& client);
  /// Own events without an increment in the same tick (for example an undo), or whose
  /// acknowledgement was lost.
  std::uint64_t unmatched() const { return unmatched_; }

 private:
  using Key = std::pair<LocalUser, std::uint64_t>;  ///< user, tick
  struct Waiting {
    Key key;
    std::int64_t seen_ns = 0;
  };
  std::map<Key, std::int64_t> sent_ns_;
  std::deque<Key> order_;
  std::vector<Waiting> waiting_;
  std::uint64_t unmatched_ = 0;
};

}  // namespace mortise
