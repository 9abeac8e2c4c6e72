#include "common/depth/answer/inner_overlap.h"

#include <gtest/gtest.h>

#include <random>

#include "common/ccd/distance.h"
#include "common/depth/answer/convex_overlap.h"
#include "common/depth/answer/region_report.h"
#include "common/evaluation/band.h"
#include "common/generators/generators.h"
#include "common/geometry/recognition/recognition.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/overlap_case.h"
#include "tests/unit/depth/random_polyhedra.h"

namespace mortise {
namespace {

using namespace shapes;
using Case = OverlapCase;

PairFrame frame_of(const Case& c) {
  OverlapQuery query;
  query.a = c.a.get();
  query.b = c.b.get();
  query.band_a = &c.band_a;
  query.band_b = &c.band_b;
  query.X_WA = c.X_WA;
  query.X_WB = c.X_WB;
  return PairFrame(query);
}

void expect_delta(const Case& c, double truth_mm) {
  const OverlapResult result = overlap_of(c);
  ASSERT_FALSE(result.regions.empty());
  const Interval delta = result.regions.front().delta_mm;
  EXPECT_LE(delta.lo, truth_mm + 1e-9);
  EXPECT_GE(delta.hi, truth_mm - 1e-9);
  EXPECT_LE(delta.width(), 0.006 * truth_mm) << delta.lo << " " << delta.hi;
  EXPECT_EQ(worst_class(result), CollisionClass::kReal);
}

// The middle of the core is 5 deep in it and 20 deep in the block.
TEST(InnerOverlap, OneWithinTheOther) {
  for (const double z : {0.0, 3.0, 12.0})
    expect_delta({solid(box({20, 20, 20})), solid(box({5, 5, 5}, {0, 0, z}))},
                 z <= 15 ? 25.0 - z : 0.0);
}

// The ends of the core are those of the block but for what files round, on either side of what
// counts as touching: no triangle of one crosses the other, and the first one is not deep inside.
TEST(InnerOverlap, OneWithinTheOtherFromEndToEnd) {
  for (const double short_mm : {0.0, 1e-9, 1e-7, 5e-7, 0.97e-6, 1e-6, 1.1e-6, 1e-5, -1e-9, -5e-7})
    for (const double aside_mm : {0.0, 14.5})
      for (int along = 0; along < 3; ++along) {
        SCOPED_TRACE(std::to_string(1e6 * short_mm) + " nm along " + std::to_string(along));
        Vec3 half(1, 1, 1), middle(0, 0, 0);
        half[along] = 20 - short_mm;
        middle[(along + 1) % 3] = aside_mm;
        Case c{solid(box({20, 20, 20})), solid(box(half, middle))};
        expect_delta(c, 21.0 - aside_mm);
        c.refinement = Refinement::kDecided;
        EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kReal);
      }
}

// To ask for the nearest of its own triangles at the middle of a ball looks at all of them.
TEST(InnerOverlap, BallsThatTouchAreNotAskedInTheirOwnMiddles) {
  const SolidPtr ball = solid(sphere(10.0));
  Case c{ball, ball};
  c.X_WB = Pose::translation({19.9, 0, 0});
  std::uint64_t evaluations = 0;
  EXPECT_FALSE(find_middle_in_both(frame_of(c), 1.0, evaluations));
  EXPECT_EQ(evaluations, 2U) << "the middle of each in the other";
  c.X_WB = Pose::translation({2.0, 0, 0});
  const auto shared = find_middle_in_both(frame_of(c), 1.0, evaluations);
  ASSERT_TRUE(shared);
  EXPECT_EQ(evaluations, 6U);
  EXPECT_NEAR(shared->depth_mm, 18.0, 0.4);
}

TEST(InnerOverlap, APegInABlockWithoutAHole) {
  expect_delta({solid(box({20, 20, 20})), solid(box({5, 5, 30}, {0, 0, 15}))}, 25.0);
}

// Both middles are where the overlap is deepest: nothing grows from there.
TEST(InnerOverlap, AroundOneMiddleLazilyAsInFull) {
  const auto stepped = generate(
      "shaft",
      {{"d1_mm", 40.0}, {"l1_mm", 40.0}, {"d2_mm", 60.0}, {"l2_mm", 40.0}, {"facets", 16}});
  ASSERT_TRUE(stepped);
  const SolidPtr shaft = std::make_shared<const Solid>(stepped->mesh),
                 block = solid(box({20, 20, 20}));
  for (const double radius : {0.5, 2.0, 5.0, 19.0})
    for (const bool convex : {true, false}) {
      if (!convex && radius > 10.0) continue;
      SCOPED_TRACE(radius);
      Case c{convex ? block : shaft, solid(sphere(radius, Vec3(0, 0, convex ? 0 : 60), 12))};
      c.band_a = c.band_b = uniform_band({}, {-0.01, 0.01});
      const OverlapResult full = overlap_of(c);
      c.refinement = Refinement::kDecided;
      const OverlapResult lazily = overlap_of(c);
      ASSERT_FALSE(full.regions.empty() || lazily.regions.empty());
      const OverlapRegion &a = lazily.regions.front(), &b = full.regions.front();
      EXPECT_LE(a.delta_mm.lo, b.delta_mm.hi + 1e-6);
      EXPECT_GE(a.delta_mm.hi, b.delta_mm.lo - 1e-6);
      // Planes say it of convex parts; else as far as the work of a lazy look goes.
      EXPECT_LE(a.delta_mm.width(), (convex ? 0.006 : 0.05) * b.delta_mm.hi);
      EXPECT_LE(a.certain_mm.width(), (convex ? 0.006 : 0.06) * b.delta_mm.hi);
      EXPECT_EQ(worst_class(lazily), CollisionClass::kReal);
    }
}

// No surface of theirs lies inside the other, or hardly.
TEST(InnerOverlap, PartsOnOnePlace) {
  const SolidPtr block = solid(box({20, 15, 10}));
  for (const double shift : {0.0, 1e-9, 1e-3, 0.5}) {
    SCOPED_TRACE(shift);
    expect_delta({block, solid(box({20, 15, 10}, {0, 0, shift}))}, 20.0 - shift);
  }
}

// Their surfaces coincide everywhere, and nothing is learned from them.
TEST(InnerOverlap, TheSamePartTwiceCostsLittle) {
  const SolidPtr part = solid(ring({12, -10, 10, 256, 9, 0}, 25));
  for (const double shift : {0.0, 0.005, 0.1}) {
    SCOPED_TRACE(shift);
    Case c{part, part};
    c.X_WB = Pose::translation(Vec3(shift, 0, 0));
    c.refinement = Refinement::kDecided;
    const OverlapResult result = overlap_of(c);
    ASSERT_EQ(result.regions.size(), 1U);
    EXPECT_GT(result.regions.front().delta_mm.lo, 12.0 - shift);
    EXPECT_TRUE(result.regions.front().has_witness);
    EXPECT_LT(result.evaluations, 2'000U);
  }
}

// A bar straight through a slab as thick as it is.
// Three points are a triangle of the hull where all others are below. No four are in one plane.
SolidPtr hull_of(const std::vector<Vec3>& points) {
  TriangleMesh mesh;
  mesh.points_mm = points;
  const auto count = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t j = i + 1; j < count; ++j)
      for (std::uint32_t k = i + 1; k < count; ++k) {
        if (j == k) continue;
        const Vec3 n = (points[j] - points[i]).cross(points[k] - points[i]);
        const auto is_below = [&](const Vec3& y) { return n.dot(y - points[i]) <= 1e-12; };
        if (std::all_of(points.begin(), points.end(), is_below))
          mesh.triangles.push_back({i, j, k});
      }
  return std::make_shared<const Solid>(std::move(mesh));
}

// The deepest point below the block's top is the tip itself, on the surface of its part.
TEST(InnerOverlap, ALeaningTipInABlockIsReal) {
  std::mt19937_64 random(4108);
  for (int i = 0; i < test::effort(30); ++i) {
    const double lean_rad = polyhedra::between(random, 0.0, 0.9),
                 half_rad = polyhedra::between(random, 0.1, 0.5),
                 deep_mm = std::exp(polyhedra::between(random, -4.0, 1.0));
    std::vector<Vec3> points = {Vec3::Zero()};
    for (const double turn_rad : {0.1, 2.2, 4.4})
      points.push_back(20.0 * Vec3(std::tan(half_rad) * std::cos(turn_rad),
                                   std::tan(half_rad) * std::sin(turn_rad), 1.0));
    Case c{hull_of(points), solid(box(Vec3(30, 30, 10), Vec3(0, 0, -10)))};
    c.X_WA = {rotation_exp(Vec3(0, lean_rad, 0)), Vec3(0.3, 0.2, -deep_mm)};
    for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull}) {
      c.refinement = refinement;
      const OverlapResult result = overlap_of(c);
      EXPECT_EQ(worst_class(result), CollisionClass::kReal) << lean_rad << " " << half_rad;
      if (result.regions.empty()) continue;
      const Vec3& witness_W = result.regions.front().witness_W;
      EXPECT_LT(witness_W.z(), 0.0);
      EXPECT_GT(nearest_surface(*c.a, c.X_WA.inverse() * witness_W).depth_mm, 0.0);
    }
  }
}

