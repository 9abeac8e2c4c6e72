#include "common/session/tick/clash_identity.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/base/constants.h"
#include "common/session/world/review.h"

namespace mortise {
namespace {

// Two declared faces meet in one region (merge_regions), and its worst place may jump all around
// it.
bool of_same_faces(const Verdict& x, const Verdict& y) {
  return !x.face_a.empty() && !x.face_b.empty() && x.face_a == y.face_a && x.face_b == y.face_b;
}

double apart(const OpenClash& clash, const SeenRegion& seen) {
  if (of_same_faces(clash.now, seen.verdict)) return 0.0;
  return std::min((clash.p_A - seen.p_A).norm(), (clash.p_B - seen.p_B).norm());
}

double least_radius_mm(const PairWork& pair) {
  return std::min(pair.ids.solid_a->sphere().radius_mm, pair.ids.solid_b->sphere().radius_mm);
}

// Is a region near enough to continue a clash? The deepest point of a flat contact may lie anywhere
// on it, so the gate grows with the area; a contact line or point may wander a little over the
// part.
double gate_mm(const OpenClash& clash, const Verdict& seen, double radius_mm) {
  const double area_mm2 = std::max(clash.now.area_mm2, seen.area_mm2);
  return 2.0 * std::sqrt(std::max(0.0, area_mm2)) + 0.2 * radius_mm;
}

// Nearest first, one region to one clash; ties by clash, then region.
void pair_up(PairWork& pair, const std::vector<OpenClash>& open, double radius_mm, bool wide) {
  struct Option {
    double distance_mm;
    int clash, region;
  };
  std::vector<Option> options;
  std::vector<char> taken(open.size(), 0);
  for (const SeenRegion& seen : pair.judged.seen)
    if (seen.open >= 0) taken[static_cast<std::size_t>(seen.open)] = 1;
  for (std::size_t c = 0; c < open.size(); ++c)
    for (std::size_t r = 0; r < pair.judged.seen.size(); ++r) {
      if (taken[c] || pair.judged.seen[r].open >= 0) continue;
      const double d = apart(open[c], pair.judged.seen[r]);
      const double gate =
          wide ? radius_mm : gate_mm(open[c], pair.judged.seen[r].verdict, radius_mm);
      if (d <= gate) options.push_back({d, static_cast<int>(c), static_cast<int>(r)});
    }
  std::sort(options.begin(), options.end(), [](const Option& x, const Option& y) {
    return std::tie(x.distance_mm, x.clash, x.region) < std::tie(y.distance_mm, y.clash, y.region);
  });
  for (const Option& option : options) {
    SeenRegion& seen = pair.judged.seen[static_cast<std::size_t>(option.region)];
    char& is_taken = taken[static_cast<std::size_t>(option.clash)];
    if (is_taken || seen.open >= 0) continue;
    is_taken = 1;
    seen.open = option.clash;
  }
}

// What holds a pair is one clash: where the push would have led, the worst place moves about and
// may fall into several regions from one tick to the next. So the worst of them goes on with the
// clash that has held the pair near there, before others may.
void go_on_holding(PairWork& pair, const std::vector<OpenClash>& open, double radius_mm) {
  if (pair.judged.seen.empty()) return;
  SeenRegion& worst = pair.judged.seen.front();
  double nearest = radius_mm;
  for (std::size_t c = 0; c < open.size(); ++c) {
    if (open[c].worst_class != CollisionClass::kReal) continue;
    const double d = apart(open[c], worst);
    if (d > nearest || (d == nearest && worst.open >= 0)) continue;
    nearest = d;
    worst.open = static_cast<int>(c);
  }
}

// How far beyond a threshold a class has to be left behind: 1 % of the width of the zone between
// both, within bounds (README, section 6).
double hysteresis_mm(const Verdict& verdict) {
  const double width = verdict.real_above_mm - verdict.fake_below_mm;
  if (!(width > 0.0)) return kClashHysteresis_mm;
  return std::clamp(kClashHysteresisShare * width, kClashHysteresis_mm, kClashHysteresisMost_mm);
}

// A class is entered at its threshold and left beyond it, so that what trembles about a threshold
// is told once. Real is left as soon as that is proven, or it would be said of what is not.
bool is_left(CollisionClass told, const Verdict& now) {
  const bool has_zone = now.real_above_mm > now.fake_below_mm;
  if (told == CollisionClass::kReal && has_zone) return now.delta_mm.hi <= now.real_above_mm;
  return now.margin_mm >= hysteresis_mm(now);
}

// And so it is entered again only beyond its threshold. How deep it is may not be known yet.
bool is_entered_again(const OpenClash& clash, const Verdict& now, std::uint64_t tick) {
  if (now.collision_class != CollisionClass::kReal || clash.worst_class != CollisionClass::kReal)
    return true;
  const double least_mm = now.real_above_mm + hysteresis_mm(now);
  return now.delta_mm.lo >= least_mm ||
         (now.delta_mm.hi >= least_mm && tick >= clash.last.tick + kClashQuietTicks);
}

// Was what is stated of the faces another one when the clash was told last?
bool thresholds_moved(const Verdict& told, const Verdict& now) {
  const double h = hysteresis_mm(now);
  return std::abs(now.fake_below_mm - told.fake_below_mm) > h ||
         std::abs(now.real_above_mm - told.real_above_mm) > h;
}

// Worth an event? A worse class, a better one when it is beyond the threshold for certain or judged
// anew by decision (nothing trembles there), other thresholds by decision, a growing depth now and
// then.
bool change_is_due(const OpenClash& clash, const Verdict& verdict, std::uint64_t tick, bool anew) {
  if (clash.revised) return true;
  const CollisionClass told = clash.last.verdict.collision_class;
  if (verdict.collision_class > told) return anew || is_entered_again(clash, verdict, tick);
  if (anew && verdict.collision_class < told) return true;
  if (anew && thresholds_moved(clash.last.verdict, verdict)) return true;
  if (verdict.collision_class < told) return is_left(told, verdict);
  if (tick < clash.last.tick + kClashQuietTicks) return false;
  const double told_mm = clash.last.worst_delta_mm.lo;
  return verdict.delta_mm.lo - told_mm >
         std::max(kClashHysteresis_mm, kClashGrowthShare * std::abs(told_mm));
}

UserId last_mover(const SessionState& state, std::uint32_t a, std::uint32_t b) {
  const PartState& x = state.parts[a];
  const PartState& y = state.parts[b];
  if (x.last_user && (!y.last_user || x.last_tick >= y.last_tick)) return x.last_user;
  return y.last_user;
}

bool is_worse(const Verdict& verdict, const OpenClash& clash) {
  return verdict.collision_class > clash.worst_class ||
         (verdict.collision_class == clash.worst_class &&
          verdict.delta_mm.lo > clash.worst_delta_mm.lo);
}

void take_in(OpenClash& clash, const SeenRegion& seen) {
  clash.now = seen.verdict;
  clash.p_A = seen.p_A;
  clash.p_B = seen.p_B;
  if (is_worse(seen.verdict, clash)) {
    clash.worst_class = seen.verdict.collision_class;
    clash.worst_delta_mm = seen.verdict.delta_mm;
  }
}

// Times of the tick that an event tells.
struct Times {
  double contact = 1.0, potential = kNever, real = kNever;
};

Times times_of(const PairWork& pair) {
  Times times{1.0, pair.judged.t_potential, pair.judged.t_real};
  if (pair.ids.placed)
    times.contact = 0.0;
  else if (pair.answer.meets)
    times.contact = pair.segment.tau + (1.0 - pair.segment.tau) * pair.answer.t_contact;
  return times;
}

// Fills in what every event of a clash carries and remembers it as the last one.
void tell(const World& world, SessionState& state, OpenClash& clash, ClashEvent::Kind kind,
          const Times& times, StepReport& report) {
  ClashEvent& event = clash.last;
  event.kind = kind;
  event.seq = ++state.event_seq;
  event.tick = world.tick;
  event.user = last_mover(state, event.part_a.value - 1, event.part_b.value - 1);
  event.verdict = clash.now;
  clash.revised = false;
  event.t_contact = times.contact;
  event.t_potential = times.potential;
  event.t_real = times.real;
  event.worst_class = clash.worst_class;
  event.worst_delta_mm = clash.worst_delta_mm;
  event.cause = Decision::Kind::kUnknown;
  for (const PartId part : {event.part_a, event.part_b}) {
    const PartState& of = state.parts[part.value - 1];
    if (of.cause_tick != world.tick) continue;
    event.cause = of.cause;
    event.user = of.cause_user;
  }
  event.approval_lost = is_worse_than_approved(clash, hysteresis_mm(clash.now));
  if (event.approval_lost) take_back_approval(clash, world.tick);
  report.events.push_back(event);
}

void begin(const World& world, SessionState& state, const PairWork& pair, const SeenRegion& seen,
           const Times& times, StepReport& report) {
  OpenClash clash;
  clash.last.clash = ClashId{state.next_clash++};
  clash.last.part_a = world.parts[pair.ids.a].id;
  clash.last.part_b = world.parts[pair.ids.b].id;
  clash.last.begin_tick = world.tick;
  clash.worst_class = seen.verdict.collision_class;
  clash.worst_delta_mm = seen.verdict.delta_mm;
  take_in(clash, seen);
  approve_where_it_starts(world, state, clash);
  tell(world, state, clash, ClashEvent::Kind::kBegin, times, report);
  if (seen.passing)
    tell(world, state, clash, ClashEvent::Kind::kEnd, times, report);
  else
    state.open[{clash.last.part_a, clash.last.part_b}].push_back(std::move(clash));
}

// The clashes of one pair that were open before the tick: change, end, or go on in silence.
void update(const World& world, SessionState& state, const PairWork* pair,
            std::vector<OpenClash>& open, StepReport& report) {
  if (pair && pair->status.together) return;  // they stand to each other as before
  const bool known = pair && pair->status.asked;
  for (std::size_t c = 0; c < open.size(); ++c) {
    const SeenRegion* seen = nullptr;
    if (known)
      for (const SeenRegion& region : pair->judged.seen)
        if (region.open == static_cast<int>(c)) seen = &region;
    const Times times = known ? times_of(*pair) : Times{};
    if (seen) take_in(open[c], *seen);
    if (seen && !seen->passing) {
      if (seen->tell || is_worse_than_approved(open[c], hysteresis_mm(open[c].now)))
        tell(world, state, open[c], ClashEvent::Kind::kChange, times, report);
      continue;
    }
    if (!seen && known && pair->judged.keeps[c]) continue;
    tell(world, state, open[c], ClashEvent::Kind::kEnd, times, report);
  }
  std::erase_if(open,
                [](const OpenClash& clash) { return clash.last.kind == ClashEvent::Kind::kEnd; });
}

}  // namespace

bool is_at(const OpenClash& clash, const CertainPlace& place, const PairWork& pair) {
  const bool of_a = place.role == 0;
  const std::string& face = of_a ? clash.now.face_a : clash.now.face_b;
  const SurfaceBand& band = of_a ? *pair.ids.band_a : *pair.ids.band_b;
  if (!face.empty() && face == band.face_of(place.triangle).name) return true;
  const double away_mm = (place.point_S - (of_a ? clash.p_A : clash.p_B)).norm();
  return away_mm <= gate_mm(clash, clash.now, least_radius_mm(pair));
}

void match_clashes(const World& world, PairWork& pair, double distance_mm) {
  const double radius_mm = least_radius_mm(pair);
  if (!pair.ids.open) {
    // What stopped the pair is the worst of what it would have met, and one clash.
    if (pair.status.blocks && pair.judged.seen.size() > 1) pair.judged.seen.resize(1);
    for (SeenRegion& seen : pair.judged.seen) seen.tell = true;
    return;
  }
  const std::vector<OpenClash>& open = *pair.ids.open;
  if (pair.status.blocks) go_on_holding(pair, open, radius_mm);
  // 1. Near the same place; then what is left over, with a wider gate: a clash that jumps over its
  //    part from tick to tick is still one clash.
  pair_up(pair, open, radius_mm, false);
  pair_up(pair, open, radius_mm, true);
  pair.judged.keeps.assign(open.size(), 0);
  if (pair.status.blocks) {
    // The same; and where the part was stopped nobody looked: what was open there stays.
    pair.judged.keeps.assign(open.size(), 1);
    std::size_t kept = 0;
    for (std::size_t r = 0; r < pair.judged.seen.size(); ++r)
      if (r == 0 || pair.judged.seen[r].open >= 0) {
        if (kept != r) pair.judged.seen[kept] = std::move(pair.judged.seen[r]);
        ++kept;
      }
    pair.judged.seen.resize(kept);
  }
  const bool anew = pair.ids.memo->not_judged || (pair.ids.memo->not_seen && !pair.status.blocks);
  for (SeenRegion& seen : pair.judged.seen) {
    if (seen.open < 0) {
      seen.tell = true;
    } else {
      const OpenClash& clash = open[static_cast<std::size_t>(seen.open)];
      pair.judged.keeps[static_cast<std::size_t>(seen.open)] = 1;
      seen.tell = change_is_due(clash, seen.verdict, world.tick, anew);
      const CollisionClass told = clash.last.verdict.collision_class;
      const bool better = seen.verdict.collision_class < told;
      // At rest, where the depth cannot be known well enough, what a fresh look says is told.
      seen.tell |= better && pair.judged.in_full && pair.status.undecided;
      pair.judged.unsettled |= seen.verdict.collision_class != told && !seen.tell;
    }
  }
  // 2. Hysteresis: not interfering any more, but by less than can be told for certain.
  double h = kClashHysteresis_mm;
  for (const OpenClash& clash : open) h = std::max(h, hysteresis_mm(clash.now));
  // Edges reach farther than faces, but only where they meet; that is known exactly.
  const double faces_mm =
      std::max(0.0, pair.ids.band_a->largest_offset_mm + pair.ids.band_b->largest_offset_mm);
  const bool close = distance_mm <= faces_mm + h;
  const bool barely =
      std::any_of(pair.judged.judgement.overlap.regions.begin(),
                  pair.judged.judgement.overlap.regions.end(), [&](const OverlapRegion& region) {
                    return region.possible_mm.hi <= 0.0 && region.possible_mm.hi > -h;
                  });
  // Nothing trembles at rest.
  if (!pair.judged.seen.empty() || anew || pair.ids.placed || !(close || barely)) return;
  pair.judged.keeps.assign(open.size(), 1);
  pair.status.owed = pair.status.lingers = true;
}

void end_unjudged_clashes(const World& world, SessionState& state, StepReport& report) {
  if (!state.edited) return;
  state.edited = false;
  for (auto it = state.open.begin(); it != state.open.end();) {
    auto& [ids, clashes] = *it;
    if (is_judged(world, ids.first, ids.second)) {
      ++it;
      continue;
    }
    for (OpenClash& clash : clashes)
      tell(world, state, clash, ClashEvent::Kind::kEnd, Times{}, report);
    state.clashes_changed = true;
    it = state.open.erase(it);
  }
}

void report_clashes(const World& world, SessionState& state, Scratch::Impl& work,
                    StepReport& report) {
  if (work.moves.empty()) return;
  const auto last = work.pairs.begin() + static_cast<std::ptrdiff_t>(work.pair_count);
  const auto pair_of = [&](PartId a, PartId b) -> const PairWork* {
    const IndexPair key{a.value - 1, b.value - 1};
    const auto it =
        std::lower_bound(work.pairs.begin(), last, key, [](const PairWork& x, IndexPair y) {
          return IndexPair{x.ids.a, x.ids.b} < y;
        });
    return it != last && it->ids.a == key.a && it->ids.b == key.b ? &*it : nullptr;
  };
  const auto is_still = [&](PartId part) {
    const std::int32_t index = work.move_of_part[part.value - 1];
    if (index < 0) return true;
    const Move& move = work.moves[static_cast<std::size_t>(index)];
    return !move.placed && !move.motion.moves();
  };

  // 1. Clashes that were open. Two parts that are both still keep theirs.
  for (auto it = state.open.begin(); it != state.open.end();) {
    const auto& [a, b] = it->first;
    const PairWork* pair = pair_of(a, b);
    if (pair || !is_still(a) || !is_still(b)) {
      update(world, state, pair, it->second, report);
      state.clashes_changed = true;
    }
    it = it->second.empty() ? state.open.erase(it) : std::next(it);
  }
  // 2. New ones, in the order of pairs.
  for (std::size_t i = 0; i < work.pair_count; ++i) {
    const PairWork& pair = work.pairs[i];
    if (!pair.status.asked) continue;
    for (const SeenRegion& seen : pair.judged.seen)
      if (seen.open < 0) {
        begin(world, state, pair, seen, times_of(pair), report);
        state.clashes_changed = true;
      }
  }
}

}  // namespace mortise
