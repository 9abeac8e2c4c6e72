// judge, distance and first_contact of two parts.
#include <mortise/io.h>
#include <mortise/mortise.h>

#include <thread>

#include "tests/support/programs.h"
#include "tests/unit/api/scene.h"

namespace mortise::test {
namespace {

TEST(Distance, OfTwoCubes) {
  const Part a = cube(10, "a"), b = cube(2, "b");
  const auto apart = distance(a, b, Pose::Identity(), shift(13, 4, 4));
  ASSERT_TRUE(apart);
  EXPECT_DOUBLE_EQ(apart->distance_mm, 3.0);
  EXPECT_TRUE(apart->within_limit);
  EXPECT_DOUBLE_EQ((apart->point_b_W - apart->point_a_W).norm(), 3.0);
  const auto far = distance(a, b, Pose::Identity(), shift(13, 4, 4), 1.0);
  ASSERT_TRUE(far);
  EXPECT_FALSE(far->within_limit);
  EXPECT_DOUBLE_EQ(far->distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(distance(a, b, Pose::Identity(), shift(9, 4, 4))->distance_mm, 0.0);
}

TEST(Distance, WhatIsNoPoseIsRefused) {
  const Part a = cube(10, "a");
  Pose scaled = Pose::Identity(), mirrored = Pose::Identity(), nowhere = Pose::Identity();
  scaled.linear() *= 2.0;
  mirrored.linear()(2, 2) = -1.0;
  nowhere.translation().x() = std::nan("");
  for (const Pose& bad : {scaled, mirrored, nowhere}) {
    const auto answer = distance(a, a, bad);
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().text, "X_WA is no finite rigid motion");
    EXPECT_FALSE(distance(a, a, Pose::Identity(), bad));
    EXPECT_FALSE(first_contact(a, a, {bad, Pose::Identity()}));
    EXPECT_FALSE(first_contact(a, a, {}, {bad}));
    EXPECT_FALSE(judge(a, a, {.X_WB = bad}));
  }
  EXPECT_FALSE(distance(a, a, Pose::Identity(), Pose::Identity(), -1.0));
  EXPECT_FALSE(distance(a, a, Pose::Identity(), Pose::Identity(), std::nan("")));
}

TEST(FirstContact, OfACubeThatFallsOnAnother) {
  const Part a = cube(10, "a"), b = cube(10, "b");
  const auto hit = first_contact(a, b, {shift(0, 0, 20), shift(0, 0, 0)});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->state, FirstContact::State::kContact);
  EXPECT_EQ(name_of(hit->state), "contact");
  EXPECT_NEAR(hit->t_contact, 0.5, 1e-6);
  EXPECT_LE(hit->t_clear, hit->t_contact);
  const auto free = first_contact(a, b, {shift(0, 0, 20), shift(30, 0, 20)});
  ASSERT_TRUE(free);
  EXPECT_EQ(free->state, FirstContact::State::kFree);
  EXPECT_EQ(first_contact(a, b, {shift(0, 0, 5), shift(0, 0, 20)})->state,
            FirstContact::State::kOverlappingAtStart);
  EXPECT_FALSE(first_contact(a, b, {}, {.accuracy_mm = -1.0}));
  EXPECT_FALSE(first_contact(a, b, {.reference_P = Vec3::Constant(std::nan(""))}));
}

TEST(FirstContact, AScrewTurnsAboutItsAxis) {
  const Part a = cube(10, "a"), b = cube(10, "b");
  // A quarter turn about the origin takes the cube from +x to +y, where B stands.
  const Pose start = shift(15, -5, 0);
  const Pose turned =
      Pose(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ()) * Eigen::Isometry3d(start));
  const auto screw = first_contact(a, b, {start, turned, Motion::Path::kScrew}, {shift(-5, 15, 0)});
  const auto linear = first_contact(a, b, {start, turned}, {shift(-5, 15, 0)});
  ASSERT_TRUE(screw && linear);
  EXPECT_EQ(screw->state, FirstContact::State::kContact);
  EXPECT_EQ(linear->state, FirstContact::State::kContact);
  EXPECT_NE(screw->t_contact, linear->t_contact);
}

