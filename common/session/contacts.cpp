#include <algorithm>

#include "common/base/constants.h"
#include "common/session/motion_budget.h"
#include "common/session/tick_work.h"

namespace mortise {
namespace {

bool trivial(const PairWork& pair) { return pair.band_a->trivial && pair.band_b->trivial; }

// Upper bound of the lower outward offset of any face: what the real surface has at least.
double largest_lower_offset_mm(const SurfaceBand& band) {
  double largest = 0.0;
  for (const SurfaceBand::Face& face : band.faces) {
    // With a surface the deviation is e(x) +- residual, and e + residual + tolerance.hi is at most
    // the largest offset of the band.
    const double lower = face.surface ? band.largest_offset_mm - face.tolerance_mm.width()
                                      : face.deviation_mm.lo + face.tolerance_mm.lo;
    largest = std::max(largest, lower);
  }
  return largest;
}

FirstContact ask_first_contact(const World& world, PairWork& pair, double separation_mm,
                               CcdScratch& ccd) {
  ContactQuery query;
  query.a = world.parts[pair.a].solid.get();
  query.b = world.parts[pair.b].solid.get();
  query.motion_a = pair.motion_a;
  query.motion_b = pair.motion_b;
  query.separation_mm = separation_mm;
  query.check_contained = !pair.memo->not_contained;
  const FirstContact contact = first_contact(query, ccd);
  ++pair.counts.first_contact_queries;
  pair.counts.box_tests += contact.work.box_tests;
  pair.counts.triangle_tests += contact.work.triangle_tests;
  return contact;
}

OverlapQuery overlap_query(const World& world, const PairWork& pair) {
  OverlapQuery query;
  query.a = world.parts[pair.a].solid.get();
  query.b = world.parts[pair.b].solid.get();
  query.band_a = pair.band_a;
  query.band_b = pair.band_b;
  return query;
}

// Deepest overlap that is certain at one time of the segment, mm; <= 0 when none is.
double certain_depth_mm(const World& world, PairWork& pair, double t, CcdScratch& ccd) {
  OverlapQuery query = overlap_query(world, pair);
  query.X_WA = pair.motion_a.pose_at(t);
  query.X_WB = pair.motion_b.pose_at(t);
  query.refinement = Refinement::kFull;
  query.accuracy_mm = kDeepeningSlack_mm;
  query.work_cap = 20'000;  // lower ends are found early; the upper ones are not needed
  const OverlapResult overlap = find_overlap(query, ccd);
  ++pair.counts.depth_queries;
  pair.counts.depth_evaluations += overlap.evaluations;
  double deepest = 0.0;
  for (const OverlapRegion& region : overlap.regions)
    deepest = std::max(deepest, region.certain_mm.lo);
  return deepest;
}

// How far a pair that already interferes may move: as long as it gets no deeper. Looked at in
// quarters of the segment; between them it is not looked at.
double withdrawal_time(const World& world, PairWork& pair, CcdScratch& ccd) {
  constexpr int kLooks = 4;
  double& allowed_mm = pair.memo->allowed_depth_mm;
  allowed_mm = std::min(allowed_mm, certain_depth_mm(world, pair, 0.0, ccd));
  for (int i = 1; i <= kLooks; ++i)
    if (certain_depth_mm(world, pair, static_cast<double>(i) / kLooks, ccd) >
        allowed_mm + kDeepeningSlack_mm)
      return static_cast<double>(i - 1) / kLooks;
  return 1.0;
}

// Time of the segment up to which the pair is proven not to be real (policy stop).
double stop_time(const World& world, PairWork& pair, const FirstContact& touch, CcdScratch& ccd) {
  // Without an inside there is no depth and so no real verdict: the crossing is reported as
  // potential and stops nobody.
  if (pair.no_inside) return touch.state == ContactState::kUndecided ? touch.t_clear : 1.0;
  const bool may_be_real_apart =
      largest_lower_offset_mm(*pair.band_a) + largest_lower_offset_mm(*pair.band_b) > 0.0;
  if (!may_be_real_apart) {
    if (touch.state == ContactState::kFree) return 1.0;
    if (touch.state == ContactState::kUndecided) return touch.t_clear;
    if (trivial(pair) && touch.state == ContactState::kContact) return touch.t_contact;
  }
  SweptQuery query;
  query.at_target = overlap_query(world, pair);
  query.motion_a = pair.motion_a;
  query.motion_b = pair.motion_b;
  const RealTime real = find_real_time(query, ccd);
  ++pair.counts.depth_queries;
  pair.counts.depth_evaluations += real.evaluations;
  if (real.real_at_start) return withdrawal_time(world, pair, ccd);
  pair.memo->allowed_depth_mm = std::numeric_limits<double>::infinity();
  if (real.capped) pair.undecided = true;
  return real.becomes_real || real.capped ? real.t_free : 1.0;
}

}  // namespace

void ask_pair(const World& world, const StepSwitches& switches, PairWork& pair, CcdScratch& ccd) {
  pair.asked = true;
  pair.near = pair.entered = pair.undecided = pair.no_inside = pair.meets = pair.blocks = false;
  pair.start = ContactState::kUnknown;
  pair.t_contact = pair.t_stop = 1.0;
  pair.apart_at_end_mm = 0.0;
  if (pair.placed) {  // no motion: only how it stands
    pair.near = true;
    return;
  }
  const Solid& a = *world.parts[pair.a].solid;
  const Solid& b = *world.parts[pair.b].solid;

  // 1. Does an earlier distance still suffice?
  const BudgetQuery budget{&a, &b, pair.motion_a, pair.motion_b};
  if (switches.motion_budget &&
      apart_lower_bound_mm(*pair.memo, budget) > pair.band_mm + kClashHysteresis_mm) {
    pair.asked = false;
    return;
  }

  // 2. Do they come within the band, and do the meshes meet?
  FirstContact touch = ask_first_contact(world, pair, pair.band_mm, ccd);
  if (touch.state == ContactState::kFree) {
    pair.memo->not_contained = true;
    pair.apart_at_end_mm = std::max(touch.distance_mm, pair.band_mm);
    return;
  }
  pair.near = true;
  pair.entered = touch.state == ContactState::kContact;
  pair.undecided = touch.state == ContactState::kUndecided;
  if (pair.band_mm > 0.0) {
    touch = ask_first_contact(world, pair, 0.0, ccd);
    pair.undecided = pair.undecided || touch.state == ContactState::kUndecided;
  }
  pair.memo->not_contained = touch.state == ContactState::kFree;
  pair.no_inside = !a.topology().closed() || !b.topology().closed();
  pair.start = touch.state;
  pair.meets = touch.state != ContactState::kFree && touch.state != ContactState::kUndecided;
  if (pair.meets) pair.t_contact = touch.t_contact;

  // 3. When would it become real?
  if (world.policy == Policy::kStop)
    pair.t_stop = pair.tau + (1.0 - pair.tau) * stop_time(world, pair, touch, ccd);
}

void find_contacts(const World& world, Scratch::Impl& work) {
  work.pool.for_each(work.pair_count, [&](std::size_t i, int thread) {
    ask_pair(world, work.switches, work.pairs[i], work.ccd[static_cast<std::size_t>(thread)]);
  });
}

}  // namespace mortise
