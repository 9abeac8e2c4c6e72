#include "common/session/session_state.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/base/hash.h"
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
    state->parts[i].growth_mm = std::max(0.0, part.band.largest_offset_mm);
    state->rehash.push_back(i);
    if (!part.moving) continue;
    ++state->moving_parts;
    state->placed.push_back(i);
  }
  // A fit may give a pair larger bands than either part has alone.
  for (const auto& [pair, rule] : world.pair_rules) {
    const auto grow = [&](PartId part, const std::shared_ptr<const SurfaceBand>& band) {
      if (!band || !world.find(part)) return;
      double& growth = state->parts[part.value - 1].growth_mm;
      growth = std::max(growth, band->largest_offset_mm);
    };
    grow(pair.first, rule.band_a);
    grow(pair.second, rule.band_b);
  }
  for (std::uint32_t i = 0; i < world.parts.size(); ++i) {
    state->parts[i].growth_mm += kClashHysteresisMost_mm;
    state->broad_phase->set_box(i, resting_box(world, *state, i));
  }
  return state;
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
}

}  // namespace

SessionState& session_state(World& world, bool brute_force_pairs) {
  if (!world.state) world.state = make_state(world, brute_force_pairs);
  MORTISE_CHECK(world.state->tick == world.tick, "a copy of this world was stepped: load it twice");
  MORTISE_CHECK(world.state->parts.size() == world.parts.size(), "parts are fixed after the load");
  return *world.state;
}

void note_placed(World& world, std::uint32_t index) {
  if (!world.state) return;
  SessionState& state = *world.state;
  ++state.parts[index].placements;
  state.rehash.push_back(index);
  if (std::find(state.placed.begin(), state.placed.end(), index) == state.placed.end())
    state.placed.push_back(index);
}

void note_holder(World& world, std::uint32_t index) {
  if (world.state) world.state->rehash.push_back(index);
}

Box resting_box(const World& world, const SessionState& state, std::uint32_t index) {
  const Part& part = world.parts[index];
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
