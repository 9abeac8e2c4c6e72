#include "common/geometry/recognition/recognition.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <map>

#include "common/base/constants.h"
#include "common/geometry/recognition/finish.h"
#include "common/geometry/recognition/seeds.h"
#include "common/geometry/recognition/surface_fit.h"

namespace mortise {
namespace {

// How far corners may stand off, as shares of the radius, exact meshes first.
constexpr std::array<double, 3> kShares{1e-6, 2e-5, 4e-4};
// A kind of more parameters must explain this much more than a simpler one.
constexpr double kWorthMore = 1.2;
// What a later region takes over whole is smaller by at least this.
constexpr double kTakesOver = 2.0;

// A first guess this far off, as a share of the extent of its points, is of
// another kind.
constexpr double kFarOff = 0.05;
// A fit to seeds that is so many times farther off than the loosest share after
// a few steps will not come near.
constexpr double kHopeless = 30.0;
// Seeds that bulge by less than this part of what corners may be off show no
// curve.
constexpr double kLeastBulge = 0.1;
// Fits to seeds stop where a step wins less: exact points win decades a step.
constexpr double kWorthGoingOn = 0.05;

// Corners of a few seeds that are farther off (root mean square) than this many times what may be
// are off in larger sets too. One would do if every fit found the nearest surface of all.
constexpr double kSurelyOff = 3.0;

constexpr std::int32_t kNobody = -1;

class Recognizer {
 public:
  Recognizer(const Solid& solid, const RecognitionOptions& options)
      : solid_(solid),
        quantum_mm_(std::max(options.quantum_mm, grid_quantum_mm(solid.mesh()))),
        facets_(build_facets(solid, flat_allowance_mm(solid, quantum_mm_))),
        grower_(solid, facets_, quantum_mm_, options.plain),
        seeds_(solid, facets_, grower_),
        options_(options),
        owner_(solid.mesh().triangles.size(), kNobody) {}

  Recognition run() {
    given_up_.assign(facets_.count(), 0.0);
    known_off_.assign(facets_.count(), {});
    // Sparse seeds first: large regions are found from a few, and their fringes
    // need none.
    for (const double share : kShares)
      for (const std::uint32_t stride : {64U, 8U, 1U})
        for (std::uint32_t f = 0; f < facets_.count(); f += stride) try_facet(f, share);
    std::erase_if(regions_, [](const Region& r) { return r.triangles.empty(); });
    return finish_recognition(solid_, facets_, grower_, std::move(regions_), options_.planes);
  }

 private:
  void try_facet(std::uint32_t f, double share) {
    if (given_up_[f] >= share || owner_[facets_.triangles(f).front()] != kNobody ||
        !seeds_.bends_smoothly(f))
      return;
    SeedSets sets = seeds_.about(f);
    recall(f, sets);
    auto region = best_about(sets, share);
    given_up_[f] = std::max(given_up_[f], share);
    if (region) {
      // A region of others that runs through the facet without it would be found again from it.
      const bool refused = !options_.plain && runs_past(*region, f);
      if (!claim(std::move(*region)) && refused)
        given_up_[f] = std::numeric_limits<double>::infinity();
      return;
    }
    // All seeds were tried, and fit nothing better than that: no use in trying
    // again below it.
    given_up_[f] = std::max(given_up_[f], std::nextafter(remember(f, sets), 0.0));
  }

  // Do the corners of a facet lie on a region that has left it out for its shape?
  bool runs_past(const Region& region, std::uint32_t f) {
    const auto triangles = facets_.triangles(f);
    return !std::binary_search(region.triangles.begin(), region.triangles.end(),
                               triangles.front()) &&
           residual_of(region.surface, grower_.points_of(triangles)) <= region.allowed_mm;
  }

  void recall(std::uint32_t f, SeedSets& sets) const {
    auto known = known_off_[f].begin();
    if (known == known_off_[f].end()) return;
    for (auto* of : {&sets.ribbons, &sets.patches})
      for (SeedSet& seeds : *of) seeds.off_share = *known++;
  }

