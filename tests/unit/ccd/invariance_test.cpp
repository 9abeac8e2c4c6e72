// What must not change the answer: frame, scale, place, order, direction of time, cutting of ticks.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/ccd/shapes.h"

namespace mortise::testing {
namespace {

constexpr double kPi = std::numbers::pi;

struct Case {
  SolidPtr a, b;
  Pose a0, a1, b0, b1;
  Vec3 reference_a = Vec3::Zero();
};

Case random_case(std::mt19937_64& random) {
  Case c;
  c.a = solid(convex_mesh(random, 12));
  c.b = solid(convex_mesh(random, 10));
  c.a0 = random_pose(random, 1.0, kPi);
  c.a0.p.x() -= 4.0;
  c.a1 = turn(rotation_log(random_pose(random, 0.0, kPi).q), c.a0.p + Vec3(8, 0, 0));
  c.b0 = c.b1 = random_pose(random, 1.0, kPi);
  return c;
}

FirstContact ask(const Case& c, bool screw = false) {
  const auto path = [&](const Pose& from, const Pose& to) {
    return screw ? screw_motion(from, to, c.reference_a) : linear_motion(from, to, c.reference_a);
  };
  return solve(c.a, path(c.a0, c.a1), c.b, path(c.b0, c.b1));
}

// Times agree when both lie within the accuracy along the way before the same truth.
void expect_same(const FirstContact& x, const FirstContact& y, double tolerance) {
  ASSERT_EQ(x.state, y.state);
  EXPECT_NEAR(x.t_contact, y.t_contact, tolerance);
}

TEST(Invariance, OfTheFrame) {
  std::mt19937_64 random(21);
  int contacts = 0;
  for (int i = 0; i < 60; ++i) {
    Case c = random_case(random);
    const FirstContact here = ask(c), here_screw = ask(c, true);
    contacts += here.state == ContactState::kContact;
    const Pose G = random_pose(random, 100.0, kPi);
    for (Pose* X : {&c.a0, &c.a1, &c.b0, &c.b1}) *X = G * *X;
    expect_same(here, ask(c), 1e-6);
    expect_same(here_screw, ask(c, true), 1e-6);
  }
  EXPECT_GT(contacts, 30);
}

TEST(Invariance, OfOrder) {
  std::mt19937_64 random(22);
  for (int i = 0; i < 40; ++i) {
    const Case c = random_case(random);
    const FirstContact ab = ask(c);
    const FirstContact ba = solve(c.b, still_motion(c.b0), c.a, linear_motion(c.a0, c.a1, {}));
    expect_same(ab, ba, 1e-6);
  }
}

TEST(Invariance, OfScale) {
  std::mt19937_64 random(23);
  for (int i = 0; i < 25; ++i) {
    const Case c = random_case(random);
    const FirstContact at_one = ask(c);
    for (double scale : {1e-3, 1e-1, 1e1, 1e3}) {
      Case s = c;
      s.a = solid(scaled(c.a->mesh(), scale));
      s.b = solid(scaled(c.b->mesh(), scale));
      for (Pose* X : {&s.a0, &s.a1, &s.b0, &s.b1}) X->p *= scale;
      ContactQuery q = query(s.a, move(s.a0, s.a1), s.b, move(s.b0, s.b1));
      q.accuracy_mm = 1e-6 * scale;
      const FirstContact scaled_answer = solve(q);
      expect_same(at_one, scaled_answer, 1e-6);
      q.accuracy_mm = 1e-6;  // the same micrometre-thousandth at any scale
      expect_same(at_one, solve(q), 1e-6 * std::max(1.0, 1.0 / scale));
    }
  }
}

TEST(Invariance, FarFromTheOrigin) {
  std::mt19937_64 random(24);
  for (int i = 0; i < 25; ++i) {
    const Case c = random_case(random);
    const FirstContact here = ask(c);
    // In the world: poses far away.
    Case far = c;
    for (Pose* X : {&far.a0, &far.a1, &far.b0, &far.b1}) X->p += Vec3(1e6, -1e6, 1e6);
    const FirstContact there = ask(far);
    expect_same(here, there, 1e-5);
    // In the part: mesh far from its own frame, pose back again.
    Case local = c;
    const Vec3 away(-1e6, 1e6, 1e6);
    TriangleMesh mesh = c.a->mesh();
    for (Vec3& p : mesh.points_mm) p += away;
    local.a = solid(mesh);
    local.reference_a = away;
    local.a0 = c.a0 * Pose::translation(-away);
    local.a1 = c.a1 * Pose::translation(-away);
    const FirstContact moved =
        solve(local.a, linear_motion(local.a0, local.a1, away), c.b, still_motion(c.b0));
    expect_same(here, moved, 1e-5);
    EXPECT_LT(moved.work.leaf_tests, 40 * (here.work.leaf_tests + 20))
        << "far meshes must not lose their boxes";
  }
}

TEST(Invariance, TranslationOfOneIsTheOppositeOfTheOther) {
  std::mt19937_64 random(25);
  for (int i = 0; i < 40; ++i) {
    const Case c = random_case(random);
    const Vec3 v(8, 0.3, -0.4);
    const auto go = [](const Pose& X, const Vec3& by) { return move(X, {X.q, X.p + by}); };
    const FirstContact a_moves = solve(c.a, go(c.a0, v), c.b, still_motion(c.b0));
    const FirstContact b_moves = solve(c.a, still_motion(c.a0), c.b, go(c.b0, -v));
    const FirstContact halves = solve(c.a, go(c.a0, 0.5 * v), c.b, go(c.b0, -0.5 * v));
    const FirstContact carried = solve(c.a, go(c.a0, 4 * v), c.b, go(c.b0, 3 * v));
    expect_same(a_moves, b_moves, 1e-6);
    expect_same(a_moves, halves, 1e-6);
    expect_same(a_moves, carried, 1e-6);
  }
}

// The first contact forward is the last backward: found by asking, backward, after each contact.
TEST(Invariance, BackwardInTime) {
  std::mt19937_64 random(26);
  for (int i = 0; i < 20; ++i) {
    const Case c = random_case(random);
    const FirstContact forward = ask(c);
    const Motion path = move(c.a0, c.a1);
    if (forward.state != ContactState::kContact) {
      EXPECT_EQ(solve(c.a, move(c.a1, c.a0), c.b, still_motion(c.b0)).state, ContactState::kFree);
      continue;
    }
    // Between the end of the free way and the start nothing is touched backward, either.
    const double before = forward.t_contact - 1e-5;
    const FirstContact back = solve(c.a, move(path.pose_at(before), c.a0), c.b, still_motion(c.b0));
    EXPECT_EQ(back.state, ContactState::kFree);
  }
}

TEST(Invariance, OfCuttingTheTick) {
  std::mt19937_64 random(27);
  int contacts = 0;
  for (int i = 0; i < 30; ++i) {
    const Case c = random_case(random);
    const FirstContact whole = ask(c);
    const Motion path = move(c.a0, c.a1);
    for (int pieces : {2, 7}) {
      double t = 1.0;
      for (int k = 0; k < pieces && t == 1.0; ++k) {
        const double begin = static_cast<double>(k) / pieces;
        const FirstContact piece =
            solve(c.a, move(path.pose_at(begin), path.pose_at(static_cast<double>(k + 1) / pieces)),
                  c.b, still_motion(c.b0));
        if (piece.state == ContactState::kContact) t = begin + piece.t_contact / pieces;
      }
      if (whole.state == ContactState::kContact) {
        ++contacts;
        EXPECT_NEAR(whole.t_contact, t, 1e-6);
      } else {
        EXPECT_EQ(t, 1.0);
      }
    }
  }
  EXPECT_GT(contacts, 20);
}

TEST(Invariance, OfRepetitionToTheLastBit) {
  std::mt19937_64 random(28);
  CcdScratch scratch;
  for (int i = 0; i < 30; ++i) {
    const Case c = random_case(random);
    const ContactQuery q = query(c.a, move(c.a0, c.a1), c.b, still_motion(c.b0));
    const FirstContact x = first_contact(q, scratch), y = solve(q);
    EXPECT_EQ(x.state, y.state);
    EXPECT_EQ(x.t_contact, y.t_contact);
    EXPECT_EQ(x.distance_mm, y.distance_mm);
    EXPECT_EQ(x.triangle_a, y.triangle_a);
    EXPECT_EQ(x.point_a_W, y.point_a_W);
    EXPECT_EQ(x.work.box_tests, y.work.box_tests);
  }
}

}  // namespace
}  // namespace mortise::testing
