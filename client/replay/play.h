#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "client/client.h"
#include "common/io/log/session_log_read.h"

namespace mortise {

struct PlayOptions {
  double speed = 1.0;   ///< 0.1 to 100
  double from_s = 0.0;  ///< of the log; what is before is played as fast as possible
  double to_s = std::numeric_limits<double>::infinity();
  double wait_s = 10.0;  ///< for the session, and for each user to be let in
};

/// The outcome of playing. Everything that was not done is counted.
struct PlayOutcome {
  std::uint64_t ticks = 0;
  std::uint64_t increments = 0;       ///< of the log
  std::uint64_t increments_sent = 0;  ///< fewer when played fast: those of one period are composed
  std::uint64_t increments_refused = 0, commands = 0, commands_refused = 0;
  std::uint64_t users_not_let_in = 0;
  std::uint64_t not_playable =
      0;                     ///< decisions that the server takes by itself, such as lease ends
  std::uint64_t events = 0;  ///< told while it played
  double took_s = 0.0, waited_s = 0.0;  ///< waited: for answers, beyond its own time
  std::vector<std::string> notes;       ///< refusals in words, the first few
};

/// Sends what the users of a log did to a live session again: the same users, commands and
/// increments, in their order, at speed times their pace. The session must have the same parts. It
/// is a session of its own: increments arrive in other ticks, so poses and clashes may differ in
/// the last digits, and beyond ×1 the server composes several increments in a tick. progress(s of
/// the log) is called now and then. Fails when there is no session, or one with other parts.
Result<PlayOutcome> play_log(const SessionLog& log, Client& client, const PlayOptions& options,
                             const std::function<void(double)>& progress = {});

}  // namespace mortise
