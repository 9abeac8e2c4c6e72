#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/clock.h"
#include "server/held_channel.h"
#include "server/tick_loop.h"

namespace mortise {

/// The end of a server that is drained (SIGUSR1) while its session continues: the standby takes
/// over at once, or a server that is started on its log continues later.
class Drain {
 public:
  enum class End {
    kNone = 0,
    kHandedOver,  ///< another server leads the session
    kNotTaken,    ///< the standby did not take over: the log holds the session
    kAlone,       ///< no standby in step: the log holds the session
  };
  /// How long a standby that is not in step yet is waited for.
  static constexpr double kCatchUp_s = 10.0;

  /// All must outlive this.
  Drain(TickLoop& loop, HeldChannel& held, Clock& clock)
      : loop_(loop), held_(held), clock_(clock) {}

  /// Asked before each tick of a draining server: is this the moment to leave?
  bool is_ready();
  bool begun() const { return begun_ns_.has_value(); }
  /// Does the last tick and waits for the standby. `goes_on` is asked meanwhile; false: end at
  /// once.
  void finish(const std::function<bool()>& goes_on);

  End end() const { return end_; }
  /// For people: how it ended.
  std::string text(const std::string& session, const std::string& log_file) const;

 private:
  TickLoop& loop_;
  HeldChannel& held_;
  Clock& clock_;
  std::optional<std::int64_t> begun_ns_;
  bool not_in_step_ = false;  ///< the standby did not come in step in time
  End end_ = End::kNone;
};

}  // namespace mortise
