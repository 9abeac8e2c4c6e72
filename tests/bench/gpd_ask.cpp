#include "tests/bench/gpd_ask.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "common/depth/gpd/holds.h"
#include "common/depth/gpd/separation_search.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {

GpdWord ask_gpd(const GpdPair& pair, Refinement refinement, const GpdWord* first) {
  const SurfaceBand band = nominal_band();
  CcdScratch scratch;
  GpdQuery query;
  query.overlap.a = pair.a.get();
  query.overlap.b = pair.b.get();
  query.overlap.band_a = query.overlap.band_b = &band;
  query.overlap.X_WA = pair.X_WA;
  query.overlap.X_WB = pair.X_WB;
  query.overlap.refinement = refinement;
  if (refinement == Refinement::kFull) query.work_cap *= 10;
  query.motion_a = still_motion(pair.X_WA);
  query.motion_b = still_motion(pair.X_WB);
  if (first != nullptr && first->depth.motion.moves()) query.known = &first->depth.motion;
  GpdWord word;
  word.overlap = find_overlap(query.overlap, scratch);
  query.regions = word.overlap.regions;
  pair.a->outline();
  pair.b->outline();
  const Stopwatch watch;
  word.depth = generalized_depth(query, scratch);
  word.time_s = watch.elapsed_s();
  word.apart = gpd::is_apart(*pair.a, word.depth.motion.displacement() * pair.X_WA, *pair.b,
                             pair.X_WB, scratch);
  return word;
}

double holds_beyond_mm(const GpdPair& pair, const GpdWord& word) {
  std::vector<Vec3> points;
  for (const OverlapRegion& region : word.overlap.regions) points.push_back(region.point_W);
  gpd::HoldsQuery query;
  query.a = pair.a.get();
  query.b = pair.b.get();
  query.X_WA = pair.X_WA;
  query.X_WB = pair.X_WB;
  query.points_W = points;
  query.limit_mm = 2.0 * word.depth.gpd_mm.hi;
  CcdScratch scratch;
  std::uint64_t work = 0;
  return gpd::held_by_balls(query, scratch, work).least_mm;
}

double search_longer(const GpdPair& pair, const GpdWord& word, int effort) {
  std::mt19937_64 random(99);
  std::normal_distribution<double> normal;
  CcdScratch scratch;
  const gpd::TwistFrame frame(*pair.a, pair.X_WA);
  double best = word.depth.gpd_mm.hi;
  for (int round = 0; round < effort; ++round) {
    std::vector<gpd::Vec6> starts = {frame.twist_of(word.depth.motion.displacement())};
    for (int i = 0; i < 40; ++i) {
      gpd::Vec6 xi;
      for (int k = 0; k < 6; ++k) xi[k] = normal(random);
      starts.push_back(best * std::exp(normal(random)) * xi.normalized());
    }
    gpd::SeparationQuery query;
    query.a = pair.a.get();
    query.b = pair.b.get();
    query.X_WA = pair.X_WA;
    query.X_WB = pair.X_WB;
    query.starts = starts;
    query.least_mm = word.depth.gpd_mm.lo * (0.5 + round % 5);
    query.thorough = true;
    const gpd::Separation found = gpd::find_separation(query, scratch);
    if (found.found) best = std::min(best, found.length_mm);
  }
  return best;
}

}  // namespace mortise::bench
