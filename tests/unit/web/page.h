#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "client/web/feed.h"

namespace mortise::web {

/// A page that takes what it is told, and may leave poses lying for a while.
struct Page final : Viewer {
  explicit Page(Role r) : may_be(r) {}
  Role role() const override { return may_be; }
  const std::string& bound_name() const override { return bound; }
  void say(SharedBytes text) override { outbox.say(std::move(text)); }
  void say_views(SharedBytes text) override { outbox.say_views(std::move(text)); }
  void changed(const std::vector<PartId>& parts, SharedBytes frame) override {
    outbox.changed(parts, std::move(frame));
  }
  void show_scene(SharedBytes scene) override {
    outbox.forget_changes();
    outbox.say(std::move(scene));
  }
  std::uint64_t folded_frames() const override { return outbox.folded(); }

  void take(const Feed& feed) {
    while (auto message = outbox.next(
               [&](const std::vector<PartId>& parts) { return feed.frame(*this, parts); })) {
      if (!message->binary) {
        told.push_back(Json::parse(*message->bytes));
        continue;
      }
      const auto frame = read_pose_frame(*message->bytes);
      ASSERT_TRUE(frame);
      ++frames;
      for (const PartState& part : frame->parts) seen[part.part] = part;
    }
  }
  /// The last message of a type; null when there is none.
  Json last(const std::string& type) const {
    for (auto at = told.rbegin(); at != told.rend(); ++at)
      if ((*at)["type"] == type) return *at;
    return nullptr;
  }
  std::size_t count(const std::string& type) const {
    return static_cast<std::size_t>(std::count_if(
        told.begin(), told.end(), [&](const Json& json) { return json["type"] == type; }));
  }

  Role may_be;
  std::string bound;
  Outbox outbox;
  std::vector<Json> told;
  std::map<PartId, PartState> seen;
  std::size_t frames = 0;
  bool reads = true;
};

}  // namespace mortise::web
