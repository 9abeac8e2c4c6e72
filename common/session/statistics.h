#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/report.h"
#include "common/session/world.h"

namespace mortise {

/// The paper's "statistic of all collisions is provided to engineers". Fed with every StepReport,
/// in order.
class SessionStatistics {
 public:
  struct Row {
    std::uint64_t clashes[4] = {0, 0, 0, 0};  ///< by worst class
    std::uint64_t ticks[4] = {0, 0, 0, 0};    ///< duration by class, ticks
    Verdict worst;                            ///< of the worst class, deepest
    std::uint64_t first_tick = 0, last_tick = 0;
    std::uint64_t worst_tick = 0;
  };
  struct ClashRow {
    ClashId clash;
    PartId a, b;
    UserId user;
    std::uint64_t begin_tick = 0, end_tick = 0;  ///< end_tick 0: still open
    CollisionClass worst_class = CollisionClass::kNone;
    Verdict worst;
    std::uint64_t ticks[4] = {0, 0, 0, 0};
    CollisionClass now = CollisionClass::kNone;  ///< as last told; kNone when it has ended
  };

  void add(const StepReport& report);

  /// Counts of all ticks, where they were added without them, as a log has them.
  void set_counters(const StepCounters& counters) { counters_ = counters; }
  /// Do its lists point at each other as they must? For what was read back.
  bool is_whole() const;

  std::uint64_t ticks() const { return ticks_; }
  const StepCounters& counters() const { return counters_; }  ///< summed over the session
  const std::map<std::pair<PartId, PartId>, Row>& by_pair() const { return by_pair_; }
  const std::map<PartId, Row>& by_part() const { return by_part_; }
  const std::map<UserId, Row>& by_user() const { return by_user_; }
  const std::vector<ClashRow>& clashes() const { return clashes_; }
  std::uint64_t clashes_open(CollisionClass c) const;
  std::uint64_t clashes_total(CollisionClass c) const;  ///< by worst class

 private:
  std::uint64_t ticks_ = 0;
  StepCounters counters_;
  std::map<std::pair<PartId, PartId>, Row> by_pair_;
  std::map<PartId, Row> by_part_;
  std::map<UserId, Row> by_user_;
  std::vector<ClashRow> clashes_;
  std::map<ClashId, std::size_t> index_;
  std::vector<std::size_t> open_;  // into clashes_, by begin

  template <class Change>
  void for_rows_of(const ClashRow& clash, const Change& change);
  void take_in(const ClashEvent& event);

  template <class Archive>
  friend void fields(Archive& archive, SessionStatistics& statistics);  ///< io/state_fields.h
};

/// Adds every count of `from` to `into`.
void accumulate(StepCounters& into, const StepCounters& from);

}  // namespace mortise
