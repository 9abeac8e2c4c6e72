#include "tests/bench/judgement_csg_cases.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include "common/math/rotation.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

using std::numbers::pi;

constexpr double kWidestCsgShare = 2e-3;    ///< of a tolerance zone, of the size
constexpr double kFarthestPose_mm = 500.0;  ///< of the random pose of everything
constexpr int kRoughStarts = 5, kStarts = 14;

void draw_bands(Dice& dice, bool by_face, CsgPart& part) {
  const Interval common =
      dice.between(0.0, 1.0) < 0.15 ? Interval{} : drawn_zone(dice, part.size_mm, kWidestCsgShare);
  for (CsgFace& face : part.faces)
    face.offset_mm = by_face ? drawn_zone(dice, part.size_mm, kWidestCsgShare) : common;
}

CsgDrawn draw_any(Dice& dice, double size_mm) {
  const double kind = dice.between(0.0, 1.0);
  if (kind < 0.45) return draw_plate(dice, size_mm, 0.0);
  if (kind < 0.85) return draw_shaft(dice, size_mm, 0.0);
  return kind < 0.93 ? draw_torus(dice, size_mm) : draw_ball(dice, size_mm);
}

double some(Dice& dice, double most_mm) {
  const double u = dice.between(0.0, 1.0);
  if (u < 0.25) return 0.0;
  return u < 0.75 ? dice.between(0.0, most_mm) : dice.spread(1e-3 * most_mm, most_mm);
}

double draw_csg_margin(Dice& dice, double size_mm) {
  if (dice.between(0.0, 1.0) < 0.08) return size_mm * dice.spread(1e-3, 0.05);
  return dice.sign() * dice.spread(1e-4, 0.1);
}

/// A shaft in a hole of its own size and some play: eccentric, tilted, at any height.
void draw_fit(Dice& dice, double size, CsgCase& c) {
  CsgDrawn outer = draw_plate(dice, size, size * dice.between(0.15, 0.4));
  while (!outer.hole) outer = draw_plate(dice, size, size * dice.between(0.15, 0.4));
  const CsgPlace hole = *outer.hole;
  const double play = size * dice.spread(2e-5, 3e-3);
  c.b = std::move(outer.part);
  c.a = draw_shaft(dice, size * dice.between(0.5, 1.2), hole.radius_mm - play).part;
  c.by_face = dice.between(0.0, 1.0) < 0.5;
  draw_bands(dice, c.by_face, c.a);
  draw_bands(dice, c.by_face, c.b);
  const double in = (hole.z1_mm - hole.z0_mm) * dice.between(0.1, 1.0);
  const double tilt = dice.between(0.0, 1.0) < 0.5 ? 0.0 : some(dice, 2.0 * play / in);
  const Quat q = rotation_exp(tilt * shapes::on_circle(1.0, dice.between(0.0, 2.0 * pi), 0.0)) *
                 rotation_exp(dice.between(0.0, 2.0 * pi) * Vec3::UnitZ());
  // The shaft enters from above with its lowest section.
  Vec3 at(hole.x_mm, hole.y_mm, hole.z1_mm - in);
  const double angle = dice.between(0.0, 2.0 * pi), aside = some(dice, 2.0 * play);
  at += shapes::on_circle(aside, angle, 0.0);
  if (dice.between(0.0, 1.0) < 0.3) at.z() = hole.z0_mm + dice.sign() * some(dice, 2.0 * play);
  c.X_BA = {q, at};
  c.text = "fit with play " + std::to_string(play);
}

/// Turned so that axes are parallel or square to each other, or any way.
Quat draw_orientation(Dice& dice) {
  const double kind = dice.between(0.0, 1.0);
  if (kind < 0.4) return dice.orientation();
  const int turns = static_cast<int>(dice.between(0.0, 3.999));
  const Quat about_z = rotation_exp(dice.between(0.0, 2.0 * pi) * Vec3::UnitZ());
  return rotation_exp(0.5 * pi * turns * Vec3::UnitX()) * about_z;
}

