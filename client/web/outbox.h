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

/// What one browser has still to be sent. Text is kept, in order, whatever it costs: the owner
/// closes who does not take it. Of poses only the newest of each part is kept, so a browser that is
/// slow is behind by one frame and by no part.
class Outbox {
 public:
  struct Message {
    SharedBytes bytes;
    bool binary = false;
  };
  /// A pose frame of these parts as they are now.
  using Encode = std::function<SharedBytes(const std::vector<PartId>&)>;

  void say(SharedBytes text);
  /// In the place of the last such text, if that is still here.
  void say_views(SharedBytes text) { views_ = std::move(text); }
  /// These parts have changed; `frame` is a frame of exactly them.
  void changed(const std::vector<PartId>& parts, SharedBytes frame);
  /// A text that was said holds all poses: what changed before is covered.
  void forget_changes();

  bool empty() const { return texts_.empty() && !views_ && parts_.empty(); }
  /// What to write now: text before poses.
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
