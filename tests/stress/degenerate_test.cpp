// Meshes as no one should make them: slivers, duplicates, triangles without area, common planes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"

namespace mortise::stress {
namespace {

using namespace mortise::testing;

std::string seeded(const char* what, std::uint64_t seed) {
  return std::string(what) + " of random_case(" + std::to_string(seed) + ")";
}

// Squeezed along any direction: every triangle a sliver, the part a sheet.
SolidPtr squeezed(const Solid& part, double by, std::mt19937_64& random) {
  TriangleMesh mesh = part.mesh();
  const Vec3 n = random_turn(random, 1.0).normalized();
  for (Vec3& p : mesh.points_mm) p -= (1.0 - by) * n.dot(p) * n;
  return solid(mesh);
}

// Each of some triangles cut in three by a point close to one corner: long needles beside it.
SolidPtr needled(const Solid& part, double aspect, std::mt19937_64& random) {
  TriangleMesh mesh = part.mesh();
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; i += 2) {
    const auto t = mesh.triangles[i];
    const Vec3 a = mesh.points_mm[t[0]], b = mesh.points_mm[t[1]], c = mesh.points_mm[t[2]];
    const double u = uniform(random, 0.2, 0.8) / aspect, v = uniform(random, 0.2, 0.8);
    // On an edge, hardly inside, or close to a corner.
    const Vec3 x = i % 3 == 0   ? Vec3(a + u * (b - a) + u * (c - a))
                   : i % 3 == 1 ? Vec3(a + v * (b - a) + u * (c - a))
                                : Vec3(a + v * (b - a));
    const auto k = static_cast<std::uint32_t>(mesh.points_mm.size());
    mesh.points_mm.push_back(x);
    mesh.triangles[i] = {t[0], t[1], k};
    mesh.triangles.push_back({t[1], t[2], k});
    mesh.triangles.push_back({t[2], t[0], k});
  }
  return solid(mesh);
}

SolidPtr spoiled(const Solid& part, std::mt19937_64& random) {
  TriangleMesh mesh = part.mesh();
  const std::size_t count = mesh.triangles.size();
  const auto any_point = [&] {
    return static_cast<std::uint32_t>(random() % mesh.points_mm.size());
  };
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = mesh.triangles[i];
    switch (random() % 6) {
      case 0:  // twice, as it is
        mesh.triangles.push_back(t);
        break;
      case 1:  // twice, the other way round
        mesh.triangles.push_back({t[0], t[2], t[1]});
        break;
      case 2:  // an edge
        mesh.triangles.push_back({t[0], t[1], t[1]});
        break;
      case 3:  // a point
        mesh.triangles.push_back({t[0], t[0], t[0]});
        break;
      case 4: {  // three points on a line, up to rounding
        mesh.points_mm.push_back(0.3 * mesh.points_mm[t[0]] + 0.7 * mesh.points_mm[t[1]]);
        const auto k = static_cast<std::uint32_t>(mesh.points_mm.size() - 1);
        mesh.triangles.push_back({t[0], k, t[1]});
        break;
      }
      default:  // points that nothing uses, points twice
        mesh.points_mm.push_back(mesh.points_mm[any_point()]);
    }
  }
  return solid(mesh);
}

TEST(Slivers, SheetsToAspect1e8) {
  for (const double aspect : {1e2, 1e4, 1e6, 1e8}) {
    char name[32];
    std::snprintf(name, sizeof name, "sheets, aspect %.0e", aspect);
    Sweep sweep(name);
    for (int i = 0; i < test::effort(50); ++i) {
      const std::uint64_t seed = 400'000 + static_cast<std::uint64_t>(i);
      std::mt19937_64 random(seed);
      Case c = random_case(seed);
      c.a = squeezed(*c.a, 1.0 / aspect, random);
      if (i % 2 == 0) c.b = squeezed(*c.b, 1.0 / aspect, random);
      c.ask_fcl = false;
      c.check_contained = false;  // rounding may leave a sheet without an inside
      sweep.ask(c, seeded(name, seed));
    }
    EXPECT_GT(sweep.contacts(), 10);
  }
}

TEST(Slivers, NeedlesToAspect1e8) {
  for (const double aspect : {1e2, 1e4, 1e6, 1e8}) {
    char name[32];
    std::snprintf(name, sizeof name, "needles, aspect %.0e", aspect);
    Sweep sweep(name);
    for (int i = 0; i < test::effort(50); ++i) {
      const std::uint64_t seed = 410'000 + static_cast<std::uint64_t>(i);
      std::mt19937_64 random(seed);
      Case c = random_case(seed);
      c.a = needled(*c.a, aspect, random);
      c.b = needled(*c.b, aspect, random);
      c.ask_fcl = false;
      c.check_contained = false;  // its edges no longer match
      sweep.ask(c, seeded(name, seed));
    }
    EXPECT_GT(sweep.contacts(), 10);
  }
}

