#pragma once
#include <map>
#include <string>

#include "client/client.h"

namespace mortise::test {

/// What somebody knows of a session in which nobody moves any more.
struct Knowledge {
  std::map<PartId, PartInfo> parts;
  std::map<ClashId, ClashEvent> open;
  std::uint64_t event_seq = 0;  ///< of the last event that it heard of
};

inline Knowledge knowledge_of(const Client& client) {
  Knowledge known;
  for (const auto& [id, part] : client.parts()) known.parts[id] = part.info;
  known.open = client.open_clashes();
  known.event_seq = client.statistics().highest_event_seq;
  return known;
}

inline Knowledge knowledge_of(const Snapshot& snapshot) {
  Knowledge known;
  for (const PartInfo& part : snapshot.parts) known.parts[part.part] = part;
  for (const ClashEvent& clash : snapshot.open_clashes) known.open[clash.clash] = clash;
  known.event_seq = snapshot.event_seq;
  return known;
}

inline bool same_clash(const ClashEvent& a, const ClashEvent& b) {
  return a.seq == b.seq && a.part_a == b.part_a && a.part_b == b.part_b &&
         a.begin_tick == b.begin_tick && a.worst_class == b.worst_class &&
         a.verdict.collision_class == b.verdict.collision_class &&
         a.verdict.delta_mm == b.verdict.delta_mm && a.verdict.gpd_mm == b.verdict.gpd_mm;
}

/// The first thing that they know differently, to the last bit; empty: nothing.
inline std::string difference(const Knowledge& a, const Knowledge& b) {
  if (a.parts.size() != b.parts.size()) return "number of parts";
  for (const auto& [id, part] : a.parts) {
    const auto other = b.parts.find(id);
    if (other == b.parts.end()) return "there is no " + part.name;
    if (!identical(part.X_WP, other->second.X_WP)) return "pose of " + part.name;
    if (part.holder != other->second.holder) return "holder of " + part.name;
  }
  if (a.event_seq != b.event_seq)
    return "events up to " + std::to_string(a.event_seq) + " and " + std::to_string(b.event_seq);
  if (a.open.size() != b.open.size())
    return std::to_string(a.open.size()) + " and " + std::to_string(b.open.size()) +
           " open clashes";
  for (const auto& [id, clash] : a.open) {
    const auto other = b.open.find(id);
    if (other == b.open.end() || !same_clash(clash, other->second))
      return "clash " + std::to_string(id.value);
  }
  return {};
}

}  // namespace mortise::test
