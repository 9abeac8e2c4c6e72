#include "common/evaluation/interference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/check.h"

namespace mortise {
namespace {

// Limits of a tolerance count as three standard deviations on either side.
constexpr double kSigmasPerWidth = 6.0;

// What other things than tolerances may add, as a share of their widths: a shift of less than half
// a standard deviation.
constexpr double kDoubtShare = 0.05;

// A normal size as it makes an overlap: mm at its middle.
class SizeShare {
 public:
  explicit SizeShare(double sigma_mm) : sigma_mm_(sigma_mm) {}

  // Share of the sizes at which there is an overlap.
  double at(double middle_mm) const {
    if (sigma_mm_ > 0.0) return 0.5 * std::erfc(-middle_mm / (sigma_mm_ * std::numbers::sqrt2));
    return middle_mm > 0.0 ? 1.0 : middle_mm < 0.0 ? 0.0 : 0.5;
  }
  // The integral of at().
  double integral_mm(double middle_mm, double share) const {
    if (!(sigma_mm_ > 0.0)) return std::max(middle_mm, 0.0);
    const double x = middle_mm / sigma_mm_;
    constexpr double kPeak = std::numbers::inv_sqrtpi / std::numbers::sqrt2;
    return middle_mm * share + sigma_mm_ * kPeak * std::exp(-0.5 * x * x);
  }
  // Below this step a difference of integrals is all rounding.
  double least_step_mm() const { return 1e-3 * sigma_mm_; }

 private:
  double sigma_mm_;
};

// Places of the axis on a polar grid about its modelled one: circles out to where one in 10^8 is,
// directions of a half plane, since the other half is its mirror image.
constexpr int kCircles = 48, kDirections = 24;
constexpr double kStep = 1.0 / 8.0;  // from circle to circle, in sigmas

// Share of the places between two circles, and how fast their density changes there.
struct Ring {
  double share = 0.0, slope = 0.0;
};

std::array<Ring, kCircles> rings() {
  std::array<Ring, kCircles> rings;
  for (int i = 0; i < kCircles; ++i) {
    const double inner = i * kStep, outer = inner + kStep, middle = inner + 0.5 * kStep;
    rings[i].share = std::exp(-0.5 * inner * inner) - std::exp(-0.5 * outer * outer);
    rings[i].slope = (1.0 - middle * middle) * std::exp(-0.5 * middle * middle);
  }
  return rings;
}

// P where the axes are off by a normal vector: the overlap grows by |d + e| - |d|. Between two
// circles the share of sizes is averaged in closed form, so that close sizes need no finer grid.
double with_places(const SizeShare& sizes, double middle_mm, const ParallelAxes& axes,
                   double sigma_mm) {
  static const std::array<Ring, kCircles> kRings = rings();
  const double d = axes.apart_mm, step_mm = kStep * sigma_mm;
  const int directions = d > 0.0 ? kDirections : 1;
  double sum = 0.0;
  for (int j = 0; j < directions; ++j) {
    const double angle = std::numbers::pi * (j + 0.5) / directions;
    const double along = std::cos(angle), across = std::sin(angle);
    double from_mm = middle_mm, from_share = sizes.at(from_mm);
    double from_integral = sizes.integral_mm(from_mm, from_share);
    for (int i = 0; i < kCircles; ++i) {
      const double e = (i + 1) * step_mm;
      const double farther = std::hypot(d + e * along, e * across) - d;
      const double to_mm = middle_mm + (axes.nested ? farther : -farther);
      const double to_share = sizes.at(to_mm);
      const double to_integral = sizes.integral_mm(to_mm, to_share);
      const double mean = std::fabs(to_mm - from_mm) > sizes.least_step_mm()
                              ? (to_integral - from_integral) / (to_mm - from_mm)
                              : 0.5 * (from_share + to_share);
      sum +=
          kRings[i].share * mean + kStep * kStep / 12.0 * kRings[i].slope * (to_share - from_share);
      from_mm = to_mm, from_share = to_share, from_integral = to_integral;
    }
  }
  return std::clamp(sum / directions, 0.0, 1.0);
}

}  // namespace

Interval modelled_overlap_mm(const InterferenceZones& zones) {
  const Interval sizes = zones.size_a_mm + zones.size_b_mm;
  const double place_mm = 0.5 * (zones.position_a_mm + zones.position_b_mm);
  return {zones.certain_mm.lo - sizes.lo + place_mm, zones.possible_mm.hi - sizes.hi - place_mm};
}

std::optional<Interval> interference_probability(const InterferenceZones& zones) {
  const double sizes_mm = zones.size_a_mm.width() + zones.size_b_mm.width();
  const double places_mm = zones.position_a_mm + zones.position_b_mm;
  if (!(sizes_mm + places_mm > 0.0) || (places_mm > 0.0 && !zones.axes)) return std::nullopt;
  const Interval modelled = modelled_overlap_mm(zones);
  if (!(std::fabs(modelled.width()) <= kDoubtShare * (sizes_mm + places_mm))) return std::nullopt;
  const SizeShare sizes(std::hypot(zones.size_a_mm.width(), zones.size_b_mm.width()) /
                        kSigmasPerWidth);
  const double sigma_mm = std::hypot(zones.position_a_mm, zones.position_b_mm) / kSigmasPerWidth;
  const double shift_mm = (zones.size_a_mm + zones.size_b_mm).middle();
  const auto p_at = [&](double overlap_mm) {
    const double middle_mm = overlap_mm + shift_mm;
    return places_mm > 0.0 ? with_places(sizes, middle_mm, *zones.axes, sigma_mm)
                           : sizes.at(middle_mm);
  };
  const double x = p_at(modelled.lo), y = p_at(modelled.hi);
  MORTISE_CHECK(0.0 <= std::min(x, y) && std::max(x, y) <= 1.0, "a probability is up to one");
  return Interval{std::min(x, y), std::max(x, y)};
}

bool is_surface_known(const SurfaceBand::Face& face, FaceShape shape) {
  switch (face.grade) {
    case DeviationGrade::kPlanar:
    case DeviationGrade::kDeclaredFeature:
    case DeviationGrade::kRecognizedFeature:
      return true;
    case DeviationGrade::kNominal:
      return shape == FaceShape::kPlanar;
    case DeviationGrade::kDeclaredChord:
    case DeviationGrade::kEstimated:
    case DeviationGrade::kUnknown:
      break;
  }
  return false;
}

std::optional<ParallelAxes> parallel_axes(const MeetingFaces& faces) {
  for (const SurfaceBand::Face* face : {faces.a, faces.b})
    if (!face->surface || face->surface->kind != SurfaceKind::kCylinder || face->position_grows)
      return std::nullopt;
  const Surface &a = *faces.a->surface, &b = *faces.b->surface;
  if (a.inward && b.inward) return std::nullopt;
  const Vec3 axis_W = faces.X_WA.q * a.axis, other_W = faces.X_WB.q * b.axis;
  const double slack_mm =
      kDoubtShare * (faces.a->tolerance_mm.width() + faces.b->tolerance_mm.width());
  if (!(axis_W.cross(other_W).norm() * faces.length_mm <= slack_mm)) return std::nullopt;
  const auto at_height = [&](const Vec3& point_W, const Vec3& along_W) -> Vec3 {
    return point_W + (faces.at_W - point_W).dot(axis_W) / along_W.dot(axis_W) * along_W;
  };
  const Vec3 apart_W =
      at_height(faces.X_WB * b.point, other_W) - at_height(faces.X_WA * a.point, axis_W);
  return ParallelAxes{apart_W.norm(), a.inward != b.inward};
}

}  // namespace mortise
