#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "client/web/frames.h"

namespace mortise::web {

/// What is still to be sent to one browser. Text is kept in order without a limit; the owner closes
/// a browser that does not take it. Of poses only the newest of each part is kept, so a slow
/// browser misses frames but no part.
class Outbox {
 public:
  struct Message {
    SharedBytes bytes;
    bool binary = false;
  };
  /// A pose frame of these parts as they are now.
  using Encode = std::function<SharedBytes(const std::vector<PartId>&)>;

  void say(SharedBytes text);
  /// Replaces the last such text if that has not been sent.
  void say_views(SharedBytes text) { views_ = std::move(text); }
  /// These parts have changed; `frame` is a frame of exactly them.
  void changed(const std::vector<PartId>& parts, SharedBytes frame);
  /// Drops pending poses: the last text contains all of them.
  void forget_changes();

  bool empty() const { return texts_.empty() && !views_ && parts_.empty(); }
  /// The next message to write: text before poses.
  std::optional<Message> next(const Encode& encode);

  std::size_t unsent_bytes() const { return unsent_bytes_; }  ///< of text
  std::uint64_t folded() const { return folded_; }            ///< frames that went into later ones

 private:
  std::deque<SharedBytes> texts_;
  SharedBytes views_;
  std::set<PartId> parts_;
  SharedBytes frame_;  ///< of exactly parts_; none once two were folded
  std::size_t unsent_bytes_ = 0;
  std::uint64_t folded_ = 0;
};

}  // namespace mortise::web
