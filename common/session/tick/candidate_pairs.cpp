#include "common/session/tick/candidate_pairs.h"

#include <algorithm>
#include <cmath>

#include "common/broadphase/pair_filter.h"
#include "common/broadphase/swept_box.h"

namespace mortise {
namespace {

PairWork& next_pair(Scratch::Impl& work) {
  if (work.pair_count == work.pairs.size()) work.pairs.emplace_back();
  PairWork& pair = work.pairs[work.pair_count++];
  std::vector<SeenRegion> seen = std::move(pair.judged.seen);
  std::vector<char> keeps = std::move(pair.judged.keeps);
  pair = PairWork{};
  pair.judged.seen = std::move(seen);
  pair.judged.keeps = std::move(keeps);
  pair.judged.seen.clear();
  pair.judged.keeps.clear();
  return pair;
}

// Legs of a slide lead elsewhere than the increments, but no faster: a projection makes nothing
// longer, in |shift|^2 + radius^2 |turn|^2. What a leg gets away from an arc comes on top.
double slide_upper_bound_mm(const Solid& solid, const Motion& motion) {
  const BoundingSphere& sphere = solid.sphere();
  const double arm_mm = (sphere.center_mm - motion.reference_P).norm() + sphere.radius_mm;
  const double turn_mm = motion.w_W.norm() * arm_mm;
  const double least_lever_mm = std::max(1e-3, sphere.radius_mm);  // see MovingGroup::lever_mm
  const double length_mm = std::hypot(motion.v_W.norm(), turn_mm);
  constexpr double kLifts_mm = 0.01;  // of all legs of a tick: four of kBandLift_mm are 0.006
  return length_mm * (1.0 + arm_mm / least_lever_mm) + motion.w_W.squaredNorm() * arm_mm +
         kLifts_mm;
}

Box box_at_start(const Solid& solid, const Motion& motion) {
  Motion still = still_motion(motion.X_W0);
  still.reference_P = solid.sphere().center_mm;
  return swept_box({solid.bounds(), solid.sphere()}, still);
}

void set_up(const World& world, SessionState& state, const Scratch::Impl& work, IndexPair indices,
            const PairRule* rule, PairWork& pair) {
  const Part& a = world.parts[indices.a];
  const Part& b = world.parts[indices.b];
  pair.ids.a = indices.a;
  pair.ids.b = indices.b;
  pair.ids.solid_a = a.solid.get();
  pair.ids.solid_b = b.solid.get();
  pair.ids.rule = rule;
  JudgementQuery bands;
  bands.a = &a;
  bands.b = &b;
  bands.rule = rule;
  pair.ids.band_a = &band_a_of(bands);
  pair.ids.band_b = &band_b_of(bands);
  pair.ids.band_mm = pair.ids.band_a->farthest_mm() + pair.ids.band_b->farthest_mm();
  pair.ids.memo = MemoInUse(state.memo(pair.ids.a, pair.ids.b));
  const auto open = state.open.find({a.id, b.id});
  if (open != state.open.end()) pair.ids.open = &open->second;
  const std::uint64_t placements =
      state.parts[pair.ids.a].placements + state.parts[pair.ids.b].placements;
  if (pair.ids.memo->placements != placements) {
    PairMemo& memo = pair.ids.memo.change();
    memo.placements = placements;
    memo.not_contained = false;
    memo.allowed_depth_mm = std::numeric_limits<double>::infinity();
    memo.held.reset();
    memo.stalled.reset();
    memo.not_judged = memo.not_seen = pair.ids.open != nullptr;
  }
  pair.ids.move_a = work.move_of_part[pair.ids.a];
  pair.ids.move_b = work.move_of_part[pair.ids.b];
  const auto motion_of = [&](std::int32_t move, const Part& part) {
    if (move >= 0) return work.moves[static_cast<std::size_t>(move)].motion;
    Motion still = still_motion(part.X_WP);
    still.reference_P = part.solid->sphere().center_mm;
    return still;
  };
  pair.segment.motion_a = motion_of(pair.ids.move_a, a);
  pair.segment.motion_b = motion_of(pair.ids.move_b, b);
  pair.ids.placed = !pair.segment.motion_a.moves() && !pair.segment.motion_b.moves();
  pair.status.together = a.group && a.group == b.group && pair.ids.move_a >= 0 &&
                         pair.ids.move_b >= 0 &&
                         !work.moves[static_cast<std::size_t>(pair.ids.move_a)].placed &&
                         !work.moves[static_cast<std::size_t>(pair.ids.move_b)].placed;
}

// Does it move, or was it put somewhere? Who is only looked at for one of its pairs is not.
bool changed(const Scratch::Impl& work, std::uint32_t part) {
  const std::int32_t index = work.move_of_part[part];
  if (index < 0) return false;
  const Move& move = work.moves[static_cast<std::size_t>(index)];
  return move.placed || move.motion.moves();
}

}  // namespace

void find_candidate_pairs(const World& world, SessionState& state, Scratch::Impl& work,
                          StepReport& report) {
  StepCounters& counters = report.counters;
  work.pair_count = 0;
  const PairCensus census = count_pairs(state.present_parts, state.moving_parts, work.moves.size());
  counters.pairs.in = census.all;
  counters.pairs_static = census.both_static;
  counters.pairs_still = census.both_still;
  if (work.moves.empty()) return;

  for (Move& move : work.moves) {
    const Solid& solid = *world.parts[move.part].solid;
    Box box = swept_box({solid.bounds(), solid.sphere()}, move.motion);
    if (world.policy == Policy::kSlide && move.motion.moves())
      box.add(box_at_start(solid, move.motion).grown(slide_upper_bound_mm(solid, move.motion)));
    move.reach = box;
    state.broad_phase->set_box(move.part, box.grown(state.parts[move.part].growth_mm));
  }
  state.broad_phase->find_pairs(work.moved_parts, work.candidates);
  counters.pairs_boxes_apart =
      census.all - census.both_static - census.both_still - work.candidates.size();
  // Who waits for a verdict may have left each other meanwhile.
  if (!state.owed.empty()) {
    const auto found = static_cast<std::ptrdiff_t>(work.candidates.size());
    work.candidates.insert(work.candidates.end(), state.owed.begin(), state.owed.end());
    std::inplace_merge(work.candidates.begin(), work.candidates.begin() + found,
                       work.candidates.end());
    work.candidates.erase(std::unique(work.candidates.begin(), work.candidates.end()),
                          work.candidates.end());
  }
  for (const IndexPair indices : work.candidates) {
    const Part& a = world.parts[indices.a];
    const Part& b = world.parts[indices.b];
    const PairRule* rule = world.rule(a.id, b.id);
    const auto filter_part = [&](std::uint32_t i) {
      return FilterPart{world.parts[i].moving, work.move_of_part[i] >= 0};
    };
    if (filter_pair(filter_part(indices.a), filter_part(indices.b), rule && rule->excluded) !=
        PairSkip::kAsk) {
      ++counters.pairs_excluded;
      continue;
    }
    if (!changed(work, indices.a) && !changed(work, indices.b) &&
        !std::binary_search(state.owed.begin(), state.owed.end(), indices)) {
      ++counters.pairs_still;
      continue;
    }
    set_up(world, state, work, indices, rule, next_pair(work));
  }
}

}  // namespace mortise
