// Covers against what the parts are drawn as (cover_parts.h): no bound is below a point found in
// both, at poses and over motions; and the search with and without them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "common/ccd/distance.h"
#include "common/depth/body.h"
#include "common/depth/cells/cover_pair.h"
#include "common/depth/depth.h"
#include "common/depth/search/search.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/ball_parts.h"
#include "tests/unit/depth/drawn_pairs.h"
#include "tests/unit/depth/profile_parts.h"

namespace mortise {
namespace {

using namespace cover_parts;

constexpr double kNothing_mm = 1e-6;

// How deep the deepest point that is found lies in both, the lesser depth of the two. Starts from
// points of the meshes and climbs.
class Deepest {
 public:
  Deepest(const DrawnPair& pair, const Pose& X_BA, bool largest)
      : pair_(pair), X_BA_(X_BA), X_AB_(X_BA.inverse()), largest_(largest) {}

  double find(Random& random, int starts) {
    struct Start {
      double depth;
      Vec3 x;
    };
    std::vector<Start> all;
    for (int i = 0; i < starts; ++i) {
      const bool of_a = below(random, 2) == 0;
      const TriangleMesh& mesh = (of_a ? pair_.a : pair_.b).solid->mesh();
      const auto t = static_cast<std::uint32_t>(below(random, int(mesh.triangles.size())));
      double u = uniform(random, 0, 1), v = uniform(random, 0, 1);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      Vec3 x = mesh.corner(t, 0) + u * (mesh.corner(t, 1) - mesh.corner(t, 0)) +
               v * (mesh.corner(t, 2) - mesh.corner(t, 0));
      if (of_a) x = X_BA_ * x;
      all.push_back({depth(x), x});
    }
    std::sort(all.begin(), all.end(),
              [](const Start& p, const Start& q) { return p.depth > q.depth; });
    double most = -1e9;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, all.size()); ++i)
      most = std::max(most, climb(random, all[i].x, all[i].depth));
    return most;
  }

 private:
  double depth(const Vec3& x) const {
    return std::min(pair_.a.depth_in(X_AB_ * x, largest_), pair_.b.depth_in(x, largest_));
  }
  double climb(Random& random, Vec3 x, double at) const {
    double step = std::max(0.02, 2.0 * std::fabs(at));
    for (int i = 0; i < 160; ++i) {
      const Vec3 next = x + step * any_direction(random);
      if (const double d = depth(next); d > at) {
        at = d;
        x = next;
        step *= 1.5;
      } else {
        step *= 0.93;
      }
    }
    return at;
  }

  const DrawnPair& pair_;
  Pose X_BA_, X_AB_;
  bool largest_;
};

const CoverLayer& layer_of(const DrawnPart& part, bool largest) {
  const Body body(*part.solid, part.band);
  const Cover& cover = cover_of(body);
  EXPECT_TRUE(cover.found()) << cover.why_not;
  return largest ? cover.largest : cover.least;
}

struct Tally {
  int poses = 0, overlap = 0, apart = 0, tight = 0, below = 0, differ = 0;
};

// What is no depth bounds none, unless nothing is in both.
double bound_of(const CoverPair& pair, const Pose& X_BA) {
  std::uint64_t work = 0;
  const CoverOverlap overlap = pair.overlap(X_BA, kNothing_mm, work);
  const bool is_bound =
      overlap.most_mm <= kNothing_mm || pair.bounds_depth(overlap, X_BA, kNothing_mm, work);
  return is_bound ? overlap.most_mm : 1e9;
}

