#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/clock.h"
#include "server/held_channel.h"
#include "server/tick_loop.h"

namespace mortise {

/// The end of a server that was told to go (SIGUSR1) while its session is to stay: the one that
/// stands by goes on with it at once, or a server that is started on its log does so later.
class Drain {
 public:
  enum class End {
    kNone = 0,
    kHandedOver,  ///< another server leads the session
    kNotTaken,    ///< one that stood by was to, and does not: the log holds the session
    kAlone,       ///< nobody stood by, or was in step: the log holds the session
  };
  /// One that stands by and is not in step yet is waited for so long.
  static constexpr double kCatchUp_s = 10.0;

  /// All must outlive this.
  Drain(TickLoop& loop, HeldChannel& held, Clock& clock)
      : loop_(loop), held_(held), clock_(clock) {}

  /// Asked before each tick once the server was told to go: is this the moment?
  bool is_ready();
  bool begun() const { return begun_ns_.has_value(); }
  /// The last tick, and what comes after it. `goes_on`, asked while the other is waited for, says
  /// false where the server is to end at once.
  void finish(const std::function<bool()>& goes_on);

  End end() const { return end_; }
  /// For people: how it ended.
  std::string text(const std::string& session, const std::string& log_file) const;

 private:
  TickLoop& loop_;
  HeldChannel& held_;
  Clock& clock_;
  std::optional<std::int64_t> begun_ns_;
  bool not_in_step_ = false;  ///< one stood by, and did not come in step in time
  End end_ = End::kNone;
};

}  // namespace mortise
