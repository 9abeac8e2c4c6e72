#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/messages/channel.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/statistics.h"
#include "common/session/tick/step.h"
#include "common/session/world/world.h"

namespace mortise {

/// Keys keep the order in which they are written. Infinity becomes null, because JSON has no
/// infinity: a gpd upper end of null means that no separating motion was verified.
using Json = nlohmann::ordered_json;

/// Names for ids in everything that people read.
struct SessionNames {
  std::vector<std::string> parts, users;  ///< [id - 1]
  std::string part(PartId id) const;      ///< "none" for no part, "#7" for an unknown one
  std::string user(UserId id) const;
  std::string pair(PartId a, PartId b) const;  ///< "shaft × housing"
};
SessionNames names_of(const World& world);
SessionNames names_of(const Snapshot& snapshot);

Json json_of(const Vec3& v);
Json json_of(Interval interval);
Json json_of(const Pose& pose);
Json json_of(const Verdict& verdict);
Json json_of(const StepCounters& counters);
Json json_of(const ClashEvent& event, const SessionNames& names);
Json json_of(const PairVerdicts& pair, const SessionNames& names);
Json json_of(const ChannelCounters& counters);

/// All statistics for engineers: by class, pair, part, user, and each clash.
Json json_of(const SessionStatistics& statistics, const SessionNames& names);

/// The same for people: collisions by class, pair and user, the worst ones explained.
std::string collision_table(const SessionStatistics& statistics, const SessionNames& names);

/// For each stage: in, out, and skipped by reason. One stage a line.
std::string stage_table(const StepCounters& counters);

}  // namespace mortise