Tally judge_poses(std::uint64_t seed, int count, void (*spoil)(CoverLayer&),
                  DrawnPair (*draw)(Random&) = any_pair) {
  Random random(seed);
  Tally tally;
  for (int i = 0; i < count; ++i) {
    const DrawnPair pair = draw(random);
    for (const bool largest : {false, true}) {
      CoverLayer a = layer_of(pair.a, largest), b = layer_of(pair.b, largest);
      spoil(a);
      spoil(b);
      std::uint64_t work = 0;
      const double most = bound_of({a, b}, pair.X_BA);
      const double other = bound_of({b, a}, pair.X_BA.inverse());
      const double found = Deepest(pair, pair.X_BA, largest).find(random, 400);
      ++tally.poses;
      tally.overlap += found > 0.0;
      tally.apart += most <= kNothing_mm;
      tally.differ += CoverPair(a, b).apart(pair.X_BA, kNothing_mm, work) != (most <= kNothing_mm);
      tally.tight += found > 0.0 && most < 2.0 * found + 5e-3;
      if (2.0 * found <= std::min(most, other) + 1e-9) continue;
      if (++tally.below <= 3)
        std::printf("pair %d (%s, %s) layer %d: %.9f in both, bounds %.9f %.9f\n", i,
                    pair.a.what.c_str(), pair.b.what.c_str(), int(largest), 2.0 * found, most,
                    other);
    }
  }
  return tally;
}

TEST(Cover, NoBoundIsBelowAPointInBoth) {
  const Tally tally = judge_poses(7001, test::effort(400), [](CoverLayer&) {});
  std::printf("%d poses: %d overlap, %d proven apart, %d within 5 um\n", tally.poses, tally.overlap,
              tally.apart, tally.tight);
  EXPECT_EQ(tally.below, 0);
  EXPECT_EQ(tally.differ, 0);  // whether they are apart, asked with and without how deep
  EXPECT_GT(tally.overlap, test::effort(175));
  EXPECT_GT(tally.apart, test::effort(225));
}

// The test sees a wall that is 20 um off, and planes that are.
TEST(Cover, PlantedFaultsAreSeen) {
  const Tally walls = judge_poses(7002, 250, [](CoverLayer& layer) {
    for (Void& v : layer.voids)
      for (VoidWall& wall : v.walls) wall.r_mm += 0.02;
  });
  EXPECT_GT(walls.below, 0);
  const Tally shafts = judge_poses(7003, 250, [](CoverLayer& layer) {
    for (ConvexCell& cell : layer.cells) {
      for (auto& circle : cell.circles) circle.r_mm -= 0.02;
      HullCorners smaller;
      for (const Vec3& corner : cell.corners.all())
        smaller.push_back(corner + 0.02 * (cell.middle - corner).normalized());
      cell.corners = smaller;
    }
  });
  EXPECT_GT(shafts.below, 0);
  const Tally teeth = judge_poses(7008, 400, [](CoverLayer& layer) {
    if (layer.cells.size() > 3 && !layer.cells.front().round)  // teeth
      layer.cells.erase(layer.cells.begin(), layer.cells.end() - 1);
  });
  EXPECT_GT(teeth.below, 0);
}

TEST(Cover, NoBoundOfABallIsBelowAPointInBoth) {
  const Tally tally = judge_poses(
      7011, test::effort(300), [](CoverLayer&) {}, ball_pair);
  std::printf("%d poses: %d overlap, %d proven apart, %d within 5 um\n", tally.poses, tally.overlap,
              tally.apart, tally.tight);
  EXPECT_EQ(tally.below, 0);
  EXPECT_EQ(tally.differ, 0);
  EXPECT_GT(tally.overlap, test::effort(150));
  EXPECT_GT(tally.apart, test::effort(150));
}

