// Queries that no caller may make, and the states that odd but lawful ones end in.
#include <gtest/gtest.h>

#include <cmath>

#include "common/ccd/distance.h"
#include "tests/stress/meshes.h"
#include "tests/stress/record.h"
#include "tests/support/numbers.h"

namespace mortise::stress {
namespace {

using namespace mortise::testing;

const SolidPtr& cube() {
  static const SolidPtr cube = solid(box_mesh({1, 1, 1}));
  return cube;
}

const SolidPtr& nothing() {
  static const SolidPtr nothing = solid(TriangleMesh{});
  return nothing;
}

ContactQuery good_query() {
  return query(cube(), slide({-5, 0, 0}, {5, 0, 0}), cube(), still_motion({}));
}

Pose not_a_number() { return shift(0, kNan, 0); }

Pose not_unit() {
  Pose X;
  X.q.coeffs() *= 2.0;
  return X;
}

// The fields that can be wrong, each in one query.
std::vector<ContactQuery> bad_queries() {
  std::vector<ContactQuery> bad;
  const auto with = [&](auto change) {
    ContactQuery q = good_query();
    change(q);
    bad.push_back(q);
  };
  with([](ContactQuery& q) { q.a = nullptr; });
  with([](ContactQuery& q) { q.b = nullptr; });
  with([](ContactQuery& q) { q.a = nothing().get(); });
  with([](ContactQuery& q) { q.b = nothing().get(); });
  with([](ContactQuery& q) { q.motion_a.X_W0 = not_a_number(); });
  with([](ContactQuery& q) { q.motion_a.X_W1 = not_unit(); });
  with([](ContactQuery& q) { q.motion_b.X_W0 = q.motion_b.X_W1 = not_a_number(); });
  with([](ContactQuery& q) { q.motion_a.v_W.z() = kInf; });
  with([](ContactQuery& q) { q.motion_a.w_W = Vec3(0, 0, 4.0); });
  with([](ContactQuery& q) { q.motion_b.kind = static_cast<PathKind>(9); });
  for (const double x : {-1e-9, kNan, kInf}) {
    with([&](ContactQuery& q) { q.accuracy_mm = x; });
    with([&](ContactQuery& q) { q.separation_mm = x; });
  }
  return bad;
}

TEST(InvalidQueryDeathTest, FirstContact) {
  CcdScratch scratch;
  EXPECT_EQ(first_contact(good_query(), scratch).state, ContactState::kContact);
  for (const ContactQuery& q : bad_queries()) {
    EXPECT_DEATH(first_contact(q, scratch), "check failed");
    EXPECT_DEATH(first_contact_by_sampling(q, 10, scratch), "check failed");
  }
  EXPECT_DEATH(first_contact_by_sampling(good_query(), 0, scratch), "check failed");
  EXPECT_DEATH(first_contact_by_sampling(good_query(), -3, scratch), "check failed");
}

TEST(InvalidQueryDeathTest, Distance) {
  CcdScratch scratch;
  for (const Pose& X : {not_a_number(), not_unit(), shift(kInf, 0, 0), shift(1e13, 0, 0)}) {
    EXPECT_DEATH(distance(*cube(), X, *cube(), {}, scratch), "check failed");
    EXPECT_DEATH(distance(*cube(), {}, *cube(), X, scratch), "check failed");
    EXPECT_DEATH(surfaces_cross(*cube(), X, *cube(), {}, scratch), "check failed");
    EXPECT_DEATH(surfaces_cross(*cube(), {}, *cube(), X, scratch), "check failed");
  }
  EXPECT_DEATH(distance(*nothing(), {}, *cube(), {}, scratch), "at least one triangle");
  EXPECT_DEATH(distance(*cube(), {}, *nothing(), {}, scratch), "at least one triangle");
  EXPECT_DEATH(surfaces_cross(*cube(), {}, *nothing(), {}, scratch), "at least one triangle");
  for (const double limit : {-1.0, kNan})
    EXPECT_DEATH(distance(*cube(), {}, *cube(), {}, scratch, limit), "check failed");
  EXPECT_EQ(distance(*cube(), shift(3, 0, 0), *cube(), {}, scratch, 0.0).distance_mm, 0.0);
  EXPECT_FALSE(distance(*cube(), shift(3, 0, 0), *cube(), {}, scratch, 0.0).within_limit);
}

TEST(InvalidQueryDeathTest, Trees) {
  EXPECT_DEATH(build_bvh(TriangleMesh{}), "at least one triangle");
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.triangles[2][2] = 1000;
  EXPECT_DEATH(build_bvh(mesh), "check failed");
  mesh = box_mesh({1, 1, 1});
  mesh.points_mm[1].x() = kNan;
  EXPECT_DEATH(build_bvh(mesh), "check failed");
}

// Odd but lawful: each ends in a state that says so.
TEST(OddQuery, EndsInADocumentedState) {
  CcdScratch scratch;
  ContactQuery q = good_query();
  q.work_cap = 0;
  const FirstContact undecided = first_contact(q, scratch);
  EXPECT_EQ(undecided.state, ContactState::kUndecided);
  EXPECT_LE(undecided.t_clear, 0.4);
  // An accuracy that is finer than rounding is raised.
  q = good_query();
  q.accuracy_mm = 0.0;
  const FirstContact finest = first_contact(q, scratch);
  ASSERT_EQ(finest.state, ContactState::kContact);
  EXPECT_LE(finest.t_contact, 0.4);
  EXPECT_NEAR(finest.t_contact, 0.4, 1e-13);
  // One that is coarser than the parts.
  q.accuracy_mm = 100.0;
  const FirstContact coarse = first_contact(q, scratch);
  EXPECT_TRUE(coarse.state == ContactState::kContact ||
              coarse.state == ContactState::kTouchingAtStart);
  EXPECT_LE(coarse.t_contact, 0.4);
  q = good_query();
  q.separation_mm = 100.0;
  EXPECT_EQ(first_contact(q, scratch).state, ContactState::kTouchingAtStart);
  // The whole length of what may be computed with.
  q = good_query();
  q.motion_a = slide({-9e11, 0, 0}, {9e11, 0, 0});
  const FloatGuard guard("as far as a coordinate may go");
  const FirstContact far_away = first_contact(q, scratch);
  EXPECT_NE(far_away.state, ContactState::kFree);
  EXPECT_LE(far_away.t_clear, 0.5);
  // A part whose points are all one.
  TriangleMesh point = box_mesh({1, 1, 1});
  for (Vec3& p : point.points_mm) p = Vec3(0, 0, 0);
  const SolidPtr dot = solid(point);
  const FirstContact met =
      solve(query(dot, slide({-5, 0.1, 0.2}, {5, 0.1, 0.2}), cube(), still_motion({})));
  ASSERT_EQ(met.state, ContactState::kContact);
  EXPECT_NEAR(met.t_contact, 0.45, 1e-7);
}

}  // namespace
}  // namespace mortise::stress
