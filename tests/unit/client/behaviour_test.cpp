#include "client/bot/behaviour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mortise {
namespace {

constexpr double kBeat_s = 1.0 / 60.0;
constexpr UserId kSelf{1}, kOther{2};

/// A server that gives what is asked for (unless somebody else holds it) and lets every increment
/// pass.
class Stage {
 public:
  Stage() {
    add("wall", false, {0, 0, 0});
    add("peg", true, {0, 0, 40});
    add("cap", true, {50, 0, 0});
  }
  void add(const std::string& name, bool moving, const Vec3& at) {
    KnownPart part;
    part.info.part = PartId{static_cast<std::uint32_t>(parts.size()) + 1};
    part.info.name = name;
    part.info.moving = moving;
    part.info.X_WP = Pose::translation(at);
    part.info.radius_mm = 10.0;
    parts[part.info.part] = part;
  }
  /// Plays for `seconds` or until the behaviour has nothing left to do.
  void play(Behaviour& behaviour, double seconds, double beat_s = kBeat_s) {
    for (double end_s = time_s + seconds; time_s < end_s && !done; time_s += beat_s) {
      View view;
      view.time_s = time_s;
      view.beat_s = beat_s;
      view.self = kSelf;
      view.parts = &parts;
      const Wish wish = behaviour.beat(view);
      done = wish.done;
      if (wish.grab) {
        ++grabs;
        last_grab = wish.grab;
        UserId& holder = parts.at(wish.grab).info.holder;
        if (!holder) holder = kSelf;
      }
      if (wish.move) {
        ASSERT_TRUE(view.holds(wish.move)) << "moves what it does not hold";
        parts.at(wish.move).info.X_WP.p += wish.translation_mm;
        turned_rad += wish.rotation_rad;
        longest_mm = std::max(longest_mm, wish.translation_mm.norm());
        path.push_back(wish.translation_mm);
      }
      if (wish.release) {
        ++releases;
        parts.at(wish.release).info.holder = UserId{};
      }
    }
  }
  Vec3 at(std::uint32_t part) const { return parts.at(PartId{part}).info.X_WP.p; }

