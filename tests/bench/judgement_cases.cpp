#include "tests/bench/judgement_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/base/check.h"
#include "common/evaluation/iso286.h"
#include "common/evaluation/tolerance.h"
#include "common/math/rotation.h"

namespace mortise::bench {
namespace {

using std::numbers::pi;

constexpr std::array<const char*, 13> kFits = {"H7/f7", "H7/g6", "H7/h6",  "H7/js6", "H7/k6",
                                               "H7/m6", "H7/n6", "H7/p6",  "H7/r6",  "H7/s6",
                                               "H8/e8", "H8/f8", "H11/c11"};
constexpr double kFarthest_mm = 500.0;  ///< of the random pose of everything

// From 12 facets on, over the decades, half of them below 45: coarse ones are common and cheap.
Around around(Dice& dice, double most) {
  const double share = std::pow(dice.between(0.0, 1.0), 1.5);
  return {static_cast<int>(std::lround(12.0 * std::pow(most / 12.0, share))),
          dice.between(0.0, 2.0 * pi)};
}

/// Both parts alike in a third of the cases: equal facets are what CAD gives.
std::array<Around, 2> both_around(Dice& dice, double most) {
  std::array<Around, 2> both{around(dice, most), around(dice, most)};
  if (dice.between(0.0, 1.0) < 0.33) both[1].facets = both[0].facets;
  return both;
}

/// One of three: nothing, some of the range, spread over decades below it.
double some(Dice& dice, double most_mm) {
  const double u = dice.between(0.0, 1.0);
  if (u < 0.25) return 0.0;
  return u < 0.75 ? dice.between(0.0, most_mm) : dice.spread(1e-3 * most_mm, most_mm);
}

void place(Dice& dice, JudgedCase& c, const Pose& X_BA) {
  const Vec3 p(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1));
  c.X_WB = {dice.orientation(), kFarthest_mm * p};
  c.X_WA = c.X_WB * X_BA;
}

template <class... Numbers>
std::string text(const char* format, Numbers... numbers) {
  char line[320];
  std::snprintf(line, sizeof line, format, numbers...);
  return line;
}

/// An ISO fit at a size and where its two modelled radii stand: at the nominal size as CAD mostly
/// does, or anywhere within the limits.
struct DrawnFit {
  std::string code;
  Fit fit;
  double nominal_mm, shaft_mm, hole_mm;  ///< diameter, radii
};

DrawnFit draw_fit(Dice& dice) {
  DrawnFit drawn;
  drawn.nominal_mm = dice.spread(3.0, 500.0);
  drawn.code = kFits[static_cast<std::size_t>(dice.between(0.0, kFits.size() - 1e-9))];
  const auto fit = iso286_fit(drawn.code, drawn.nominal_mm);
  MORTISE_CHECK(bool(fit), "a common fit at a common size has limits");
  drawn.fit = *fit;
  const auto radius = [&](const SizeLimits& limits) {
    const double d = dice.between(0.0, 1.0) < 0.6
                         ? 0.0
                         : dice.between(limits.deviation_mm.lo, limits.deviation_mm.hi);
    return 0.5 * (drawn.nominal_mm + d);
  };
  drawn.shaft_mm = radius(drawn.fit.shaft);
  drawn.hole_mm = radius(drawn.fit.hole);
  return drawn;
}

/// How far parts of this fit are moved against each other, mm: about its clearance.
double play_mm(const Interval& overlap_mm) {
  return 0.002 + std::max(std::abs(overlap_mm.lo), std::abs(overlap_mm.hi));
}

void set_shape(JudgedCase& c, const RoundFit& fit) {
  c.shape = fit;
  c.overlap_mm = [fit](const Offsets& offsets) { return round_overlap_mm(fit, offsets); };
}

JudgedCase draw_cylinder(Dice& dice) {
  JudgedCase c;
  const DrawnFit drawn = draw_fit(dice);
  c.offset_a_mm = size_offset_mm(drawn.fit.shaft, drawn.shaft_mm);
  c.offset_b_mm = size_offset_mm(drawn.fit.hole, drawn.hole_mm);
  const double d = drawn.nominal_mm, height = d * dice.between(0.5, 1.5);
  const bool through = dice.between(0.0, 1.0) < 0.5;
  const double upper = through ? height + 0.3 * d : height * dice.between(0.3, 0.8);
  const auto [of_a, of_b] = both_around(dice, 512.0);
  const int rows = dice.between(0.0, 1.0) < 0.7 ? 1 : 3;
  RoundFit fit;
  fit.shaft = {drawn.shaft_mm, -0.4 * d, drawn.shaft_mm, upper};
  fit.hole = {drawn.hole_mm, 0.0, drawn.hole_mm, height};
  c.a = make_shaft(fit.shaft, rows, of_a);
  c.b = make_ring(fit.hole, d * dice.between(0.8, 1.1), rows, of_b);
  c.stated_a = c.stated_b = 1;
  // Moved by about the play of the fit: eccentric, tilted about the middle of the engagement,
  // turned.
  const double play =
      play_mm(c.offset_a_mm + c.offset_b_mm +
              Interval{drawn.shaft_mm - drawn.hole_mm, drawn.shaft_mm - drawn.hole_mm});
  const double engaged = std::min(upper, height);
  const double apart = some(dice, 1.5 * play), direction = dice.between(0.0, 2.0 * pi);
  const double tilt = dice.between(0.0, 1.0) < 0.5 ? 0.0 : some(dice, 3.0 * play / engaged);
  const double about = dice.between(0.0, 2.0 * pi), turn = dice.between(0.0, 2.0 * pi);
  const Vec3 middle(0, 0, 0.5 * engaged);
  const Quat q =
      rotation_exp(tilt * shapes::on_circle(1.0, about, 0.0)) * rotation_exp(turn * Vec3::UnitZ());
  fit.X_BA = {q, shapes::on_circle(apart, direction, 0.0) + middle - q * middle};
  place(dice, c, fit.X_BA);
  set_shape(c, fit);
  c.overlap_is_depth = tilt == 0.0;
  if (tilt == 0.0) {
    const double depth = polygon_depth_mm({drawn.shaft_mm, drawn.hole_mm, of_a, of_b,
                                           shapes::on_circle(apart, direction, 0.0), turn});
    if (depth > 0.0) c.mesh_depth_mm = depth;
  }
  c.text = text(
      "%s D %.4f, modelled %.5f in %.5f, facets %d in %d, %s %.2f of %.2f, eccentric "
      "%.5f, tilt %.3g",
      drawn.code.c_str(), d, 2.0 * drawn.shaft_mm, 2.0 * drawn.hole_mm, of_a.facets, of_b.facets,
      through ? "through" : "blind", engaged, height, apart, tilt);
  return c;
}

/// A profile zone of either sign about the surface, from a few micrometres to tenths.
Interval zone(Dice& dice, double width_mm) {
  const double middle = width_mm * dice.between(-1.0, 1.0);
  const double half = 0.5 * width_mm * dice.between(0.1, 1.0);
  return {middle - half, middle + half};
}

JudgedCase draw_cone(Dice& dice) {
  JudgedCase c;
  const double d = dice.spread(3.0, 500.0), width = d * dice.spread(1e-4, 1e-3);
  const double half_angle = dice.between(0.03, 0.8);
  const double slope = std::tan(half_angle);
  const double height = std::min(0.6, 0.35 / slope) * d;
  c.offset_a_mm = zone(dice, width);
  c.offset_b_mm = zone(dice, width);
  const auto [of_a, of_b] = both_around(dice, 512.0);
  const double r0 = 0.5 * d - 0.5 * height * slope, r1 = 0.5 * d + 0.5 * height * slope;
  const double more = 0.2 * height;
  RoundFit fit;
  fit.hole = {r0, 0.0, r1, height};
  fit.shaft = {r0 + more * slope, more, r1 + more * slope, height + more};
  c.a = make_shaft(fit.shaft, 1, of_a);
  c.b = make_ring(fit.hole, 1.5 * r1 + 0.1 * d, 1, of_b);
  c.stated_a = c.stated_b = 1;
  const double play = play_mm(c.offset_a_mm + c.offset_b_mm);
  const double apart = some(dice, play), direction = dice.between(0.0, 2.0 * pi);
  const double pushed = dice.sign() * some(dice, play / std::sin(half_angle));
  const double tilt = dice.between(0.0, 1.0) < 0.6 ? 0.0 : some(dice, play / height);
  const Vec3 middle(0, 0, 0.5 * height);
  const Quat q = rotation_exp(tilt * shapes::on_circle(1.0, dice.between(0.0, 2.0 * pi), 0.0)) *
                 rotation_exp(dice.between(0.0, 2.0 * pi) * Vec3::UnitZ());
  fit.X_BA = {q, shapes::on_circle(apart, direction, -pushed) + middle - q * middle};
  place(dice, c, fit.X_BA);
  set_shape(c, fit);
  c.overlap_is_depth = tilt == 0.0;
  c.text = text(
      "D %.4f, half angle %.4f, zones [%.5f, %.5f] [%.5f, %.5f], facets %d in %d, "
      "pushed %.5f, eccentric %.5f, tilt %.3g",
      d, half_angle, c.offset_a_mm.lo, c.offset_a_mm.hi, c.offset_b_mm.lo, c.offset_b_mm.hi,
      of_a.facets, of_b.facets, pushed, apart, tilt);
  return c;
}

JudgedCase draw_ball(Dice& dice) {
  JudgedCase c;
  const DrawnFit drawn = draw_fit(dice);
  c.offset_a_mm = size_offset_mm(drawn.fit.shaft, drawn.shaft_mm);
  c.offset_b_mm = size_offset_mm(drawn.fit.hole, drawn.hole_mm);
  const auto [of_a, of_b] = both_around(dice, 96.0);
  BallFit fit;
  fit.ball_mm = drawn.shaft_mm;
  fit.socket_mm = drawn.hole_mm;
  fit.rim_z_mm = drawn.hole_mm * dice.between(-0.4, 0.4);
  c.a = make_ball(fit.ball_mm, of_a);
  c.b = make_socket(fit.socket_mm, fit.rim_z_mm, 1.5 * fit.socket_mm, of_b);
  c.stated_a = c.stated_b = 1;
  const double play =
      play_mm(c.offset_a_mm + c.offset_b_mm +
              Interval{drawn.shaft_mm - drawn.hole_mm, drawn.shaft_mm - drawn.hole_mm});
  fit.center = some(dice, 1.5 * play) * dice.direction();
  place(dice, c, {dice.orientation(), fit.center});
  c.shape = fit;
  c.overlap_mm = [fit](const Offsets& offsets) { return ball_overlap_mm(fit, offsets); };
  c.overlap_is_depth = deepest_below_rim(fit);
  c.text = text(
      "%s D %.4f, modelled %.5f in %.5f, facets %d in %d, rim %.3f, eccentric %.5f "
      "(z %.5f)",
      drawn.code.c_str(), drawn.nominal_mm, 2.0 * fit.ball_mm, 2.0 * fit.socket_mm, of_a.facets,
      of_b.facets, fit.rim_z_mm, fit.center.norm(), fit.center.z());
  return c;
}

JudgedCase draw_key(Dice& dice) {
  JudgedCase c;
  const double w = dice.spread(3.0, 500.0), width = w * dice.spread(1e-4, 3e-3);
  c.offset_a_mm = zone(dice, width);
  c.offset_b_mm = zone(dice, width);
  const double play = play_mm(c.offset_a_mm + c.offset_b_mm);
  KeyFit fit;
  fit.slot = {0.5 * w, w * dice.between(0.5, 1.0), w * dice.between(1.0, 3.0), 0.5 * w};
  fit.key_half_mm = Vec3(0.5 * w - play * dice.between(-0.5, 2.0), w * dice.between(0.5, 0.8),
                         0.8 * fit.slot.half_length_mm);
  c.a = make_block(fit.key_half_mm, dice.between(0.0, 1.0) < 0.5 ? 1 : 4);
  c.b = make_slot(fit.slot);
  c.stated_a = c.stated_b = 3;
  fit.center = Vec3(dice.sign() * some(dice, play),
                    fit.key_half_mm.y() + play * dice.between(-0.5, 4.0), 0.0);
  fit.yaw_rad =
      dice.sign() * (dice.between(0.0, 1.0) < 0.5 ? 0.0 : some(dice, play / fit.key_half_mm.z()));
  place(dice, c, {rotation_exp(fit.yaw_rad * Vec3::UnitY()), fit.center});
  c.shape = fit;
  c.overlap_mm = [fit](const Offsets& offsets) { return key_overlap_mm(fit, offsets); };
  c.overlap_is_depth = true;
  const double depth = key_overlap_mm(fit, {});
  if (depth > 0.0) c.mesh_depth_mm = depth;
  c.text = text(
      "slot %.4f, key %.5f, zones [%.5f, %.5f] [%.5f, %.5f], shift %.5f, above floor %.5f, yaw "
      "%.3g",
      w, 2.0 * fit.key_half_mm.x(), c.offset_a_mm.lo, c.offset_a_mm.hi, c.offset_b_mm.lo,
      c.offset_b_mm.hi, fit.center.x(), fit.center.y() - fit.key_half_mm.y(), fit.yaw_rad);
  return c;
}

JudgedCase draw_blocks(Dice& dice) {
  JudgedCase c;
  const double d = dice.spread(3.0, 500.0), width = d * dice.spread(1e-4, 1e-2);
  c.offset_a_mm = zone(dice, width);
  c.offset_b_mm = zone(dice, width);
  const Vec3 half_a(d * dice.between(0.3, 0.6), d * dice.between(0.3, 0.6), 0.3 * d);
  const Vec3 half_b(d * dice.between(0.3, 0.6), d * dice.between(0.3, 0.6), 0.3 * d);
  c.a = make_block(half_a, 1 + static_cast<int>(dice.between(0.0, 3.999)));
  c.b = make_block(half_b, 1 + static_cast<int>(dice.between(0.0, 3.999)));
  const double play = play_mm(c.offset_a_mm + c.offset_b_mm);
  const double overlap = dice.between(-1.5, 1.5) * play;
  // The contact face is at least a fifth of d wide, so that only it decides.
  const Vec3 shift(dice.between(-0.35, 0.35) * d, dice.between(-0.35, 0.35) * d, 0.6 * d - overlap);
  place(dice, c, Pose::translation(shift));
  c.overlap_mm = [overlap](const Offsets& offsets) { return overlap + offsets.a + offsets.b; };
  c.overlap_is_depth = true;
  if (overlap > 0.0) c.mesh_depth_mm = overlap;
  c.text = text("size %.4f, zones [%.5f, %.5f] [%.5f, %.5f], overlap %.5f", d, c.offset_a_mm.lo,
                c.offset_a_mm.hi, c.offset_b_mm.lo, c.offset_b_mm.hi, overlap);
  return c;
}

}  // namespace

