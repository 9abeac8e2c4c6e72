#include "common/evaluation/tolerance.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mortise {
namespace {

// Sizes that went through another unit differ by rounding; a nanometre is far below IT01.
constexpr double kSameSize_mm = 1e-6;

bool has_size(const Surface& surface) {
  return surface.kind == SurfaceKind::kCylinder || surface.kind == SurfaceKind::kSphere;
}

// A modelled size under limits of size: a diameter, or a width.
struct Modelled {
  const char* what;
  double size_mm;
  std::string symbol;  // before the size: "Ø" of a diameter
};

Result<FaceStatement> statement_of(const SizeLimits& limits, const Modelled& modelled,
                                   double residual_mm) {
  const double slack_mm = 2.0 * residual_mm + kSameSize_mm;
  const double least_mm = limits.nominal_mm + limits.deviation_mm.lo;
  const double most_mm = limits.nominal_mm + limits.deviation_mm.hi;
  const bool nominal = std::fabs(modelled.size_mm - limits.nominal_mm) <= slack_mm;
  const bool within =
      modelled.size_mm >= least_mm - slack_mm && modelled.size_mm <= most_mm + slack_mm;
  const std::string name = modelled.symbol + size_text(limits.nominal_mm) + " " + limits.code;
  if (!nominal && !within)
    return fail(Code::kInvalidInput,
                std::string("modelled ") + modelled.what + " " + size_text(modelled.size_mm) +
                    " mm is neither the nominal size nor within the limits " + size_text(least_mm) +
                    " to " + size_text(most_mm) + " mm of " + name + "; state its nominal size");
  return FaceStatement{size_offset_mm(limits, 0.5 * modelled.size_mm), name, {}, true};
}

Modelled diameter_of(const Surface& surface) { return {"diameter", 2.0 * surface.radius_mm, "Ø"}; }

std::string side_text(const FitSide& side) {
  return side.name + (side.surface->inward ? " is a hole" : " is a shaft");
}

}  // namespace

std::string size_text(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6f", mm);
  std::string trimmed = text;
  while (trimmed.back() == '0') trimmed.pop_back();
  if (trimmed.back() == '.') trimmed.pop_back();
  return trimmed == "-0" ? "0" : trimmed;
}

std::optional<FaceStatement> both_hold(const FaceStatement& a, const FaceStatement& b) {
  FaceStatement both = b.source.empty() ? a : b;
  both.is_size = a.is_size || b.is_size;
  both.position = a.position.zone_mm > b.position.zone_mm ? a.position : b.position;
  if (a.source.empty() || b.source.empty()) return both;
  const Interval x = a.offset_mm, y = b.offset_mm;
  const auto within = [](const Interval& inner, const Interval& outer) {
    return inner.lo >= outer.lo - kSameSize_mm && inner.hi <= outer.hi + kSameSize_mm;
  };
  if (within(y, x)) return both;
  both.source = a.source;
  both.offset_mm = x;
  if (within(x, y)) return both;
  both.source = a.source + " and " + b.source;
  both.offset_mm = {std::max(x.lo, y.lo), std::min(x.hi, y.hi)};
  if (both.offset_mm.lo <= both.offset_mm.hi) return both;
  if (both.offset_mm.lo - both.offset_mm.hi > kSameSize_mm) return std::nullopt;
  const double touch_mm = both.offset_mm.middle();
  both.offset_mm = {touch_mm, touch_mm};
  return both;
}

FaceStatement with_position(const FaceStatement& statement) {
  const Position& position = statement.position;
  if (position.zone_mm <= 0.0) return statement;
  const double half_mm = 0.5 * position.zone_mm;
  const Interval size = statement.offset_mm, stated = position.size_offset_mm;
  FaceStatement widened = statement;
  widened.source += std::string(statement.source.empty() ? "" : ", ") + "position Ø" +
                    size_text(position.zone_mm) + " mm";
  switch (position.condition) {
    case MaterialCondition::kRegardless:
      widened.offset_mm = size + Interval{-half_mm, half_mm};
      break;
    case MaterialCondition::kMaximum:
      widened.offset_mm = {size.lo - half_mm - (stated.hi - size.lo), stated.hi + half_mm};
      widened.source += " at MMC";
      break;
    case MaterialCondition::kLeast:
      widened.offset_mm = {stated.lo - half_mm, size.hi + half_mm + (size.hi - stated.lo)};
      widened.source += " at LMC";
      break;
  }
  return widened;
}

Interval size_offset_mm(const SizeLimits& limits, double modelled_radius_mm) {
  // Sizes first: a part modelled at nominal then has no rounding in its offsets (h6 ends at 0).
  const double off_nominal_mm = 0.5 * limits.nominal_mm - modelled_radius_mm;
  const Interval grown{off_nominal_mm + 0.5 * limits.deviation_mm.lo,
                       off_nominal_mm + 0.5 * limits.deviation_mm.hi};
  return limits.hole ? -grown : grown;
}

