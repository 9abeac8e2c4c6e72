#pragma once
#include <cstdint>
#include <string>

#include "common/io/report_json.h"
#include "server/tick_loop.h"

namespace mortise {

/// One line about the running session: tick, users, open clashes by class, tick p99.
std::string live_line(const SessionPulse& pulse, double seconds);

/// Prints the news of a tick: users who join and leave, clashes that begin and end, refusals and
/// overloads at most once a second, and optionally the live line: overwritten on a terminal,
/// otherwise one line every five seconds.
class Announcer {
 public:
  Announcer(bool live, bool quiet);
  void after_tick(const TickLoop& loop);
  void finish();  ///< ends the live line

 private:
  void say_people(const TickLoop& loop);
  void say_clashes(const TickLoop& loop);
  void say_trouble(const TickLoop& loop);
  void say_live(const TickLoop& loop);
  void clear_line();

  bool live_, quiet_, terminal_;
  bool line_open_ = false;
  bool log_failed_ = false;  ///< said once
  double trouble_at_s_ = 0.0, live_at_s_ = -1e9;
  std::uint64_t refused_ = 0, missed_ = 0, overloads_ = 0, not_examined_ = 0, dropped_ = 0;
  std::uint64_t turned_away_said_ = 0;
};

}  // namespace mortise