// The hole of a cone is open though the chords of its rims are inside of it: whether a ball meets
// its seat is known, by the distance of its middle from the wall.
TEST(Cover, WhetherABallMeetsItsSeatIsKnown) {
  Random random(7015);
  const auto surface_of = [](const DrawnPart& part, SurfaceKind kind) {
    return std::find_if(
               part.band.faces.begin(), part.band.faces.end(),
               [&](const auto& face) { return face.surface && face.surface->kind == kind; })
        ->surface.value();
  };
  int meet = 0, apart = 0;
  for (int i = 0; i < test::effort(120); ++i) {
    const DrawnPair pair = seated_ball(random);
    const double away_mm = surface_of(pair.b, SurfaceKind::kCone).signed_distance_mm(pair.X_BA.p) -
                           surface_of(pair.a, SurfaceKind::kSphere).radius_mm;
    for (const bool largest : {false, true}) {
      const auto offset_mm = [&](const DrawnPart& part, const char* name) {
        return largest ? part.offsets.at(name).hi : part.offsets.at(name).lo;
      };
      const double truth_mm = offset_mm(pair.a, "ball") + offset_mm(pair.b, "cone") - away_mm;
      if (std::fabs(truth_mm) < 2e-5) continue;
      std::uint64_t work = 0;
      const CoverPair cells(layer_of(pair.a, largest), layer_of(pair.b, largest));
      EXPECT_EQ(cells.apart(pair.X_BA, kNothing_mm, work), truth_mm < 0.0) << i << " " << truth_mm;
      ++(truth_mm > 0.0 ? meet : apart);
    }
  }
  EXPECT_GT(meet, test::effort(30));
  EXPECT_GT(apart, test::effort(30));
}

// Also where the ball of a dome meets the other end of its pin, which it does not trim.
TEST(Cover, HoldsTheRimsOfADomedPin) {
  Random random(7016);
  int inside = 0, outside = 0;
  for (int i = 0; i < test::effort(100); ++i) {
    const DrawnPart part = domed_pin(random, uniform(random, 3.0, 12.0));
    const double bottom = part.solid->bounds().lo.z();
    for (const bool largest : {false, true})
      for (int k = 0; k < 200; ++k) {
        const Vec3 u = rotation_exp(uniform(random, -3.1, 3.1) * Vec3::UnitZ()) * Vec3::UnitX();
        const Vec3 x = (part.round_mm + uniform(random, -0.05, 0.05)) * u +
                       (bottom + uniform(random, -0.05, 0.3)) * Vec3::UnitZ();
        if (!(part.depth_in(x, largest) > 1e-6)) continue;
        ++inside;
        const std::vector<ConvexCell>& cells = layer_of(part, largest).cells;
        outside += std::none_of(cells.begin(), cells.end(), [&](const ConvexCell& cell) {
          return (cell.near(x) - x).norm() < 1e-9;
        });
      }
  }
  EXPECT_EQ(outside, 0) << "of " << inside;
  EXPECT_GT(inside, test::effort(5000));
}

TEST(Cover, PlantedFaultsOfABallAreSeen) {
  const auto small_ball = [](CoverLayer& layer) {
    for (ConvexCell& cell : layer.cells)
      for (ConvexCell::Zone& zone : cell.zones) zone.r_mm -= 0.02;
  };
  const auto wide_socket = [](CoverLayer& layer) {
    for (Void& v : layer.voids)
      for (VoidWall& wall : v.walls) wall.r_mm += wall.is_socket ? 0.02 : 0.0;
  };
  EXPECT_GT(judge_poses(7012, 200, small_ball, ball_pair).below, 0);
  EXPECT_GT(judge_poses(7013, 200, wide_socket, ball_pair).below, 0);
}

// A shaft with flats, or with round corners, nearly in the middle of its hole; the shaft also
// rests in a bore, and any part in such a hole.
DrawnPair profile_pair(Random& random) {
  const double r = uniform(random, 4.0, 12.0), less = uniform(random, -0.02, 0.1);
  const double flat = r * uniform(random, 0.3, 0.95), side = r * uniform(random, 0.4, 1.0);
  const double corner = below(random, 3) == 0 ? side : side * uniform(random, 0.1, 0.9);
  const int kind = below(random, 3), facets = 4 + below(random, 20);
  const auto profile = [&](double by) {
    if (kind < 2) return flattened(r - by, flat - by, kind == 1, 2 * facets);
    return rounded(r - by, side - by, corner - by, facets);
  };
  const int other = below(random, 6);
  DrawnPair pair{other == 0 ? shaft(random, 0.5 * r) : profile_part(random, profile(less), false),
                 other == 1 ? ring(random, r) : profile_part(random, profile(0.0), true),
                 {}};
  const double off = below(random, 3) == 0 ? uniform(random, 0.0, 0.2) : 0.01;
  const Vec3 turn = below(random, 2) * uniform(random, 0.0, 5e-3) * any_direction(random);
  pair.X_BA.q = rotation_exp(turn);
  pair.X_BA.p = off * any_direction(random) + uniform(random, -0.9, 0.9) *
                                                  std::min(pair.a.length_mm, pair.b.length_mm) *
                                                  Vec3::UnitZ();
  return pair;
}

