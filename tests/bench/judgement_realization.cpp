#include "tests/bench/judgement_realization.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mortise::bench {
namespace {

using std::numbers::pi;
constexpr double kNoOverlap = -std::numeric_limits<double>::infinity();

// The largest value over (angle, height in -1 .. 1): a grid, then finer ones about its best local
// bests; where the hole ends the best lies beside places that have no value.
template <class F>
double largest_over(F&& f) {
  constexpr int kAngles = 240, kHeights = 32, kFiner = 4;
  constexpr std::size_t kStarts = 6;
  struct Place {
    double value, angle, height;
  };
  std::vector<double> grid(kAngles * (kHeights + 1));
  const auto at = [&](int i, int j) -> double& {
    return grid[static_cast<std::size_t>(j * kAngles + (i + kAngles) % kAngles)];
  };
  for (int j = 0; j <= kHeights; ++j)
    for (int i = 0; i < kAngles; ++i)
      at(i, j) = f(2.0 * pi * i / kAngles, -1.0 + 2.0 * j / kHeights);
  std::vector<Place> starts;
  for (int j = 0; j <= kHeights; ++j)
    for (int i = 0; i < kAngles; ++i) {
      const double value = at(i, j);
      if (value == kNoOverlap || value < at(i - 1, j) || value < at(i + 1, j)) continue;
      if ((j > 0 && value < at(i, j - 1)) || (j < kHeights && value < at(i, j + 1))) continue;
      starts.push_back({value, 2.0 * pi * i / kAngles, -1.0 + 2.0 * j / kHeights});
    }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Place& x, const Place& y) { return x.value > y.value; });
  if (starts.size() > kStarts) starts.resize(kStarts);
  double largest = kNoOverlap;
  for (Place best : starts) {
    double angle_step = 2.0 * pi / kAngles, height_step = 2.0 / kHeights;
    for (int round = 0; round < 9; ++round) {
      const Place middle = best;
      angle_step /= kFiner, height_step /= kFiner;
      for (int j = -kFiner; j <= kFiner; ++j)
        for (int i = -kFiner; i <= kFiner; ++i) {
          const double angle = middle.angle + i * angle_step;
          const double height = std::clamp(middle.height + j * height_step, -1.0, 1.0);
          const double value = f(angle, height);
          if (value > best.value) best = {value, angle, height};
        }
    }
    largest = std::max(largest, best.value);
  }
  return largest;
}

double height_of(const Frustum& f, double z) {
  return 2.0 * (z - f.z0_mm) / (f.z1_mm - f.z0_mm) - 1.0;
}

// Heights of the shaft are counted between the ends of the hole: along its axis, which is quick, or
// along each of its lines (`to_ends`), where the deepest point often is and a grid of heights falls
// short of it. Ten times the work.
double sampled_round(const RoundFit& fit, const Realization& drawn, bool to_ends) {
  const double slope = (fit.hole.r1_mm - fit.hole.r0_mm) / (fit.hole.z1_mm - fit.hole.z0_mm);
  const double cosine = 1.0 / std::hypot(1.0, slope);
  const double lower = fit.hole.z0_mm - drawn.b.rest_mm, upper = fit.hole.z1_mm + drawn.b.rest_mm;
  const double z0 = fit.shaft.z0_mm - drawn.a.rest_mm, z1 = fit.shaft.z1_mm + drawn.a.rest_mm;
  const Pose X_AB = fit.X_BA.inverse();
  const double rise = (fit.X_BA.q * Vec3::UnitZ()).z();
  const auto point_at = [&](double angle, double z) -> Vec3 {
    const double radius = fit.shaft.r0_mm + slope * (z - fit.shaft.z0_mm) +
                          drawn.a.offset_mm(angle, height_of(fit.shaft, z)) / cosine;
    return fit.X_BA * shapes::on_circle(radius, angle, z);
  };
  const auto end_at = [&](double angle, double height_B) {
    double z = 0.5 * (z0 + z1);
    for (int i = 0; i < 4; ++i) z += (height_B - point_at(angle, z).z()) / rise;
    return z;
  };
  const double more = 0.02 * (upper - lower);
  const Interval on_axis{(X_AB * Vec3(0, 0, lower)).z() - more,
                         (X_AB * Vec3(0, 0, upper)).z() + more};
  return largest_over([&](double angle, double height) {
    Interval hole_z = on_axis;
    if (to_ends) {
      const auto [least, most] = std::minmax({end_at(angle, lower), end_at(angle, upper)});
      hole_z = {least, most};
    }
    const double from = std::max(z0, hole_z.lo), to = std::min(z1, hole_z.hi);
    if (to_ends && !(from <= to)) return kNoOverlap;
    const Vec3 p = point_at(angle, 0.5 * (from + to) + 0.5 * height * (to - from));
    if (!to_ends && (p.z() < lower || p.z() > upper)) return kNoOverlap;
    const double hole = fit.hole.r0_mm + slope * (p.z() - fit.hole.z0_mm);
    return (std::hypot(p.x(), p.y()) - hole) * cosine +
           drawn.b.offset_mm(std::atan2(p.y(), p.x()), height_of(fit.hole, p.z()));
  });
}

double sampled_ball(const BallFit& fit, const Realization& drawn) {
  return largest_over([&](double angle, double height) {
    const double radius = fit.ball_mm + drawn.a.offset_mm(angle, height);
    const double polar = 0.5 * pi * (height + 1.0);
    const Vec3 p =
        fit.center + radius * shapes::on_circle(std::sin(polar), angle, -std::cos(polar));
    if (p.z() > fit.rim_z_mm + drawn.b.rest_mm) return kNoOverlap;
    const double apart = p.norm();
    return apart - fit.socket_mm +
           drawn.b.offset_mm(std::atan2(p.y(), p.x()), p.z() / std::max(apart, 1e-300));
  });
}

DrawnSurface draw_surface(const Interval& zone_mm, bool whole, int corner, Dice& dice) {
  DrawnSurface s;
  s.zone_mm = zone_mm;
  if (corner >= 0) {
    s.level = corner == 0 ? -1.0 : 1.0;
  } else {
    s.level = dice.between(-1.0, 1.0);
    s.lobes_share = dice.between(0.0, 1.0);
    s.lobes = 1 + static_cast<int>(dice.between(0.0, 6.999));
    s.phase_rad = dice.between(0.0, 2.0 * pi);
    s.taper_share = dice.between(-1.0, 1.0);
  }
  if (whole) s.rest_mm = zone_mm.middle() + 0.5 * s.level * zone_mm.width();
  return s;
}

}  // namespace

double DrawnSurface::offset_mm(double angle_rad, double height) const {
  const double share =
      level + lobes_share * std::cos(lobes * angle_rad + phase_rad) + taper_share * height;
  return zone_mm.middle() + 0.5 * std::clamp(share, -1.0, 1.0) * zone_mm.width();
}

Realization draw_realization(const JudgedCase& c, bool whole, int i, Dice& dice) {
  return {draw_surface(c.offset_a_mm, whole, i < 4 ? i % 2 : -1, dice),
          draw_surface(c.offset_b_mm, whole, i < 4 ? i / 2 : -1, dice)};
}

std::optional<double> sampled_overlap_mm(const JudgedCase& c, const Realization& drawn,
                                         bool to_ends) {
  if (const auto* fit = std::get_if<RoundFit>(&c.shape)) return sampled_round(*fit, drawn, to_ends);
  if (const auto* fit = std::get_if<BallFit>(&c.shape)) return sampled_ball(*fit, drawn);
  return std::nullopt;
}

}  // namespace mortise::bench
