#include "common/geometry/recognition/recognition.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <map>
#include <thread>

#include "common/base/constants.h"
#include "common/geometry/recognition/finish.h"
#include "common/geometry/recognition/seed_fits.h"
#include "common/geometry/recognition/surface_fit.h"

namespace mortise {
namespace {

// A kind of more parameters must explain this much more than a simpler one.
constexpr double kWorthMore = 1.2;
// What a later region takes over whole is smaller by at least this.
constexpr double kTakesOver = 2.0;

// Seeds that bulge by less than this part of what corners may be off show no
// curve.
constexpr double kLeastBulge = 0.1;

// Tries whose seeds are asked ahead together: about 4 ms of them, a hundred times what a thread
// costs.
constexpr std::size_t kAhead = 64;
// To ask seeds is half of the work of nist_ctc_02 and two thirds of that of nist_ftc_10; one thread
// does the rest. More threads than this would wait for it.
constexpr unsigned kMostThreads = 3;

constexpr std::int32_t kNobody = -1;

class Recognizer {
 public:
  Recognizer(const Solid& solid, const RecognitionOptions& options)
      : solid_(solid),
        quantum_mm_(std::max(options.quantum_mm, grid_quantum_mm(solid.mesh()))),
        facets_(build_facets(solid, flat_allowance_mm(solid, quantum_mm_))),
        grower_(solid, facets_, quantum_mm_, options.plain),
        seeds_(solid, facets_, grower_),
        fitter_(solid, seeds_, grower_, options.plain),
        options_(options),
        owner_(solid.mesh().triangles.size(), kNobody) {
    const unsigned threads =
        options.threads > 0 ? options.threads : std::thread::hardware_concurrency();
    for (unsigned k = 1; k < std::min(threads, kMostThreads) && !options.plain; ++k)
      ahead_.emplace_back(solid, seeds_, grower_, options.plain);
  }

  Recognition run() {
    given_up_.assign(facets_.count(), 0.0);
    known_off_.assign(facets_.count(), {});
    // Sparse seeds first: large regions are found from a few, and their fringes
    // need none.
    for (const double share : kShares)
      for (const std::uint32_t stride : {64U, 8U, 1U}) try_each(stride, share);
    std::erase_if(regions_, [](const Region& r) { return r.triangles.empty(); });
    return finish_recognition(solid_, facets_, grower_, std::move(regions_), options_.planes);
  }

 private:
  struct Try {
    std::uint32_t facet = 0;
    std::optional<SeedSets> sets;  // once they were asked
  };

  bool worth_trying(std::uint32_t f, double share) const {
    return given_up_[f] < share && owner_[facets_.triangles(f).front()] == kNobody &&
           seeds_.bends_smoothly(f);
  }

  std::vector<Try> next_tries(std::uint32_t& next, std::uint32_t stride, double share) const {
    std::vector<Try> tries;
    for (; next < facets_.count() && tries.size() < kAhead; next += stride)
      if (worth_trying(next, share)) tries.push_back({next, {}});
    return tries;
  }

  void ask(Try& t, double share, SeedFitter& fitter) const {
    t.sets = fitter.about(t.facet, known_off_[t.facet]);
    fitter.ask_first(*t.sets, share);
  }

  // While facets are tried, other threads ask the seeds of the next ones. What they ask does not
  // depend on what is found meanwhile; only whether it is of use does.
  void try_each(std::uint32_t stride, double share) {
    std::uint32_t next = 0;
    for (std::vector<Try> now = next_tries(next, stride, share); !now.empty();) {
      std::vector<Try> then = next_tries(next, stride, share);
      std::atomic<std::size_t> asked{0};
      std::vector<std::jthread> others;
      for (SeedFitter& fitter : ahead_)
        if (!then.empty())
          others.emplace_back([&] {
            for (std::size_t i = asked++; i < then.size(); i = asked++) ask(then[i], share, fitter);
          });
      for (Try& t : now) {
        if (!worth_trying(t.facet, share)) continue;
        if (!t.sets) t.sets = fitter_.about(t.facet, known_off_[t.facet]);
        try_facet(t.facet, *t.sets, share);
      }
      if (!others.empty())
        for (std::size_t i = asked++; i < then.size(); i = asked++)
          if (worth_trying(then[i].facet, share)) ask(then[i], share, fitter_);
      others.clear();
      now = std::move(then);
    }
  }

  void try_facet(std::uint32_t f, SeedSets& sets, double share) {
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
    for (SeedSet& seeds : sets)
      if (fitter_.holds(kind, all, seeds, share))
        if (auto region = grown(*seeds.fits[kind].surface, seeds, share)) return region;
    return std::nullopt;
  }

  std::optional<Region> grown(const Surface& fit, const SeedSet& seeds, double share) {
    const double size = size_mm(fit, seeds.points), extent_mm = extent_of(seeds.points);
    const double bulge_mm = extent_mm * extent_mm / (8.0 * size);
    if (bulge_mm < kLeastBulge * share * size) return std::nullopt;
    return grower_.grow(fit, {seeds.triangles, seeds.points, seeds.normals}, share);
  }

  // A strip may be one of a torus: its axis is that of the torus.
  std::optional<Region> torus_of(const Region& strip, SeedSets& sets, double share) {
    if (!lie_in_one_row(solid_.mesh(), strip.surface, strip.triangles)) return std::nullopt;
    for (SeedSet& seeds : sets.patches) {
      fitter_.fill(seeds);
      const auto guess = guess_torus_about(strip.surface, seeds.points);
      if (!guess) continue;
      SeedFit fit;
      if (fitter_.fit_from(*guess, seeds, fit) > share) continue;
      if (auto region = grown(*fit.surface, seeds, share)) return region;
    }
    return std::nullopt;
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
  const SeedFinder seeds_;
  SeedFitter fitter_;
  std::vector<SeedFitter> ahead_;  // one for each thread beside this one
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
