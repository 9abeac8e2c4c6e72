#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/report.h"
#include "common/session/world/world.h"

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
  /// The same as so many reports in which nothing happened, in one go.
  void add_idle(std::uint64_t ticks);
  /// When a decision gives an id to another user, removes the former user's rows.
  void forget_users(std::span<const Decision> decisions);

  /// Rows of clashes that have ended, as many as a server keeps.
  static constexpr std::size_t kMostEndedRows = 256;
  /// From now on keeps only so many of them, those that ended last, so that a session of days does
  /// not grow. The others stay in every count and sum, and in the log.
  void keep_ended_rows(std::size_t most);

  /// Sets the counters of all ticks, when reports were added without counters (from a log).
  void set_counters(const StepCounters& counters) { counters_ = counters; }
  /// Are its lists consistent? For statistics that were read from a file.
  bool is_whole() const;

  std::uint64_t ticks() const { return ticks_; }
  const StepCounters& counters() const { return counters_; }  ///< summed over the session
  const std::map<std::pair<PartId, PartId>, Row>& by_pair() const { return by_pair_; }
  const std::map<PartId, Row>& by_part() const { return by_part_; }
  const std::map<UserId, Row>& by_user() const { return by_user_; }
  const std::map<ClashId, ClashRow>& clashes() const { return clashes_; }
  std::uint64_t rows_left_out() const { return rows_left_out_; }  ///< see keep_ended_rows()
  std::uint64_t clashes_open(CollisionClass c) const;
  std::uint64_t clashes_total(CollisionClass c) const;  ///< by worst class

 private:
  std::uint64_t ticks_ = 0;
  StepCounters counters_;
  std::map<std::pair<PartId, PartId>, Row> by_pair_;
  std::map<PartId, Row> by_part_;
  std::map<UserId, Row> by_user_;
  std::map<ClashId, ClashRow> clashes_;
  std::vector<ClashId> open_, ended_;     ///< of clashes_, by begin, by end
  std::array<std::uint64_t, 4> total_{};  ///< of all there were, by worst class
  std::uint64_t rows_left_out_ = 0;
  std::size_t most_ended_ = std::numeric_limits<std::size_t>::max();

  template <class Change>
  void for_rows_of(const ClashRow& clash, const Change& change);
  void take_in(const ClashEvent& event);
  void last_longer(std::uint64_t ticks);  ///< the open clashes
  void end(ClashRow& clash, std::uint64_t tick);
  void drop_old_rows();

  template <class Archive>
  friend void fields(Archive& archive, SessionStatistics& statistics);  ///< io/state_fields.h
};

/// Adds every count of `from` to `into`.
void accumulate(StepCounters& into, const StepCounters& from);

}  // namespace mortise
