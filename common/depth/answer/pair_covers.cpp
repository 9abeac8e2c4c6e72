#include "common/depth/answer/pair_covers.h"

#include <algorithm>
#include <limits>

#include "common/depth/answer/region_report.h"
#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

// A point that is this share as deep as any may be: no other place is asked but the first ones.
constexpr double kAsDeep = 0.9;
constexpr std::size_t kFirstPlaces = 3;
// So far a search of times may be off (interference_time).
constexpr double kTouches_mm = 4e-4;
// Where edges run side by side, a place that covers name is often where one of them comes into the
// other part. So many times the depth farther in, that is not what holds it any more.
constexpr double kGoesIn = 2.0;

std::size_t index_of(Layer layer) { return layer == Layer::kLower ? 0 : 1; }

}  // namespace

PairCovers::PairCovers(const PairFrame& pair, bool use, std::uint64_t& evaluations)
    : pair_(pair),
      found_(use && !pair.trivial && cover_of(pair.bodies[0]).found() &&
             cover_of(pair.bodies[1]).found()),
      evaluations_(evaluations) {}

CoverPair PairCovers::cells_of(Layer layer) const {
  const bool least = layer == Layer::kLower;
  return {cover_of(pair_.bodies[0]).of(least), cover_of(pair_.bodies[1]).of(least)};
}

bool PairCovers::apart(Layer layer) {
  std::optional<bool>& apart = apart_[index_of(layer)];
  if (apart) return *apart;
  if (!found_) return *(apart = false);
  std::uint64_t work = 0;
  apart = cells_of(layer).apart(pair_.X_KS[0], pair_.touch_mm, work);
  evaluations_ += evaluations_of_bounds(work);
  return *apart;
}

const CoverOverlap& PairCovers::overlap_of(Layer layer) {
  std::optional<CoverOverlap>& overlap = overlap_[index_of(layer)];
  if (overlap) return *overlap;
  overlap.emplace();
  if (!found_) return *overlap;
  std::uint64_t work = 0;
  overlap = cells_of(layer).overlap(pair_.X_KS[0], pair_.touch_mm, work);
  evaluations_ += evaluations_of_bounds(work);
  return *overlap;
}

double PairCovers::most_mm(Layer layer) {
  std::optional<double>& most_mm = most_mm_[index_of(layer)];
  if (most_mm) return *most_mm;
  if (apart(layer)) return *(most_mm = pair_.touch_mm);
  most_mm = std::numeric_limits<double>::infinity();
  const CoverOverlap& overlap = overlap_of(layer);
  std::uint64_t work = 0;
  if (found_ && cells_of(layer).bounds_depth(overlap, pair_.X_KS[0], pair_.touch_mm, work))
    most_mm = overlap.most_mm + pair_.touch_mm;
  evaluations_ += evaluations_of_bounds(work);
  return *most_mm;
}

// Where the cover is the part, its border is its surface; else what is nearest of the mesh counts.
std::optional<Sample> PairCovers::deepest(Layer layer) {
  std::optional<Sample>& found = deepest_[index_of(layer)];
  if (found || apart(layer)) return found;
  const CoverOverlap& overlap = overlap_of(layer);
  if (overlap.places_S.empty()) return found;
  const int role = overlap.keeper.role;
  const Body &s = pair_.s(role), &k = pair_.k(role);
  std::optional<Sample> off_mesh;
  const auto deeper = [&](std::optional<Sample>& known, const Sample& sample) {
    if (sample.depth_mm > (known ? known->depth_mm : pair_.touch_mm)) known = sample;
  };
  for (std::size_t i = 0; i < overlap.places_S.size(); ++i) {
    if (i >= kFirstPlaces && found && found->depth_mm >= kAsDeep * overlap.most_mm) break;
    const Vec3& x_S = overlap.places_S[i];
    const SurfacePoint own = nearest_surface(*s.solid, x_S);
    evaluations_ += 2;
    const double own_mm = s.depth_in(x_S, own, layer);
    if (own_mm < -kTouches_mm) {
      deeper(off_mesh, sample_at(pair_, layer, role, own.triangle, own.point));
      continue;
    }
    Sample sample;
    sample.role = role;
    sample.triangle = own.triangle;
    sample.point_K = pair_.X_KS[role] * x_S;
    sample.at = nearest_surface(*k.solid, sample.point_K);
    sample.depth_mm = k.depth_in(sample.point_K, sample.at, layer);
    if (sample.depth_mm >= -kTouches_mm) touching_[index_of(layer)].push_back(sample);
    if (own_mm < -pair_.touch_mm)
      deeper(off_mesh, sample_at(pair_, layer, role, own.triangle, own.point));
    else
      deeper(found, sample);
  }
  if (!found) found = off_mesh;
  return found;
}

