// Bots that insert parts with a trembling hand, against the real tick loop, as fast as it goes.
#include "client/bot/guided.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "common/io/scenario/scene_load.h"
#include "common/messages/memory_channel.h"
#include "server/tick_loop.h"

namespace mortise {
namespace {

// Two pegs of 10 um less radius than their bores, one from above and one, askew, from below.
constexpr const char* kGuided = R"(
name: guided
units: mm
policy: stop
max_jump: 20
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 32}
    instances:
      - {name: plate_1, pose: {position: [0, 0, 0]}}
      - {name: plate_2, pose: {position: [90, 0, 0], rotation_deg: [0, 40, 0]}}
  - name: peg
    generator: {kind: dowel, diameter: 19.98, length: 40, chamfer: 1, facets: 32, phase_deg: 5.625}
    moving: true
    instances:
      - {name: peg_1, pose: {position: [30, 10, 40]}}
      - {name: peg_2, pose: {position: [70, 5, -80], rotation_deg: [0, 20, 10]}}
)";

/// Time passes by ticks alone.
class StepClock : public Clock {
 public:
  std::int64_t now_ns() override { return ns; }
  std::int64_t wall_ns() override { return ns; }
  void sleep_until_ns(std::int64_t deadline_ns) override { ns = std::max(ns, deadline_ns); }
  std::int64_t ns = 1'000'000'000;
};

/// What became of the tries of two bots.
std::vector<Insertions> insert(const std::string& policy, const GuidedSettings& wanted) {
  std::string yaml = kGuided;
  yaml.replace(yaml.find("policy: stop"), 12, "policy: " + policy);
  auto reading = read_scenario_text(yaml, "guided.yaml");
  EXPECT_TRUE(reading) << reading.error().text;
  auto scene = load_scene(reading->scenario, default_meshes());
  EXPECT_TRUE(scene) << scene.error().text;
  MemoryHub hub;
  const auto server = hub.open_server();
  StepClock clock;
  TickLoop loop(scene->world, *server, clock, nullptr, {});
  loop.open();
  const auto channel = hub.open_client();
  Client client(*channel, {}, [&] { return clock.ns; });
  std::vector<std::unique_ptr<Behaviour>> bots;
  for (std::size_t user = 0; user < 2; ++user) {
    client.add_user("bot" + std::to_string(user), "bot");
    GuidedSettings settings = wanted;
    settings.first = user;
    settings.seed += user;
    bots.push_back(make_guided(settings));
  }
  bool all_done = false;
  for (int tick = 0; tick < 60 * 600 && !all_done; ++tick) {
    clock.ns += 1'000'000'000 / 60;
    loop.tick();
    client.poll();
    all_done = true;
    for (LocalUser user = 0; user < 2; ++user) {
      View view;
      view.time_s = static_cast<double>(clock.ns) * 1e-9;
      view.beat_s = 1.0 / 60.0;
      view.self = client.user_id(user);
      view.parts = &client.parts();
      view.standing = &client.standing();
      view.features = &client.features();
      if (!view.self) {
        all_done = false;
        continue;
      }
      const Wish wish = bots[user]->beat(view);
      all_done &= wish.done;
      if (wish.grab) client.grab(user, wish.grab);
      if (wish.move) client.send(user, wish.move, wish.translation_mm, wish.rotation_rad);
      for (const Wish::Ask& ask : wish.asks) client.command(user, ask.kind, ask.part, ask.details);
      if (wish.release) client.release(user, wish.release);
    }
  }
  EXPECT_TRUE(all_done);
  std::vector<Insertions> results;
  for (const auto& bot : bots) {
    for (const std::string& trouble : bot->troubles()) ADD_FAILURE() << trouble;
    results.push_back(*bot->insertions());
  }
  return results;
}

TEST(GuidedBots, InsertAlwaysWhenAligned) {
  GuidedSettings settings;
  settings.tries = 2;
  for (const Insertions& count : insert("stop", settings)) {
    EXPECT_EQ(count.tries, 2U);
    EXPECT_EQ(count.inserted, 2U);
    EXPECT_EQ(count.not_aligned + count.stuck, 0U);
    EXPECT_EQ(count.seconds.size(), 2U);
  }
}

TEST(GuidedBots, GetStuckByFreeHandAtTheFirstContact) {
  GuidedSettings settings;
  settings.tries = 1;
  settings.free_hand = true;
  for (const Insertions& count : insert("stop", settings)) {
    EXPECT_EQ(count.tries, 1U);
    EXPECT_EQ(count.stuck, 1U) << "a clearance of 10 um is below what a hand can do";
  }
}

}  // namespace
}  // namespace mortise
