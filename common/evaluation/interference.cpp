#include "common/evaluation/interference.h"

#include <algorithm>
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

// Axes are no farther off than so many sigmas, but for one in 10^8.
constexpr double kFarthest = 6.0;
// Steps from the nearest to the farthest; each is 1/43 sigma or less. Chosen: what is left of the
// error is 1e-5 where sizes have no width, and far less where they have.
constexpr int kSteps = 512;

// e^-x I0(x), I0 the modified Bessel function: by its series, or the asymptotic one where that is
// exact to rounding.
double scaled_bessel(double x) {
  constexpr double kFar = 20.0;     // there the tenth term is 1e-11 of the first
  constexpr int kAsymptotic = 12;   // terms, falling
  constexpr double kLeast = 1e-17;  // of the sum: below rounding
  double sum = 1.0, term = 1.0;
  if (x > kFar) {
    for (int k = 1; k <= kAsymptotic; ++k) {
      const double odd = 2.0 * k - 1.0;
      sum += term *= odd * odd / (8.0 * k * x);
    }
    return sum / std::sqrt(2.0 * std::numbers::pi * x);
  }
  for (int k = 1; term > kLeast * sum; ++k) sum += term *= 0.25 * x * x / (k * k);
  return sum * std::exp(-x);
}

// How far apart two axes are that are modelled d apart, where one is off by a normal vector:
// the density of Rice.
double density_of_distance(double distance_mm, double d_mm, double sigma_mm) {
  const double r = distance_mm / sigma_mm, d = d_mm / sigma_mm;
  return r / sigma_mm * std::exp(-0.5 * (r - d) * (r - d)) * scaled_bessel(r * d);
}

// P where the axes are off by a normal vector: the overlap grows by |d + e| - |d|. That is linear
// in the distance |d + e|, so within a step the share of sizes is averaged in closed form, and
// close sizes need no finer steps.
double with_places(const SizeShare& sizes, double middle_mm, const ParallelAxes& axes,
                   double sigma_mm) {
  const double d = axes.apart_mm, sign = axes.nested ? 1.0 : -1.0;
  const double nearest_mm = std::max(0.0, d - kFarthest * sigma_mm);
  const double step_mm = (d + kFarthest * sigma_mm - nearest_mm) / kSteps;
  const auto density_at = [&](double steps) {
    return density_of_distance(nearest_mm + steps * step_mm, d, sigma_mm);
  };
  double sum = 0.0;
  double from_mm = middle_mm + sign * (nearest_mm - d), from_share = sizes.at(from_mm);
  double from_integral = sizes.integral_mm(from_mm, from_share), from_density = density_at(0.0);
  for (int i = 0; i < kSteps; ++i) {
    const double to_mm = middle_mm + sign * (nearest_mm + (i + 1) * step_mm - d);
    const double to_share = sizes.at(to_mm), to_density = density_at(i + 1);
    const double to_integral = sizes.integral_mm(to_mm, to_share);
    const double mean = std::fabs(to_mm - from_mm) > sizes.least_step_mm()
                            ? (to_integral - from_integral) / (to_mm - from_mm)
                            : 0.5 * (from_share + to_share);
    const double density = (from_density + 4.0 * density_at(i + 0.5) + to_density) / 6.0;
    sum +=
        step_mm * (density * mean + (to_density - from_density) * (to_share - from_share) / 12.0);
    from_mm = to_mm, from_share = to_share, from_integral = to_integral, from_density = to_density;
  }
  return std::clamp(sum, 0.0, 1.0);
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
