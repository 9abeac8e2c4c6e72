#include <algorithm>

#include "common/depth/interference_search.h"
#include "common/depth/pair_path.h"

namespace mortise {
namespace {

// Looks ahead from the proven time, doubling from the accuracy, before anything is searched.
constexpr int kLooks = 3;

// Work of one look; at the brink of interfering it is not worth more.
constexpr std::uint64_t kLookWorkCap = 600;

// What first contact may do before the search, for each evaluation of that: a test is the cheaper.
constexpr std::uint64_t kTestsPerEvaluation = 8;

// A path cut anywhere is a path of its kind.
Motion rest_of(const Motion& motion, double t) {
  if (!motion.moves()) return motion;
  const Pose X_Wt = motion.pose_at(t);
  return motion.kind == PathKind::kScrew ? screw_motion(X_Wt, motion.X_W1, motion.reference_P)
                                         : linear_motion(X_Wt, motion.X_W1, motion.reference_P);
}

// Upper bound of how far the largest surface lies outside of a triangle.
double reach_mm(const SurfaceBand& band, std::uint32_t triangle) {
  return Body::offset_range_of(band.face_of(triangle), Layer::kUpper).hi;
}

bool is_possible_at(const SweptQuery& query, double t, std::uint64_t& evaluations,
                    CcdScratch& scratch) {
  OverlapQuery at = query.at_target;
  at.X_WA = query.motion_a.pose_at(t);
  at.X_WB = query.motion_b.pose_at(t);
  at.refinement = Refinement::kDecided;
  at.work_cap = std::min(at.work_cap, kLookWorkCap);
  const OverlapResult result = find_overlap(at, scratch);
  evaluations += result.evaluations;
  return std::any_of(result.regions.begin(), result.regions.end(),
                     [](const OverlapRegion& region) { return region.possible_mm.lo > 0.0; });
}

}  // namespace

// 1. Nothing is possible before the meshes are as near as the largest offsets of both reach: first
//    contact says when that is.
// 2. Where all faces have the same zone that is the time itself: looked at shortly behind it.
// 3. Else the surfaces that do meet there have narrower zones: the rest of the path is searched.
PossibleTime find_possible_time(const SweptQuery& query, CcdScratch& scratch) {
  PossibleTime answer;
  const OverlapQuery& at = query.at_target;
  ContactQuery near;
  near.a = at.a;
  near.b = at.b;
  near.motion_a = query.motion_a;
  near.motion_b = query.motion_b;
  near.separation_mm =
      std::max(0.0, at.band_a->largest_offset_mm) + std::max(0.0, at.band_b->largest_offset_mm);
  near.work_cap = std::min(kCcdWorkCap, kTestsPerEvaluation * std::min(kCcdWorkCap, at.work_cap));
  const FirstContact first = first_contact(near, scratch);
  if (first.state == ContactState::kFree) return answer;
  if (first.state == ContactState::kUndecided) {
    answer.t_clear = first.t_clear;
    answer.capped = true;
    return answer;
  }
  const bool begins = first.state == ContactState::kContact;
  const double t0 = begins ? first.t_clear : 0.0;
  const PairPath path(query.motion_a, *at.a, query.motion_b, *at.b);
  double step = query.accuracy_mm / std::max(path.speed_upper_bound(), 1e-300);
  const bool widest_meet =
      reach_mm(*at.band_a, first.triangle_a) + reach_mm(*at.band_b, first.triangle_b) >=
      near.separation_mm - query.accuracy_mm;
  for (int i = 0; i < kLooks && (widest_meet || !begins); ++i, step *= 2.0) {
    const double t = begins ? t0 + step : 0.0;
    if (t > 1.0) break;
    if (is_possible_at(query, t, answer.evaluations, scratch)) {
      answer.becomes_possible = true;
      answer.t_clear = t0;
      answer.t_possible = t;
      return answer;
    }
    if (!begins) break;
  }

  SweptQuery rest = query;
  rest.motion_a = rest_of(query.motion_a, t0);
  rest.motion_b = rest_of(query.motion_b, t0);
  const RealTime found = first_interference(rest, Layer::kUpper);
  const auto in_tick = [&](double t) { return t >= 1.0 ? 1.0 : t0 + (1.0 - t0) * t; };
  answer.becomes_possible = found.becomes_real;
  answer.t_clear = in_tick(found.t_free);
  answer.t_possible = in_tick(found.t_real);
  answer.capped = found.capped;
  answer.evaluations += found.evaluations;
  return answer;
}

}  // namespace mortise