/// Two parts, one of which comes near the other along a direction until a layer has its margin.
void draw_touch(Dice& dice, double size, CsgCase& c) {
  c.a = draw_any(dice, size * dice.between(0.4, 1.0)).part;
  c.b = draw_any(dice, size * dice.between(0.4, 1.0)).part;
  c.by_face = dice.between(0.0, 1.0) < 0.5;
  draw_bands(dice, c.by_face, c.a);
  draw_bands(dice, c.by_face, c.b);
  c.X_BA.q = draw_orientation(dice);
  const Vec3 direction =
      dice.between(0.0, 1.0) < 0.5
          ? dice.direction()
          : Vec3(dice.sign() * Vec3::Unit(static_cast<int>(dice.between(0.0, 2.999))));
  const Vec3 aside = 0.3 * size * dice.direction();
  const CsgLayer layer = static_cast<CsgLayer>(static_cast<int>(dice.between(0.0, 2.999)));
  const double wanted = 0.5 * draw_csg_margin(dice, size);
  const CsgPair pair{&c.a, &c.b, c.X_BA};
  const auto depth_at = [&](double shift) {
    CsgPair moved = pair;
    moved.X_BA.p = aside + shift * direction;
    return deepest_point(moved, layer, kRoughStarts).depth_mm;
  };
  // Apart at the one end, deeper than wanted or as deep as may be at the other.
  double far = 6.0 * size, near = 0.0;
  for (int i = 0; i < 6 && depth_at(near) < wanted; ++i) near -= 0.4 * size;
  for (int i = 0; i < 24 && far - near > 1e-7 * size; ++i) {
    const double middle = 0.5 * (near + far);
    (depth_at(middle) > wanted ? near : far) = middle;
  }
  c.X_BA.p = aside + 0.5 * (near + far) * direction;
  c.text = "near touch, wanted " + std::to_string(2.0 * wanted);
}

}  // namespace

CsgCase draw_csg(std::uint64_t seed) {
  Dice dice(seed * 8 + 7);
  CsgCase c;
  const double size = 10.0 * dice.spread(1e-2, 1e2);
  if (dice.between(0.0, 1.0) < 0.4)
    draw_fit(dice, size, c);
  else
    draw_touch(dice, size, c);
  c.X_WB = {dice.orientation(),
            kFarthestPose_mm * Vec3(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1))};
  const CsgPair pair{&c.a, &c.b, c.X_BA};
  c.truth.searched = true;
  c.truth.certain_mm = 2.0 * deepest_point(pair, CsgLayer::kLeast, kStarts).depth_mm;
  c.truth.possible_mm = 2.0 * deepest_point(pair, CsgLayer::kLargest, kStarts).depth_mm;
  char zones[160];
  std::snprintf(zones, sizeof zones, ", zones %s[%.6f, %.6f], [%.6f, %.6f], size %.4f",
                c.by_face ? "by face, the first " : "", c.a.faces[0].offset_mm.lo,
                c.a.faces[0].offset_mm.hi, c.b.faces[0].offset_mm.lo, c.b.faces[0].offset_mm.hi,
                size);
  c.text = c.a.text + " on " + c.b.text + ": " + c.text + zones;
  return c;
}

OracleCase CsgCase::asked(std::uint64_t seed, bool recognized) const {
  OracleCase one;
  one.name = "csg:" + std::to_string(seed);
  one.text = text;
  one.truth = truth;
  one.X_WB = X_WB;
  one.X_WA = X_WB * X_BA;
  one.pair = {csg_known_part(1, a, recognized), csg_known_part(2, b, recognized)};
  const auto own = std::make_shared<const CsgCase>(*this);
  one.least_depth_mm = [own](const Vec3& p_W) {
    const CsgPair pair{&own->a, &own->b, own->X_BA};
    return pair.depth_mm(own->X_WB.inverse() * p_W, CsgLayer::kLeast);
  };
  return one;
}

}  // namespace mortise::bench
