// Figure 1b of the paper, played: the travel since the contact depends on the direction from which
// a part came, overlap and generalized depth do not.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/golden/played_session.h"

namespace mortise {
namespace {

TEST(PaperPlay, TravelDependsOnTheDirectionAndDepthDoesNot) {
  const auto scenarios = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios";
  const auto session =
      test::play_session(scenarios / "paper_fig1b.yaml", scenarios / "paper_fig1b.play.yaml");
  ASSERT_TRUE(session) << session.error().text;
  struct Travel {
    double path_mm, normal_mm;
  };
  const std::map<std::string, Travel> expected = {
      {"a_straight", {0.1, 0.1}}, {"a_slanted", {0.2, 0.1}}, {"a_across", {5.0, 0.0}}};
  std::size_t told = 0;
  for (const TickRecord& record : session->ticks)
    for (const ClashEvent& event : record.report.events) {
      if (event.kind != ClashEvent::Kind::kBegin) continue;
      const World& world = session->scene.world;
      const std::string a = world.find(event.part_a)->name, b = world.find(event.part_b)->name;
      const auto of = expected.contains(a) ? expected.find(a) : expected.find(b);
      ASSERT_NE(of, expected.end());
      SCOPED_TRACE(of->first);
      ++told;
      const Verdict& v = event.verdict;
      EXPECT_EQ(v.collision_class, CollisionClass::kReal);
      EXPECT_NEAR(v.delta_mm.lo, 0.1, 1e-6);
      EXPECT_NEAR(v.gpd_mm.lo, 0.1, 1e-6);
      EXPECT_NEAR(v.gpd_mm.hi, 0.1, 1e-6);
      EXPECT_NEAR(v.travel_mm, of->second.path_mm, 1e-5);
      EXPECT_NEAR(v.normal_travel_mm, of->second.normal_mm, 1e-5);
    }
  EXPECT_EQ(told, 3U);
}

}  // namespace
}  // namespace mortise