TEST(Cover, NoBoundOfAProfileIsBelowAPointInBoth) {
  const Tally tally = judge_poses(
      7011, test::effort(300), [](CoverLayer&) {}, profile_pair);
  std::printf("%d poses: %d overlap, %d proven apart, %d within 5 um\n", tally.poses, tally.overlap,
              tally.apart, tally.tight);
  EXPECT_EQ(tally.below, 0);
  EXPECT_EQ(tally.differ, 0);
  EXPECT_GT(tally.overlap, test::effort(60));
  EXPECT_GT(tally.apart, test::effort(150));
}

TEST(Cover, PlantedFaultsOfAProfileAreSeen) {
  const Tally flats = judge_poses(
      7012, 250,
      [](CoverLayer& layer) {
        for (Void& v : layer.voids)
          for (HalfSpace& plane : v.planes) plane.c_mm -= 0.02;
      },
      profile_pair);
  EXPECT_GT(flats.below, 0);
  const Tally rounds = judge_poses(
      7013, 250,
      [](CoverLayer& layer) {
        for (Void& v : layer.voids)
          for (VoidWall& wall : v.walls) wall.r_mm += 0.02;
        for (ConvexCell& cell : layer.cells)
          for (ConvexCell& piece : cell.pieces)
            for (auto& circle : piece.circles) circle.r_mm -= 0.02;
      },
      profile_pair);
  EXPECT_GT(rounds.below, 0);
}

Motion any_motion(Random& random, const Pose& X_W, const Vec3& reference, bool along) {
  const double far = below(random, 2) == 0 ? 0.3 : 5.0;
  Vec3 way = uniform(random, 0.0, far) * any_direction(random);
  Vec3 turn = below(random, 2) * uniform(random, 0.0, 0.02) * any_direction(random);
  if (along) {
    way = X_W.q * Vec3(0.0, 0.0, uniform(random, -far, far));
    turn = below(random, 2) * uniform(random, -1.0, 1.0) * (X_W.q * Vec3::UnitZ());
  }
  const Pose turned{(rotation_exp(turn) * X_W.q).normalized(),
                    X_W.p + way + (X_W.q * reference) - rotation_exp(turn) * (X_W.q * reference)};
  if (below(random, 3) == 0) return screw_motion(X_W, turned, reference);
  return linear_motion(X_W, turned, reference);
}

// One or two movers, straight and by screws, in a frame of their own.
SweptQuery any_sweep(Random& random, const DrawnPair& pair) {
  SweptQuery query;
  query.at_target.a = pair.a.solid.get();
  query.at_target.b = pair.b.solid.get();
  query.at_target.band_a = &pair.a.band;
  query.at_target.band_b = &pair.b.band;
  query.at_target.work_cap = 3000;
  const Pose X_WB{rotation_exp(uniform(random, 0.0, 3.0) * any_direction(random)),
                  50.0 * any_direction(random)};
  const bool along = below(random, 2) == 0;
  query.motion_a = any_motion(random, X_WB * pair.X_BA, pair.a.axis_point, along);
  query.motion_b = below(random, 3) == 0 ? any_motion(random, X_WB, pair.b.axis_point, along)
                                         : still_motion(X_WB);
  return query;
}

struct Times {
  int free = 0, later = 0, never = 0;
};

