#include "common/session/world/ready_world.h"

#include <future>
#include <set>
#include <utility>

#include "common/depth/depth.h"
#include "common/session/world/part_shapes.h"

namespace mortise {
namespace {

// Who makes for others takes nothing that was made: see make_body_ready.
void make_ready(const World& world, int threads) {
  std::set<std::pair<const Solid*, std::uint32_t>> kinds;
  for (const Part& part : world.parts)
    if (part.present && kinds.emplace(part.solid.get(), part.kind).second)
      build_derived({part.solid, {}, part.band}, threads);
  std::set<std::pair<const Solid*, const SurfaceBand*>> stated;
  for (const auto& [pair, rule] : world.pair_rules)
    for (const auto& [id, band] : {std::pair(rule.a, &rule.band_a), {rule.b, &rule.band_b}})
      if (const Part* part = world.find_present(id);
          *band && part && stated.emplace(part->solid.get(), band->get()).second)
        make_body_ready(*part->solid, **band, threads);
}

}  // namespace

void make_world_ready(const World& world, int threads) {
  std::async(std::launch::async, [&] { make_ready(world, threads); }).get();
}

}  // namespace mortise