TEST(Degenerate, DuplicatesAndTrianglesWithoutArea) {
  Sweep sweep("duplicated, without area");
  for (int i = 0; i < test::effort(100); ++i) {
    const std::uint64_t seed = 420'000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    Case c = random_case(seed);
    c.a = spoiled(*c.a, random);
    if (i % 2 == 0) c.b = spoiled(*c.b, random);
    c.ask_fcl = false;
    c.check_contained = false;
    sweep.ask(c, seeded("spoiled", seed));
  }
  EXPECT_GT(sweep.contacts(), 40);
}

// Boxes on a grid that move along it: common planes and parallel edges everywhere, and the time is
// known: the overlap of three intervals, exact in doubles.
TEST(Degenerate, BoxesOnAGrid) {
  Sweep sweep("coplanar, parallel edges");
  int graze = 0;
  for (int i = 0; i < test::effort(300); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(430'000 + i));
    const auto grid = [&](int lo, int hi) {
      return 0.25 * (lo + static_cast<int>(random() % static_cast<unsigned>(hi - lo + 1)));
    };
    const auto size = [&] { return Vec3(grid(1, 6), grid(1, 6), grid(1, 6)); };
    const Vec3 size_a = size(), size_b = size();
    TriangleMesh a = box_mesh(size_a), b = box_mesh(size_b);
    Case c;
    c.a = solid(i % 2 == 0 ? refined(a) : a);
    c.b = solid(i % 3 == 0 ? refined(refined(b)) : b);
    const Vec3 from((i % 5 < 2 ? -1 : 1) * grid(4, 12), grid(-5, 5), grid(-5, 5));
    const Vec3 by((from.x() > 0 ? -1 : 1) * grid(4, 24), i % 4 < 2 ? 0.0 : grid(-8, 8),
                  i % 4 == 3 ? grid(-8, 8) : 0.0);
    c.motion_a = slide(from, from + by);
    c.motion_b = still_motion({});
    c.ask_fcl = false;
    // The closed boxes share a point for t in [enter, leave].
    double enter = 0.0, leave = 1.0;
    for (int k = 0; k < 3; ++k) {
      const double reach = 0.5 * (size_a[k] + size_b[k]);
      if (by[k] == 0.0) {
        if (std::abs(from[k]) > reach) leave = -1.0;
        continue;
      }
      const double t0 = (-reach - from[k]) / by[k], t1 = (reach - from[k]) / by[k];
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    const FirstContact answer = sweep.ask(c, "grid case " + std::to_string(i));
    if (enter > leave) {
      EXPECT_EQ(answer.state, ContactState::kFree) << i;
    } else if (enter == 0.0) {
      EXPECT_TRUE(answer.t_contact == 0.0 && answer.state != ContactState::kFree) << i;
    } else {
      ASSERT_EQ(answer.state, ContactState::kContact) << i;
      EXPECT_LE(answer.t_contact, enter) << i;
      sweep.measured((enter - answer.t_contact) * by.norm(), 3e-6, "grid " + std::to_string(i));
      graze += enter == leave;
    }
  }
  EXPECT_GT(graze, 0) << "none only grazes";
}

// The same grid, turned by right angles about the axes, so that planes stay common only at the end.
TEST(Degenerate, QuarterTurnsOnAGrid) {
  Sweep sweep("quarter turns on a grid");
  for (int i = 0; i < test::effort(150); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(440'000 + i));
    const auto grid = [&](int n) {
      return 0.25 * (static_cast<int>(random() % static_cast<unsigned>(2 * n + 1)) - n);
    };
    const auto right = [&] {
      return rotation_exp(kPi / 2 * Vec3::Unit(static_cast<int>(random() % 3)));
    };
    Case c;
    c.a = solid(box_mesh({1.5, 0.5, 0.25}));
    c.b = i % 2 == 0 ? solid(refined(box_mesh({0.5, 1.0, 0.75}))) : solid(gear_mesh(1.0, 6, 0.5));
    const Pose X0{right(), {grid(4) + 2.0, grid(4), grid(3)}};
    const Pose X1{(right() * X0.q).normalized(), {grid(4) - 1.0, grid(4), grid(3)}};
    const Vec3 reference(grid(2), grid(2), 0.0);
    c.motion_a = i % 3 == 0 ? screw_motion(X0, X1, reference) : linear_motion(X0, X1, reference);
    c.motion_b = still_motion({right(), Vec3::Zero()});
    c.ask_fcl = false;
    sweep.ask(c, "quarter turn " + std::to_string(i));
  }
  EXPECT_GT(sweep.contacts(), 20);
}

}  // namespace
}  // namespace mortise::stress
