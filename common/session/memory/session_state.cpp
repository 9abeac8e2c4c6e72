#include "common/session/memory/session_state.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/base/hash.h"
#include "common/broadphase/brute_force.h"
#include "common/broadphase/dynamic_tree.h"
#include "common/broadphase/swept_box.h"

namespace mortise {
namespace {

std::unique_ptr<SessionState> make_state(const World& world, bool brute_force_pairs) {
  auto state = std::make_unique<SessionState>();
  state->tick = world.tick;
  state->broad_phase = brute_force_pairs ? make_brute_force() : make_dynamic_tree();
  state->parts.resize(world.parts.size());
  for (std::uint32_t i = 0; i < world.parts.size(); ++i) {
    const Part& part = world.parts[i];
    MORTISE_CHECK(part.id.value == i + 1 && part.solid,
                  "parts are numbered from 1 and have a mesh");
    MORTISE_CHECK(valid(part.band, part.solid->mesh().triangles.size()),
                  "a band has a face for every triangle of its part");
    state->parts[i].growth_mm = part.band.farthest_mm();
    state->rehash.push_back(i);
    if (part.present && part.moving) state->placed.push_back(i);
  }
  count_parts(world, *state);
  // A fit may give a pair larger bands than either part has alone.
  for (const auto& [pair, rule] : world.pair_rules) {
    const auto grow = [&](PartId part, const std::shared_ptr<const SurfaceBand>& band) {
      if (!band || !world.find(part)) return;
      MORTISE_CHECK(valid(*band, world.find(part)->solid->mesh().triangles.size()),
                    "a band has a face for every triangle of its part");
      double& growth = state->parts[part.value - 1].growth_mm;
      growth = std::max(growth, band->farthest_mm());
    };
    grow(pair.first, rule.band_a);
    grow(pair.second, rule.band_b);
  }
  for (PartState& part : state->parts) part.growth_mm += kClashHysteresisMost_mm;
  set_resting_boxes(world, *state);
  return state;
}

double farthest_mm(const World& world, PartId part) {
  double largest_mm = world.find(part)->band.farthest_mm();
  for (const auto& [ids, rule] : world.pair_rules) {
    const auto& band = ids.first == part ? rule.band_a : rule.band_b;
    if ((ids.first == part || ids.second == part) && band)
      largest_mm = std::max(largest_mm, band->farthest_mm());
  }
  return largest_mm;
}

void add(StateHash& hash, const Vec3& v) {
  for (int i = 0; i < 3; ++i) hash.add(v[i]);
}

std::uint64_t hash_of(const Part& part) {
  StateHash hash;
  hash.add(static_cast<std::uint64_t>(part.id.value));
  hash.add(static_cast<std::uint64_t>(part.holder.value));
  for (int i = 0; i < 4; ++i) hash.add(part.X_WP.q.coeffs()[i]);
  add(hash, part.X_WP.p);
  if (part.edits == 0) return hash.value();  // as before there were edits
  hash.add(static_cast<std::uint64_t>(part.present));
  hash.add(static_cast<std::uint64_t>(part.moving));
  hash.add(std::as_bytes(std::span(part.solid->hash())));
  return hash.value();
}

void add(StateHash& hash, const OpenClash& clash) {
  hash.add(static_cast<std::uint64_t>(clash.last.clash.value));
  hash.add(static_cast<std::uint64_t>(clash.last.part_a.value));
  hash.add(static_cast<std::uint64_t>(clash.last.part_b.value));
  hash.add(static_cast<std::uint64_t>(clash.last.begin_tick));
  hash.add(static_cast<std::uint64_t>(clash.last.verdict.collision_class));
  const Verdict& now = clash.now;
  hash.add(static_cast<std::uint64_t>(now.collision_class));
  for (const double x : {now.delta_mm.lo, now.delta_mm.hi, now.gpd_mm.lo, now.gpd_mm.hi,
                         now.fake_below_mm, now.real_above_mm, now.probability})
    hash.add(x);
  add(hash, now.point_W);
  add(hash, now.normal_W);
  const Review& review = clash.last.review;
  if (review.tick == 0) return;  // nobody has said anything: as before there were reviews
  hash.add(static_cast<std::uint64_t>(review.status));
  hash.add(static_cast<std::uint64_t>(review.user.value));
  hash.add(review.tick);
}

}  // namespace

SessionState& session_state(World& world, bool brute_force_pairs) {
  if (!world.state) world.state = make_state(world, brute_force_pairs);
  MORTISE_CHECK(world.state->tick == world.tick, "a copy of this world was stepped: load it twice");
  MORTISE_CHECK(world.state->parts.size() == world.parts.size(), "parts come by decisions alone");
  return *world.state;
}

void forget_user(SessionState& state, UserId user) {
  const auto forget = [user](UserId& by) {
    if (by == user) by = UserId{};
  };
  for (PartState& part : state.parts) {
    forget(part.last_user);
    forget(part.cause_user);
  }
  for (KeptPush& push : state.kept) forget(push.user);
  for (auto& [pair, clashes] : state.open) {
    for (OpenClash& clash : clashes) {
      forget(clash.last.user);
      forget(clash.last.review.user);
    }
  }
  for (ClashEvent& event : state.reviews) {
    forget(event.user);
    forget(event.review.user);
  }
  state.clashes_changed = true;
}

void note_placed(World& world, std::uint32_t index, const Decision& by) {
  if (!world.state) return;
  SessionState& state = *world.state;
  PartState& part = state.parts[index];
  ++part.placements;
  part.cause = by.kind;
  part.cause_user = by.user;
  part.cause_tick = world.tick + 1;
  state.rehash.push_back(index);
  if (std::find(state.placed.begin(), state.placed.end(), index) == state.placed.end())
    state.placed.push_back(index);
}

void note_holder(World& world, std::uint32_t index) {
  if (world.state) world.state->rehash.push_back(index);
}

namespace {

// The moving parts of the pairs concerned count as put where they stand: that voids what is
// remembered of them and has them judged. Without `other`: of all pairs of the part.
void judge_anew(World& world, PartId part, PartId other, const Decision& by) {
  SessionState& state = *world.state;
  std::vector<std::uint32_t> again;
  const auto add = [&](PartId id) {
    const bool moves = world.find(id)->present && world.find(id)->moving;
    if (moves) again.push_back(id.value - 1);
    return moves;
  };
  if (world.find(other)) {
    if (!add(part)) add(other);
  } else if (!add(part)) {
    std::vector<IndexPair> pairs;
    state.broad_phase->find_pairs(std::vector<std::uint32_t>{part.value - 1}, pairs);
    for (const IndexPair pair : pairs)
      add(PartId{(pair.a == part.value - 1 ? pair.b : pair.a) + 1});
    for (const auto& [ids, clashes] : state.open)
      if (ids.first == part || ids.second == part) add(ids.first == part ? ids.second : ids.first);
  }
  for (const std::uint32_t index : again) note_placed(world, index, by);
}

}  // namespace

bool is_judged(const World& world, PartId a, PartId b) {
  const Part &x = *world.find(a), &y = *world.find(b);
  return x.present && y.present && (x.moving || y.moving);
}

void count_parts(const World& world, SessionState& state) {
  state.present_parts = state.moving_parts = 0;
  for (const Part& part : world.parts) {
    state.present_parts += part.present;
    state.moving_parts += part.present && part.moving;
  }
}

void note_form(World& world, std::uint32_t index, const Decision& by) {
  if (!world.state) return;
  SessionState& state = *world.state;
  const Part& part = world.parts[index];
  // 1. Lists and boxes.
  state.parts.resize(world.parts.size());
  count_parts(world, state);
  PartState& of = state.parts[index];
  of.growth_mm = farthest_mm(world, part.id) + kClashHysteresisMost_mm;
  of.cause = by.kind;
  of.cause_user = by.user;
  of.cause_tick = world.tick + 1;
  state.broad_phase->set_box(index, resting_box(world, state, index));
  state.rehash.push_back(index);
  state.edited = true;
  // 2. What the next tick would have gone on with.
  if (!part.present || !part.moving) {
    std::erase(state.placed, index);
    std::erase_if(state.kept, [&](const KeptPush& push) { return push.part == index; });
  }
  std::erase_if(state.owed, [&](IndexPair pair) {
    return !is_judged(world, PartId{pair.a + 1}, PartId{pair.b + 1});
  });
  // 3. What is to be judged.
  if (part.present) judge_anew(world, part.id, PartId{}, by);
}

void note_mesh(World& world, std::uint32_t index) {
  if (!world.state) return;
  SessionState& state = *world.state;
  for (auto& [key, memo] : state.memos) {  // in any order: all become alike
    if (key >> 32 != index && (key & 0xffffffff) != index) continue;
    state.touch(key, memo);
    PairMemo fresh;
    fresh.touched = memo.touched;
    fresh.touched_tick = memo.touched_tick;
    memo = std::move(fresh);
  }
  std::erase_if(state.kept, [&](const KeptPush& push) { return push.part == index; });
  for (auto& [ids, clashes] : state.open)
    if (ids.first.value == index + 1 || ids.second.value == index + 1)
      for (OpenClash& clash : clashes) clash.revised = true;
}

void note_surface(World& world, PartId part, PartId other, const Decision& by) {
  if (!world.state) return;
  SessionState& state = *world.state;
  // 1. Boxes as large as what they now hold.
  for (const PartId id : {part, other}) {
    if (!world.find(id)) continue;
    const std::uint32_t index = id.value - 1;
    state.parts[index].growth_mm = farthest_mm(world, id) + kClashHysteresisMost_mm;
    state.broad_phase->set_box(index, resting_box(world, state, index));
  }
  // 2. Verdicts.
  judge_anew(world, part, other, by);
}

void note_policy(World& world) {
  if (!world.state) return;
  for (auto& [pair, memo] : world.state->memos) {  // in any order: all become alike
    if (std::isinf(memo.allowed_depth_mm)) continue;
    memo.allowed_depth_mm = std::numeric_limits<double>::infinity();
    world.state->touch(pair, memo);
  }
}

std::unique_ptr<SessionState> empty_state(const World& world) {
  auto state = std::make_unique<SessionState>();
  state->broad_phase = make_dynamic_tree();
  state->parts.resize(world.parts.size());
  return state;
}

void set_resting_boxes(const World& world, SessionState& state) {
  for (std::uint32_t i = 0; i < world.parts.size(); ++i)
    state.broad_phase->set_box(i, resting_box(world, state, i));
}

Box resting_box(const World& world, const SessionState& state, std::uint32_t index) {
  const Part& part = world.parts[index];
  if (!part.present) return {};
  const BodyBounds body{part.solid->bounds(), part.solid->sphere()};
  Motion still = still_motion(part.X_WP);
  still.reference_P = body.sphere_P.center_mm;
  return swept_box(body, still).grown(state.parts[index].growth_mm);
}

std::uint64_t state_hash(const World& world, SessionState& state) {
  if (!state.rehash.empty()) {
    // A sum, so that a part can be exchanged in it: each summand knows its part.
    for (const std::uint32_t i : state.rehash) {
      const std::uint64_t now = hash_of(world.parts[i]);
      state.parts_hash += now - state.parts[i].hash;
      state.parts[i].hash = now;
    }
    state.rehash.clear();
  }
  if (state.clashes_changed) {
    StateHash hash;
    for (const auto& [pair, clashes] : state.open)
      for (const OpenClash& clash : clashes) add(hash, clash);
    state.clashes_hash = hash.value();
    state.clashes_changed = false;
  }
  StateHash hash;
  hash.add(world.tick);
  hash.add(state.parts_hash);
  hash.add(state.clashes_hash);
  return hash.value();
}

}  // namespace mortise