// The surfaces of both are the same, so that no point of one is deep in the other.
TEST(InnerOverlap, TheSamePartTwiceIsRealInFullAsWell) {
  std::mt19937_64 random(4107);
  for (int i = 0; i < test::effort(6); ++i) {
    std::vector<Vec3> points;
    for (int k = 0; k < 9; ++k)
      points.push_back(polyhedra::between(random, 0.12, 0.2) * polyhedra::direction(random));
    const SolidPtr part = hull_of(points);
    Case c{part, part};
    const auto features = recognize_features(*part).features;
    BandInput input;
    input.solid = part.get();
    input.features = features;
    input.of_feature.resize(features.size());
    input.estimate = true;
    c.band_a = c.band_b = build_band(input);
    c.X_WA = {polyhedra::rotation(random), 1.0 * polyhedra::direction(random)};
    c.X_WB = {c.X_WA.q, c.X_WA.p + 1e-8 * polyhedra::direction(random)};
    for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull}) {
      c.refinement = refinement;
      EXPECT_EQ(worst_class(overlap_of(c)), CollisionClass::kReal) << i;
    }
  }
}

// Along its sides and its floor the overlap is the same everywhere: their planes close that.
TEST(InnerOverlap, OfAKeyInItsSlotNothingIsDeeperThanItsEdges) {
  const auto slot = generate("slot_block", {{"slot_width_mm", 8.0}, {"slot_depth_mm", 5.0}});
  ASSERT_TRUE(slot);
  Case c{std::make_shared<const Solid>(slot->mesh), solid(box({4.02, 5.0, 8.0}))};
  c.X_WA = {rotation_exp(Vec3(0.3, -0.5, 0.2)), Vec3(10, 20, 30)};
  c.X_WB = c.X_WA * Pose::translation({0, 9.99, 1});
  const OverlapResult result = overlap_of(c);
  ASSERT_FALSE(result.regions.empty());
  const Interval delta = result.regions.front().delta_mm;
  const double truth_mm = std::hypot(0.02, 0.01);
  EXPECT_LE(delta.lo, truth_mm + 1e-9);
  EXPECT_GE(delta.hi, truth_mm - 1e-9);
  EXPECT_LE(delta.width(), 2.0 * kDepthAccuracyDefault_mm);
}

