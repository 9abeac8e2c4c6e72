// The state hash stands for poses, holders and open clashes, whatever way led there.
#include <gtest/gtest.h>

#include "common/session/memory/session_state.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

struct StateHashTest : ::testing::Test {
  SessionBuilder session{Policy::kReport};
  Scratch scratch;
  UserId ada = session.join("ada");
  PartId one = session.add("one", cube_mesh(2), at(0, 0, 0), true);
  PartId other = session.add("other", cube_mesh(2), at(10, 0, 0), true);

  StateHashTest() {
    session.grab(ada, one);
    session.grab(ada, other);
  }
  std::uint64_t tick(const std::vector<Increment>& increments = {}) {
    return play_tick(session.world, increments, scratch).state_hash;
  }
  Increment push(PartId part, double x_mm) { return session.push(ada, part, Vec3(x_mm, 0, 0)); }
};

TEST_F(StateHashTest, AnyWayToTheSamePosesGivesTheSame) {
  tick({push(one, 1.0)});
  tick({push(other, 2.0)});
  const std::uint64_t here = tick({push(one, 1.0)});
  SessionBuilder again(Policy::kReport);
  again.join("ada");
  again.add("one", cube_mesh(2), at(2, 0, 0), true);
  again.add("other", cube_mesh(2), at(12, 0, 0), true);
  again.grab(ada, one);
  again.grab(ada, other);
  std::uint64_t there = 0;
  for (int i = 0; i < 3; ++i) there = play_tick(again.world, {}, scratch).state_hash;
  EXPECT_EQ(here, there);
}

TEST_F(StateHashTest, EveryPoseAndHolderCounts) {
  // Worlds that differ in one thing, each after one tick.
  const auto hash_of = [](double x_one, double x_other, bool held) {
    SessionBuilder s(Policy::kReport);
    const UserId user = s.join("ada");
    const PartId part = s.add("one", cube_mesh(2), at(x_one, 0, 0), true);
    s.add("other", cube_mesh(2), at(x_other, 0, 0), true);
    if (held) s.grab(user, part);
    Scratch memory;
    return play_tick(s.world, {}, memory).state_hash;
  };
  const std::uint64_t base = hash_of(5, 10, false);
  EXPECT_EQ(hash_of(5, 10, false), base);
  EXPECT_NE(hash_of(5.0 + 1e-12, 10, false), base);
  EXPECT_NE(hash_of(5, 10.0 + 1e-12, false), base);
  EXPECT_NE(hash_of(10, 5, false), base) << "two equal parts have changed places";
  EXPECT_NE(hash_of(5, 10, true), base);
}

TEST_F(StateHashTest, MovesAndHoldersAreFollowed) {
  const std::uint64_t before = tick();
  const std::uint64_t moved = tick({push(one, 1.0)});
  const std::uint64_t idle = tick();
  EXPECT_NE(before, moved);
  session.command(ada, other, CommandKind::kRelease);
  EXPECT_NE(tick(), idle);
  const std::uint64_t parts = session.world.state->parts_hash;
  tick({push(one, -1.0)});
  EXPECT_NE(session.world.state->parts_hash, parts);
  tick({push(one, 1.0)});
  EXPECT_EQ(session.world.state->parts_hash, parts) << "back where it was";
}

}  // namespace
}  // namespace mortise