Times judge_times(std::uint64_t seed, int count, DrawnPair (*draw)(Random&)) {
  Random random(seed);
  Times times;
  for (int i = 0; i < count; ++i) {
    const DrawnPair pair = draw(random);
    const SweptQuery query = any_sweep(random, pair);
    const PairPath path(query.motion_a, *pair.a.solid, query.motion_b, *pair.b.solid);
    for (const bool largest : {false, true}) {
      const CoverPair cells(layer_of(pair.a, largest), layer_of(pair.b, largest));
      const CoverFree proven = cells.free_until(path, kNothing_mm, 2.5e-5);
      const double end = proven.all ? 1.0 : proven.t_free;
      times.free += proven.all;
      times.later += !proven.all && end > 0.0;
      times.never += end <= 0.0;
      for (int k = 0; k < 4; ++k) {
        const double t = end * (k == 0 ? 1.0 : uniform(random, 0.0, 1.0));
        if (!proven.all && end <= 0.0) break;
        const double found = Deepest(pair, path.pose(0, t), largest).find(random, 150);
        EXPECT_LE(2.0 * found, 2.0 * kNothing_mm)
            << "pair " << i << " (" << pair.a.what << ", " << pair.b.what << ") at " << t;
      }
    }
  }
  std::printf("%d free, %d later, %d not at all\n", times.free, times.later, times.never);
  return times;
}

TEST(Cover, NothingIsInBothBeforeTheTimeThatIsProvenFree) {
  const Times any = judge_times(7004, test::effort(400), any_pair);
  EXPECT_GT(any.free, test::effort(134));
  EXPECT_GT(any.later, test::effort(80));
  const Times of_balls = judge_times(7014, test::effort(150), ball_pair);
  EXPECT_GT(of_balls.free, test::effort(50));
  EXPECT_GT(of_balls.later, test::effort(30));
}

// With covers and without them: the search may know less of what is free, never the opposite.
TEST(Cover, SearchesAgreeWithThoseWithoutCovers) {
  Random random(7005);
  int settled = 0, both_real = 0, less = 0, opposite = 0;
  for (int i = 0; i < test::effort(120); ++i) {
    const DrawnPair pair = any_pair(random);
    SweptQuery query = any_sweep(random, pair);
    CcdScratch scratch;
    const InterferenceTime with = find_interference_time(query, scratch);
    std::uint64_t work = 0;
    const double proven = certain_free_until(query, work).t;
    settled += proven >= 1.0;
    query.at_target.use_covers = false;
    const InterferenceTime without = find_interference_time(query, scratch);
    both_real += with.becomes_real && without.becomes_real;
    EXPECT_EQ(work > 0, true);
    const PairPath path(query.motion_a, *pair.a.solid, query.motion_b, *pair.b.solid);
    const double speed = path.speed_upper_bound();
    // A time at which it is real comes after what the other way has proven free.
    if (with.becomes_real && (with.t_real - without.t_free) * speed < -1e-3) ++opposite;
    if (without.becomes_real && (without.t_real - with.t_free) * speed < -1e-3) ++opposite;
    if ((with.t_free - without.t_free) * speed < -0.03 && !with.capped) ++less;
  }
  std::printf("%d settled by covers, %d real in both, %d proven for less long, %d opposite\n",
              settled, both_real, less, opposite);
  EXPECT_GT(settled, test::effort(20));
  EXPECT_GT(both_real, test::effort(8));
  EXPECT_EQ(opposite, 0);
}