TEST(InnerOverlap, CrossingBars) {
  expect_delta({solid(box({5, 5, 0.2})), solid(box({0.2, 0.2, 5}, {0.3, 0.1, 0.4}))}, 0.4);
}

// Two discs that slide over each other: 2 min(r - x/2, half their length), less for their facets.
TEST(InnerOverlap, DiscsThatSlideOverEachOther) {
  const SolidPtr disc = solid(peg({250.0, 0.0, 100.0, 96}));
  for (const double x : {0.0, 100.0, 300.0, 450.0}) {
    SCOPED_TRACE(x);
    Case c{disc, disc};
    c.X_WB = Pose::translation(Vec3(x, 0, 0));
    const OverlapResult result = overlap_of(c);
    ASSERT_FALSE(result.regions.empty());
    const Interval delta = result.regions.front().delta_mm;
    const double truth = 2.0 * std::min(250.0 - 0.5 * x, 50.0);
    EXPECT_LE(delta.lo, truth + 1e-6);
    EXPECT_GE(delta.hi, truth - 0.3);
    EXPECT_LE(delta.hi, 1.07 * truth);  // the ends are cut into sectors
  }
}

// What rests in each other by a hair is as deep as its surfaces say.
TEST(InnerOverlap, ShallowOnesAreLeftToTheSurfaces) {
  for (const double deep : {1e-3, 0.01, 0.5}) {
    const Case c{solid(box({20, 20, 20})), solid(box({8, 8, 8}, {0, 0, 28 - deep}))};
    std::uint64_t evaluations = 0;
    const Vec3 point(0, 0, 20);
    EXPECT_FALSE(find_inner_overlap(frame_of(c), {std::span(&point, 1), deep}, 1000, evaluations));
    EXPECT_LT(evaluations, 25U);
    EXPECT_NEAR(overlap_of(c).regions.at(0).delta_mm.lo, deep, 1e-9);
  }
}

