#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/io/mesh/mesh_import.h"
#include "common/messages/report.h"

/// The JSON records of a session log: those that viewers open directly.
namespace mortise::log_json {

/// One clash event; doubles are written so that they read back to the last bit. JSON has no
/// infinity: null means "no limit on this side".
std::string encode(const ClashEvent& event);
/// Accepts any text; false when it is no clash event. Unknown keys are ignored.
bool decode(std::string_view text, ClashEvent& event);
/// Names the first key whose value differs, with both values; empty when the events are the same.
std::string first_difference(const ClashEvent& logged, const ClashEvent& computed);

/// What the engine took for the recorded ticks of about a second.
struct TickTimes {
  std::uint64_t first_tick = 0, last_tick = 0, ticks = 0;
  double sum_us = 0.0, max_us = 0.0;
};

/// Sums of the counters of several ticks, for the topic /statistics.
class CounterSums {
 public:
  /// step_ns: what the engine took for the tick; 0: not measured.
  void add(const StepReport& report, std::int64_t step_ns);
  bool empty() const { return ticks_ == 0; }
  std::string encode() const;  ///< adds first_tick, last_tick, ticks and step_us
 private:
  std::uint64_t ticks_ = 0, first_tick_ = 0, last_tick_ = 0, events_ = 0;
  std::int64_t step_ns_ = 0, longest_ns_ = 0;
  StepCounters sums_;
};
/// What such a record says of times; false: it is none, or nothing was measured.
bool decode(std::string_view text, TickTimes& times);

/// Ticks that are missing from the log, and why. last_tick 0: not known how many.
struct Gap {
  std::uint64_t first_tick = 0, last_tick = 0, ticks = 0;
  std::string reason;
};
std::string encode(const Gap& gap);
bool decode(std::string_view text, Gap& gap);

std::string encode(const ImportReport& report);
bool decode(std::string_view text, ImportReport& report);

/// JSON schemas of the topics, made from the encoders.
std::string clash_schema();
std::string statistics_schema();
std::string gap_schema();

}  // namespace mortise::log_json
