#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "common/depth/search/patch.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"
#include "tests/unit/depth/overlap_case.h"

namespace mortise {
namespace {

using namespace shapes;

struct RowPoint {
  double out = 0.0, up = 0.0;
};
using Profile = std::vector<RowPoint>;  // closed, its material on the left

// A profile turned about z; by part of a turn where it is convex.
TriangleMesh revolved(const Profile& profile, int facets, double phase_rad, double arc_rad) {
  const bool closed = arc_rad >= 2.0 * kPi;
  const auto rows = static_cast<std::uint32_t>(profile.size());
  const auto steps = static_cast<std::uint32_t>(facets);
  const std::uint32_t columns = closed ? steps : steps + 1;
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < columns; ++i)
    for (const RowPoint& p : profile) {
      const double a = phase_rad + arc_rad * i / facets;
      mesh.points_mm.emplace_back(p.out * std::cos(a), p.out * std::sin(a), p.up);
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % columns * rows + j % rows; };
  for (std::uint32_t i = 0; i < steps; ++i)
    for (std::uint32_t j = 0; j < rows; ++j)
      add_quad(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  for (std::uint32_t j = 1; !closed && j + 1 < rows; ++j) {
    mesh.triangles.push_back({at(0, 0), at(0, j), at(0, j + 1)});
    mesh.triangles.push_back({at(steps, 0), at(steps, j + 1), at(steps, j)});
  }
  return mesh;
}

// Points of a circle from one angle to another.
void add_arc(Profile& profile, RowPoint center, double radius, double from, double to, int steps,
             bool last = true) {
  for (int i = 0; i < steps + (last ? 1 : 0); ++i) {
    const double a = from + (to - from) * i / steps;
    profile.push_back({center.out + radius * std::cos(a), center.up + radius * std::sin(a)});
  }
}

Surface round_surface(SurfaceKind kind, double radius, double tube, bool inward) {
  Surface surface;
  surface.kind = kind;
  surface.radius_mm = radius;
  surface.tube_radius_mm = tube;
  surface.inward = inward;
  return surface;
}

SurfaceBand declared(const SolidPtr& solid, const std::vector<Surface>& surfaces) {
  std::vector<Feature> features;
  for (const Surface& surface : surfaces) {
    FeatureDeclaration declaration;
    declaration.name = "round_" + std::to_string(features.size());
    declaration.surface = surface;
    const auto match = match_feature(solid->mesh(), declaration);
    EXPECT_TRUE(match) << (match ? "" : match.error().text);
    if (match) features.push_back(match->feature);
  }
  BandInput input;
  input.solid = solid.get();
  input.features = features;
  input.of_feature.resize(features.size());
  return build_band(input);
}

enum class Kind { kGroove, kGland, kBore, kShaft, kPlane, kBall, kSegment, kCount };

// A ring (or ball, or part of a ring) and what it meets, with their exact sets. Frame of the
// second.
struct Pair {
  OverlapCase query;
  double size_mm = 0.0;
  std::function<Vec3(double, double)> surface_a;  // by two shares in [0, 1], in A
  std::function<double(const Vec3&)> depth_b;     // below the surface of B, exact inside
  std::function<Vec3(double, double)> surface_b;  // of the round face, in B
  std::function<double(const Vec3&)> depth_a;
  Pose X_BA;
};

double out_of(const Vec3& x) { return std::hypot(x.x(), x.y()); }
double off_circle(const Vec3& x, double radius) { return std::hypot(out_of(x) - radius, x.z()); }

Vec3 on_torus(double radius, double tube, double turn, double around) {
  const double out = radius + tube * std::cos(around);
  return {out * std::cos(turn), out * std::sin(turn), tube * std::sin(around)};
}

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {}

  Pair make(Kind kind) {
    Pair pair;
    const double scale = std::pow(10.0, uniform(-1.0, 1.0));
    radius_ = scale * uniform(8.0, 30.0);
    tube_ = radius_ * uniform(0.05, 0.3);
    clearance_ = scale * uniform(0.005, 0.06);
    turns_ = facets();
    around_ = facets();
    phase_ = uniform(0.0, 1.0);
    arc_ = kind == Kind::kSegment ? uniform(0.3, 1.6) * kPi : 2.0 * kPi;
    pair.size_mm = radius_;
    make_ring(kind, pair);
    make_other(kind, pair);
    place(kind, pair);
    return pair;
  }
  double uniform(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }

