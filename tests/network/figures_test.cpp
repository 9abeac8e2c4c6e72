// What the network costs, printed; asserted is only that all arrives. The bars are held by
// `./mortise bench session`.
#include <gtest/gtest.h>

#include <cstdio>

#include "client/client.h"
#include "tests/network/frozen_reader.h"
#include "tests/network/large_scene.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

DdsOptions options_for_this_test() {
  return options_for_test(testing::UnitTest::GetInstance()->current_test_info()->name());
}

TEST(NetworkFigures, TicksHeldWithAStoppedReader) {
  const DdsOptions options = options_for_this_test();
  FrozenReader reader(options);
  ASSERT_TRUE(reader.both_joined());
  const auto beat = [&] { reader.busy_turn(); };
  Beat without, with;
  without.run(2.0 * effort(1), 240.0, beat);
  reader.stop();
  with.run(2.0 * effort(1), 240.0, beat);
  reader.go_on();
  const double ratio = static_cast<double>(with.held) / static_cast<double>(without.held);
  std::printf("ticks held with a stopped reader %llu of %llu, without %llu: ratio %.4f\n",
              static_cast<unsigned long long>(with.held), static_cast<unsigned long long>(with.due),
              static_cast<unsigned long long>(without.held), ratio);
  EXPECT_EQ(reader.channel->counters().send_failed, 0u);
  EXPECT_TRUE(reader.all_heard());
}

TEST(NetworkFigures, LateJoin) {
  const DdsOptions options = options_for_this_test();
  auto channel = open_server_channel(options);
  ASSERT_TRUE(channel) << channel.error().text;
  SmallServer server(**channel, options.session, 200);
  std::vector<double> took_s;
  for (int i = 0; i < effort(12); ++i) {
    auto own_channel = open_client_channel(options);
    ASSERT_TRUE(own_channel) << own_channel.error().text;
    const double start_s = now_s();
    Client late(**own_channel);
    late.add_user("late" + std::to_string(i), "observer");
    ASSERT_TRUE(until(
        8.0, [&] { return late.synced() && late.user_id(0); },
        [&] {
          server.turn();
          server.publish_events(1);
          late.poll();
        }));
    took_s.push_back(now_s() - start_s);
    ASSERT_EQ(late.parts().size(), 200u);
  }
  std::printf("late join of %zu, one after another: p50 %.3f p99 %.3f s\n", took_s.size(),
              percentile(took_s, 0.5), percentile(took_s, 0.99));
}

TEST(NetworkFigures, FiftyMegabytesForEightAtOnce) {
  const auto served = serve_scene(options_for_this_test(), 10, 8);
  ASSERT_TRUE(served) << served.error().text;
  ASSERT_EQ(served->whole, 8) << "a scene did not arrive";
  std::printf(
      "%.1f MB for 8 at once: slowest %.2f s; tick lateness p99 %.3f ms, undisturbed %.3f ms\n",
      static_cast<double>(served->bytes) * 1e-6, served->slowest_s, served->lateness_p99_ms,
      served->undisturbed_p99_ms);
}

}  // namespace
}  // namespace mortise::test
