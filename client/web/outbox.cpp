#include "client/web/outbox.h"

#include <utility>

namespace mortise::web {

void Outbox::say(SharedBytes text) {
  unsent_bytes_ += text->size();
  texts_.push_back(std::move(text));
}

void Outbox::changed(const std::vector<PartId>& parts, SharedBytes frame) {
  if (parts_.empty()) {
    frame_ = std::move(frame);
  } else {
    frame_.reset();
    ++folded_;
  }
  parts_.insert(parts.begin(), parts.end());
}

void Outbox::forget_changes() {
  parts_.clear();
  frame_.reset();
}

std::optional<Outbox::Message> Outbox::next(const Encode& encode) {
  if (!texts_.empty()) {
    SharedBytes text = std::move(texts_.front());
    texts_.pop_front();
    unsent_bytes_ -= text->size();
    return Message{std::move(text), false};
  }
  if (!parts_.empty()) {
    SharedBytes frame = frame_ ? std::move(frame_) : encode({parts_.begin(), parts_.end()});
    forget_changes();
    return Message{std::move(frame), true};
  }
  if (views_) return Message{std::exchange(views_, nullptr), false};
  return std::nullopt;
}

}  // namespace mortise::web
