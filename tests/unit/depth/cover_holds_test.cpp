// A cover holds its part: each point that the drawing has in a layer is in a cell, and in no hole.
// Parts whose faces go on into each other smoothly, or nearly so, where neither trims the other,
// and such with a face that gives way beside one that does not.
#include <gtest/gtest.h>

#include "common/depth/body.h"
#include "common/depth/cells/cover.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/ball_parts.h"

namespace mortise {
namespace {

using namespace cover_parts;

// A ring about z whose hole ends at z0 and z1; outside it is a cylinder. hole_depth(x, offsets):
// how far x is outside of the hole.
template <class HoleDepth>
DrawnPart ring_of(Random& random, const shapes::Chain& hole, const std::vector<std::string>& names,
                  double most_mm, HoleDepth hole_depth) {
  const double z0 = hole.points.front().z, z1 = hole.points.back().z;
  double out = 0.0;
  for (const auto& p : hole.points) out = std::max(out, 1.4 * p.r);
  shapes::Chain outer;
  outer.start(out, z0).line(out, z1);
  DrawnPart part = finish(random, turned(outer, {"outer"}, hole, names, 12 + 4 * below(random, 12)),
                          0.03, most_mm);
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    return std::min({out + o("outer") - radius(x), x.z() - z0 + o("lower"), hole_depth(x, z1, o)});
  };
  return part;
}

// A bore that ends in a ball of its own radius.
DrawnPart ball_end(Random& random, double most_mm) {
  const double r = uniform(random, 3.0, 12.0), low = -uniform(random, 0.3, 1.3);
  shapes::Chain hole;
  hole.inward = true;
  hole.start(r * std::cos(low), r * std::sin(low)).arc(0.0, 0.0, 0.0, 6 + below(random, 12));
  hole.points.back() = {r, hole.surfaces.back().z1_mm = 0.0};
  hole.line(r, uniform(random, 0.3, 2.0) * r);
  return ring_of(
      random, hole, {"socket", "bore"}, most_mm, [r](const Vec3& x, double z1, const OffsetOf& o) {
        return std::min(z1 + o("upper") - x.z(),
                        x.z() < 0.0 ? x.norm() - r + o("socket") : radius(x) - r + o("bore"));
      });
}

// Two seats of one size in one bore, each a face of its own.
DrawnPart two_seats(Random& random, double most_mm) {
  const double r = uniform(random, 3.0, 12.0), z = uniform(random, 0.3, 2.0) * r;
  shapes::Chain hole;
  hole.inward = true;
  hole.start(r, 0.0).line(r, z).line(r, 2.0 * z);
  hole.surfaces.back().surface.point = z * Vec3::UnitZ();
  return ring_of(
      random, hole, {"near", "far"}, most_mm, [=](const Vec3& x, double z1, const OffsetOf& o) {
        return std::min(z1 + o("upper") - x.z(), radius(x) - r + o(x.z() < z ? "near" : "far"));
      });
}

// A socket with a rounded rim.
DrawnPart rounded_rim(Random& random, double most_mm) {
  const double r = uniform(random, 3.0, 12.0), tube = uniform(random, 0.05, 0.2) * r;
  const double low = -uniform(random, 0.5, 1.3), up = uniform(random, -0.3, 0.6);
  // The middle of the tube stands beside the socket, where both are tangent.
  const double tube_r = (r + tube) * std::cos(up), tube_z = (r + tube) * std::sin(up);
  shapes::Chain hole;
  hole.inward = true;
  hole.start(r * std::cos(low), r * std::sin(low)).arc(0.0, 0.0, up, 6 + below(random, 12));
  // Seen from the tube the socket is on the other side.
  const double from = up + std::numbers::pi, to = 0.5 * std::numbers::pi;
  const int steps = 3 + below(random, 8);
  for (int i = 1; i <= steps; ++i) {
    const double a = from + (to - from) * i / steps;
    hole.points.push_back({tube_r + tube * std::cos(a), tube_z + tube * std::sin(a)});
  }
  Surface rim;
  rim.kind = SurfaceKind::kTorus;
  rim.point = tube_z * Vec3::UnitZ();
  rim.radius_mm = tube_r;
  rim.tube_radius_mm = tube;
  hole.surfaces.push_back({rim, r * std::sin(up), tube_z + tube});
  return ring_of(
      random, hole, {"socket", "rim"}, most_mm, [=](const Vec3& x, double z1, const OffsetOf& o) {
        const double rho = radius(x);
        if (rho >= tube_r && x.z() >= tube_z) return z1 + o("upper") - x.z();
        // Above the line through both middles the rim is nearest, below it the socket.
        const double side = (rho - tube_r) * std::sin(up) - (x.z() - tube_z) * std::cos(up);
        if (side < 0.0) return tube + o("rim") - std::hypot(rho - tube_r, x.z() - tube_z);
        return x.norm() - r + o("socket");
      });
}

// A cone above a flatter ball: where the cone gives way the ball rises into its hole.
DrawnPart sink_on_socket(Random& random, double most_mm) {
  const double r = uniform(random, 3.0, 12.0), joint = -uniform(random, 0.9, 1.2);
  const double half = -joint - uniform(random, 0.15, 0.3), slope = std::tan(half);
  const double r0 = r * std::cos(joint), z0 = r * std::sin(joint), z1 = z0 + 0.05 * r;
  shapes::Chain hole;
  hole.inward = true;
  hole.start(r * std::cos(joint - 0.2), r * std::sin(joint - 0.2));
  hole.arc(0.0, 0.0, joint, 2 + below(random, 12));
  hole.points.back() = {r0, hole.surfaces.back().z1_mm = z0};
  hole.line(r0 + slope * (z1 - z0), z1);
  return ring_of(random, hole, {"socket", "sink"}, most_mm,
                 [=](const Vec3& x, double top, const OffsetOf& o) {
                   const double sink = std::cos(half) * (radius(x) - r0 - slope * (x.z() - z0));
                   return std::min(top + o("upper") - x.z(),
                                   std::max(x.norm() - r + o("socket"), sink + o("sink")));
                 });
}

// A slot with a wall that has a low step: where it gives way the wall above it stands out.
DrawnPart stepped_slot(Random& random, double most_mm) {
  const double half = uniform(random, 2.0, 8.0), length = uniform(random, 5.0, 20.0);
  const double outside = half + 5.0, step = half + uniform(random, 0.002, 0.02);
  const Loop loop = {{-outside, 0.0}, {outside, 0.0}, {outside, 8.0}, {step, 8.0},
                     {step, 5.0},     {half, 5.0},    {half, 2.0},    {-half, 2.0},
                     {-half, 8.0},    {-outside, 8.0}};
  const char* names[] = {"front", "right", "top",       "above",    "ledge",
                         "wall",  "floor", "left wall", "left top", "left"};
  Shape shape;
  const Ring lower = shape.ring(loop, 0.0), upper = shape.ring(loop, length);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &p = loop[i], d = loop[(i + 1) % loop.size()] - p;
    shape.facet(lower, upper, i,
                shape.plane(names[i], {p.x(), p.y(), 0.0}, Vec3(d.y(), -d.x(), 0.0).normalized()));
  }
  shape.cap(lower, {}, false, shape.plane("lower", Vec3::Zero(), -Vec3::UnitZ()));
  shape.cap(upper, {}, true, shape.plane("upper", {0, 0, length}, Vec3::UnitZ()));
  DrawnPart part = finish(random, *std::move(shape).finish(), 0.03, most_mm);
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    const double below = 2.0 + o("floor") - x.y();
    const double left = std::min(-half + o("left wall") - x.x(), 8.0 + o("left top") - x.y());
    const double wall = std::min(x.x() - half + o("wall"), 5.0 + o("ledge") - x.y());
    const double right =
        std::min(std::max(wall, x.x() - step + o("above")), 8.0 + o("top") - x.y());
    return std::min({std::max({below, left, right}), x.y() + o("front"),
                     outside + o("right") - x.x(), outside + o("left") + x.x(), x.z() + o("lower"),
                     length + o("upper") - x.z()});
  };
  return part;
}