TEST(InnerOverlap, RandomOnesAgreeWithALattice) {
  std::mt19937_64 rng(7);
  const auto u = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(rng);
  };
  int deep = 0;
  for (int i = 0; i < test::effort(12); ++i) {
    Case c{solid(box({u(1, 3), u(1, 3), u(1, 3)})), i % 2
                                                        ? solid(box({u(1, 3), u(1, 3), u(1, 3)}))
                                                        : solid(sphere(u(1, 3), Vec3::Zero(), 12))};
    c.X_WA = {rotation_exp(Vec3(u(-1, 1), u(-1, 1), u(-1, 1))), Vec3(u(-1, 1), u(-1, 1), u(-1, 1))};
    const PairFrame frame = frame_of(c);
    std::uint64_t evaluations = 0;
    const auto found =
        find_inner_overlap(frame, {std::span(&c.X_WA.p, 1), 0.01, true}, 100'000, evaluations);
    const double lattice_mm = inner_overlap_brute_force(frame, 0.12);
    if (!found || !found->grows) continue;
    ++deep;
    EXPECT_GE(found->depth_mm.hi, lattice_mm) << i;
    EXPECT_GE(found->depth_mm.lo, lattice_mm - 0.12 * 1.8) << i;
    EXPECT_LE(found->depth_mm.width(), 0.006 * found->depth_mm.hi + 1e-6) << i;
    // At the named point both are as deep as is said.
    double sum_mm = 0.0;
    for (int body = 0; body < 2; ++body)
      sum_mm -=
          signed_distance_mm(*frame.bodies[body].solid, frame.X_W[body].inverse() * found->point_W);
    EXPECT_NEAR(sum_mm, found->depth_mm.lo, 1e-9) << i;
  }
  EXPECT_GT(deep, test::effort(12) / 2);
}

// Cutting planes and boxes of space say the same of convex parts; the planes to the last digit.
TEST(InnerOverlap, ConvexPartsByPlanesAsByBoxes) {
  std::mt19937_64 rng(11);
  const auto u = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(rng);
  };
  int deep = 0;
  for (int i = 0; i < test::effort(40); ++i) {
    Case c{solid(box({u(1, 3), u(1, 3), u(1, 3)})),
           i % 2 ? solid(box({u(1, 3), u(1, 3), u(1, 3)})) : solid(peg({u(1, 3), 0.0, 4.0, 7}))};
    c.X_WA = {rotation_exp(Vec3(u(-2, 2), u(-2, 2), u(-2, 2))), Vec3(u(-4, 4), u(-4, 4), u(-4, 4))};
    const PairFrame frame = frame_of(c);
    std::uint64_t evaluations = 0;
    const auto planes = convex_overlap(frame, c.X_WA.p, 1e-6, evaluations);
    const auto boxes =
        find_inner_overlap(frame, {std::span(&c.X_WA.p, 1), 0.0, true, 0.02}, 100'000, evaluations);
    ASSERT_EQ(planes.has_value(), boxes && boxes->grows) << i;
    if (!planes) continue;
    ++deep;
    EXPECT_LE(planes->depth_mm.lo, boxes->depth_mm.hi) << i;
    EXPECT_GE(planes->depth_mm.hi, boxes->depth_mm.lo) << i;
    EXPECT_LE(planes->depth_mm.width(), 2e-6) << i;
    // A lazy look says the same.
    const OverlapResult result = overlap_of(c);
    ASSERT_FALSE(result.regions.empty()) << i;
    const Interval delta = result.regions.front().delta_mm;
    EXPECT_LE(delta.lo, planes->depth_mm.hi) << i;
    EXPECT_GE(delta.hi, planes->depth_mm.lo) << i;
    EXPECT_LE(delta.width(), kDepthAccuracyDefault_mm + 2e-6) << i;
  }
  EXPECT_GT(deep, test::effort(40) / 4);
}

