#include "common/session/tick/slide.h"

#include <algorithm>
#include <cmath>

#include "common/broadphase/swept_box.h"
#include "common/ccd/contact_places.h"
#include "common/ccd/distance.h"
#include "common/math/rotation.h"
#include "common/session/tick/hold_places.h"

namespace mortise {
namespace {

// A tick ends on its way after so many turns of direction; along a round wall each is a facet.
constexpr int kMostLegs = 16;
// With bands every leg is a search for the time at which it becomes real.
constexpr int kMostBandLegs = 4;
// Legs in a row that end where they begin: what holds the body is not known well enough.
constexpr int kMostStalls = 4;
constexpr double kStalled = 1e-9;  // share of the tick

// What is this near counts as holding, mm: less than any clearance; with bands as near as a search
// for the time at which a pair becomes real may leave it.
constexpr double kReach_mm = 1e-3, kBandReach_mm = 0.03;
// A leg leaves what it leans on by so much, mm, so that it does not end where it begins: twice the
// accuracy of first contact; with bands see kBandLift_mm.
constexpr double kLift_mm = 2.0 * kAccuracyDefault_mm;
// A shorter leg is not started, mm: more than the lifts.
constexpr double kLeastLeg_mm = 1e-5;
constexpr double kLeastBandLeg_mm = 2.0 * kBandLift_mm;

// How closely the depth of what holds a body is looked at, mm: a share of the lift.
constexpr double kHoldAccuracy_mm = 0.25 * kBandLift_mm;

// How far the body is tried against what held it, mm: more than the lift, less than a clearance;
// and at how many places of a leg: one in so many mm.
constexpr double kTry_mm = 2e-3, kBandTry_mm = 6e-3;
constexpr double kLookEvery_mm = 0.01;
constexpr int kMostLooks = 64;
constexpr int kMostBandLooks = 3;
constexpr std::uint64_t kHoldWorkCap = 1'000;

const Move& move_at(const Scratch::Impl& work, std::int32_t index) {
  return work.moves[static_cast<std::size_t>(index)];
}

double tick_to_leg(const Move& move, double t) {
  return (t - move.leg_start) / (1.0 - move.leg_start);
}

Pose pose_at(const Scratch::Impl& work, const World& world, std::int32_t index, std::uint32_t part,
             double t) {
  if (index < 0) return world.parts[part].X_WP;
  const Move& move = move_at(work, index);
  if (move.stopped) return move.X_WP_end;
  return move.leg.pose_at(tick_to_leg(move, t));
}

SlidingGroup& sliding_of(Scratch::Impl& work, std::int32_t index) {
  return work.sliding[static_cast<std::size_t>(move_at(work, index).sliding)];
}

struct Side {
  bool a = false;  ///< the body is part A of the pair
  bool of_group = false;
};

Side side_of(const PairWork& pair, const Scratch::Impl& work, std::int32_t sliding) {
  const bool a = pair.ids.move_a >= 0 && move_at(work, pair.ids.move_a).sliding == sliding;
  const bool b = pair.ids.move_b >= 0 && move_at(work, pair.ids.move_b).sliding == sliding;
  return {a, a != b};
}

// What is certain of a pair at these poses, and a little beyond; kDecided: only whether.
OverlapQuery certain_query(const PairWork& pair, const Pose& X_WA, const Pose& X_WB,
                           Refinement refinement) {
  OverlapQuery query;
  query.a = pair.ids.solid_a;
  query.b = pair.ids.solid_b;
  query.band_a = pair.ids.band_a;
  query.band_b = pair.ids.band_b;
  query.X_WA = X_WA;
  query.X_WB = X_WB;
  query.refinement = refinement;
  query.accuracy_mm = kHoldAccuracy_mm;
  query.work_cap = kHoldWorkCap;
  query.only_certain = true;
  query.certain_from_mm = -kBandReach_mm;
  query.prove_not_certain = true;
  return query;
}

OverlapResult ask(PairWork& pair, const OverlapQuery& query, CcdScratch& ccd) {
  OverlapResult overlap = find_overlap(query, ccd);
  ++pair.effort.counts.depth_queries;
  pair.effort.counts.depth_evaluations += overlap.evaluations;
  return overlap;
}

// Parts with bands, or that interfere already, hold where the overlap that is certain is nearest to
// none.
void add_banded_holds(PairWork& pair, const Pose& X_WA, const Pose& X_WB, bool is_a,
                      CcdScratch& ccd, std::vector<Hold>& holds) {
  const OverlapQuery query = certain_query(pair, X_WA, X_WB, Refinement::kFull);
  const OverlapResult overlap = ask(pair, query, ccd);
  const auto add = [&](const HoldPlace& place, bool is_real) {
    // What interferes already may not go deeper; nobody has to push it out.
    const double gap_mm = is_real ? 0.0 : -place.depth_mm - kBandLift_mm;
    holds.push_back({place.point_W, is_a ? place.normal_W : Vec3(-place.normal_W),
                     std::max(gap_mm, -kBandReach_mm)});
  };
  bool any = false;
  for (const OverlapRegion& region : overlap.regions) {
    if (region.certain_mm.hi < -kBandReach_mm) continue;
    any = true;
    for (const HoldPlace& place : hold_places(query, region, kBandReach_mm))
      add(place, region.has_witness && region.certain_mm.lo > kDeepeningSlack_mm);
  }
  if (any || !pair.answer.place.known()) return;
  for (const HoldPlace& place : hold_places(query, pair.answer.place, kBandReach_mm))
    add(place, false);
}

void add_plain_holds(PairWork& pair, const Pose& X_WA, const Pose& X_WB, bool is_a, CcdScratch& ccd,
                     std::vector<Hold>& holds) {
  ContactPlacesQuery query;
  query.a = pair.ids.solid_a;
  query.b = pair.ids.solid_b;
  query.X_WA = X_WA;
  query.X_WB = X_WB;
  query.reach_mm = kReach_mm;
  for (const ContactPlace& place : contact_places(query, ccd).places)
    holds.push_back(
        {place.point_W, is_a ? place.normal_W : Vec3(-place.normal_W), place.gap_mm - kLift_mm});
}

// Where the holds of earlier legs stand after the leg so far.
void carry_on(SlidingGroup& sliding, double share, const Vec3& center_W) {
  for (Hold& hold : sliding.holds) {
    const Vec3 by =
        sliding.given.shift_mm + sliding.given.turn_rad.cross(Vec3(hold.point_W - center_W));
    hold.gap_mm += share * hold.normal_W.dot(by);
    hold.point_W += share * by;
  }
  std::erase_if(sliding.holds, [](const Hold& hold) { return hold.gap_mm > kBandReach_mm; });
}

double travel_mm(const Twist& twist, double radius_mm) {
  return twist.shift_mm.norm() + twist.turn_rad.norm() * radius_mm;
}

Displacement displacement_of(const Twist& twist) {
  return {twist.turn_rad.isZero(0.0) ? Quat::Identity() : rotation_exp(twist.turn_rad),
          twist.shift_mm};
}

// The relations of the body as it stands after a displacement from X_W0 to X_W1 of its first part.
std::vector<Relation> relations_at(const SlidingGroup& sliding, const Pose& X_W0,
                                   const Pose& X_W1) {
  const Pose by = X_W1 * X_W0.inverse();
  std::vector<Relation> relations = sliding.relations;
  for (Relation& relation : relations) relation.a = moved(relation.a, by);
  return relations;
}

// A turning point leaves its tangent by half its arm times the turn squared: by so much it has to
// get away from what holds it, or the leg would end before it has begun.
TangentMove on_arc(TangentQuery query, double& lift_mm) {
  lift_mm = 0.0;
  const TangentMove straight = on_tangent_cone(query);
  const double turn_rad = straight.twist.turn_rad.norm();
  if (!straight.possible || turn_rad == 0.0) return straight;
  for (Hold& hold : query.holds) {
    // Half, and a tenth of that for the rest of the arc.
    const double off_mm = 0.55 * turn_rad * turn_rad * (hold.point_W - query.center_W).norm();
    hold.gap_mm -= off_mm;
    lift_mm = std::max(lift_mm, off_mm);
  }
  const TangentMove move = on_tangent_cone(query);
  return move.possible ? move : straight;
}

// Puts the body on its next leg, kept exactly on what guides it.
bool set_out(const World& world, Scratch::Impl& work, SlidingGroup& sliding, const Vec3& center_W,
             const std::vector<Relation>& relations, double t) {
  Displacement by = displacement_of(sliding.given);
  if (!relations.empty())
    by = guided({relations, center_W, sliding.group.lever_mm(), by}).displacement;
  std::vector<Motion> legs;
  for (const std::int32_t index : sliding.moves) {
    const Move& move = move_at(work, index);
    const Pose X_Wt = pose_at(work, world, index, move.part, t);
    Motion leg = rigid_motion(X_Wt, center_W, by);
    leg.reference_P = X_Wt.inverse() * center_W;
    const Solid& solid = *world.parts[move.part].solid;
    const Box box = swept_box({solid.bounds(), solid.sphere()}, leg);
    if ((box.lo.array() < move.reach.lo.array()).any() ||
        (box.hi.array() > move.reach.hi.array()).any())
      return false;  // what is there was not looked for
    legs.push_back(leg);
  }
  for (std::size_t i = 0; i < legs.size(); ++i) {
    Move& move = work.moves[static_cast<std::size_t>(sliding.moves[i])];
    move.leg = legs[i];
    move.leg_start = t;
    move.X_WP_end = move.leg.X_W1;
  }
  sliding.look_due = true;
  sliding.look = 2.0;
  return true;
}

// What holds a group at time t of the tick: contacts of plain pairs, and, in sliding.holds, those
// of pairs with bands.
struct Holding {
  bool known = true;    ///< false: nothing is known of what lies beyond t
  bool banded = false;  ///< a pair with bands is in the way
  std::vector<Hold> plain;
};

Holding what_holds(const World& world, Scratch::Impl& work, const Island& island,
                   SlidingGroup& sliding, double t, CcdScratch& ccd) {
  Holding holding;
  const std::int32_t number = move_at(work, sliding.moves.front()).sliding;
  for (const std::uint32_t i : island.pairs) {
    PairWork& pair = work.pairs[i];
    const Side side = side_of(pair, work, number);
    if (!side.of_group || pair.ids.placed || pair.ids.no_inside()) continue;
    // A leg that only leans on a part is free of it: what held the group before is looked at again.
    if (!pair.status.asked && !pair.status.blocked) continue;
    if (pair.status.blocks && pair.status.undecided) {
      holding.known = false;
      return holding;
    }
    const Pose X_WA = pose_at(work, world, pair.ids.move_a, pair.ids.a, t);
    const Pose X_WB = pose_at(work, world, pair.ids.move_b, pair.ids.b, t);
    if (pair.ids.plain() && !pair.answer.overlaps_at_start) {
      add_plain_holds(pair, X_WA, X_WB, side.a, ccd, holding.plain);
    } else {
      holding.banded = true;
      if (pair.status.blocks) add_banded_holds(pair, X_WA, X_WB, side.a, ccd, sliding.holds);
    }
  }
  return holding;
}

// What is wanted of the rest of the tick, and what holds the group and guides it.
TangentQuery tangent_query(const SlidingGroup& sliding, const Motion& wanted, const Vec3& center_W,
                           std::vector<Hold> plain, const std::vector<Relation>& relations,
                           double t) {
  TangentQuery query;
  query.wanted = {(1.0 - t) * wanted.v_W, (1.0 - t) * wanted.w_W};
  query.center_W = center_W;
  query.lever_mm = sliding.group.lever_mm();
  // A hand that does not turn the part keeps it from turning.
  query.may_turn = !wanted.w_W.isZero(0.0);
  query.holds = std::move(plain);
  query.holds.insert(query.holds.end(), sliding.holds.begin(), sliding.holds.end());
  if (!relations.empty()) query.guides = guide_rows({relations, center_W, query.lever_mm, {}});
  return query;
}

}  // namespace

void prepare_leg(const World& world, Scratch::Impl& work, std::int32_t index) {
  Move& move = work.moves[static_cast<std::size_t>(index)];
  if (move.sliding >= 0) return;
  const auto number = static_cast<std::int32_t>(work.sliding.size());
  SlidingGroup& sliding = work.sliding.emplace_back();
  sliding.group = moving_group_of(world, move.part);
  sliding.relations = relations_of(world, sliding.group);
  for (const std::uint32_t part : sliding.group.parts)
    if (const std::int32_t m = work.move_of_part[part]; m >= 0) {
      sliding.moves.push_back(m);
      work.moves[static_cast<std::size_t>(m)].sliding = number;
    }
}

bool start_leg(const World& world, Scratch::Impl& work, Island& island, std::int32_t index,
               double t, CcdScratch& ccd) {
  StepCounters& counters = island.counts;
  SlidingGroup& sliding = sliding_of(work, index);
  const bool first = sliding.legs == 0;
  const Move& lead = move_at(work, sliding.moves.front());
  if (!first) sliding.stalls = t - lead.leg_start < kStalled ? sliding.stalls + 1 : 0;
  if (sliding.legs >= kMostLegs || sliding.stalls > kMostStalls) {
    ++counters.slides_cut_short;
    return false;
  }
  const Pose X_Wt = pose_at(work, world, sliding.moves.front(), lead.part, t);
  const Vec3 center_W = X_Wt * lead.motion.reference_P;

  // 1. what holds it
  if (!first) carry_on(sliding, tick_to_leg(lead, t), lead.leg.X_W0 * lead.leg.reference_P);
  Holding holding = what_holds(world, work, island, sliding, t, ccd);
  if (!holding.known) return false;
  if (holding.banded && sliding.legs >= kMostBandLegs) {
    ++counters.slides_cut_short;
    return false;
  }

  // 2. what that leaves of the rest of the increments
  const std::vector<Relation> relations = relations_at(sliding, lead.motion.X_W0, X_Wt);
  const TangentQuery query =
      tangent_query(sliding, lead.motion, center_W, std::move(holding.plain), relations, t);
  const TangentMove move = on_arc(query, sliding.lift_mm);
  counters.slide_holds += query.holds.size();
  const double least_mm = holding.banded ? kLeastBandLeg_mm : kLeastLeg_mm;
  if (!move.possible || travel_mm(move.twist, sliding.group.radius_mm) < least_mm) return false;

  // 3. on its way
  sliding.wanted = query.wanted;
  sliding.given = move.twist;
  if (!set_out(world, work, sliding, center_W, relations, t)) {
    ++counters.slides_cut_short;
    return false;
  }
  if (sliding.legs == 0) counters.slid_parts += sliding.moves.size();
  ++sliding.legs;
  ++counters.slide_legs;
  return true;
}

void look_for_release(const World& world, Scratch::Impl& work, const Island& island,
                      SlidingGroup& sliding, double t_end, CcdScratch& ccd) {
  sliding.look_due = false;
  sliding.look = 2.0;
  const std::int32_t number = move_at(work, sliding.moves.front()).sliding;
  const Move& lead = move_at(work, sliding.moves.front());
  std::vector<PairWork*> holding;
  bool banded = false;
  for (const std::uint32_t i : island.pairs) {
    PairWork& pair = work.pairs[i];
    if (!side_of(pair, work, number).of_group || pair.ids.placed || pair.ids.no_inside()) continue;
    if (!pair.status.asked && !pair.status.blocked) continue;
    holding.push_back(&pair);
    banded |= !pair.ids.plain();
  }
  Twist away{sliding.wanted.shift_mm - sliding.given.shift_mm,
             sliding.wanted.turn_rad - sliding.given.turn_rad};
  const double length_mm = travel_mm(away, sliding.group.radius_mm);
  const double try_mm = (banded ? kBandTry_mm : kTry_mm) + 2.0 * sliding.lift_mm;
  if (length_mm < try_mm) return;
  away.shift_mm *= try_mm / length_mm;
  away.turn_rad *= try_mm / length_mm;
  const Displacement tried = displacement_of(away);
  const double leg_mm = travel_mm(sliding.given, sliding.group.radius_mm);
  const int looks = std::min(banded ? kMostBandLooks : kMostLooks,
                             static_cast<int>(std::ceil(leg_mm / kLookEvery_mm)));
  const auto held_at = [&](PairWork& pair, double t) {
    Pose X_W[2] = {pose_at(work, world, pair.ids.move_a, pair.ids.a, t),
                   pose_at(work, world, pair.ids.move_b, pair.ids.b, t)};
    const bool is_a = side_of(pair, work, number).a;
    Pose& X = X_W[is_a ? 0 : 1];
    const Vec3 center_W =
        (is_a ? move_at(work, pair.ids.move_a) : move_at(work, pair.ids.move_b)).leg.reference_P;
    X = rigid_motion(X, X * center_W, tried).X_W1;
    if (pair.ids.plain())
      return surfaces_cross(*pair.ids.solid_a, X_W[0], *pair.ids.solid_b, X_W[1], ccd);
    // Only what is proven free is let go.
    const OverlapResult overlap =
        ask(pair, certain_query(pair, X_W[0], X_W[1], Refinement::kDecided), ccd);
    return std::any_of(overlap.regions.begin(), overlap.regions.end(),
                       [](const OverlapRegion& region) { return region.certain_mm.hi > 0.0; });
  };
  for (int k = 1; k <= looks; ++k) {
    const double t =
        lead.leg_start + (t_end - lead.leg_start) * static_cast<double>(k) / (looks + 1.0);
    if (std::none_of(holding.begin(), holding.end(),
                     [&](PairWork* pair) { return held_at(*pair, t); })) {
      sliding.look = t;
      return;
    }
  }
}

}  // namespace mortise