  std::map<PartId, KnownPart> parts;
  double time_s = 0.0, longest_mm = 0.0;
  int grabs = 0, releases = 0;
  PartId last_grab;
  bool done = false;
  Vec3 turned_rad = Vec3::Zero();
  std::vector<Vec3> path;
};

Play play_of(const std::string& yaml) {
  auto play = read_play_text(yaml, "test");
  EXPECT_TRUE(play) << play.error().text;
  return *play;
}

TEST(Script, PlaysItsActsExactlyAtAnyBeat) {
  const Play play = play_of(R"(
acts:
  - user: anna
    part: peg
    steps:
      - {by: [0, 0, -30], seconds: 0.7}
      - {seconds: 0.3}
      - {rotate_deg: [0, 0, 90], by: [1, 2, 3], seconds: 0.41}
  - {user: ben, part: cap, steps: [{by: [9, 9, 9], seconds: 1}]}
  - {user: anna, part: cap, at: 2, steps: [{by: [-5, 0, 0], seconds: 0.2}]}
)");
  EXPECT_EQ(play.users(), (std::vector<std::string>{"anna", "ben"}));
  EXPECT_NEAR(play.seconds(), 2.2, 1e-12);
  for (double beat_s : {1.0 / 60, 1.0 / 240, 0.5}) {
    Stage stage;
    Script script(play, "anna");
    stage.play(script, 60.0, beat_s);
    EXPECT_TRUE(stage.done);
    EXPECT_LT((stage.at(2) - Vec3(1, 2, 13)).norm(), 1e-12) << beat_s;
    EXPECT_LT((stage.at(3) - Vec3(45, 0, 0)).norm(), 1e-12);
    EXPECT_LT((stage.turned_rad - Vec3(0, 0, std::numbers::pi / 2)).norm(), 1e-12);
    EXPECT_EQ(stage.releases, 2);
    EXPECT_LE(stage.longest_mm, 30.0 / 0.7 * 0.05 + 1e-9) << "leaps after a long beat";
    EXPECT_TRUE(script.troubles().empty());
    EXPECT_GE(stage.time_s, 2.2);
  }
}

TEST(Script, SaysWhatItCouldNotDoAndGoesOn) {
  const Play play = play_of(R"(
acts:
  - {user: anna, part: nowhere, steps: [{by: [1, 0, 0], seconds: 1}]}
  - {user: anna, part: cap, steps: [{by: [1, 0, 0], seconds: 1}]}
  - {user: anna, part: peg, steps: [{by: [1, 0, 0], seconds: 1}]}
)");
  Stage stage;
  stage.parts.at(PartId{3}).info.holder = kOther;
  Script script(play, "anna");
  stage.play(script, 60.0);
  EXPECT_TRUE(stage.done);
  ASSERT_EQ(script.troubles().size(), 2U);
  EXPECT_NE(script.troubles()[0].find("nowhere"), std::string::npos);
  EXPECT_NE(script.troubles()[1].find("cap"), std::string::npos);
  EXPECT_NEAR(stage.at(2).x(), 1.0, 1e-12);
}

TEST(Behaviours, TheSameSeedGivesTheSamePathAndAnotherSeedAnother) {
  for (const char* kind : {"wander", "shake", "fight"}) {
    const auto path = [&](std::uint64_t seed, std::size_t index) {
      Stage stage;
      const auto behaviour = make_behaviour({kind, "u", index, seed, PartId{2}, nullptr});
      stage.play(*behaviour, 3.0);
      return stage.path;
    };
    EXPECT_EQ(path(1, 0), path(1, 0)) << kind;
    EXPECT_NE(path(1, 0), path(2, 0)) << kind;
    EXPECT_NE(path(1, 0), path(1, 1)) << kind;
    EXPECT_GT(path(1, 0).size(), 30U) << kind;
  }
}

TEST(Behaviours, InsertGoesToTheNeighbourAndBack) {
  Stage stage;
  const auto behaviour = make_behaviour({"insert", "u", 0, 1, PartId{2}, nullptr});
  double lowest = 40.0;
  for (int i = 0; i < 300; ++i) {
    stage.play(*behaviour, kBeat_s);
    lowest = std::min(lowest, stage.at(2).z());
  }
  EXPECT_NEAR(lowest, 0.0, 0.1);
  EXPECT_NEAR(stage.at(2).x(), 0.0, 1e-9);
}

TEST(Behaviours, ARefusedUserTriesTheNextPartAndAFighterTheSame) {
  Stage stage;
  stage.parts.at(PartId{2}).info.holder = kOther;
  const auto wander = make_behaviour({"wander", "u", 0, 1, PartId{}, nullptr});
  stage.play(*wander, 2.0);
  EXPECT_EQ(stage.last_grab, PartId{3});
  EXPECT_FALSE(stage.path.empty());

  Stage ring;
  ring.parts.at(PartId{2}).info.holder = kOther;
  const auto fight = make_behaviour({"fight", "u", 3, 1, PartId{}, nullptr});
  ring.play(*fight, 3.0);
  EXPECT_GE(ring.grabs, 5);
  EXPECT_EQ(ring.last_grab, PartId{2});
  EXPECT_TRUE(ring.path.empty());
  ring.parts.at(PartId{2}).info.holder = UserId{};
  ring.play(*fight, 10.0);
  EXPECT_GE(ring.releases, 2);
}

TEST(Behaviours, ALostPartIsNotMovedOn) {
  Stage stage;
  const auto wander = make_behaviour({"wander", "u", 0, 1, PartId{2}, nullptr});
  stage.play(*wander, 1.0);
  const std::size_t before = stage.path.size();
  stage.parts.at(PartId{2}).info.holder = kOther;
  stage.play(*wander, 2.0);  // the stage fails the test when it moves
  EXPECT_EQ(stage.path.size(), before);
}

}  // namespace
}  // namespace mortise