// A bar with two round sides: its planes go over into them.
DrawnPart round_bar(Random& random, double most_mm) {
  const double r = uniform(random, 3.0, 12.0), half = uniform(random, 0.1, 2.0) * r;
  const double length = uniform(random, 5.0, 20.0);
  const int steps = 4 + below(random, 30);
  Shape shape;
  const int below_it = shape.plane("below", {0.0, -r, 0.0}, -Vec3::UnitY());
  const int right = shape.cylinder("right", {half, 0.0, 0.0}, r, false);
  const int above = shape.plane("above", {0.0, r, 0.0}, Vec3::UnitY());
  const int left = shape.cylinder("left", {-half, 0.0, 0.0}, r, false);
  Loop loop{{-half, -r}};
  std::vector<int> side{below_it};
  for (const double sign : {1.0, -1.0}) {
    for (int i = 0; i < steps; ++i) {
      const double a = std::numbers::pi * i / steps;
      loop.push_back(sign * Vec2(half + r * std::sin(a), -r * std::cos(a)));
      side.push_back(sign > 0.0 ? right : left);
    }
    if (sign < 0.0) break;
    loop.push_back({half, r});
    side.push_back(above);
  }
  const Ring lower = shape.ring(loop, 0.0), upper = shape.ring(loop, length);
  for (std::size_t i = 0; i < loop.size(); ++i) shape.facet(lower, upper, i, side[i]);
  shape.cap(lower, {}, false, shape.plane("lower", Vec3::Zero(), -Vec3::UnitZ()));
  shape.cap(upper, {}, true, shape.plane("upper", {0, 0, length}, Vec3::UnitZ()));
  DrawnPart part = finish(random, *std::move(shape).finish(), 0.03, most_mm);
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    const double ends = std::min(x.z() + o("lower"), length + o("upper") - x.z());
    if (x.x() > half) return std::min(ends, r + o("right") - radius(x, half));
    if (x.x() < -half) return std::min(ends, r + o("left") - radius(x, -half));
    return std::min({ends, r + o("above") - x.y(), r + o("below") + x.y()});
  };
  return part;
}

