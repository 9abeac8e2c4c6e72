#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "client/web/json_out.h"
#include "common/base/result.h"
#include "common/io/log/log_json.h"

namespace mortise::web {

/// A logged session in a form in which any moment of it can be shown at once.
struct Recording {
  /// The pose and holder of a part after a tick.
  struct Step {
    std::uint64_t tick = 0;
    PartState state;
  };
  /// Users, policy and rules after a tick with decisions.
  struct Agreement {
    std::uint64_t tick = 0;
    std::string policy;
    std::vector<UserInfo> users;
    std::vector<Decision> standing;
    std::vector<Remark> remarks;
    std::vector<Decision> decisions;  ///< of this tick
  };

  /// The parts after a tick that edited the scene: as they were put there.
  struct PartList {
    std::uint64_t tick = 0;
    std::vector<PartInfo> parts;
    std::vector<PartNote> notes;  ///< of the import of their meshes
  };

  std::string session;
  double tick_rate_hz = 60.0;
  std::uint64_t first_tick = 0, last_tick = 0;
  std::vector<PartList> part_lists;             ///< by tick, the first from before all
  std::map<PartId, std::vector<Step>> steps;    ///< by tick
  std::vector<ClashEvent> events;               ///< by tick
  std::vector<Agreement> agreements;            ///< by tick, the first from before all
  std::map<std::string, SharedBytes> meshes;    ///< by hash, as pages read them
  std::vector<log_json::TickTimes> tick_times;  ///< by tick; empty: not measured
  std::vector<std::string> notes;               ///< what is missing, in words

  /// The scene at the end of a tick.
  Scene scene_at(std::uint64_t tick) const;
  const Agreement& agreement_at(std::uint64_t tick) const;
  const PartList& parts_at(std::uint64_t tick) const;
  PartState state_at(PartId part, std::uint64_t tick) const;
  /// Parts whose pose or holder changed in the ticks after `from` up to `to`.
  std::vector<PartId> moved_between(std::uint64_t from, std::uint64_t to) const;
};

/// Reads a session log and computes it again, so that the recording is exact to the last bit; of a
/// log of another build it is what this build computes, within accuracy, and a note says so. Where
/// engine and log disagree, or a piece is missing, the recording ends, and a note says so. Takes
/// about as long as the busy ticks took.
Result<Recording> read_recording(const std::filesystem::path& file);

}  // namespace mortise::web