// A part whose middle lies deep in the other is told without a look at its surface; as in full.
TEST(InnerOverlap, WhoLiesDeepInsideCostsLittle) {
  std::mt19937_64 rng(13);
  const auto u = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(rng);
  };
  int asked = 0, contained = 0;
  for (int i = 0; i < test::effort(12); ++i) {
    const double size = i % 3 == 0 ? 0.5 : 1.0;
    Case c{solid(box({u(2, 4), u(2, 4), u(2, 4)}, Vec3::Zero(), 2)),
           i % 2 ? solid(box({size * u(1, 2), size * u(1, 2), size * u(1, 2)}, Vec3::Zero(), 2))
                 : solid(sphere(size * u(1, 2), Vec3::Zero(), 8))};
    c.band_a = c.band_b = uniform_band({}, {-0.01, 0.01});
    c.X_WB = {rotation_exp(Vec3(u(-2, 2), u(-2, 2), u(-2, 2))), Vec3(u(-1, 1), u(-1, 1), u(-1, 1))};
    c.refinement = Refinement::kDecided;
    const OverlapResult lazily = overlap_of(c);
    c.refinement = Refinement::kFull;
    const OverlapResult full = overlap_of(c);
    ASSERT_EQ(worst_class(lazily), CollisionClass::kReal) << i;
    ASSERT_EQ(worst_class(full), CollisionClass::kReal) << i;
    EXPECT_LT(lazily.evaluations, 1'500U) << i;
    EXPECT_EQ(lazily.contained, full.contained) << i;
    const OverlapRegion &a = lazily.regions.front(), &b = full.regions.front();
    for (const auto& [x, y] :
         {std::pair(a.delta_mm, b.delta_mm), std::pair(a.certain_mm, b.certain_mm),
          std::pair(a.possible_mm, b.possible_mm)}) {
      EXPECT_LE(x.lo, y.hi + 1e-6) << i;
      EXPECT_GE(x.hi, y.lo - 1e-6) << i;
    }
    EXPECT_LT(signed_distance_mm(*c.a, c.X_WA.inverse() * a.witness_W), -0.01) << i;
    EXPECT_LT(signed_distance_mm(*c.b, c.X_WB.inverse() * a.witness_W), -0.01) << i;
    ++asked;
    contained += lazily.contained;
  }
  EXPECT_GT(contained, asked / 5);
  EXPECT_LT(contained, asked);
}

// Signed depth of a point in a drawn part: its formula says on which side it is, and each triangle
// by its own corners how far off. Shares no code with the search.
double drawn_depth_mm(const polyhedra::Polyhedron& part, const Vec3& x) {
  double nearest = kInfinity;
  const TriangleMesh& mesh = part.solid->mesh();
  const auto from_edge = [&](const Vec3& p, const Vec3& q) {
    const double along = std::clamp((x - p).dot(q - p) / (q - p).squaredNorm(), 0.0, 1.0);
    return (x - p - along * (q - p)).norm();
  };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 c[3] = {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
    const Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    bool above = true;  // the foot of x on the plane is in the triangle
    for (int k = 0; k < 3; ++k) {
      const Vec3& from = c[k];
      const Vec3& to = c[(k + 1) % 3];
      above &= n.cross(to - from).dot(x - from) >= 0.0;
      nearest = std::min(nearest, from_edge(from, to));
    }
    if (above) nearest = std::min(nearest, std::fabs(n.dot(x - c[0])));
  }
  const bool inside = std::any_of(part.terms.begin(), part.terms.end(), [&](const auto& term) {
    return std::all_of(term.begin(), term.end(), [&](int h) {
      const polyhedra::HalfSpace& half = part.half_spaces[static_cast<std::size_t>(h)];
      return half.n.dot(x) <= half.c;
    });
  });
  return inside ? nearest : -nearest;
}

struct DrawnOverlap {
  const polyhedra::Polyhedron &a, &b;
  Pose X_AB;

  double at_mm(const Vec3& x_B) const {
    return drawn_depth_mm(a, X_AB * x_B) + drawn_depth_mm(b, x_B);
  }

  bool is_inside(const Vec3& x_B) const {
    return drawn_depth_mm(a, X_AB * x_B) > 1e-6 && drawn_depth_mm(b, x_B) > 1e-6;
  }