TEST(Judge, ClassesOfFits) {
  const auto expect = [](const std::string& fit, CollisionClass wanted) {
    const auto judgement =
        judge(made(plate()), made(peg()), {.fit = fit, .X_WB = shift(0, 0, -10)});
    ASSERT_TRUE(judgement) << why(judgement.error());
    EXPECT_EQ(judgement->worst(), wanted) << fit;
    ASSERT_FALSE(judgement->clashes.empty());
    const Clash& worst = judgement->clashes.front();
    EXPECT_EQ(worst.part_a, "plate");
    EXPECT_EQ(worst.part_b, "peg");
    EXPECT_LE(worst.depth_mm.lo, 0.0483);
    EXPECT_GE(worst.depth_mm.hi, 0.0481);
    EXPECT_LT(worst.fake_up_to_mm, worst.real_above_mm);
    EXPECT_EQ(worst.witness_W.has_value(), wanted == CollisionClass::kReal);
    EXPECT_NE(worst.explanation.find(fit), std::string::npos);
  };
  expect("H7/g6", CollisionClass::kFake);
  expect("H7/k6", CollisionClass::kPotential);
  expect("H7/p6", CollisionClass::kReal);
}

TEST(Judge, WhatIsWrongIsSaid) {
  const auto fit = judge(made(plate()), made(peg()), {.fit = "H7/zz99"});
  ASSERT_FALSE(fit);
  EXPECT_NE(fit.error().text.find("zz99"), std::string::npos) << fit.error().text;
  EXPECT_FALSE(judge(made(plate()), made(peg()), {.threads = 0}));
  EXPECT_FALSE(judge(made(plate()), made(peg()), {.threads = 257}));
  const auto apart = judge(cube(1, "a"), cube(1, "b"), {.X_WB = shift(9, 0, 0)});
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->worst(), CollisionClass::kNone);
  EXPECT_TRUE(apart->clashes.empty());
  EXPECT_FALSE(picture_svg(cube(1, "a"), cube(1, "b"), {.X_WB = shift(9, 0, 0)}));
}

TEST(Judge, PartsOfOneNameAreToldApart) {
  const auto judgement = judge(cube(10, "cube"), cube(10, "cube"), {.X_WB = shift(9, 0, 0)});
  ASSERT_TRUE(judgement);
  ASSERT_EQ(judgement->clashes.size(), 1u);
  EXPECT_EQ(judgement->clashes[0].part_a, "cube");
  EXPECT_EQ(judgement->clashes[0].part_b, "cube_2");
  ASSERT_TRUE(judgement->clashes[0].way_out);
  EXPECT_NEAR(judgement->clashes[0].way_out->translation_mm.norm(), 1.0, 1e-3);
}

TEST(Judge, APictureIsDrawn) {
  const auto svg =
      picture_svg(made(plate()), made(peg()), {.fit = "H7/p6", .X_WB = shift(0, 0, -10)});
  ASSERT_TRUE(svg) << why(svg.error());
  EXPECT_TRUE(svg->starts_with("<svg") || svg->starts_with("<?xml")) << svg->substr(0, 40);
  EXPECT_NE(svg->find("H7/p6"), std::string::npos);
}

struct JudgedFiles : InFolder {
  void SetUp() override {
    InFolder::SetUp();
    for (const auto& part : {plate(), peg()})
      ASSERT_TRUE(save_stl(*part, (folder_ / (part->name() + ".stl")).string()));
  }
  Part read(const std::string& name) const { return made(load((folder_ / name).string())); }
};

TEST_F(JudgedFiles, HaveTheBitsOfTheProgram) {
  for (const std::string fit : {"", "H7/g6", "H7/p6"}) {
    const Outcome program =
        run("mortise-judge", "plate.stl peg.stl --json" + (fit.empty() ? "" : " --fit " + fit),
            folder_);
    ASSERT_EQ(program.exit_code, 0) << program.err;
    const auto judgement = judge(read("plate.stl"), read("peg.stl"), {.fit = fit});
    ASSERT_TRUE(judgement) << why(judgement.error());
    const auto ours = nlohmann::json::parse(judgement->json);
    EXPECT_EQ(ours["pairs"].dump(), program.document()["pairs"].dump()) << fit;
    EXPECT_EQ(ours["counters"].dump(), program.document()["counters"].dump()) << fit;
    EXPECT_FALSE(ours["pairs"].empty());
  }
}

TEST_F(JudgedFiles, AnswersDoNotDependOnThreads) {
  const Part a = read("plate.stl"), b = read("peg.stl");
  const auto alone = judge(a, b, {.fit = "H7/p6"});
  ASSERT_TRUE(alone);
  std::string others[3];
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i)
    threads.emplace_back(
        [&, i] { others[i] = judge(a, b, {.fit = "H7/p6", .threads = i + 1})->json; });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& other : others) EXPECT_EQ(other, alone->json);
}

}  // namespace
}  // namespace mortise::test
