#include "common/geometry/recognition/seed_fits.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/geometry/recognition/surface_fit.h"

namespace mortise {
namespace {

// A first guess this far off, as a share of the extent of its points, is of
// another kind.
constexpr double kFarOff = 0.05;
// A fit to seeds that is so many times farther off than the loosest share after
// a few steps will not come near.
constexpr double kHopeless = 30.0;
// Fits to seeds stop where a step wins less: exact points win decades a step.
constexpr double kWorthGoingOn = 0.05;
// Corners of a few seeds that are farther off (root mean square) than this many times what may be
// are off in larger sets too. One would do if every fit found the nearest surface of all.
constexpr double kSurelyOff = 3.0;

constexpr double kFar = std::numeric_limits<double>::infinity();

std::optional<Surface> guess_of(SurfaceKind kind, std::span<const Vec3> points,
                                std::span<const OrientedPoint> normals) {
  switch (kind) {
    case SurfaceKind::kCylinder:
      return guess_cylinder(points, normals);
    case SurfaceKind::kCone:
      return guess_cone(points, normals);
    case SurfaceKind::kSphere:
      return guess_sphere(points);
    default:
      return guess_torus(points, normals);
  }
}

// Are all points as near as this?
bool within(double most_mm, const Surface& surface, std::span<const Vec3> points) {
  const SurfaceAt at(surface);
  return std::none_of(points.begin(), points.end(),
                      [&](const Vec3& x) { return std::fabs(at.outside_mm(x)) > most_mm; });
}

}  // namespace

double extent_of(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& x : points) box.add(x);
  return (box.hi - box.lo).norm();
}

SeedFitter::SeedFitter(const Solid& solid, const SeedFinder& finder, const RegionGrower& grower,
                       bool plain)
    : mesh_(solid.mesh()),
      finder_(finder),
      grower_(grower),
      plain_(plain),
      corners_(mesh_.points_mm.size()),
      triangles_(mesh_.triangles.size()) {}

SeedSets SeedFitter::about(std::uint32_t facet, std::span<const ByKind> known) {
  SeedSets sets = finder_.about(facet, triangles_);
  if (known.empty()) return sets;
  auto next = known.begin();
  for (auto* of : {&sets.ribbons, &sets.patches})
    for (SeedSet& seeds : *of) seeds.off_share = *next++;
  return sets;
}

void SeedFitter::ask_first(SeedSets& sets, double share) {
  for (std::size_t kind = 0; kind < kCurvedKinds.size(); ++kind) {
    const auto any_holds = [&](std::vector<SeedSet>& of) {
      return std::any_of(of.begin(), of.end(),
                         [&](SeedSet& seeds) { return holds(kind, sets, seeds, share); });
    };
    if (!grows_in_ribbons(kCurvedKinds[kind]) || !any_holds(sets.ribbons)) any_holds(sets.patches);
  }
}

bool SeedFitter::holds(std::size_t kind, SeedSets& all, SeedSet& seeds, double share) {
  double& off_share = seeds.off_share[kind];
  if (off_share > share) return false;
  if (const double least = least_share(kind, all, seeds, share); least > share) {
    off_share = least;
    return false;
  }
  fit(kind, seeds);
  return !(off_share > share);
}

// Corners that are far off every surface of a kind are so in any larger set too: the smallest
// sets, which cost least, are asked first.
double SeedFitter::least_share(std::size_t kind, SeedSets& all, const SeedSet& seeds,
                               double share) {
  const bool patch =
      &seeds >= all.patches.data() && &seeds < all.patches.data() + all.patches.size();
  for (std::uint32_t parts = plain_ ? 0U : seeds.holds; parts != 0;) {
    const auto bit = static_cast<unsigned>(std::bit_width(parts)) - 1U;
    parts ^= 1U << bit;
    SeedSet& part = all.at_bit(bit);
    // Ribbons were asked before, or are not asked for this kind at all.
    if (patch == (bit >= SeedSets::kPatchBit) && !(part.off_share[kind] > share)) fit(kind, part);
    if (part.fits[kind].least_share > share) return part.fits[kind].least_share;
  }
  return 0.0;
}

void SeedFitter::fill(SeedSet& seeds) {
  if (!seeds.points.empty()) return;
  seeds.points = corners_of(mesh_, seeds.triangles, corners_);
  seeds.normals = grower_.normals_of(seeds.triangles);
}

void SeedFitter::fit(std::size_t kind, SeedSet& seeds) {
  SeedFit& fit = seeds.fits[kind];
  if (fit.asked) return;
  fit.asked = true;
  fill(seeds);
  seeds.off_share[kind] = kFar;
  if (const auto guess = guess_of(kCurvedKinds[kind], seeds.points, seeds.normals))
    seeds.off_share[kind] = fit_from(*guess, seeds, fit);
}

double SeedFitter::fit_from(const Surface& guess, const SeedSet& seeds, SeedFit& fit) const {
  if (!within(kFarOff * extent_of(seeds.points), guess, seeds.points)) return kFar;
  const double rounding_mm = grower_.rounding_mm(), size = size_mm(guess, seeds.points);
  const double hopeless_mm = kHopeless * (kShares.back() * size + rounding_mm);
  fit.surface = fitted_surface(guess, seeds.points, kWorthGoingOn, hopeless_mm);
  if (!fit.surface) return kFar;
  const double fit_size = size_mm(*fit.surface, seeds.points);
  const Residuals off = residuals_of(*fit.surface, seeds.points);
  fit.least_share = (off.mean_mm / kSurelyOff - rounding_mm) / fit_size;
  return (off.most_mm - rounding_mm) / fit_size;
}

}  // namespace mortise
