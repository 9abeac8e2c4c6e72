// The sharp offset bodies of polyhedra against linear programs over their known half-spaces.
#include <gtest/gtest.h>

#include "common/depth/cells/decide.h"
#include "common/evaluation/band.h"
#include "tests/support/effort.h"
#include "tests/support/shapes.h"
#include "tests/unit/depth/random_polyhedra.h"

namespace mortise {
namespace {

using polyhedra::Body;
using polyhedra::Polyhedron;

constexpr double kDepth_mm = 0.4, kFarthest_mm = -0.25;

SharpDecision decided(const Polyhedron& a, const PlaneFaces& planes_a, const Polyhedron& b,
                      const PlaneFaces& planes_b, const Pose& X_BA) {
  SharpQuery query;
  query.a = {a.solid.get(), &planes_a};
  query.b = {b.solid.get(), &planes_b};
  query.X_BA = X_BA;
  query.depth_mm = kDepth_mm;
  return decide(query);
}

struct Tally {
  int pairs = 0, undecided = 0, false_real = 0, false_free = 0, wide = 0, off = 0, outside = 0;
  int real = 0, free = 0, potential = 0;
};

// Near contact: where the parts as modelled just meet, moved by a few bands.
Pose near_contact(polyhedra::Random& random, const Polyhedron& a, const PlaneFaces& planes_a,
                  const Polyhedron& b, const PlaneFaces& planes_b) {
  Pose X_BA;
  X_BA.q = polyhedra::rotation(random);
  const Vec3 along = polyhedra::direction(random);
  double in = 0.0, out = 20.0;
  for (int i = 0; i < 14; ++i) {
    X_BA.p = 0.5 * (in + out) * along;
    const SharpDecision at = decided(a, planes_a, b, planes_b, X_BA);
    (at.state == SharpDecision::State::kDecided && at.largest.margin_mm.lo > 0.05 ? in : out) =
        0.5 * (in + out);
  }
  X_BA.p += polyhedra::between(random, -0.15, 0.1) * along;
  return X_BA;
}

void judge(const SharpDecision& decision, const Polyhedron& a, const Polyhedron& b,
           const Pose& X_BA, Tally& tally) {
  const double least = true_margin(a, b, X_BA, Body::kLeast);
  const double largest = true_margin(a, b, X_BA, Body::kLargest);
  const Interval &of_least = decision.least.margin_mm, &of_largest = decision.largest.margin_mm;
  const bool real = decision.least.has_point && of_least.lo > 0.0;
  tally.real += real;
  tally.free += of_largest.hi <= 0.0;
  tally.potential += !real && of_largest.hi > 0.0;
  tally.false_real += real && !(least > 0.0);
  tally.false_free += of_largest.hi <= 0.0 && largest > 1e-9;
  // Of parts that are farther apart than their smallest features the gap is not compared.
  const auto apart = [](const Interval& bracket, double truth) {
    const double told = std::clamp(truth, kFarthest_mm, 2.0 * kDepth_mm);
    return told < std::max(bracket.lo, kFarthest_mm) - 1e-8 ||
           told > std::max(bracket.hi, kFarthest_mm) + 1e-8;
  };
  tally.off += apart(of_least, least) || apart(of_largest, largest);
  const auto open = [](const Interval& bracket) {
    return bracket.hi > -2.0 * kDepth_mm && !(bracket.width() < 5e-4);
  };
  tally.wide += open(of_least) || open(of_largest);
  if (!real) return;
  const Vec3& x = decision.least.point_B;
  tally.outside +=
      !(depth_in(a, X_BA, x, Body::kLeast) > 0.0) || !(depth_in(b, Pose(), x, Body::kLeast) > 0.0);
}

template <class Make>
Tally tried(Make make, int pairs, std::uint64_t seed) {
  polyhedra::Random random(seed);
  Tally tally;
  for (int i = 0; i < pairs; ++i) {
    const Polyhedron a = make(random), b = make(random);
    const PlaneFaces planes_a = find_plane_faces(*a.solid, a.band),
                     planes_b = find_plane_faces(*b.solid, b.band);
    const Pose X_BA = near_contact(random, a, planes_a, b, planes_b);
    const SharpDecision decision = decided(a, planes_a, b, planes_b, X_BA);
    ++tally.pairs;
    if (decision.state == SharpDecision::State::kDecided)
      judge(decision, a, b, X_BA, tally);
    else
      ++tally.undecided;
  }
  std::printf(
      "%d pairs: %d undecided, %d real, %d potential, %d free; %d false real, %d false free, "
      "%d points outside, %d brackets off, %d open\n",
      tally.pairs, tally.undecided, tally.real, tally.potential, tally.free, tally.false_real,
      tally.false_free, tally.outside, tally.off, tally.wide);
  return tally;
}

void expect_true(const Tally& tally, int most_undecided) {
  EXPECT_EQ(tally.false_real, 0);
  EXPECT_EQ(tally.false_free, 0);
  EXPECT_EQ(tally.outside, 0);
  // The formulas of boxes trim by planes of faces that are out of reach, too.
  EXPECT_LE(tally.off, tally.pairs / 500);
  EXPECT_LE(tally.undecided + tally.wide, most_undecided);
  EXPECT_GT(tally.real, 0);
  EXPECT_GT(tally.potential, 0);
  EXPECT_GT(tally.free, 0);
}

TEST(SharpBodies, RandomConvexPairsAreJudgedAsTheirHalfSpacesAre) {
  const int pairs = test::effort(200);
  expect_true(tried(polyhedra::random_convex, pairs, 4711), pairs / 10);
}

TEST(SharpBodies, RandomUnionsAndDifferencesOfBoxesAreJudgedAsTheirHalfSpacesAre) {
  const int pairs = test::effort(60);
  expect_true(tried(polyhedra::random_boxes, pairs, 815), pairs / 10);
}

// A ball, at whose poles many facets meet, beside what is drawn.
TEST(SharpBodies, ATipOfUnknownTravelLeavesOpenWhatALongerSearchLeavesOpen) {
  polyhedra::Random random(11);
  const SolidPtr ball = shapes::solid(shapes::sphere(5.0, Vec3::Zero(), 24));
  int decided = 0, open = 0;
  for (int i = 0; i < test::effort(120); ++i) {
    const Polyhedron other =
        i % 2 == 0 ? polyhedra::random_convex(random) : polyhedra::random_boxes(random);
    BandInput input;
    input.solid = ball.get();
    const double t_mm = polyhedra::between(random, 0.0, 0.2);
    input.rest = {{-t_mm, t_mm}, "plus minus"};
    const PlaneFaces planes = find_plane_faces(*ball, build_band(input)),
                     of_other = find_plane_faces(*other.solid, other.band);
    SharpQuery query;
    query.a = {ball.get(), &planes};
    query.b = {other.solid.get(), &of_other};
    query.depth_mm = kDepth_mm;
    query.X_BA.q = polyhedra::rotation(random);
    query.X_BA.p = polyhedra::between(random, 0.0, 25.0) * polyhedra::direction(random);
    const SharpDecision fast = decide(query);
    query.ask_ahead = false;
    const SharpDecision slow = decide(query);
    const bool is_decided = slow.state == SharpDecision::State::kDecided;
    EXPECT_EQ(fast.state == SharpDecision::State::kDecided, is_decided) << i;
    EXPECT_EQ(fast.largest.margin_mm.hi, slow.largest.margin_mm.hi) << i;
    ++(is_decided ? decided : open);
  }
  EXPECT_GT(decided, test::effort(10));
  EXPECT_GT(open, test::effort(10));
}

}  // namespace
}  // namespace mortise