 private:
  int facets() { return std::uniform_int_distribution<int>(12, 64)(random_); }
  Vec3 direction() {
    std::normal_distribution<double> normal;
    return Vec3(normal(random_), normal(random_), normal(random_)).normalized();
  }
  Pose anywhere() {
    return {rotation_exp(uniform(-kPi, kPi) * direction()), 3.0 * radius_ * direction()};
  }

  void make_ring(Kind kind, Pair& pair) {
    const double R = radius_, r = tube_, arc = arc_;
    Profile profile;
    if (kind == Kind::kBall) {
      for (int i = 0; i <= around_ / 2; ++i) {
        const double a = -0.49 * kPi + 0.98 * kPi * i / (around_ / 2);
        profile.push_back({r * std::cos(a), r * std::sin(a)});
      }
      profile.push_back({0.01 * r, r * std::sin(0.49 * kPi)});
      profile.push_back({0.01 * r, -r * std::sin(0.49 * kPi)});
      pair.query.a = solid(revolved(profile, turns_, phase_, 2.0 * kPi));
      pair.query.band_a =
          declared(pair.query.a, {round_surface(SurfaceKind::kSphere, r, 0.0, false)});
      pair.surface_a = [r](double u, double v) {
        return Vec3(on_torus(0.0, r, 2.0 * kPi * u, kPi * (v - 0.5)));
      };
      pair.depth_a = [r](const Vec3& x) { return r - x.norm(); };
      return;
    }
    add_arc(profile, {R, 0.0}, r, phase_, phase_ + 2.0 * kPi, around_, false);
    const double from = phase_;
    pair.query.a = solid(revolved(profile, turns_, from, arc));
    pair.query.band_a = declared(pair.query.a, {round_surface(SurfaceKind::kTorus, R, r, false)});
    pair.surface_a = [R, r, arc, from](double u, double v) {
      return on_torus(R, r, from + arc * u, 2.0 * kPi * v);
    };
    pair.depth_a = [R, r, arc, from](const Vec3& x) {
      const double off = std::remainder(std::atan2(x.y(), x.x()) - from - 0.5 * arc, 2.0 * kPi);
      const double beside = out_of(x) * (0.5 * arc - std::fabs(off));
      const double depth = r - off_circle(x, R);
      return arc < 2.0 * kPi ? std::min(depth, beside) : depth;
    };
  }

  void make_other(Kind kind, Pair& pair) {
    const double R = radius_, g = tube_ + clearance_, high = 3.0 * tube_;
    const double inner = 0.4 * R, outer = 1.8 * R;
    Profile profile;
    if (kind == Kind::kGroove || kind == Kind::kBall || kind == Kind::kSegment) {
      profile = {{inner, -high}, {outer, -high}, {outer, 0.0}};
      add_arc(profile, {R, 0.0}, g, 0.0, -kPi, around_);
      profile.push_back({inner, 0.0});
      finish(profile, {round_surface(SurfaceKind::kTorus, R, g, true)}, pair);
      pair.depth_b = [R, g](const Vec3& x) { return std::min(-x.z(), off_circle(x, R) - g); };
      pair.surface_b = [R, g](double u, double v) {
        return on_torus(R, g, 2.0 * kPi * u, -kPi * v);
      };
    } else if (kind == Kind::kGland) {
      profile = {{outer, -high}, {outer, high}, {R, high}};
      add_arc(profile, {R, 0.0}, g, 0.5 * kPi, -0.5 * kPi, around_);
      profile.push_back({R, -high});
      finish(profile,
             {round_surface(SurfaceKind::kTorus, R, g, true),
              round_surface(SurfaceKind::kCylinder, R, 0.0, true)},
             pair);
      pair.depth_b = [R, g](const Vec3& x) {
        return std::min(out_of(x) - R, off_circle(x, R) - g);
      };
      pair.surface_b = [R, g](double u, double v) {
        return on_torus(R, g, 2.0 * kPi * u, kPi * (v - 0.5));
      };
    } else if (kind == Kind::kBore) {
      const double bore = R + g;
      profile = {{outer, -high}, {outer, high}, {bore, high}, {bore, -high}};
      finish(profile, {round_surface(SurfaceKind::kCylinder, bore, 0.0, true)}, pair);
      pair.depth_b = [bore](const Vec3& x) { return out_of(x) - bore; };
    } else {
      const double shaft = kind == Kind::kPlane ? outer : R - g;
      profile = {{0.01 * R, -high}, {shaft, -high}, {shaft, high}, {0.01 * R, high}};
      finish(profile, {round_surface(SurfaceKind::kCylinder, shaft, 0.0, false)}, pair);
      if (kind == Kind::kPlane)
        pair.depth_b = [high](const Vec3& x) { return high - x.z(); };
      else
        pair.depth_b = [shaft](const Vec3& x) { return shaft - out_of(x); };
    }
  }