std::optional<Sample> PairCovers::farther_in(Layer layer) {
  const std::vector<Sample>& touching = touching_[index_of(layer)];
  if (touching.empty()) return std::nullopt;
  const int role = touching.front().role;
  const Body& k = pair_.k(role);
  Vec3 middle = Vec3::Zero();
  for (const Sample& sample : touching)
    middle += sample.point_K / static_cast<double>(touching.size());
  const Vec3 in = kGoesIn * overlap_of(layer).most_mm * k.normal(touching.front().at.triangle);
  for (const Vec3& x_K : {middle, Vec3(touching.front().point_K - in)}) {
    const SurfacePoint own =
        nearest_surface(*pair_.s(role).solid, pair_.X_KS[role].inverse() * x_K);
    evaluations_ += 2;
    const Sample sample = sample_at(pair_, layer, role, own.triangle, own.point);
    if (sample.depth_mm > pair_.touch_mm) return sample;
  }
  return std::nullopt;
}

bool PairCovers::touches(Layer layer) const { return !touching_[index_of(layer)].empty(); }

std::optional<Sample> PairCovers::on_mesh(Layer layer) {
  if (apart(layer)) return std::nullopt;
  const CoverOverlap& overlap = overlap_of(layer);
  if (overlap.places_S.empty()) return std::nullopt;
  const Vec3& x_S = overlap.places_S[overlap.places_S.size() > 1 ? 1 : 0];
  const SurfacePoint at = nearest_surface(*pair_.s(overlap.keeper.role).solid, x_S);
  evaluations_ += 2;
  const Sample sample = sample_at(pair_, layer, overlap.keeper.role, at.triangle, at.point);
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

namespace {

void grade_by_faces(const PairFrame& pair, OverlapRegion& region) {
  for (const DeviationGrade grade : {pair.bodies[0].face(region.triangle_a).grade,
                                     pair.bodies[1].face(region.triangle_b).grade}) {
    region.grade = std::max(region.grade, grade);
    region.estimated |= grade == DeviationGrade::kEstimated;
  }
}

}  // namespace

// With a witness; only what is certain is known.
std::optional<OverlapRegion> PairCovers::certain_region() {
  const std::optional<Sample> sample = deepest(Layer::kLower);
  if (!sample) return std::nullopt;
  const double most =
      std::min(most_mm(Layer::kLower) + pair_.rounding_mm, 2.0 * pair_.deepest_mm(Layer::kLower));
  OverlapRegion region = region_of_certain(pair_, *sample, most);
  set_witness(pair_, find_witness(pair_, *sample, evaluations_, &region.witnesses_refused), *sample,
              region);
  if (!region.has_witness) return std::nullopt;
  region.points_W = {region.point_W};
  grade_by_faces(pair_, region);
  return region;
}

// Nothing is certain in it.
std::optional<OverlapRegion> PairCovers::possible_region() {
  if (!apart(Layer::kLower)) return std::nullopt;
  const std::optional<Sample> sample = deepest(Layer::kUpper);
  if (!sample) return std::nullopt;
  OverlapRegion region = region_of_certain(pair_, *sample, 0.0);
  region.possible_mm.lo = sample->depth_mm;
  region.certain_mm = {-pair_.reach_mm(Layer::kLower) - pair_.reach_mm(Layer::kUpper), 0.0};
  region.points_W = {region.point_W};
  grade_by_faces(pair_, region);
  return region;
}

bool PairCovers::is_closed(const Interval& bracket, const OverlapQuery& query) const {
  return bracket.hi <= 0.0 || query.refinement == Refinement::kDecided ||
         bracket.width() <= std::max(query.accuracy_mm, pair_.rounding_mm);
}

std::optional<OverlapRegion> PairCovers::region(const OverlapQuery& query) {
  std::optional<OverlapRegion> region = certain_region();
  if (region && !is_closed(region->certain_mm, query)) return std::nullopt;
  if (query.only_certain) return region;
  if (!region) region = possible_region();
  if (!region) return std::nullopt;
  if (query.refinement != Refinement::kDecided && region->has_witness)
    if (const std::optional<Sample> sample = deepest(Layer::kUpper))
      region->possible_mm.lo = std::max(region->possible_mm.lo, sample->depth_mm);
  region->possible_mm.hi = std::max(
      region->possible_mm.lo,
      std::min(most_mm(Layer::kUpper) + pair_.rounding_mm, 2.0 * pair_.deepest_mm(Layer::kUpper)));
  if (!is_closed(region->possible_mm, query)) return std::nullopt;
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

void PairCovers::cap(Interval& bracket, Layer layer, bool is_closed) {
  if (apart(layer))
    bracket.hi = std::min(bracket.hi, 0.0);
  else if (!is_closed)
    bracket.hi = std::min(bracket.hi, most_mm(layer) + pair_.rounding_mm);
  bracket.lo = std::min(bracket.lo, bracket.hi);
}

void PairCovers::tell(std::vector<OverlapRegion>& regions) {
  give_witness(regions);
  for (OverlapRegion& region : regions) {
    cap(region.possible_mm, Layer::kUpper, region.closed_form);
    if (!(region.certain_mm.hi > 0.0)) continue;
    if (region.has_witness && apart(Layer::kLower)) {
      region.has_witness = false;
      ++region.witnesses_refused;
    }
    cap(region.certain_mm, Layer::kLower, region.closed_form);
    region.certain_mm.hi = std::min(region.certain_mm.hi, region.possible_mm.hi);
    region.certain_mm.lo = std::min(region.certain_mm.lo, region.certain_mm.hi);
  }
}

}  // namespace mortise
