// Back-pressure: whatever the pace of a browser, no event is lost or overtaken and no part is left
// stale.
#include "client/web/outbox.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace mortise::web {
namespace {

SharedBytes bytes(const std::string& text) { return std::make_shared<const std::string>(text); }

Outbox::Encode never() {
  return [](const std::vector<PartId>&) {
    ADD_FAILURE() << "nothing was folded";
    return bytes("");
  };
}

TEST(Outbox, SendsTextInOrderAndBeforePoses) {
  Outbox box;
  EXPECT_TRUE(box.empty());
  box.changed({PartId{1}}, bytes("frame"));
  box.say(bytes("one"));
  box.say_views(bytes("views"));
  box.say(bytes("two"));
  EXPECT_EQ(box.unsent_bytes(), 6u);
  EXPECT_EQ(*box.next(never())->bytes, "one");
  EXPECT_EQ(*box.next(never())->bytes, "two");
  const auto frame = box.next(never());
  EXPECT_EQ(*frame->bytes, "frame");
  EXPECT_TRUE(frame->binary);
  EXPECT_EQ(*box.next(never())->bytes, "views");
  EXPECT_FALSE(box.next(never()));
  EXPECT_EQ(box.unsent_bytes(), 0u);
  EXPECT_EQ(box.folded(), 0u);
}

TEST(Outbox, FoldsFramesThatWaitIntoOneOfAllTheirParts) {
  Outbox box;
  box.changed({PartId{2}, PartId{5}}, bytes("a"));
  box.changed({PartId{1}, PartId{5}}, bytes("b"));
  std::vector<PartId> asked;
  const auto frame = box.next([&](const std::vector<PartId>& parts) {
    asked = parts;
    return bytes("folded");
  });
  EXPECT_EQ(*frame->bytes, "folded");
  EXPECT_EQ(asked, (std::vector<PartId>{PartId{1}, PartId{2}, PartId{5}}));
  EXPECT_EQ(box.folded(), 1u);
  box.changed({PartId{3}}, bytes("c"));  // nothing of before comes along
  EXPECT_EQ(*box.next(never())->bytes, "c");
}

TEST(Outbox, KeepsTheNewestViewsOnly) {
  Outbox box;
  box.say_views(bytes("old"));
  box.say_views(bytes("new"));
  EXPECT_EQ(*box.next(never())->bytes, "new");
  EXPECT_FALSE(box.next(never()));
}

TEST(Outbox, ASceneCoversWhatChangedBeforeIt) {
  Outbox box;
  box.changed({PartId{1}}, bytes("old"));
  box.forget_changes();
  box.say(bytes("scene"));
  EXPECT_EQ(*box.next(never())->bytes, "scene");
  EXPECT_FALSE(box.next(never()));
}

// A world of numbers instead of poses; a browser that reads whenever chance will have it.
TEST(Outbox, LeavesNoPartStaleAtAnyPace) {
  std::mt19937 random(11);
  for (int round = 0; round < 200; ++round) {
    std::map<PartId, int> world, seen;
    std::vector<int> events_said, events_seen;
    Outbox box;
    const auto encode = [&](const std::vector<PartId>& parts) {
      std::string text;
      for (const PartId part : parts)
        text += std::to_string(part.value) + " " + std::to_string(world[part]) + " ";
      return bytes(text);
    };
    const auto read = [&] {
      const auto message = box.next(encode);
      if (!message) return false;
      std::istringstream in(*message->bytes);
      if (!message->binary) {
        int event = 0;
        in >> event;
        events_seen.push_back(event);
      } else {
        std::uint32_t part = 0;
        int value = 0;
        while (in >> part >> value) seen[PartId{part}] = value;
      }
      return true;
    };
    const auto pace = 1 + random() % 10;
    for (int tick = 1; tick <= 100; ++tick) {
      std::vector<PartId> changed;
      for (std::uint32_t part = 1; part <= 8; ++part) {
        if (random() % 4 != 0) continue;
        world[PartId{part}] = tick;
        changed.push_back(PartId{part});
      }
      if (!changed.empty()) box.changed(changed, encode(changed));
      if (random() % 3 == 0) {
        events_said.push_back(tick);
        box.say(bytes(std::to_string(tick)));
      }
      if (random() % pace == 0) read();
    }
    while (read()) {
    }
    EXPECT_EQ(seen, world);
    EXPECT_EQ(events_seen, events_said);
  }
}

}  // namespace
}  // namespace mortise::web