bool is_in(const Void& hole, const Vec3& x, double by_mm) {
  for (const HalfSpace& plane : hole.planes)
    if (plane.n.dot(x) <= plane.c_mm + by_mm) return false;
  for (const VoidWall& wall : hole.walls) {
    const Vec3 d = x - wall.point;
    const double z = d.dot(wall.axis), off = (d - z * wall.axis).norm();
    const double out = wall.is_socket ? d.norm() - wall.r_mm : off - wall.r_mm - wall.slope * z;
    if (!wall.arc.whole || wall.cosine * out >= -by_mm) return false;
  }
  return true;
}

struct Tally {
  int inside = 0, outside = 0, in_hole = 0;
};

// Points about the surfaces of random parts.
Tally points_of(DrawnPart (*draw)(Random&, double), double most_mm, double spoil_mm) {
  Random random(7017);
  Tally tally;
  for (int i = 0; i < test::effort(20); ++i) {
    const DrawnPart part = draw(random, most_mm);
    const TriangleMesh& mesh = part.solid->mesh();
    const Body body(*part.solid, part.band);
    const Cover& cover = cover_of(body);
    EXPECT_TRUE(cover.found()) << cover.why_not;
    for (const bool largest : {false, true}) {
      CoverLayer layer = cover.of(!largest);
      for (Void& hole : layer.voids)
        for (VoidWall& wall : hole.walls) wall.r_mm += spoil_mm;
      for (int k = 0; k < 300; ++k) {
        const auto t = static_cast<std::uint32_t>(below(random, int(mesh.triangles.size())));
        const double u = uniform(random, 0.0, 1.0), v = uniform(random, 0.0, 1.0 - u);
        const Vec3 on = mesh.corner(t, 0) + u * (mesh.corner(t, 1) - mesh.corner(t, 0)) +
                        v * (mesh.corner(t, 2) - mesh.corner(t, 0));
        const Vec3 x = on + uniform(random, 0.0, 0.2) * any_direction(random);
        if (!(part.depth_in(x, largest) > 1e-6)) continue;
        ++tally.inside;
        tally.outside +=
            std::none_of(layer.cells.begin(), layer.cells.end(),
                         [&](const auto& cell) { return (cell.near(x) - x).norm() < 1e-9; });
        tally.in_hole += std::any_of(layer.voids.begin(), layer.voids.end(),
                                     [&](const Void& hole) { return is_in(hole, x, 1e-6); });
      }
    }
  }
  return tally;
}

TEST(CoverHolds, PointsOfPartsWhoseFacesGoOnIntoEachOther) {
  for (const auto draw :
       {ball_end, two_seats, rounded_rim, sink_on_socket, stepped_slot, round_bar})
    // Faces are moved either way, or none outwards.
    for (const double most_mm : {0.03, 0.0}) {
      const Tally tally = points_of(draw, most_mm, 0.0);
      EXPECT_EQ(tally.outside, 0) << "of " << tally.inside;
      EXPECT_EQ(tally.in_hole, 0) << "of " << tally.inside;
      EXPECT_GT(tally.inside, test::effort(3000));
    }
}

// The test sees a wall that is 20 um off.
TEST(CoverHolds, APlantedFaultIsSeen) { EXPECT_GT(points_of(two_seats, 0.03, 0.02).in_hole, 0); }

// A cone that ends in a tip, within a ball that does not reach the tip.
TEST(CoverHolds, NoCircleOfACellIsAcrossTheAxis) {
  Random random(7018);
  for (int i = 0; i < 20000; ++i) {
    const double half = uniform(random, 0.2, 1.3), z = uniform(random, 0.1, 1.0);
    const MeridianLine lines[] = {{std::sin(half), std::cos(half), z}, {-1.0, 0.0, 0.0}};
    const MeridianBall balls[] = {{10.0 - uniform(random, 0.0, 0.05), 10.0}};
    const auto cell = round_cell(Vec3::Zero(), Vec3::UnitZ(), lines, balls);
    ASSERT_TRUE(cell.has_value());
    for (const ConvexCell::Circle& circle : cell->circles) ASSERT_GE(circle.r_mm, 0.0) << i;
  }
}

}  // namespace
}  // namespace mortise
