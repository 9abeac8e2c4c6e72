// How the answer is made: kernels, memory, allocation, distance, and the slow twin.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>

#include "common/ccd/distance.h"
#include "common/ccd/pair_motion.h"
#include "common/geometry/triangle_distance.h"
#include "tests/support/numbers.h"
#include "tests/unit/ccd/shapes.h"

namespace {
std::atomic<long> g_allocations{0};
}

// Inlined, the compiler takes free() for the wrong partner of the new above it.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
void* operator new(std::size_t size) {
  ++g_allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace mortise::testing {
namespace {

TEST(BoxKernels, WideAndPortableAgreeToTheLastBit) {
  if (ccd::wide_kernels() == nullptr)
    GTEST_SKIP() << "machine: no AVX2, the portable kernel is the only one";
  const ccd::BoxKernels& wide = ccd::wide_kernels()->box;
  const ccd::BoxKernels& portable = ccd::portable_kernels().box;
  std::mt19937_64 random(41);
  const SolidPtr a = solid(sphere_mesh(3, 40, 20)), b = solid(sphere_mesh(5, 30, 20));
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    const Pose a0 = random_pose(random, 10, kPi), b0 = random_pose(random, 10, kPi);
    const Pose a1 = i % 3 == 0 ? Pose{a0.q, a0.p + Vec3(1, 2, 3)} : random_pose(random, 10, kPi);
    const Pose b1 = i % 2 == 0 ? b0 : random_pose(random, 10, kPi);
    ccd::PairMotion motion(*a, move(a0, a1), *b, move(b0, b1));
    motion.at(unit(random));
    const ccd::BoxFrame& frame = motion.frame(1e-7);
    const Bvh::Node& node_a = a->bvh().nodes[i % a->bvh().nodes.size()];
    const Bvh::Node& node_b = b->bvh().nodes[i % b->bvh().nodes.size()];
    ccd::OneBox one_a{}, one_b{};
    for (int c = 0; c < 3; ++c) {
      one_a.center[c] = node_a.local_center[c][1];
      one_a.half[c] = node_a.half[c][1];
      one_b.center[c] = node_b.local_center[c][0];
      one_b.half[c] = node_b.half[c][0];
    }
    const ccd::EightBoxes eight_a{node_a.local_center, node_a.half};
    const ccd::EightBoxes eight_b{node_b.local_center, node_b.half};
    alignas(32) float x[8], y[8];
    const auto same = [&] { return std::memcmp(x, y, sizeof x) == 0; };
    wide.advance_a(frame, eight_a, one_b, x), portable.advance_a(frame, eight_a, one_b, y);
    EXPECT_TRUE(same());
    wide.advance_b(frame, one_a, eight_b, x), portable.advance_b(frame, one_a, eight_b, y);
    EXPECT_TRUE(same());
    wide.lower_a(frame, eight_a, one_b, x), portable.lower_a(frame, eight_a, one_b, y);
    EXPECT_TRUE(same());
    wide.lower_b(frame, one_a, eight_b, x), portable.lower_b(frame, one_a, eight_b, y);
    EXPECT_TRUE(same());
    wide.apart_a(frame, eight_a, one_b, x), portable.apart_a(frame, eight_a, one_b, y);
    EXPECT_TRUE(same());
    wide.apart_b(frame, one_a, eight_b, x), portable.apart_b(frame, one_a, eight_b, y);
    EXPECT_TRUE(same());
  }
}

// Boxes only discard: within the time that a kernel grants, no triangle below comes nearer than the
// target. Seen at sampled times.
TEST(BoxKernels, GrantNoTimeThatIsNotFree) {
  std::mt19937_64 random(42);
  const SolidPtr a = solid(sphere_mesh(3, 12, 6)), b = solid(sphere_mesh(4, 12, 6));
  int granted = 0, planted = 0;
  for (int i = 0; i < 150; ++i) {
    const Pose a0 = random_pose(random, 8, kPi), b0 = random_pose(random, 8, kPi);
    const Motion ma = screw_motion(a0, random_pose(random, 8, kPi), Vec3::Zero());
    const Motion mb = i % 2 == 0 ? still_motion(b0) : move(b0, random_pose(random, 8, kPi));
    ccd::PairMotion motion(*a, ma, *b, mb);
    const double t0 = 0.3;
    motion.at(t0);
    const Bvh& tree_a = a->bvh();
    const Bvh& tree_b = b->bvh();
    const Bvh::Node& node = tree_a.nodes[0];
    ccd::OneBox one{};
    const int slot = i % tree_b.nodes[0].count;
    for (int c = 0; c < 3; ++c) {
      one.center[c] = tree_b.nodes[0].local_center[c][slot];
      one.half[c] = tree_b.nodes[0].half[c][slot];
    }
    alignas(32) float dt[8];
    ccd::best_kernels().box.advance_a(motion.frame(0.0), {node.local_center, node.half}, one, dt);
    for (int k = 0; k < node.count; ++k) {
      const Box box_a = tree_a.child_box(node, k), box_b = tree_b.child_box(tree_b.nodes[0], slot);
      const auto meet = [&](double until_dt) {
        for (int s = 0; s <= 20; ++s) {
          const double t = t0 + until_dt * s / 20.0;
          if (t > 1.0) break;
          // Corners of A's box in B's: a box in a box is enough of a check here.
          const Pose X_BA = mb.pose_at(t).inverse() * ma.pose_at(t);
          for (int corner = 0; corner < 8; ++corner) {
            Vec3 x;
            for (int c = 0; c < 3; ++c) x[c] = (corner >> c) & 1 ? box_a.hi[c] : box_a.lo[c];
            const Vec3 y = X_BA * x;
            if ((y.array() > box_b.lo.array()).all() && (y.array() < box_b.hi.array()).all())
              return true;
          }
        }
        return false;
      };
      if (dt[k] <= 0.0F) continue;
      ++granted;
      EXPECT_FALSE(meet(std::min<double>(dt[k], 1.0)));
      planted += meet(std::min(5.0 * static_cast<double>(dt[k]) + 0.2, 1.0));
    }
  }
  EXPECT_GT(granted, 200);
  EXPECT_GT(planted, 20) << "the check must be able to fail";
}

TEST(Engine, WarmQueryDoesNotAllocate) {
  const SolidPtr peg = solid(prism_mesh(9.95, 64, -12.5, 12.5));
  const SolidPtr bore = solid(tube_mesh(10, 20, 64, -40, 40));
  CcdScratch scratch;
  const ContactQuery tilt = query(peg, move({}, turn({0.02, 0, 0})), bore, Motion{});
  const ContactQuery both =
      query(peg, move({}, turn({0, 0, 0.1})), bore, slide({0, 0, 0}, {1, 0, 0}));
  first_contact(tilt, scratch), first_contact(both, scratch);
  distance(*peg, {}, *bore, {}, scratch);
  const long before = g_allocations;
  first_contact(tilt, scratch), first_contact(both, scratch);
  distance(*peg, {}, *bore, {}, scratch);
  surfaces_cross(*peg, {}, *bore, {}, scratch);
  EXPECT_EQ(g_allocations - before, 0);
  solid(box_mesh({1, 1, 1}));
  EXPECT_GT(g_allocations - before, 0) << "the counter counts";
}

TEST(Engine, LargePartsStaySmall) {
  // As many triangles as the largest part measured (263,730).
  const TriangleMesh mesh = sphere_mesh(50, 420, 315);
  ASSERT_GE(mesh.triangles.size(), 263'730U);
  const auto count = static_cast<double>(mesh.triangles.size());
  const SolidPtr big = solid(mesh);
  EXPECT_EQ(big->derived_bytes(), 0U) << "nothing is built before it is asked for";
  big->bvh();
  big->topology();
  big->shells();
  const double bytes = static_cast<double>(big->derived_bytes()) / count;
  std::printf("tree and topology: %.1f bytes a triangle\n", bytes);
  EXPECT_LE(bytes, 250.0);
  EXPECT_GE(bytes, 72.0) << "the corners alone";
}

TEST(Engine, TreeHoldsEveryTriangleOnce) {
  std::mt19937_64 random(43);
  for (const TriangleMesh& mesh :
       {sphere_mesh(3, 50, 30), convex_mesh(random, 14), box_mesh({1, 2, 3}, {1e6, 0, 0})}) {
    const Bvh bvh = build_bvh(mesh);
    std::vector<int> seen(mesh.triangles.size(), 0);
    const auto visit = [&](auto&& self, std::int32_t ref, const Box& within) -> void {
      if (ref >= 0) {
        const Bvh::Node& node = bvh.nodes[ref];
        for (int k = 0; k < node.count; ++k) self(self, node.child[k], bvh.child_box(node, k));
        return;
      }
      const Bvh::Leaf& leaf = bvh.leaves[~ref];
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        ++seen[bvh.triangle_order[i]];
        for (int k = 0; k < 3; ++k) {
          const Vec3& p = mesh.corner(bvh.triangle_order[i], k);
          EXPECT_TRUE((p.array() >= within.lo.array()).all() &&
                      (p.array() <= within.hi.array()).all());
          EXPECT_EQ(
              p, Vec3(bvh.corners[i][3 * k], bvh.corners[i][3 * k + 1], bvh.corners[i][3 * k + 2]));
        }
      }
    };
    visit(visit, bvh.root, bvh.bounds);
    for (int n : seen) EXPECT_EQ(n, 1);
  }
}

TEST(Engine, ManyTrianglesInOnePlace) {
  TriangleMesh mesh;
  for (int i = 0; i < 1000; ++i)
    append(mesh, tetrahedron_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  const SolidPtr heap = solid(mesh), cube = solid(box_mesh({1, 1, 1}));
  const FirstContact c = solve(cube, slide({5, 0.2, 0.2}, {0, 0.2, 0.2}), heap);
  ASSERT_EQ(c.state, ContactState::kContact);
  EXPECT_NEAR(c.t_contact, (5 - 0.5 - 1.0) / 5, 0.3);
}

double brute_distance(const TriangleMesh& a, const Pose& Xa, const TriangleMesh& b,
                      const Pose& Xb) {
  double best = 1e300;
  const TriangleMesh x = transformed(a, Xa), y = transformed(b, Xb);
  for (std::uint32_t i = 0; i < x.triangles.size(); ++i)
    for (std::uint32_t j = 0; j < y.triangles.size(); ++j)
      best = std::min(best, triangle_distance({x.corner(i, 0), x.corner(i, 1), x.corner(i, 2)},
                                              {y.corner(j, 0), y.corner(j, 1), y.corner(j, 2)})
                                .distance_mm);
  return best;
}

TEST(Distance, IsTheLeastOfAllPairs) {
  std::mt19937_64 random(44);
  CcdScratch scratch;
  int crossing = 0;
  for (int i = 0; i < 60; ++i) {
    const SolidPtr a = solid(convex_mesh(random, 16)), b = solid(sphere_mesh(1, 12, 7));
    const Pose Xa = random_pose(random, 1.5, kPi), Xb = random_pose(random, 1.5, kPi);
    const double twin = brute_distance(a->mesh(), Xa, b->mesh(), Xb);
    const DistanceResult d = distance(*a, Xa, *b, Xb, scratch);
    EXPECT_TRUE(d.within_limit);
    EXPECT_NEAR(d.distance_mm, twin, 1e-13);
    EXPECT_EQ(surfaces_cross(*a, Xa, *b, Xb, scratch), twin == 0.0);
    crossing += twin == 0.0;
    if (twin == 0.0) continue;
    EXPECT_NEAR((d.point_a_W - d.point_b_W).norm(), twin, 1e-12);
    const DistanceResult beyond = distance(*a, Xa, *b, Xb, scratch, 0.9 * twin);
    EXPECT_FALSE(beyond.within_limit);
    EXPECT_EQ(beyond.distance_mm, 0.9 * twin);
    EXPECT_EQ(distance(*a, Xa, *b, Xb, scratch, 1.1 * twin).distance_mm, d.distance_mm);
  }
  EXPECT_GT(crossing, 5);
  EXPECT_LT(crossing, 55);
}

struct Swept {
  SolidPtr a, b;
  Motion ma, mb;
};

Swept random_sweep(std::mt19937_64& random, int i) {
  Swept s;
  s.a = i % 2 == 0 ? solid(box_mesh({1.5, 0.3, 0.4})) : solid(convex_mesh(random, 12));
  s.b = i % 3 == 0 ? solid(sphere_mesh(0.7, 12, 8)) : solid(convex_mesh(random, 10));
  const Pose a0 = random_pose(random, 2.0, kPi), b0 = random_pose(random, 2.0, kPi);
  const double angle = i % 5 == 0 ? kPi : 2.0;
  const Pose a1 = random_pose(random, 0.0, angle) * a0, b1 = random_pose(random, 0.0, angle) * b0;
  const Pose a2{a1.q, random_pose(random, 2.5, 0).p}, b2{b1.q, random_pose(random, 2.5, 0).p};
  const Vec3 reference(0.1, -0.2, 0.05);
  s.ma = i % 4 == 0 ? screw_motion(a0, a2, reference) : linear_motion(a0, a2, reference);
  s.mb = i % 4 < 2
             ? still_motion(b0)
             : (i % 4 == 2 ? linear_motion(b0, b2, reference) : screw_motion(b0, b2, reference));
  return s;
}

// Compares with distances asked for along the way; `late_by` plants a fault in the answers.
int contradictions(int cases, double late_by, int& contacts, int& movers) {
  std::mt19937_64 random(45);
  CcdScratch scratch;
  int wrong = 0;
  for (int i = 0; i < cases; ++i) {
    const Swept s = random_sweep(random, i);
    ContactQuery q = query(s.a, s.ma, s.b, s.mb);
    q.check_contained = false;
    FirstContact c = first_contact(q, scratch);
    const FirstContact twin = first_contact_by_sampling(q, 64, scratch);
    const bool start =
        c.state == ContactState::kOverlappingAtStart || c.state == ContactState::kTouchingAtStart;
    if (start) {
      wrong += twin.t_contact != 0.0;
      continue;
    }
    if (twin.state == ContactState::kContact && c.state == ContactState::kFree) ++wrong;  // missed
    if (c.state != ContactState::kContact) continue;
    ++contacts;
    movers += s.mb.moves();
    c.t_contact += late_by;
    // Never late: free up to there; and not early: within accuracy there.
    if (twin.state == ContactState::kContact && twin.t_contact < c.t_contact) ++wrong;
    const DistanceResult at =
        distance(*s.a, s.ma.pose_at(c.t_contact), *s.b, s.mb.pose_at(c.t_contact), scratch);
    if (!(at.distance_mm > 0.0 && at.distance_mm <= q.accuracy_mm)) ++wrong;
  }
  return wrong;
}

TEST(Twin, AgreesOnRandomSweepsOfOneAndOfTwoMovers) {
  int contacts = 0, movers = 0;
  EXPECT_EQ(contradictions(900, 0.0, contacts, movers), 0);
  std::printf("%d contacts, %d of them of two movers\n", contacts, movers);
  EXPECT_GT(contacts, 150);
  EXPECT_GT(movers, 60);
}

TEST(Twin, FindsOutContactsThatAreTenThousandthLate) {
  int contacts = 0, movers = 0;
  const int wrong = contradictions(100, 1e-4, contacts, movers);
  EXPECT_GE(wrong, contacts * 9 / 10);
  EXPECT_GT(contacts, 20);
}

// A question that is cut short again and again and goes on each time from where it was proven clear
// ends as the same question without a cap.
TEST(FirstContact, GoesOnFromWhereItWasCutShort) {
  std::mt19937_64 random(77);
  const SolidPtr a = solid(sphere_mesh(3, 40, 20)), b = solid(sphere_mesh(5, 30, 20));
  CcdScratch scratch;
  int cut = 0, contacts = 0;
  for (int i = 0; i < 300; ++i) {
    ContactQuery query;
    query.a = a.get();
    query.b = b.get();
    query.motion_a = move(random_pose(random, 9, kPi), random_pose(random, 9, kPi));
    query.motion_b = move(random_pose(random, 9, kPi), random_pose(random, 9, kPi));
    query.separation_mm = i % 3 == 0 ? 0.05 : 0.0;
    const FirstContact whole = first_contact(query, scratch);
    if (whole.state == ContactState::kOverlappingAtStart) continue;
    query.work_cap = 20;
    FirstContact part = first_contact(query, scratch);
    for (; part.state == ContactState::kUndecided; part = first_contact(query, scratch)) {
      ++cut;
      ASSERT_GE(part.t_clear, query.t_from);
      // Steps that begin elsewhere end elsewhere within the accuracy, 1e-6 mm of some mm a tick.
      ASSERT_LE(part.t_clear, whole.t_contact + 1e-6) << i << " " << part.t_clear - whole.t_contact;
      if (part.t_clear == query.t_from) query.work_cap *= 2;
      query.t_from = part.t_clear;
    }
    ASSERT_EQ(part.state, whole.state) << i;
    EXPECT_NEAR(part.t_contact, whole.t_contact, 1e-6) << i;
    contacts += whole.state == ContactState::kContact ? 1 : 0;
  }
  EXPECT_GT(cut, 300);
  EXPECT_GT(contacts, 50);
}

}  // namespace
}  // namespace mortise::testing
