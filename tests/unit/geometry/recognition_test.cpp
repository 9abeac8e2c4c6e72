#include "common/geometry/recognition/recognition.h"

#include <gtest/gtest.h>

#include "tests/support/lofted.h"
#include "tests/support/numbers.h"
#include "tests/support/turned_part.h"

namespace mortise {
namespace {

using shapes::Chain;
using shapes::TurnedSurface;

// How far the found surface runs from the true one, over the length that the true one has.
double radius_error_mm(const Surface& truth, const TurnedSurface& local, const Surface& found) {
  if (truth.kind == SurfaceKind::kSphere)
    return std::max(std::fabs(truth.radius_mm - found.radius_mm),
                    (truth.point - found.point).norm());
  if (truth.kind == SurfaceKind::kTorus)
    return std::max({std::fabs(truth.radius_mm - found.radius_mm),
                     std::fabs(truth.tube_radius_mm - found.tube_radius_mm),
                     (truth.point - found.point).norm()});
  double worst = 0.0;
  const Vec3 u = truth.axis.unitOrthogonal(), v = truth.axis.cross(u);
  // Heights as the chain counts them: from its origin for a cylinder, from the apex for a cone.
  const double sign = local.surface.axis.z();
  for (const double z : {local.z0_mm, local.z1_mm}) {
    const double h = sign * (z - local.surface.point.z());
    const double r =
        truth.kind == SurfaceKind::kCone ? h * std::tan(truth.half_angle_rad) : truth.radius_mm;
    for (int i = 0; i < 8; ++i) {
      const double a = kPi * i / 4.0;
      const Vec3 x = truth.point + h * truth.axis + r * (std::cos(a) * u + std::sin(a) * v);
      worst = std::max(worst, std::fabs(found.signed_distance_mm(x)));
    }
  }
  return worst;
}

struct Case {
  Chain outer, inner;
  int facets = 32;
  double arc_rad = 2.0 * kPi;
  double size_mm = 10.0;
};

int rows_for(double arc_rad, int facets) {
  constexpr int kMostRows = 24;  // along the meridian steps may be coarser than around
  const int rows = static_cast<int>(std::ceil(std::fabs(arc_rad) * facets / (2.0 * kPi)));
  return std::clamp(rows, 2, kMostRows);
}

// A main surface outside with any neighbours at its ends, and a bore, tapered or not.
Case random_case(std::mt19937_64& random) {
  const auto pick = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  Case c;
  const double R = c.size_mm = std::exp(pick(std::log(1.5), std::log(250.0)));
  c.facets = static_cast<int>(std::exp(pick(std::log(12.0), std::log(512.999))));
  if (random() % 3 == 0) {
    c.arc_rad = pick(0.3, 2.0) * kPi;
    c.facets = std::max(5, static_cast<int>(std::ceil(c.facets * c.arc_rad / (2.0 * kPi))));
  }
  const int whole = std::max(12, static_cast<int>(c.facets * 2.0 * kPi / c.arc_rad));
  const double length = R * pick(0.3, 3.0);
  Chain& o = c.outer;
  const double edge = R * pick(0.03, 0.1);
  const auto below = random() % 4, above = random() % 4, main = random() % 3;
  // 1. what is below: nothing, a chamfer, a step with a fillet in the corner, a rounded edge
  if (below == 1) o.start(R - edge, -edge).line(R, 0.0);
  if (below == 2) o.start(R * 1.5, -R).line(R * 1.5, -edge - 0.01 * R), o.line(R + edge, -edge);
  if (below == 3) o.start(R - edge, -edge).arc(R - edge, 0.0, 0.0, rows_for(0.5 * kPi, whole));
  if (below == 0) o.start(R, 0.0);
  if (below == 2) {
    // The fillet curves the other way: about (R + edge, 0), from below to the left.
    o.surfaces.pop_back();
    const int rows = rows_for(0.5 * kPi, whole);
    for (int i = 1; i <= rows; ++i) {
      const double a = -0.5 * kPi - 0.5 * kPi * i / rows;
      o.points.push_back({R + edge + edge * std::cos(a), edge * std::sin(a)});
    }
    Surface s;
    s.kind = SurfaceKind::kTorus;
    s.radius_mm = R + edge;
    s.tube_radius_mm = edge;
    s.inward = true;
    o.surfaces.push_back({s, -edge, 0.0});
  }
  // 2. the main surface
  double end_r = R;
  if (main == 0) o.line(R, length);
  if (main == 1) {
    end_r = R + length * std::tan(pick(0.01, 0.9)) * (random() % 2 == 0 ? 1.0 : -0.25);
    end_r = std::max(end_r, 0.4 * R);
    o.line(end_r, length);
  }
  if (main == 2) {
    const double sphere = R * pick(1.05, 2.0), low = -std::acos(R / sphere);
    const double high = low + pick(0.35, 0.8) * (0.45 * kPi - low);
    const double z = sphere * std::sin(-low);
    o.arc(0.0, z, high, rows_for(high - low, whole));
    end_r = o.points.back().r;
  }
  const double z = o.points.back().z;
  // 3. what is above
  if (above == 1) o.line(end_r - edge, z + edge);
  if (above == 2) o.line(0.9 * end_r, z + 0.02 * R), o.line(0.9 * end_r, z + R);
  Chain& i = c.inner;
  i.inward = true;
  const double bottom = o.points.front().z, top = o.points.back().z;
  double least = end_r;
  for (const auto& p : o.points) least = std::min(least, p.r);
  const double bore = least * pick(0.3, 0.8);
  i.start(bore, bottom);
  if (random() % 2 == 0) {
    i.line(bore, top);
  } else {  // a countersink
    i.line(bore, top - 0.1 * bore).line(1.1 * bore, top);
  }
  return c;
}

const char* name_of_kind(SurfaceKind kind) {
  constexpr const char* kNames[] = {"unknown", "plane", "cylinder", "cone", "sphere", "torus"};
  return kNames[static_cast<int>(kind)];
}

TEST(Recognition, FindsWhatWasTurned) {
  std::mt19937_64 random(20240);
  std::array<int, 6> asked{}, found{};
  int printed = 0;
  for (int i = 0; i < 150; ++i) {
    const Case c = random_case(random);
    const Pose X = shapes::random_pose(random, 10.0 * c.size_mm);
    const TriangleMesh mesh = transformed(turned_part(c.outer, c.inner, c.facets, c.arc_rad), X);
    const Solid solid(mesh);
    ASSERT_TRUE(solid.topology().closed()) << "case " << i;
    const Recognition got = recognize_features(solid);
    for (const Chain* chain : {&c.outer, &c.inner})
      for (const TurnedSurface& t : chain->surfaces) {
        const Surface truth = shapes::moved(t.surface, X);
        const auto kind = static_cast<std::size_t>(truth.kind);
        ++asked[kind];
        double best = 1e9;
        for (const Feature& f : got.features)
          if (f.surface.kind == truth.kind && f.surface.inward == truth.inward)
            best = std::min(best, radius_error_mm(truth, t, f.surface));
        const double size = truth.kind == SurfaceKind::kCone ? c.size_mm : truth.radius_mm;
        if (best <= 1e-4 + 1e-6 * size) {
          ++found[kind];
        } else if (truth.kind != SurfaceKind::kTorus && ++printed <= 12) {
          std::printf("case %d: %s R %.4f, %d facets of %.1f deg, z %.3f to %.3f: off by %.3g\n", i,
                      name_of_kind(truth.kind), size, c.facets, c.arc_rad * 180 / kPi, t.z0_mm,
                      t.z1_mm, best);
        }
      }
  }
  for (const SurfaceKind kind :
       {SurfaceKind::kCylinder, SurfaceKind::kCone, SurfaceKind::kSphere, SurfaceKind::kTorus}) {
    const auto k = static_cast<std::size_t>(kind);
    std::printf("%s: %d of %d found\n", name_of_kind(kind), found[k], asked[k]);
    if (kind == SurfaceKind::kTorus) continue;
    EXPECT_GE(found[k], 0.99 * asked[k]) << name_of_kind(kind);
  }
}

TriangleMesh in_floats(TriangleMesh mesh) {
  for (Vec3& x : mesh.points_mm) x = x.cast<float>().cast<double>();
  return mesh;
}

bool shows_ball(const TriangleMesh& mesh) {
  const Solid solid(mesh);
  EXPECT_TRUE(solid.topology().closed());
  const auto features = recognize_features(solid).features;
  return std::any_of(features.begin(), features.end(),
                     [](const Feature& f) { return f.surface.kind == SurfaceKind::kSphere; });
}

// Low pyramids without their tip, with as many flats of unlike widths: all corners lie on two
// circles, and so on a ball, but the pyramid is as good an answer.
TEST(Recognition, ALowPyramidIsNoBall) {
  for (const int flats : {5, 6, 7, 9, 12})
    for (const double share : {0.05, 0.3, 0.6}) {
      std::vector<Vec3> section, upper;
      for (int i = 0; i < flats; ++i) {
        const double t = 2.0 * kPi * (i + 0.3 * std::sin(2.3 * i * i)) / flats;
        section.emplace_back(5.0 * std::cos(t), 5.0 * std::sin(t), 0.0);
        upper.emplace_back(share * section.back() + (1.0 - share) * 1.3 * Vec3::UnitZ());
      }
      const TriangleMesh mesh = shapes::lofted({section, upper});
      EXPECT_FALSE(shows_ball(mesh)) << flats << " flats, " << share;
      EXPECT_FALSE(shows_ball(in_floats(mesh))) << flats << " flats, floats, " << share;
    }
}

TEST(Recognition, ABallIsOneInFloats) {
  for (const double radius_mm : {0.1, 3.0, 700.0})
    for (const int rows : {12, 16, 40}) {
      const TriangleMesh mesh = shapes::sphere(radius_mm, Vec3(1.0, 2.0, 3.0) * radius_mm, rows);
      EXPECT_TRUE(shows_ball(mesh)) << radius_mm << " mm, " << rows << " rows";
      EXPECT_TRUE(shows_ball(in_floats(mesh))) << radius_mm << " mm, floats, " << rows << " rows";
    }
}

// A slab whose top waves by 2 mm over 200 mm: its normals turn by several degrees, but it is no
// part of a ball.
TEST(Recognition, AWavySlabIsNoBall) {
  constexpr std::uint32_t kCells = 20;
  TriangleMesh mesh;
  for (const bool top : {false, true})
    for (std::uint32_t i = 0; i <= kCells; ++i)
      for (std::uint32_t j = 0; j <= kCells; ++j) {
        const double x = 10.0 * i, y = 10.0 * j;
        mesh.points_mm.emplace_back(
            x, y, top ? 20.0 + std::sin(x / 30.0) * std::sin(y / 37.0) + std::cos(x / 50.0) : 0.0);
      }
  const std::uint32_t up = (kCells + 1) * (kCells + 1);
  const auto at = [](std::uint32_t i, std::uint32_t j) { return i * (kCells + 1) + j; };
  for (std::uint32_t i = 0; i < kCells; ++i) {
    for (std::uint32_t j = 0; j < kCells; ++j) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      shapes::add_quad(mesh, a, d, c, b);
      shapes::add_quad(mesh, up + a, up + b, up + c, up + d);
    }
    for (const auto& [p, q] : {std::pair{at(i, 0), at(i + 1, 0)},
                               {at(kCells, i), at(kCells, i + 1)},
                               {at(i + 1, kCells), at(i, kCells)},
                               {at(0, i + 1), at(0, i)}})
      shapes::add_quad(mesh, p, q, up + q, up + p);
  }
  const Solid solid(mesh);
  ASSERT_TRUE(solid.topology().closed());
  ASSERT_GT(solid.topology().volume_mm3, 0.0);
  for (const Feature& f : recognize_features(solid).features) {
    if (f.surface.kind != SurfaceKind::kSphere) continue;
    EXPECT_LT(f.surface.radius_mm, 1000.0) << f.name << " of " << f.triangles.size();
    EXPECT_LT(f.residual_mm, 0.05) << f.name;
  }
}

}  // namespace
}  // namespace mortise
