#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "common/io/log/session_log.h"
#include "common/io/state/checkpoint.h"
#include "common/session/world/world.h"

namespace mortise {

/// A checkpoint goes into the log when the engine has worked for so long since the last one, which
/// is what a restart has to compute again, and so often at least when something went in, or not.
struct CheckpointTimes {
  double work_s = 0.3, changed_s = 10.0, idle_s = 600.0;
};

/// Passes ticks to the log of a session, with the state whenever a checkpoint is due or the log
/// begins its next file. The leader and the standby both use it.
class TickRecorder {
 public:
  /// `log` may be null: nothing is done then. Both must outlive this.
  TickRecorder(World& world, SessionLogWriter* log, const CheckpointTimes& times);

  /// Before the first tick that it is to see. Times are of a clock that never goes back.
  void open(std::int64_t now_ns);

  struct Stepped {
    std::uint64_t tick = 0;
    std::int64_t wall_ns = 0, now_ns = 0;
    std::int64_t step_ns = 0;  ///< what the engine took for it
    bool changed = false;      ///< something went into it
    bool last = false;         ///< of the session here: with the state
  };
  /// After the step, while the world stands as after this tick.
  void begin(const Stepped& stepped);
  /// Passes the begun record to the log, with the input and the report of the tick. They are moved,
  /// after everybody has read them, because copying would be the largest cost of recording. Does
  /// nothing when no record is begun.
  void hand_over(std::vector<Decision>& decisions, std::vector<Increment>& increments,
                 StepReport& report);

 private:
  bool checkpoint_is_due(std::int64_t now_ns);
  void add_meshes(const std::vector<Decision>& decisions);

  World& world_;
  SessionLogWriter* log_;
  CheckpointTimes times_;
  CheckpointMaker checkpoints_;
  std::set<std::string> logged_;  ///< meshes that the log has
  TickRecord record_;             ///< of the last tick, not yet handed over; tick 0: none
  std::int64_t worked_ns_ = 0, checkpoint_ns_ = 0;  ///< since the last one; when that was
  bool changed_since_checkpoint_ = false;
};

}  // namespace mortise