  // Gives the least.
  double remember(std::uint32_t f, const SeedSets& sets) {
    known_off_[f].clear();
    double least = std::numeric_limits<double>::infinity();
    for (const auto* of : {&sets.ribbons, &sets.patches})
      for (const SeedSet& seeds : *of) {
        known_off_[f].push_back(seeds.off_share);
        for (std::size_t k = 0; k < kCurvedKinds.size(); ++k)
          if (of == &sets.patches || grows_in_ribbons(kCurvedKinds[k]))
            least = std::min(least, seeds.off_share[k]);
      }
    return least;
  }

  static bool grows_in_ribbons(SurfaceKind kind) {
    return kind == SurfaceKind::kCylinder || kind == SurfaceKind::kCone;
  }

  // The region that explains most about a facet; simpler kinds win where they
  // do nearly as well.
  std::optional<Region> best_about(SeedSets& sets, double share) {
    std::optional<Region> best;
    for (std::size_t k = 0; k < kCurvedKinds.size(); ++k) {
      std::optional<Region> found;
      if (grows_in_ribbons(kCurvedKinds[k])) found = first_of(k, sets, sets.ribbons, share);
      if (kCurvedKinds[k] == SurfaceKind::kTorus && best) found = torus_of(*best, sets, share);
      if (!found) found = first_of(k, sets, sets.patches, share);
      if (!found) continue;
      const auto worth = [](const Region& r) { return static_cast<double>(r.triangles.size()); };
      if (!best || worth(*found) > kWorthMore * worth(*best)) best = std::move(found);
    }
    return best;
  }

  std::optional<Region> first_of(std::size_t kind, SeedSets& all, std::vector<SeedSet>& sets,
                                 double share) {
    for (SeedSet& seeds : sets) {
      double& off_share = seeds.off_share[kind];
      if (off_share > share) continue;
      if (const double least = least_share(kind, all, seeds, share); least > share) {
        off_share = least;
        continue;
      }
      fit(kind, seeds);
      if (off_share > share) continue;
      if (auto region = grown(*seeds.fits[kind].surface, seeds, share)) return region;
    }
    return std::nullopt;
  }

  // Corners that are far off every surface of a kind are so in any larger set too: the smallest
  // sets, which cost least, are asked first.
  double least_share(std::size_t kind, SeedSets& all, const SeedSet& seeds, double share) {
    const bool patch =
        &seeds >= all.patches.data() && &seeds < all.patches.data() + all.patches.size();
    for (std::uint32_t parts = options_.plain ? 0U : seeds.holds; parts != 0;) {
      const auto bit = static_cast<unsigned>(std::bit_width(parts)) - 1U;
      parts ^= 1U << bit;
      SeedSet& part = all.at_bit(bit);
      // Ribbons were asked before, or are not asked for this kind at all.
      if (patch == (bit >= SeedSets::kPatchBit) && !(part.off_share[kind] > share)) fit(kind, part);
      if (part.fits[kind].least_share > share) return part.fits[kind].least_share;
    }
    return 0.0;
  }

  void fill(SeedSet& seeds) {
    if (!seeds.points.empty()) return;
    seeds.points = grower_.points_of(seeds.triangles);
    seeds.normals = grower_.normals_of(seeds.triangles);
  }

  void fit(std::size_t kind, SeedSet& seeds) {
    SeedFit& fit = seeds.fits[kind];
    if (fit.asked) return;
    fit.asked = true;
    fill(seeds);
    seeds.off_share[kind] = std::numeric_limits<double>::infinity();
    if (const auto guess = guess_of(kCurvedKinds[kind], seeds.points, seeds.normals))
      seeds.off_share[kind] = fit_from(*guess, seeds, fit);
  }