const char* name_of(Family family) {
  switch (family) {
    case Family::kCylinder:
      return "cylinder";
    case Family::kCone:
      return "cone";
    case Family::kBall:
      return "ball";
    case Family::kKey:
      return "key";
    case Family::kBlocks:
      return "blocks";
  }
  return "";
}

int JudgedCase::facets() const {
  if (a.facets == 0 || b.facets == 0) return std::max(a.facets, b.facets);
  return std::min(a.facets, b.facets);
}

Truth JudgedCase::truth(bool whole) const {
  const auto at = [&](double offset_a, double offset_b) {
    Offsets offsets{offset_a, offset_b, 0.0, 0.0};
    if (whole) offsets.rest_a = offset_a, offsets.rest_b = offset_b;
    return overlap_mm(offsets);
  };
  return {at(offset_a_mm.lo, offset_b_mm.lo), at(offset_a_mm.hi, offset_b_mm.hi)};
}

JudgedCase draw_case(Family family, std::uint64_t seed) {
  Dice dice(seed * 8 + static_cast<std::uint64_t>(family));
  JudgedCase c;
  switch (family) {
    case Family::kCylinder:
      c = draw_cylinder(dice);
      break;
    case Family::kCone:
      c = draw_cone(dice);
      break;
    case Family::kBall:
      c = draw_ball(dice);
      break;
    case Family::kKey:
      c = draw_key(dice);
      break;
    case Family::kBlocks:
      c = draw_blocks(dice);
      break;
  }
  c.family = family;
  c.seed = seed;
  return c;
}

}  // namespace mortise::bench
