#include "common/depth/pair_covers.h"

#include <algorithm>
#include <limits>

#include "common/depth/region_report.h"
#include "common/geometry/signed_distance.h"

namespace mortise {

PairCovers::PairCovers(const PairFrame& pair, bool use, std::uint64_t& evaluations)
    : pair_(pair),
      found_(use && !pair.trivial && cover_of(pair.bodies[0]).found() &&
             cover_of(pair.bodies[1]).found()),
      evaluations_(evaluations) {}

const CoverOverlap& PairCovers::overlap_of(Layer layer) {
  std::optional<CoverOverlap>& overlap = overlap_[layer == Layer::kLower ? 0 : 1];
  if (overlap) return *overlap;
  overlap.emplace();
  if (!found_) return *overlap;
  const auto of = [&](int i) -> const CoverLayer& {
    return cover_of(pair_.bodies[i]).of(layer == Layer::kLower);
  };
  std::uint64_t work = 0;
  overlap = CoverPair(of(0), of(1)).overlap(pair_.X_KS[0], pair_.touch_mm, work);
  evaluations_ += evaluations_of_bounds(work);
  return *overlap;
}

double PairCovers::most_mm(Layer layer) {
  const CoverOverlap& overlap = overlap_of(layer);
  return overlap.is_depth || apart(layer) ? overlap.most_mm
                                          : std::numeric_limits<double>::infinity();
}

std::optional<Sample> PairCovers::deepest(Layer layer) {
  const CoverOverlap& overlap = overlap_of(layer);
  if (!overlap.at_S || apart(layer)) return std::nullopt;
  const SurfacePoint at = nearest_surface(*pair_.s(overlap.role).solid, *overlap.at_S);
  evaluations_ += 2;
  const Sample sample = sample_at(pair_, layer, overlap.role, at.triangle, at.point);
  if (!(sample.depth_mm > pair_.touch_mm)) return std::nullopt;
  return sample;
}

std::optional<Bracket> PairCovers::bracket(Layer layer, double accuracy_mm, bool sign_only) {
  if (layer == Layer::kMesh || pair_.trivial) return std::nullopt;
  const std::optional<Sample> sample = deepest(layer);
  if (!sample) return std::nullopt;
  const double most = most_mm(layer) + pair_.rounding_mm;
  const double open_mm = std::max(accuracy_mm, sign_only ? kLooseShare * most : 0.0);
  if (most > sample->depth_mm + open_mm) return std::nullopt;
  Bracket bracket;
  bracket.best = *sample;
  bracket.hi_mm = std::max(most, sample->depth_mm);
  bracket.samples = {*sample};
  return bracket;
}

std::optional<OverlapRegion> PairCovers::certain_region() {
  const std::optional<Sample> sample = deepest(Layer::kLower);
  if (!sample) return std::nullopt;
  const double most = std::min(most_mm(Layer::kLower), 2.0 * pair_.deepest_mm(Layer::kLower));
  OverlapRegion region = region_of_certain(pair_, *sample, most);
  set_witness(pair_, find_witness(pair_, *sample, evaluations_, &region.witnesses_refused), *sample,
              region);
  if (!region.has_witness) return std::nullopt;
  return region;
}

void PairCovers::give_witness(std::vector<OverlapRegion>& regions) {
  for (const OverlapRegion& region : regions)
    if (region.has_witness) return;
  std::optional<OverlapRegion> found = certain_region();
  if (!found) return;
  if (regions.empty()) {
    found->delta_mm = {-pair_.reach_mm(Layer::kLower), 2.0 * pair_.deepest_mm(Layer::kMesh)};
    found->possible_mm.hi = 2.0 * pair_.deepest_mm(Layer::kUpper);
    found->points_W = {found->point_W};
    for (const DeviationGrade grade : {pair_.bodies[0].face(found->triangle_a).grade,
                                       pair_.bodies[1].face(found->triangle_b).grade}) {
      found->grade = std::max(found->grade, grade);
      found->estimated |= grade == DeviationGrade::kEstimated;
    }
    regions.push_back(std::move(*found));
    return;
  }
  OverlapRegion* nearest = &regions.front();
  for (OverlapRegion& region : regions)
    if ((region.point_W - found->point_W).norm() < (nearest->point_W - found->point_W).norm())
      nearest = &region;
  nearest->has_witness = true;
  nearest->witness_W = found->witness_W;
  nearest->certain_place = found->certain_place;
  for (Interval* bracket : {&nearest->certain_mm, &nearest->possible_mm}) {
    bracket->lo = std::max(bracket->lo, found->certain_mm.lo);
    bracket->hi = std::max(bracket->hi, bracket->lo);
  }
}

void PairCovers::cap(Interval& bracket, Layer layer) {
  const double most = apart(layer) ? 0.0 : most_mm(layer) + pair_.rounding_mm;
  bracket.hi = std::min(bracket.hi, most);
  bracket.lo = std::min(bracket.lo, bracket.hi);
}

void PairCovers::tell(std::vector<OverlapRegion>& regions) {
  give_witness(regions);
  for (OverlapRegion& region : regions) {
    cap(region.possible_mm, Layer::kUpper);
    if (!(region.certain_mm.hi > 0.0)) continue;
    if (region.has_witness && apart(Layer::kLower)) {
      region.has_witness = false;
      ++region.witnesses_refused;
    }
    cap(region.certain_mm, Layer::kLower);
    region.certain_mm.hi = std::min(region.certain_mm.hi, region.possible_mm.hi);
    region.certain_mm.lo = std::min(region.certain_mm.lo, region.certain_mm.hi);
  }
}

}  // namespace mortise