// A search ends a path at its accuracy, where covers are deeper in each other than they let a path
// end: a part that stands there comes out again, and is told at once that it is real a little on.
TEST(Cover, WhoStandsWhereASearchHasEndedMayLeave) {
  constexpr double kDeep_mm = 1.5e-4, kTooDeep_mm = 1e-2;
  Random random(7006);
  int left = 0, held = 0;
  for (int i = 0; i < test::effort(400); ++i) {
    const DrawnPair pair = any_pair(random);
    const SweptQuery in = any_sweep(random, pair);
    if (in.motion_a.kind != PathKind::kLinear || in.motion_b.moves()) continue;
    std::uint64_t work = 0;
    const FreeUntil free = certain_free_until(in, work);
    if (free.t <= 0.0 || free.t >= 1.0) continue;
    const CoverPair cells(layer_of(pair.a, false), layer_of(pair.b, false));
    const auto within = [&](double t, double mm) {
      const PairPath still(still_motion(in.motion_a.pose_at(t)), *pair.a.solid, in.motion_b,
                           *pair.b.solid);
      return cells.free_until(still, mm, 1e-9).all;
    };
    double lo = free.t, hi = 1.0;
    if (within(hi, kTooDeep_mm)) continue;
    for (int k = 0; k < 50; ++k) (within(0.5 * (lo + hi), kDeep_mm) ? lo : hi) = 0.5 * (lo + hi);
    if (within(lo, 0.9 * kDeep_mm)) continue;
    bool only_deepens = true;
    for (int k = 1; k < 16; ++k) only_deepens &= within(lo + k / 16.0 * (free.t - lo), kDeep_mm);
    // Where an edge passes the rim of a hole the bound may deepen faster than the path is long.
    const PairPath path(in.motion_a, *pair.a.solid, in.motion_b, *pair.b.solid);
    only_deepens &= within(lo + kDeep_mm / path.speed_upper_bound(), 2.1 * kDeep_mm);
    if (!only_deepens) continue;
    SweptQuery out = in, on = in;
    on.slides = false;
    out.motion_a =
        linear_motion(in.motion_a.pose_at(lo), in.motion_a.X_W0, in.motion_a.reference_P);
    on.motion_a = linear_motion(in.motion_a.pose_at(lo), in.motion_a.X_W1, in.motion_a.reference_P);
    const FreeUntil leaves = certain_free_until(out, work), stays = certain_free_until(on, work);
    EXPECT_TRUE(leaves.touches && stays.touches) << i;
    EXPECT_EQ(leaves.t, 1.0) << i;
    EXPECT_EQ(stays.t, 0.0) << i;
    CcdScratch scratch;
    const InterferenceTime real = find_interference_time(on, scratch);
    held += real.becomes_real && real.t_free == 0.0;
    ++left;
  }
  std::printf("%d may leave, %d of them are held when they go on\n", left, held);
  EXPECT_GT(left, test::effort(20));
  EXPECT_GT(4 * held, 3 * left);
}

CollisionClass class_of(const OverlapResult& result) {
  CollisionClass word = CollisionClass::kNone;
  for (const OverlapRegion& region : result.regions) {
    const bool real = region.certain_mm.lo > 0.0 && region.has_witness;
    word = std::max(word, real                          ? CollisionClass::kReal
                          : region.possible_mm.hi > 0.0 ? CollisionClass::kPotential
                                                        : CollisionClass::kFake);
  }
  return word;
}

OverlapQuery overlap_of(const DrawnPair& pair) {
  OverlapQuery query;
  query.a = pair.a.solid.get();
  query.b = pair.b.solid.get();
  query.band_a = &pair.a.band;
  query.band_b = &pair.b.band;
  query.X_WA = pair.X_BA;
  query.work_cap = 5000;
  return query;
}

OverlapQuery look_at(const DrawnPair& pair) {
  OverlapQuery query = overlap_of(pair);
  query.want_delta = false;
  query.prove_not_certain = true;
  return query;
}

/// Words with covers beside those without them.
struct Words {
  int decided = 0, more = 0, less = 0, opposite = 0;

  void compare(const OverlapResult& with, const OverlapResult& without) {
    const CollisionClass word = class_of(with), other = class_of(without);
    const bool open = other == CollisionClass::kPotential;
    decided += !open;
    more += open && word != other;
    less += !open && word == CollisionClass::kPotential;
    opposite += (word == CollisionClass::kReal) != (other == CollisionClass::kReal) && !open &&
                word != CollisionClass::kPotential;
  }
};