  void finish(const Profile& profile, const std::vector<Surface>& surfaces, Pair& pair) {
    pair.query.b = solid(revolved(profile, turns_, 0.0, 2.0 * kPi));
    pair.query.band_b = declared(pair.query.b, surfaces);
  }

  // Off the middle by up to twice the clearance.
  void place(Kind kind, Pair& pair) {
    const double tilt = uniform(0.0, 1.0) * clearance_ / radius_;
    const double off = uniform(0.0, 2.0) * clearance_;
    Vec3 p = off * direction();
    if (kind == Kind::kPlane) p = Vec3(0, 0, 4.0 * tube_ + uniform(-1.0, 1.0) * clearance_);
    if (kind == Kind::kBall) {
      const double a = uniform(-kPi, kPi);
      p += radius_ * Vec3(std::cos(a), std::sin(a), 0.0);
    }
    Vec3 axis = direction();
    axis.z() = 0.0;
    pair.X_BA = {rotation_exp(tilt * axis.normalized()), p};
    if (kind != Kind::kSegment)
      pair.X_BA = pair.X_BA * Pose{rotation_exp(uniform(-kPi, kPi) * Vec3::UnitZ()), Vec3::Zero()};
    pair.query.X_WB = anywhere();
    pair.query.X_WA = pair.query.X_WB * pair.X_BA;
  }

  std::mt19937_64 random_;
  double radius_ = 0.0, tube_ = 0.0, clearance_ = 0.0, phase_ = 0.0, arc_ = 0.0;
  int turns_ = 0, around_ = 0;
};

// Largest value over the unit square by sampling, the best places looked at closer.
double sampled_most(const std::function<double(double, double)>& f) {
  constexpr int kTurns = 240, kAround = 120, kBest = 12;
  std::vector<std::pair<double, std::pair<double, double>>> best;
  for (int i = 0; i <= kTurns; ++i)
    for (int j = 0; j <= kAround; ++j) {
      const double u = double(i) / kTurns, v = double(j) / kAround;
      best.push_back({f(u, v), {u, v}});
    }
  std::partial_sort(best.begin(), best.begin() + kBest, best.end(), std::greater<>());
  double most = best.front().first;
  for (int k = 0; k < kBest; ++k) {
    auto [value, at] = best[k];
    for (double du = 1.0 / kTurns, dv = 1.0 / kAround; du > 1e-9; du *= 0.7, dv *= 0.7)
      for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) {
          const double u = std::clamp(at.first + i * du, 0.0, 1.0);
          const double v = std::clamp(at.second + j * dv, 0.0, 1.0);
          const double here = f(u, v);
          if (!(here > value)) continue;
          value = here;
          at = {u, v};
        }
    most = std::max(most, value);
  }
  return most;
}

// Overlap from surface to surface; below zero only its sign is exact.
double true_overlap(const Pair& pair) {
  double most = sampled_most(
      [&](double u, double v) { return pair.depth_b(pair.X_BA * pair.surface_a(u, v)); });
  if (!pair.surface_b) return most;
  const Pose X_AB = pair.X_BA.inverse();
  return std::max(most, sampled_most([&](double u, double v) {
                    return pair.depth_a(X_AB * pair.surface_b(u, v));
                  }));
}

struct Said {
  CollisionClass said = CollisionClass::kNone;
  double certain_mm = -1e9, possible_mm = -1e9;
};

Said judged(Pair& pair, Refinement refinement) {
  pair.query.refinement = refinement;
  const OverlapResult result = overlap_of(pair.query);
  Said said{worst_class(result)};
  for (const OverlapRegion& region : result.regions) {
    said.certain_mm = std::max(said.certain_mm, region.certain_mm.lo);
    said.possible_mm = std::max(said.possible_mm, region.possible_mm.hi);
  }
  return said;
}