  // The deepest of some random points, and of ever closer ones about the deepest few.
  double sampled_mm(polyhedra::Random& random) const {
    const Box& box = b.solid->bounds();
    std::vector<std::pair<double, Vec3>> found;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 x(polyhedra::between(random, box.lo.x(), box.hi.x()),
                   polyhedra::between(random, box.lo.y(), box.hi.y()),
                   polyhedra::between(random, box.lo.z(), box.hi.z()));
      found.emplace_back(at_mm(x), x);
    }
    std::partial_sort(found.begin(), found.begin() + 6, found.end(),
                      [](const auto& p, const auto& q) { return p.first > q.first; });
    double most_mm = -kInfinity;
    for (std::size_t i = 0; i < 6; ++i) {
      auto& [depth_mm, x] = found[i];
      double step_mm = 0.5;
      for (int k = 0; k < 400; ++k) {
        const Vec3 next =
            x + step_mm * polyhedra::between(random, 0.0, 1.0) * polyhedra::direction(random);
        const double next_mm = at_mm(next);
        if (next_mm > depth_mm) {
          depth_mm = next_mm;
          x = next;
        } else {
          step_mm *= 0.97;
        }
      }
      most_mm = std::max(most_mm, depth_mm);
    }
    return most_mm;
  }
};

// Behind a hollow edge a part is deeper than the planes of its faces say, and the deepest point of
// both may be one of neither surface.
TEST(InnerOverlap, NothingIsDeeperThanToldBehindHollowEdges) {
  polyhedra::Random random(2026);
  int inside = 0, asked = 0;
  const int pairs = test::effort(60);
  for (int i = 0; i < pairs; ++i) {
    const polyhedra::Polyhedron a = polyhedra::random_boxes(random),
                                b = polyhedra::random_boxes(random);
    Case c{a.solid, b.solid, a.band, b.band};
    const Vec3 from = polyhedra::direction(random);
    c.X_WA.q = polyhedra::rotation(random);
    c.X_WA.p = 20.0 * from;
    CcdScratch scratch;
    for (int k = 0; k < 30; ++k)
      c.X_WA.p -= distance(*c.a, c.X_WA, *c.b, c.X_WB, scratch).distance_mm * from;
    c.X_WA.p -= std::pow(10.0, polyhedra::between(random, -2.0, 0.0)) * from;
    const OverlapResult result = overlap_of(c);
    if (result.regions.empty()) continue;
    const OverlapRegion& deepest = result.regions.front();
    const DrawnOverlap drawn{a, b, c.X_WA.inverse() * c.X_WB};
    const double truth_mm = std::max(drawn.sampled_mm(random), drawn.at_mm(deepest.point_W));
    EXPECT_LE(deepest.delta_mm.lo, truth_mm + 1e-9) << i;
    EXPECT_GE(deepest.delta_mm.hi, truth_mm - 1e-9) << i << " " << deepest.delta_mm.lo;
    inside += drawn.is_inside(deepest.point_W);
    ++asked;
  }
  std::printf("%d of %d deepest inside\n", inside, asked);
  EXPECT_GT(inside, asked / 10);
  EXPECT_LT(inside, asked);
}

// Where the work ends the bracket stays wide, and true.
TEST(InnerOverlap, LittleWorkGivesAWideBracket) {
  const Case c{solid(box({20, 15, 10})), solid(box({5, 6, 30}, {1, 2, 3}))};
  const PairFrame frame = frame_of(c);
  const Vec3 point(6, 2, 3);  // on the surface of b
  double width_mm = std::numeric_limits<double>::infinity();
  for (const std::uint64_t cap : {60U, 300U, 3000U}) {
    std::uint64_t evaluations = 0;
    const auto found = find_inner_overlap(frame, {std::span(&point, 1), 0.01}, cap, evaluations);
    ASSERT_TRUE(found);
    EXPECT_LE(found->depth_mm.lo, 15.0 + 1e-9);
    EXPECT_GE(found->depth_mm.hi, 15.0 - 1e-9);
    EXPECT_LE(found->depth_mm.width(), width_mm);
    width_mm = found->depth_mm.width();
    EXPECT_LE(evaluations, cap + 200);
  }
}

}  // namespace
}  // namespace mortise