// What one way decides the other one does not deny, and no witness is refused.
TEST(Cover, WordsAgreeWithThoseWithoutCovers) {
  Random random(7006);
  Words words;
  int refused = 0;
  for (int i = 0; i < test::effort(150); ++i) {
    const DrawnPair pair = any_pair(random);
    OverlapQuery query = overlap_of(pair);
    query.refinement = Refinement::kDecided;
    CcdScratch scratch;
    const OverlapResult with = find_overlap(query, scratch);
    query.use_covers = false;
    words.compare(with, find_overlap(query, scratch));
    // One point may be refused where another one is found.
    for (const OverlapRegion& region : with.regions)
      if (!region.has_witness) refused += static_cast<int>(region.witnesses_refused);
  }
  std::printf("%d decided without covers, %d more with them, %d less\n", words.decided, words.more,
              words.less);
  EXPECT_EQ(words.opposite, 0);
  EXPECT_EQ(words.less, 0);
  EXPECT_EQ(refused, 0);
  EXPECT_GT(words.more, 0);
}

// Behind a chamfer a depth by the mesh is as good as its chords.
constexpr double kMeshDepth_mm = 1e-3;

// By the drawings, climbing from a place: how deep the most of `value` is, and where.
template <class Value>
double climb_from(Random& random, Vec3 x, double step, const Value& value) {
  double at = value(x);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 next = x + step * any_direction(random);
    const double there = value(next);
    if (there > at) {
      at = there;
      x = next;
      step *= 1.5;
    } else {
      step = std::max(1e-9, 0.97 * step);
    }
  }
  return at;
}

// How deep a point that is in one of both drawn parts lies in the other, at most, from below.
double deepest_of_drawings(const DrawnPair& pair, bool largest) {
  const Pose X_AB = pair.X_BA.inverse();
  Random random(11);
  double most = -1e9;
  for (int i = 0; i < 80; ++i) {
    const bool of_a = i % 2 == 0;
    const TriangleMesh& mesh = (of_a ? pair.a : pair.b).solid->mesh();
    const Vec3 x = mesh.corner(
        static_cast<std::uint32_t>(below(random, int(mesh.triangles.size()))), below(random, 3));
    most = std::max(most, climb_from(random, of_a ? pair.X_BA * x : x, 0.3, [&](const Vec3& y) {
                      const double a = pair.a.depth_in(X_AB * y, largest),
                                   b = pair.b.depth_in(y, largest);
                      return (of_a ? b : a) + 50.0 * std::min(0.0, of_a ? a : b);
                    }));
  }
  return most;
}

// The most that the depths in both drawn parts add up to near a place of both, from below.
double overlap_of_drawings(const DrawnPair& pair, bool largest, const Vec3& near_B) {
  const Pose X_AB = pair.X_BA.inverse();
  Random random(12);
  double most = -1e9;
  for (int i = 0; i < 60; ++i)
    most =
        std::max(most, climb_from(random, near_B + uniform(random, 0, 0.05) * any_direction(random),
                                  0.02, [&](const Vec3& y) {
                                    const double a = pair.a.depth_in(X_AB * y, largest),
                                                 b = pair.b.depth_in(y, largest);
                                    return a + b + 100.0 * std::min({0.0, a, b});
                                  }));
  return most;
}

// A point of either surface of the layer, drawn anew; how deep it lies in the other part.
double deepest_of_surfaces(const PairFrame& pair, Layer layer, Random& random, int points) {
  double most = -1e9;
  for (int i = 0; i < points; ++i) {
    const int role = below(random, 2);
    const TriangleMesh& mesh = *pair.s(role).mesh;
    const auto t = static_cast<std::uint32_t>(below(random, int(mesh.triangles.size())));
    double u = uniform(random, 0, 1), v = below(random, 2) * uniform(random, 0, 1);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const Vec3 x = mesh.corner(t, 0) + u * (mesh.corner(t, 1) - mesh.corner(t, 0)) +
                   v * (mesh.corner(t, 2) - mesh.corner(t, 0));
    const Sample at = sample_at(pair, layer, role, t, x);
    if (at.depth_mm <= most) continue;
    // Where a neighbour cuts its face short it is no point of the part.
    const Vec3 x_S = pair.X_KS[1 - role] * at.point_K;
    const Body& s = pair.s(role);
    if (s.depth_in(x_S, nearest_surface(*s.solid, x_S), layer) > -kNothing_mm) most = at.depth_mm;
  }
  return most;
}

