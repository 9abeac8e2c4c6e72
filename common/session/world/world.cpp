#include "common/session/world/world.h"

#include <algorithm>

#include "common/messages/names.h"
#include "common/session/memory/session_state.h"
#include "common/session/world/standing.h"

namespace mortise {

const Part* World::find_part(const std::string& part_name) const {
  for (const Part& part : parts)
    if (part.present && part.name == part_name) return &part;
  return nullptr;
}

const PairRule* World::rule(PartId a, PartId b) const {
  if (pair_rules.empty()) return nullptr;
  const auto it = pair_rules.find(std::minmax(a, b));
  return it == pair_rules.end() ? nullptr : &it->second;
}

Snapshot snapshot_of(const World& world) {
  Snapshot snapshot;
  snapshot.session = world.name;
  snapshot.tick = world.tick;
  snapshot.tick_rate_hz = world.tick_rate_hz;
  snapshot.policy = name_of(world.policy);
  snapshot.standing = standing_decisions(world);
  snapshot.remarks = world.remarks;
  for (const Part& part : world.parts) {
    if (!part.present) continue;
    snapshot.parts.push_back({part.id, part.name, part.solid->hash(), part.moving, part.holder,
                              part.X_WP, part.solid->sphere().center_mm,
                              part.solid->sphere().radius_mm});
    for (const std::string& note : part.notes) snapshot.notes.push_back({part.id, note});
  }
  for (const User& user : world.users)
    snapshot.users.push_back({user.id, user.name, user.present, user.role});
  if (!world.state) return snapshot;
  snapshot.event_seq = world.state->event_seq;
  for (const auto& [pair, clashes] : world.state->open)
    for (const OpenClash& clash : clashes) snapshot.open_clashes.push_back(clash.last);
  std::sort(snapshot.open_clashes.begin(), snapshot.open_clashes.end(),
            [](const ClashEvent& x, const ClashEvent& y) { return x.clash < y.clash; });
  return snapshot;
}

}  // namespace mortise
