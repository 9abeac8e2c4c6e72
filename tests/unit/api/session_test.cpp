#include <mortise/mortise.h>

#include "tests/support/programs.h"
#include "tests/unit/api/scene.h"

namespace mortise::test {
namespace {

TEST(Session, APushStopsAtTheFirstRealContact) {
  Session s;
  const PartRef floor = s.add_fixed(cube(10, "floor"));
  const PartRef box = s.add(cube(10, "box"), shift(0, 0, 12));
  s.hold("ann", box);
  const Pushed free = s.push(box, shift(0, 0, -1));
  ASSERT_TRUE(free.status) << why(free.status.error());
  EXPECT_TRUE(free.clashes.empty());
  EXPECT_NEAR(free.X_WP.translation().z(), 11.0, 1e-9);
  const Pushed held = s.push(box, shift(0, 0, -5));
  ASSERT_TRUE(held.status);
  EXPECT_NEAR(held.X_WP.translation().z(), 10.0, 1e-3);
  ASSERT_EQ(held.clashes.size(), 1u);
  EXPECT_EQ(held.clashes[0].part_a, s.name(floor));
  EXPECT_EQ(held.clashes[0].part_b, "box");
  EXPECT_NE(held.clashes[0].id, 0u);
  EXPECT_EQ(s.clashes().size(), 1u);
  EXPECT_EQ(s.pose(box).matrix(), held.X_WP.matrix());
  const Pushed away = s.push(box, shift(0, 0, 5));
  EXPECT_TRUE(away.clashes.empty());
}

TEST(Session, APushActsOnTheLeftInTheWorld) {
  Session s({.policy = "report", .max_jump_mm = 1000});
  const PartRef box = s.add(cube(10, "box"), shift(30, 0, 0));
  s.hold("ann", box);
  const Pose turn = Pose(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()) *
                         Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3)));
  const Pose before = s.pose(box);
  const Pushed pushed = s.push(box, turn);
  ASSERT_TRUE(pushed.status) << why(pushed.status.error());
  EXPECT_LT((pushed.X_WP.matrix() - (turn * before).matrix()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Session, TheSamePushesGiveTheSameHash) {
  const auto play = [](int threads) {
    Session s({.policy = "report", .threads = threads});
    const PartRef in = s.add_fixed(plate());
    const PartRef hand = s.add(peg(), shift(0, 0, 30));
    s.fit(in, "bore", hand, "journal", "H7/g6");
    s.hold("ann", hand);
    std::uint64_t hash = 0;
    for (int i = 0; i < 30; ++i) hash = s.push(hand, shift(0, 0, -1)).state_hash;
    EXPECT_TRUE(s.status());
    return hash;
  };
  EXPECT_NE(play(1), 0u);
  EXPECT_EQ(play(1), play(2));
}

TEST(Session, AFitDecidesWhetherThePegGoesIn) {
  const auto depth_of = [](const std::string& code) {
    Session s;
    const PartRef in = s.add_fixed(plate());
    const PartRef hand = s.add(peg(), shift(0, 0, 30));
    s.fit(in, "bore", hand, "journal", code);
    s.hold("ann", hand);
    for (int i = 0; i < 30; ++i) s.push(hand, shift(0, 0, -1));
    EXPECT_TRUE(s.status()) << why(s.status().error());
    return s.pose(hand).translation().z();
  };
  EXPECT_NEAR(depth_of("H7/g6"), 0.0, 1e-6);
  EXPECT_GT(depth_of("H7/p6"), 5.0);
}

TEST(Session, TheFirstFailureStays) {
  Session s;
  const PartRef none = s.add(Part::from_mesh({}, "empty"));
  EXPECT_FALSE(none);
  ASSERT_FALSE(s.status());
  const std::string first = s.status().error().text;
  EXPECT_NE(first.find("empty"), std::string::npos);
  const PartRef box = s.add(cube(1, "box"));
  EXPECT_FALSE(box);
  EXPECT_EQ(s.push(box, shift(0, 0, 1)).status.error().text, first);
  EXPECT_EQ(s.hold("ann", box).error().text, first);
  EXPECT_EQ(s.judge().error().text, first);
}

TEST(Session, WhatIsWrongIsSaid) {
  const auto said = [](auto act) {
    Session s;
    const PartRef box = s.add(cube(10, "box"));
    act(s, box);
    return s.status() ? std::string() : s.status().error().text;
  };
  EXPECT_EQ(said([](Session& s, PartRef box) { s.push(box, shift(0, 0, 1)); }),
            "nobody holds 'box': hold() it first");
  EXPECT_EQ(said([](Session& s, PartRef) { s.hold("ann", {7}); }),
            "there is no such part in the session");
  EXPECT_NE(said([](Session& s, PartRef box) {
              s.hold("ann", box);
              s.hold("bob", box);
            }).find("is held by 'ann'"),
            std::string::npos);
  EXPECT_NE(said([](Session& s, PartRef box) {
              s.tolerance(box, "no_such", "±0.1");
              s.hold("ann", box);
            }),
            "");
  Pose none = Pose::Identity();
  none.linear().setZero();
  EXPECT_EQ(said([&](Session& s, PartRef box) { s.push(box, none); }),
            "dX_W is no finite rigid motion");
  Session slow({.policy = "bounce"});
  slow.add(cube(1, "a"));
  EXPECT_FALSE(slow.judge());
  EXPECT_FALSE(Session().judge());
}

TEST(Session, APushThatIsTooLongIsRefusedAlone) {
  Session s({.max_jump_mm = 5});
  const PartRef box = s.add(cube(10, "box"));
  s.hold("ann", box);
  EXPECT_FALSE(s.push(box, shift(0, 0, 6)).status);
  EXPECT_TRUE(s.status());
  EXPECT_TRUE(s.push(box, shift(0, 0, 4)).status);
  EXPECT_NEAR(s.pose(box).translation().z(), 4.0, 1e-12);
}

TEST(Session, PartsMayComeLater) {
  Session s;
  const PartRef a = s.add(cube(10, "cube"));
  s.hold("ann", a);
  s.push(a, shift(3, 0, 0));
  const PartRef b = s.add_fixed(cube(10, "cube"), shift(15, 0, 0));
  EXPECT_EQ(s.name(b), "cube_2");
  EXPECT_EQ(s.find("cube_2").value, b.value);
  EXPECT_NEAR(s.pose(a).translation().x(), 3.0, 1e-12);
  const Pushed pushed = s.push(a, shift(4, 0, 0));  // still held by ann
  ASSERT_TRUE(pushed.status) << why(pushed.status.error());
  EXPECT_NEAR(pushed.X_WP.translation().x(), 5.0, 1e-3);
  ASSERT_EQ(pushed.clashes.size(), 1u);
  ASSERT_TRUE(s.exclude(a, b, "meant"));
  const Pushed through = s.push(a, shift(4, 0, 0));
  EXPECT_TRUE(through.clashes.empty());
  EXPECT_NEAR(through.X_WP.translation().x(), 9.0, 1e-3);
  ASSERT_TRUE(s.place(a, shift(-40, 0, 0)));
  EXPECT_NEAR(s.pose(a).translation().x(), -40.0, 1e-12);
  ASSERT_TRUE(s.release(a));
  EXPECT_FALSE(s.push(a, shift(1, 0, 0)).status);
}

TEST(Session, JudgesWhereItStandsAndGoesOn) {
  Session s({.policy = "report"});
  const PartRef a = s.add(cube(10, "a")), b = s.add(cube(10, "b"), shift(12, 0, 0));
  s.hold("ann", a);
  const std::uint64_t hash = s.push(a, shift(3, 0, 0)).state_hash;
  const auto judgement = s.judge();
  ASSERT_TRUE(judgement);
  ASSERT_EQ(judgement->clashes.size(), 1u);
  EXPECT_EQ(judgement->clashes[0].collision_class, CollisionClass::kReal);
  EXPECT_NEAR(judgement->clashes[0].depth_mm.lo, 1.0, 1e-3);
  ASSERT_TRUE(b);
  // The session does not notice: the same push again as in one that was not asked.
  Session other({.policy = "report"});
  const PartRef a2 = other.add(cube(10, "a"));
  other.add(cube(10, "b"), shift(12, 0, 0));
  other.hold("ann", a2);
  EXPECT_EQ(other.push(a2, shift(3, 0, 0)).state_hash, hash);
  EXPECT_EQ(s.push(a, shift(-3, 0, 0)).state_hash, other.push(a2, shift(-3, 0, 0)).state_hash);
}

struct SessionOfFiles : InFolder {};

// As it stands in client/api/README.md, with files.
TEST_F(SessionOfFiles, TheBuilderReadsAsItIsPromised) {
  setenv("MORTISE_IMPORTER", MORTISE_BIN_DIR "/mortise-import", 1);
  ASSERT_TRUE(save_stl(*plate(), (folder_ / "plate.stl").string()));
  ASSERT_TRUE(save_stl(*peg(), (folder_ / "pin.stl").string()));
  const std::string plate_file = (folder_ / "plate.stl").string(),
                    pin_file = (folder_ / "pin.stl").string();
  Pose dX_W = Pose::Identity();
  dX_W.translation().z() = -0.5;
  std::size_t told = 0;
  Session s;
  auto plate = s.add(load(plate_file));
  auto pin = s.add(load(pin_file, mm));
  s.fit(plate, "bore_1", pin, "shaft_1", "H7/g6");
  s.hold("ann", pin);
  for (const Clash& c : s.push(pin, dX_W).clashes) told += c.explanation.size() > 10;
  ASSERT_TRUE(s.status()) << why(s.status().error());
  EXPECT_GT(told, 0u);
  EXPECT_EQ(s.clashes().front().collision_class, CollisionClass::kFake);
}

}  // namespace
}  // namespace mortise::test
