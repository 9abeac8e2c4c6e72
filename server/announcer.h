#pragma once
#include <cstdint>
#include <istream>
#include <map>
#include <string>
#include <vector>

#include "common/io/report_json.h"
#include "server/console.h"
#include "server/tick_loop.h"
#include "server/waiting_news.h"

namespace mortise {

/// One line about the running session: time, users, open clashes by class, tick p99.
std::string live_line(const SessionPulse& pulse, double seconds);

/// What the gateway for browsers has written, "ROLE [NAME] ADDRESS" a line, for people. The one
/// to take part by comes last.
std::vector<std::string> address_lines(std::istream& written);

struct AnnouncerOptions {
  bool live = false, quiet = false;
  std::string addresses;  ///< file of the gateway for browsers, there or not yet; empty: none
};

/// Says the news of a tick: users who join and leave, clashes that begin, get worse and end, pairs
/// that wait, refusals and overloads at most once a second, and optionally the live line: below all
/// messages on a terminal, otherwise one line every five seconds.
class Announcer {
 public:
  /// `console` may be null (messages are no text for a terminal); it must outlive this.
  Announcer(AnnouncerOptions options, Console* console);
  void after_tick(const TickLoop& loop);
  void finish();  ///< the live line is left where it is

 private:
  void say_people(const TickLoop& loop);
  void say_clashes(const TickLoop& loop);
  void say_clash(const ClashEvent& event, const World& world, const SessionNames& names);
  void say_end(const ClashEvent& event, const World& world, const SessionNames& names);
  void say_trouble(const TickLoop& loop);
  void say_log(const TickLoop& loop);
  void say_live(const TickLoop& loop);
  void say_line(const std::string& line, CollisionClass collision_class) const;

  AnnouncerOptions options_;
  Console* console_;
  ConsoleStyle style_;
  WaitingNews waiting_;
  std::map<ClashId, CollisionClass> worst_said_;  ///< of clashes that are open
  std::vector<std::string> addresses_;
  bool log_failed_ = false;  ///< said once
  double trouble_at_s_ = 0.0, live_at_s_ = -1e9;
  std::uint64_t refused_ = 0, missed_ = 0, overloads_ = 0, dropped_ = 0;
  std::uint64_t turned_away_said_ = 0;
};

}  // namespace mortise
