// A slide never ends deeper than a stop would: random pushes, both ways from the same poses. Depth
// by the separating-axis test of boxes, unknown to the engine.
#include <gtest/gtest.h>

#include "tests/support/box_overlap.h"
#include "tests/support/effort.h"
#include "tests/unit/session/random_play.h"

namespace mortise {
namespace {

// The same parts at the same poses under another policy, nothing remembered.
World as_new(const World& world, Policy policy) {
  World copy = world;
  copy.state.reset();
  copy.policy = policy;
  copy.tick = 0;
  return copy;
}

struct Slid {
  std::uint64_t pushes = 0, slid = 0, legs = 0, cut_short = 0;
  double deepest_mm = -1e300, deeper_mm = -1e300, farther_mm = 0.0;
};

// One mover among walls and posts, `pushes` times somewhere.
void play(std::uint64_t seed, int ticks, int movers, Slid& outcome) {
  RandomPlay slide(Policy::kSlide, seed, movers, false);
  Scratch scratch;
  for (int i = 0; i < ticks; ++i) {
    const std::vector<Increment> pushes = slide.pushes();
    World stop = as_new(slide.session.world, Policy::kStop);
    Scratch fresh;
    const Pose before = slide.session.pose(slide.movers[0]);
    play_tick(stop, pushes, fresh);
    const StepReport report = play_tick(slide.session.world, pushes, scratch);
    const double there = deepest_overlap_mm(slide.session.world);
    outcome.pushes += pushes.size();
    outcome.slid += report.counters.slid_parts;
    outcome.legs += report.counters.slide_legs;
    outcome.cut_short += report.counters.slides_cut_short;
    outcome.deepest_mm = std::max(outcome.deepest_mm, there);
    outcome.deeper_mm =
        std::max(outcome.deeper_mm, there - std::max(0.0, deepest_overlap_mm(stop)));
    outcome.farther_mm += (slide.session.pose(slide.movers[0]).p - before.p).norm() -
                          (stop.find(slide.movers[0])->X_WP.p - before.p).norm();
    ASSERT_LE(there, std::max(0.0, deepest_overlap_mm(stop)) + kAccuracyDefault_mm)
        << "seed " << seed << " tick " << i;
    ASSERT_LE(there, 2.0 * kAccuracyDefault_mm) << "seed " << seed << " tick " << i;
  }
}

void tell(const char* what, const Slid& o) {
  std::printf(
      "%s: %llu pushes, %llu parts slid in %llu legs, %llu cut short; deepest %.3g mm, "
      "deeper than stop by %.3g mm at most; %.3g mm farther in all\n",
      what, static_cast<unsigned long long>(o.pushes), static_cast<unsigned long long>(o.slid),
      static_cast<unsigned long long>(o.legs), static_cast<unsigned long long>(o.cut_short),
      o.deepest_mm, o.deeper_mm, o.farther_mm);
}

TEST(SlideProperty, OneMoverNeverEndsDeeperThanUnderStop) {
  Slid outcome;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(24)); ++seed)
    ASSERT_NO_FATAL_FAILURE(play(seed, 50, 1, outcome));
  tell("one mover", outcome);
  EXPECT_GT(outcome.slid, outcome.pushes / 8);
  EXPECT_GT(outcome.farther_mm, 1.0);  // and it does get on
}

TEST(SlideProperty, NorDoSixMovers) {
  Slid outcome;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(test::effort(4)); ++seed)
    ASSERT_NO_FATAL_FAILURE(play(1000 + seed, 25, 6, outcome));
  tell("six movers", outcome);
  EXPECT_GT(outcome.slid, 10U);
}

}  // namespace
}  // namespace mortise