  // Gives how far off the fit leaves corners, as a share of its size.
  double fit_from(const Surface& guess, const SeedSet& seeds, SeedFit& fit) const {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    if (residual_of(guess, seeds.points) > kFarOff * extent_of(seeds.points)) return kNever;
    const double rounding_mm = grower_.rounding_mm(), size = size_mm(guess, seeds.points);
    const double hopeless_mm = kHopeless * (kShares.back() * size + rounding_mm);
    fit.surface = fitted_surface(guess, seeds.points, kWorthGoingOn, hopeless_mm);
    if (!fit.surface) return kNever;
    const double fit_size = size_mm(*fit.surface, seeds.points);
    const Residuals off = residuals_of(*fit.surface, seeds.points);
    fit.least_share = (off.mean_mm / kSurelyOff - rounding_mm) / fit_size;
    return (off.most_mm - rounding_mm) / fit_size;
  }

  std::optional<Region> grown(const Surface& fit, const SeedSet& seeds, double share) {
    const double size = size_mm(fit, seeds.points), extent_mm = extent_of(seeds.points);
    const double bulge_mm = extent_mm * extent_mm / (8.0 * size);
    if (bulge_mm < kLeastBulge * share * size) return std::nullopt;
    return grower_.grow(fit, seeds.triangles, share);
  }

  // A strip may be one of a torus: its axis is that of the torus.
  std::optional<Region> torus_of(const Region& strip, SeedSets& sets, double share) {
    if (!measure_region(solid_.mesh(), strip.surface, strip.triangles).one_row) return std::nullopt;
    for (SeedSet& seeds : sets.patches) {
      fill(seeds);
      const auto guess = guess_torus_about(strip.surface, seeds.points);
      if (!guess) continue;
      SeedFit fit;
      if (fit_from(*guess, seeds, fit) > share) continue;
      if (auto region = grown(*fit.surface, seeds, share)) return region;
    }
    return std::nullopt;
  }

  static double extent_of(std::span<const Vec3> points) {
    Box box;
    for (const Vec3& x : points) box.add(x);
    return (box.hi - box.lo).norm();
  }

  static std::optional<Surface> guess_of(SurfaceKind kind, std::span<const Vec3> points,
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

  // Triangles belong to who came first, except that a larger region takes over
  // smaller ones whole: the strips of a sphere may have been found as cones. False where nothing
  // was left to claim.
  bool claim(Region region) {
    std::map<std::int32_t, std::size_t> overlap;
    for (const std::uint32_t t : region.triangles)
      if (owner_[t] != kNobody) ++overlap[owner_[t]];
    for (const auto& [other, count] : overlap) {
      Region& smaller = regions_[static_cast<std::size_t>(other)];
      if (count < smaller.triangles.size() ||
          static_cast<double>(region.triangles.size()) < kTakesOver * static_cast<double>(count))
        continue;
      for (const std::uint32_t t : smaller.triangles) owner_[t] = kNobody;
      smaller.triangles.clear();
    }
    const std::size_t before = region.triangles.size();
    std::erase_if(region.triangles, [&](std::uint32_t t) { return owner_[t] != kNobody; });
    if (region.triangles.empty()) return false;
    if (region.triangles.size() < before && !grower_.settle(region)) {
      // What is left over beside others would be found again from each of its
      // facets.
      for (const std::uint32_t t : region.triangles) {
        double& given_up = given_up_[facets_.of_triangle[t]];
        given_up = std::max(given_up, region.share);
      }
      return true;
    }
    for (const std::uint32_t t : region.triangles)
      owner_[t] = static_cast<std::int32_t>(regions_.size());
    regions_.push_back(std::move(region));
    return true;
  }

  const Solid& solid_;
  double quantum_mm_ = 0.0;
  const Facets facets_;
  RegionGrower grower_;
  SeedFinder seeds_;
  RecognitionOptions options_;
  std::vector<std::int32_t> owner_;
  std::vector<Region> regions_;
  std::vector<double> given_up_;                // by facet: up to this share it need not be tried
  std::vector<std::vector<ByKind>> known_off_;  // by facet: of its seeds, as they come
};

}  // namespace

Recognition recognize_features(const Solid& solid, const RecognitionOptions& options) {
  if (solid.mesh().triangles.empty()) return {};
  return Recognizer(solid, options).run();
}

}  // namespace mortise