// What covers call a depth holds in the parts, inside hollow edges as well.
TEST(Cover, NoSurfaceIsDeeperThanADepth) {
  Random random(7007);
  int depths = 0, deeper = 0;
  for (int i = 0; i < test::effort(400); ++i) {
    const DrawnPair pair = any_pair(random);
    const PairFrame frame(look_at(pair));
    for (const bool largest : {false, true}) {
      std::uint64_t work = 0;
      const CoverLayer a = layer_of(pair.a, largest), b = layer_of(pair.b, largest);
      const CoverPair covers(a, b);
      const CoverOverlap overlap = covers.overlap(frame.X_KS[0], frame.touch_mm, work);
      if (!covers.bounds_depth(overlap, frame.X_KS[0], frame.touch_mm, work)) continue;
      ++depths;
      const double found =
          deepest_of_surfaces(frame, largest ? Layer::kUpper : Layer::kLower, random, 3000);
      if (found <= overlap.most_mm + kMeshDepth_mm) continue;
      // A depth by the mesh may be said too deep: the drawings decide.
      if (deepest_of_drawings(pair, largest) <= overlap.most_mm + 1e-5) continue;
      if (++deeper <= 3)
        std::printf("pair %d (%s, %s) layer %d: %.6f deep, said %.6f\n", i, pair.a.what.c_str(),
                    pair.b.what.c_str(), int(largest), found, overlap.most_mm);
    }
  }
  std::printf("%d depths by covers\n", depths);
  EXPECT_EQ(deeper, 0);
  EXPECT_GT(depths, test::effort(67));
}

// Looks at certain and possible alone, lazily and in full: brackets of the deepest region that have
// nothing in common with those of the search would be a contradiction.
TEST(Cover, LooksAgreeWithThoseWithoutCovers) {
  Random random(7008);
  Words words;
  const int looks = test::effort(150);
  int told = 0, apart = 0;
  for (int i = 0; i < looks; ++i) {
    const DrawnPair pair = any_pair(random);
    OverlapQuery query = look_at(pair);
    query.refinement = i % 2 == 0 ? Refinement::kDecided : Refinement::kFull;
    query.only_certain = i % 3 == 0;
    CcdScratch scratch;
    const OverlapResult with = find_overlap(query, scratch);
    query.use_covers = false;
    const OverlapResult without = find_overlap(query, scratch);
    told += with.evaluations < without.evaluations / 4;
    const auto most = [](const OverlapResult& result, Interval OverlapRegion::*of) {
      Interval found{-1e9, 0.0};
      for (const OverlapRegion& region : result.regions) {
        found.lo = std::max(found.lo, (region.*of).lo);
        found.hi = std::max(found.hi, (region.*of).hi);
      }
      return found;
    };
    // Faces beyond moved neighbours are too deep for the search, and its upper ends were seen
    // 0.12 um below the truth: the drawings decide.
    const auto compare = [&](Interval OverlapRegion::*of, bool largest) {
      const Interval x = most(with, of), y = most(without, of);
      if (y.hi < x.lo - 1e-5)
        apart += overlap_of_drawings(pair, largest, with.regions.front().witness_W) < x.lo - 1e-6;
      if (x.hi < y.lo - 1e-5)
        apart += 2.0 * Deepest(pair, pair.X_BA, largest).find(random, 800) > x.hi + 1e-5;
    };
    compare(&OverlapRegion::certain_mm, false);
    if (query.only_certain) continue;
    compare(&OverlapRegion::possible_mm, true);
    words.compare(with, without);
  }
  std::printf("%d of %d looks with a quarter of the work or less\n", told, looks);
  EXPECT_EQ(apart, 0);
  EXPECT_EQ(words.opposite, 0);
  EXPECT_EQ(words.less, 0);
  EXPECT_GT(told, test::effort(57));
}

}  // namespace
}  // namespace mortise
