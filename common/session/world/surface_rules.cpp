#include "common/session/world/surface_rules.h"

#include <algorithm>

#include "common/session/memory/session_state.h"

namespace mortise {
namespace {

bool says_something(const std::shared_ptr<const SurfaceBand>& band) {
  return band && !band->trivial;
}

}  // namespace

bool evaluates(const World& world) {
  return std::any_of(world.parts.begin(), world.parts.end(),
                     [](const Part& part) { return !part.band.trivial; }) ||
         std::any_of(world.pair_rules.begin(), world.pair_rules.end(), [](const auto& entry) {
           return says_something(entry.second.band_a) || says_something(entry.second.band_b);
         });
}

void apply_change(World& world, const Decision& by, SurfaceRules::Change change) {
  for (auto& [id, band] : change.bands)
    if (Part* part = world.find(id)) part->band = std::move(band);
  // What the pairs of the part had is gone; exclusions stand apart and stay.
  for (auto& [ids, rule] : world.pair_rules) {
    if (rule.a != by.part && rule.b != by.part) continue;
    rule.band_a = rule.band_b = nullptr;
    rule.fit.clear();
  }
  for (PairRule& stated : change.pairs) {
    PairRule& rule = world.pair_rules[{stated.a, stated.b}];
    rule.a = stated.a, rule.b = stated.b;
    rule.band_a = std::move(stated.band_a), rule.band_b = std::move(stated.band_b);
    rule.fit = std::move(stated.fit);
  }
  std::erase_if(world.pair_rules, [](const auto& entry) {
    const PairRule& rule = entry.second;
    return !rule.excluded && !rule.band_a && !rule.band_b;
  });
  world.evaluates = evaluates(world);
  note_surface(world, by.part, by.details.other_part, by);
}

}  // namespace mortise
