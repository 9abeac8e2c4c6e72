// Random pairs: the word for a pair is the same whether a whole assembly is looked over with little
// work, as `mortise check` does, or it is judged by itself.
#include <gtest/gtest.h>

#include <map>

#include "common/session/tick/judge_world.h"
#include "common/session/tick/judgement.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/mixed_pairs.h"

namespace mortise {
namespace {

// What check spends on all pairs, and on those that this leaves open.
constexpr std::uint64_t kFirstWork = 3'000, kTellWork = 30'000;

World world_of(const OverlapCase& c) {
  World world;
  const auto add = [&](const char* name, const SolidPtr& solid, const SurfaceBand& band,
                       const Pose& X_WP) {
    Part part;
    part.id = PartId{static_cast<std::uint32_t>(world.parts.size() + 1)};
    part.name = name;
    part.solid = solid;
    part.band = band;
    part.X_WP_scenario = part.X_WP = X_WP;
    world.parts.push_back(std::move(part));
  };
  add("a", c.a, c.band_a, c.X_WA);
  add("b", c.b, c.band_b, c.X_WB);
  world.evaluates = true;
  return world;
}

CollisionClass word_of(const PairVerdicts& pair) {
  return pair.verdicts.empty() ? CollisionClass::kNone : pair.verdicts.front().collision_class;
}

CollisionClass word_of(const JudgeReport& report) {
  return report.pairs.empty() ? CollisionClass::kNone : word_of(report.pairs.front());
}

TEST(SameWord, OfAnAssemblyAndOfThePair) {
  cover_parts::Random random(5);
  std::map<CollisionClass, int> found;
  for (int i = 0; i < test::effort(230); ++i) {
    const int grade = i % mixed::kGradesOf;
    World world =
        world_of(i % 4 != 0 ? mixed::coarse_case(random, grade) : mixed::any_case(random, grade));
    Scratch scratch;
    // Without the ways out, which take most of the time and change no word.
    const CollisionClass judged =
        word_of(judge_assembly(world, scratch, JudgementQuery().work_cap).report);
    if (i % 20 == 0) {
      EXPECT_EQ(judged, word_of(judge_world(world, scratch, false))) << i;
    }
    CollisionClass checked = word_of(judge_assembly(world, scratch, kFirstWork).report);
    if (checked == CollisionClass::kPotential)
      checked = word_of(tell_pair(world, PartId{1}, PartId{2}, kTellWork, scratch));
    EXPECT_EQ(judged, checked) << i << ", " << mixed::kGrades[grade];
    ++found[judged];
  }
  for (const auto& [which, count] : found) std::printf("%d of class %d, ", count, int(which));
  std::printf("\n");
  EXPECT_GT(found[CollisionClass::kFake], test::effort(5));
  EXPECT_GT(found[CollisionClass::kReal], test::effort(30));
}

}  // namespace
}  // namespace mortise