class TorusPair : public testing::TestWithParam<Kind> {};

TEST_P(TorusPair, IsDecidedAsTheExactSurfacesAre) {
  const int cases = test::effort(18);
  constexpr int kFullEvery = 18;
  constexpr double kDoubt_mm = 5e-4, kClose_mm = 2e-4;
  int real = 0, apart = 0;
  for (int i = 0; i < cases; ++i) {
    Pair pair = Maker(1000 * static_cast<int>(GetParam()) + i).make(GetParam());
    const double truth = true_overlap(pair);
    if (std::fabs(truth) < kDoubt_mm) continue;
    SCOPED_TRACE(testing::Message() << "case " << i << ", true overlap " << truth << " mm");
    (truth > 0.0 ? real : apart) += 1;
    const bool full = i % kFullEvery == 0;
    for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull}) {
      if (refinement == Refinement::kFull && !full) continue;
      const Said said = judged(pair, refinement);
      if (truth > 0.0) {
        EXPECT_EQ(said.said, CollisionClass::kReal);
        EXPECT_GE(said.possible_mm, truth - kClose_mm);
      } else {
        EXPECT_NE(said.said, CollisionClass::kReal);
        EXPECT_NE(said.said, CollisionClass::kPotential);
      }
      EXPECT_LE(said.certain_mm, std::max(0.0, truth) + kClose_mm);
      // Nothing but the closed form tells of these.
      const bool closed = GetParam() == Kind::kBore || GetParam() == Kind::kShaft;
      if (truth > 0.0 && closed) {
        EXPECT_LE(said.possible_mm, truth + kClose_mm);
        EXPECT_GE(said.certain_mm, truth - kClose_mm);
      }
    }
  }
  EXPECT_GE(real, test::effort(1));
  EXPECT_GE(apart, test::effort(2));
}

INSTANTIATE_TEST_SUITE_P(Kinds, TorusPair,
                         testing::Values(Kind::kGroove, Kind::kGland, Kind::kBore, Kind::kShaft,
                                         Kind::kPlane, Kind::kBall, Kind::kSegment));

SurfaceBand declared_all(const Surface& surface) {
  SurfaceBand band = nominal_band();
  band.trivial = false;
  band.faces[0].surface = surface;
  band.faces[0].grade = DeviationGrade::kDeclaredFeature;
  return band;
}

// What a piece of a coarse torus stands for reaches no farther below any plane than its patch.
TEST(TorusPatch, HoldsTheSurfaceOverItsPieces) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; ++i) {
    const bool inward = i % 2 == 1;
    const double R = 10.0, r = R * (0.05 + 0.6 * unit(random));
    Profile profile;
    add_arc(profile, {R, 0.0}, r, 0.0, 2.0 * kPi, 8 + i % 24, false);
    if (inward) std::reverse(profile.begin(), profile.end());
    const SolidPtr part = solid(revolved(profile, 10 + i % 40, 0.0, 2.0 * kPi));
    const Surface torus = round_surface(SurfaceKind::kTorus, R, r, inward);
    const SurfaceBand band = declared_all(torus);
    const Body body(*part, band);
    const TriangleMesh& mesh = part->mesh();
    const auto t = static_cast<std::uint32_t>(unit(random) * 0.999 *
                                              static_cast<double>(mesh.triangles.size()));
    Piece piece{{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, t};
    for (int halving = i % 5; halving > 0; --halving)
      piece = split(body, Layer::kUpper, piece)[unit(random) < 0.5 ? 0 : 1];
    const Patch patch = make_patch(body, Layer::kUpper, piece, Pose());
    const Vec3 n = Vec3(normal(random), normal(random), normal(random)).normalized();
    double deepest = -1e9;
    for (int s = 0; s < 400; ++s) {
      double a = unit(random), b = unit(random);
      if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
      const Vec3 x = piece.corners[0] + a * (piece.corners[1] - piece.corners[0]) +
                     b * (piece.corners[2] - piece.corners[0]);
      const Vec3 on = x - torus.signed_distance_mm(x) * torus.outward_normal(x);
      deepest = std::max(deepest, -n.dot(on));
    }
    EXPECT_LE(deepest, patch.depth_below_plane(n, Vec3::Zero(), 0.0) + 1e-12) << i;
  }
}

}  // namespace
}  // namespace mortise
