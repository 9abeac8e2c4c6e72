// What is already the case at t = 0: touching to rounding, overlapping, contained; and parts that
// leave or press from there.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"

namespace mortise::stress {
namespace {

using namespace mortise::testing;

// Any pair, brought to the distance asked for, where it then stays. Empty when they do not meet.
bool bring_near(std::uint64_t seed, double gap_mm, Case& c, Vec3& normal) {
  c = random_case(seed);
  c.separation_mm = gap_mm;
  c.accuracy_mm = std::max(1e-13, 1e-6 * gap_mm);
  c.check_contained = false;
  CcdScratch scratch;
  const FirstContact stop = first_contact(query_of(c), scratch);
  if (stop.state != ContactState::kContact || stop.distance_mm <= 0.0) return false;
  normal = (stop.point_b_W - stop.point_a_W).normalized();
  c.motion_a = still_motion(c.motion_a.pose_at(stop.t_contact));
  c.motion_b = still_motion(c.motion_b.pose_at(stop.t_contact));
  c.separation_mm = 0.0;
  c.accuracy_mm = kAccuracyDefault_mm;
  return true;
}

// Near, touching, a little in each other: the state has to follow the distance.
TEST(Start, StateFollowsTheDistance) {
  Sweep sweep("start: near to overlapping");
  int touching = 0, overlapping = 0;
  for (int i = 0; i < test::effort(150); ++i) {
    const std::uint64_t seed = 900'000 + static_cast<std::uint64_t>(i);
    Case c;
    Vec3 n;
    if (!bring_near(seed, 1e-3, c, n)) continue;
    const Pose at = c.motion_a.X_W0;
    for (const double gap_mm : {1e-5, 2e-6, 2e-7, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-5, -1e-3}) {
      // Moved along the normal by what is missing; away from there it may move or not.
      const Pose X{at.q, at.p + (1e-3 - gap_mm) * n};
      const Pose away{at.q, X.p - n};
      c.motion_a = i % 2 == 0 ? still_motion(X) : linear_motion(X, away, Vec3::Zero());
      char label[64];
      std::snprintf(label, sizeof label, "gap %g mm, seed %d", gap_mm, static_cast<int>(seed));
      const ContactState state = sweep.ask(c, label, 16).state;
      touching += state == ContactState::kTouchingAtStart;
      overlapping += state == ContactState::kOverlappingAtStart;
      if (std::abs(gap_mm) <= 2e-7) {
        EXPECT_EQ(state, ContactState::kTouchingAtStart) << label;
      } else if (gap_mm > 0.0) {
        EXPECT_NE(state, ContactState::kOverlappingAtStart) << label;
      } else {
        // A corner may stand deeper in a corner's neighbourhood than its triangles tell.
        EXPECT_TRUE(state == ContactState::kOverlappingAtStart ||
                    state == ContactState::kTouchingAtStart)
            << label;
      }
    }
  }
  EXPECT_GT(touching, 100);
  EXPECT_GT(overlapping, 50);
}

// Surfaces through one another anyhow are an overlap; parts apart are none.
TEST(Start, OverlapsAreSeen) {
  Sweep sweep("start: overlapping or apart");
  int crossing = 0;
  for (int i = 0; i < test::effort(200); ++i) {
    const std::uint64_t seed = 910'000 + static_cast<std::uint64_t>(i);
    Case c = random_case(seed);
    c.separation_mm = 0.0;
    std::mt19937_64 random(seed);
    const Pose X{c.motion_a.X_W0.q, c.motion_b.X_W0.p + random_vector(random, 1.2)};
    c.motion_a = i % 2 == 0
                     ? still_motion(X)
                     : linear_motion(X, {X.q, X.p + random_vector(random, 3.0)}, Vec3::Zero());
    Oracle oracle(c);
    const Real gap = oracle.gap_mm(0.0, 10);
    const FirstContact answer = sweep.ask(c, "overlap " + std::to_string(seed), 16);
    if (gap >= 0) continue;
    ++crossing;
    EXPECT_TRUE(answer.state == ContactState::kOverlappingAtStart ||
                answer.state == ContactState::kTouchingAtStart)
        << seed;
  }
  EXPECT_GT(crossing, 60);
}

// One inside the other, without any surface meeting; hollow parts have an inside that is none.
TEST(Start, ContainedIsSeen) {
  Sweep sweep("start: contained");
  for (int i = 0; i < test::effort(100); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(920'000 + i));
    Case c;
    c.a = random_shape(random, i % kShapes);
    const double size = 12.0;
    TriangleMesh outer = transformed(box_mesh({size, size, size}), turn(random_turn(random, kPi)));
    const bool hollow = i % 3 == 0;
    if (hollow) append(outer, inside_out(transformed(box_mesh({8, 8, 8}), turn({0.1, 0.2, 0.3}))));
    c.b = solid(outer);
    const Pose at{rotation_exp(random_turn(random, kPi)), random_vector(random, 0.8)};
    c.motion_a = i % 2 == 0
                     ? still_motion(at)
                     : linear_motion(at, {at.q, at.p + random_vector(random, 0.3)}, Vec3::Zero());
    const Pose G{rotation_exp(random_turn(random, kPi)), random_vector(random, 100.0)};
    c.motion_b = still_motion({});
    c = moved(c, G);
    c.check_contained = true;
    const FirstContact answer = sweep.ask(c, "contained " + std::to_string(i), 16);
    EXPECT_EQ(answer.contained, !hollow) << i;
    EXPECT_EQ(answer.state, hollow ? ContactState::kFree : ContactState::kOverlappingAtStart) << i;
  }
}

// A convex part A, B and where they touch at the end of a straight way.
struct Touch {
  Case c;
  Pose at;
  Vec3 normal = Vec3::Zero();  // from A to B
  double gap_mm = 0.0;
};

bool touch(std::uint64_t seed, int finer, double accuracy_mm, Touch& t) {
  std::mt19937_64 random(seed);
  const auto part = [&] {
    TriangleMesh mesh = random_shape(random, 1)->mesh();
    for (int k = 0; k < finer; ++k) mesh = refined(mesh);
    return solid(mesh);
  };
  t.c.a = part();
  t.c.b = part();
  const Vec3 side = random_turn(random, 1.0).normalized();
  const Quat q = rotation_exp(random_turn(random, kPi));
  t.c.motion_a = linear_motion({q, 5 * side}, {q, Vec3::Zero()}, Vec3::Zero());
  t.c.motion_b = still_motion({rotation_exp(random_turn(random, kPi)), random_vector(random, 0.5)});
  t.c.accuracy_mm = accuracy_mm;
  t.c.ask_fcl = false;
  CcdScratch scratch;
  const FirstContact stop = first_contact(query_of(t.c), scratch);
  if (stop.state != ContactState::kContact) return false;
  t.at = t.c.motion_a.pose_at(stop.t_contact);
  t.normal = (stop.point_b_W - stop.point_a_W).normalized();
  t.gap_mm = stop.distance_mm;
  return true;
}

FirstContact ask_from_touch(const Case& c, const std::string& label) {
  ContactQuery query = query_of(c);
  query.ignore_touching_at_start = true;
  CcdScratch scratch;
  const FloatGuard guard(label);
  return first_contact(query, scratch);
}

// Convex parts that touch: a plane parts them. Away from it they are free for ever, along it, too;
// against it they are stopped at once.
TEST(Start, ConvexPartsLeaveSlideAndPress) {
  Sweep sweep("start: leave, slide, press (depth mm)");
  int left = 0, pressed = 0;
  for (int i = 0; i < test::effort(200); ++i) {
    Touch touching;
    if (!touch(static_cast<std::uint64_t>(930'000 + i), 0, 1e-6, touching)) continue;
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    Case c = touching.c;
    const Vec3 n = touching.normal, any = random_vector(random, 1.0);
    const Pose& at = touching.at;
    for (const double against : {-1.0, -1e-3, 0.0, 1e-3, 1.0}) {
      const Vec3 by = any - any.dot(n) * n + against * n;
      c.motion_a = linear_motion(at, {at.q, at.p + by}, Vec3::Zero());
      const std::string label = "case " + std::to_string(i) + " against " + std::to_string(against);
      const FirstContact answer = ask_from_touch(c, label);
      if (against <= 0.0) {
        ++left;
        EXPECT_EQ(answer.state, ContactState::kFree) << label;
        continue;
      }
      // The way along may lead off the edge before the press is deep: then it is free.
      if (answer.state != ContactState::kContact) continue;
      ++pressed;
      sweep.measured(std::max(0.0, against * answer.t_contact - touching.gap_mm), c.accuracy_mm,
                     label);
    }
  }
  EXPECT_GT(left, 300);
  EXPECT_GT(pressed, 100);
}

// Whatever a touching convex part does, it gets no deeper than the accuracy: A made smaller by four
// times as much about its centre never meets B. Fine meshes whose triangles are no larger than a
// coarse accuracy would be let through first.
TEST(Start, NothingIsPressedThrough) {
  Sweep sweep("start: pressed and turned (depth in accuracies)");
  int stopped = 0, planted = 0;
  for (int i = 0; i < test::effort(150); ++i) {
    const double accuracy_mm = std::pow(10.0, -2.0 * (1 + i % 3));
    Touch touching;
    if (!touch(static_cast<std::uint64_t>(940'000 + i), i % 3, accuracy_mm, touching)) continue;
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    Case c = touching.c;
    const Pose& at = touching.at;
    const Vec3 w = i % 4 == 0 ? Vec3(Vec3::Zero()) : random_turn(random, 1.0);
    const Vec3 by = random_vector(random, 0.3) + uniform(random, -0.2, 1.0) * touching.normal;
    const Pose end{i % 4 == 0 ? at.q : (rotation_exp(w) * at.q).normalized(), at.p + by};
    c.motion_a = i % 2 == 0 ? linear_motion(at, end, Vec3::Zero())
                            : screw_motion(at, end, random_vector(random, 1.0));
    const std::string label = "press " + std::to_string(i);
    const FirstContact answer = ask_from_touch(c, label);
    stopped += answer.state == ContactState::kContact;
    // The origin lies inside A, farther than 0.2 from its faces.
    const TriangleMesh& shrunk = c.a->mesh();
    double inner = 1e300;
    for (std::uint32_t k = 0; k < shrunk.triangles.size(); ++k) {
      const Vec3 x = shrunk.corner(k, 0);
      inner = std::min(
          inner, (shrunk.corner(k, 1) - x).cross(shrunk.corner(k, 2) - x).normalized().dot(x));
    }
    if (inner < 0.2) continue;
    // The least of the factors with which nothing meets.
    const auto meets = [&](double factor, double t_end) {
      Case smaller = c;
      TriangleMesh mesh = shrunk;
      for (Vec3& p : mesh.points_mm) p *= 1.0 - factor * accuracy_mm / inner;
      smaller.a = solid(mesh);
      return std::isfinite(Oracle(smaller).first_seen(t_end, 100));
    };
    double depth = 1.0;
    while (depth < 8.0 && meets(depth, answer.t_contact)) depth *= 2.0;
    sweep.measured(depth, 4.0, label);
    if (answer.state == ContactState::kContact)
      planted += meets(4.0, std::min(1.0, answer.t_contact + 0.1));
  }
  EXPECT_GT(stopped, 50);
  EXPECT_GT(planted, stopped / 4) << "the check must be able to fail";
}

}  // namespace
}  // namespace mortise::stress