Result<FaceStatement> iso_statement(const std::string& code, double nominal_mm,
                                    const Surface& surface, double residual_mm) {
  if (!has_size(surface))
    return fail(
        Code::kInvalidInput,
        "an ISO 286 class needs a diameter (cylinder or sphere), or the other plane of a width "
        "(width_to); use plus_minus or profile");
  const Result<SizeLimits> limits =
      iso286_limits(code, nominal_mm > 0.0 ? nominal_mm : 2.0 * surface.radius_mm);
  if (!limits) return limits.error();
  if (limits->hole != surface.inward)
    return fail(Code::kInvalidInput,
                std::string("class ") + code + " is for a " + (limits->hole ? "hole" : "shaft") +
                    ", but the feature is a " + (surface.inward ? "hole" : "shaft") +
                    (limits->hole ? "; use a small letter or say inward: true"
                                  : "; use a capital letter or say inward: false"));
  return statement_of(*limits, diameter_of(surface), residual_mm);
}

Result<FaceStatement> width_statement(const std::string& code, double nominal_mm,
                                      const Surface& plane, const Surface& opposite,
                                      double residual_mm) {
  if (plane.kind != SurfaceKind::kPlane || opposite.kind != SurfaceKind::kPlane)
    return fail(Code::kInvalidInput, "a width needs two planes");
  // How far one plane runs away from the other over a width of 1: a second of arc is 5e-6.
  constexpr double kParallel = 1e-6;
  const double across_mm = (opposite.point - plane.point).dot(plane.axis);
  if ((plane.axis + opposite.axis).norm() > kParallel || across_mm == 0.0)
    return fail(Code::kInvalidInput,
                "a width needs two parallel planes that face each other or away from each other");
  const Modelled width{"width", std::fabs(across_mm), ""};
  const bool slot = across_mm > 0.0;  // the material's outside lies between them
  const Result<SizeLimits> limits =
      iso286_limits(code, nominal_mm > 0.0 ? nominal_mm : width.size_mm);
  if (!limits) return limits.error();
  if (limits->hole != slot)
    return fail(Code::kInvalidInput, "class " + code + " is for a " +
                                         (limits->hole ? "slot" : "key") +
                                         ", but both planes face " +
                                         (slot ? "each other; use a capital letter"
                                               : "away from each other; use a small letter"));
  return statement_of(*limits, width, residual_mm);
}

Result<FitStatement> fit_statement(const std::string& code, double nominal_mm, const FitSide& a,
                                   const FitSide& b) {
  for (const FitSide* side : {&a, &b})
    if (!has_size(*side->surface))
      return fail(Code::kInvalidInput, "fit " + code + ": " + side->name +
                                           " has no diameter; name cylinders or spheres");
  if (a.surface->inward == b.surface->inward)
    return fail(Code::kInvalidInput, "fit " + code + " joins a hole and a shaft, but " +
                                         side_text(a) + " and " + side_text(b));
  if (nominal_mm <= 0.0) {
    const double slack_mm = a.residual_mm + b.residual_mm + kSameSize_mm;
    if (std::fabs(a.surface->radius_mm - b.surface->radius_mm) > slack_mm)
      return fail(Code::kInvalidInput,
                  "fit " + code + ": " + a.name + " is modelled at Ø" +
                      size_text(2.0 * a.surface->radius_mm) + " and " + b.name + " at Ø" +
                      size_text(2.0 * b.surface->radius_mm) +
                      " mm; add nominal: the common size, or write it before the code (Ø20 H7/g6)");
    nominal_mm = 2.0 * (a.surface->inward ? a : b).surface->radius_mm;
  }
  Result<Fit> fit = iso286_fit(code, nominal_mm);
  if (!fit) return fit.error();
  const auto of = [&](const FitSide& side) -> Result<FaceStatement> {
    Result<FaceStatement> stated = statement_of(side.surface->inward ? fit->hole : fit->shaft,
                                                diameter_of(*side.surface), side.residual_mm);
    if (!stated) return fail(stated.error().code, side.name + ": " + stated.error().text);
    return stated;
  };
  Result<FaceStatement> of_a = of(a);
  if (!of_a) return of_a.error();
  Result<FaceStatement> of_b = of(b);
  if (!of_b) return of_b.error();
  FitStatement statement;
  statement.a = std::move(of_a).value();
  statement.b = std::move(of_b).value();
  statement.nominal_mm = nominal_mm;
  statement.text = "Ø" + size_text(nominal_mm) + " " + code;
  statement.fit = std::move(fit).value();
  return statement;
}

}  // namespace mortise
