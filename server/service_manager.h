#pragma once
#include <chrono>
#include <optional>
#include <string>

namespace mortise {

/// Tells systemd (sd_notify(3), Type=notify) that the server is up, and with each tick that ticks
/// go on (WatchdogSec=). Does nothing where no service manager listens ($NOTIFY_SOCKET).
class ServiceManager {
 public:
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// Up, and what it does, in words.
  void ready(const std::string& status);
  /// Ticks go on; said a few times within the time that the manager gave.
  void beat();
  /// What follows has no ticks and may take long: a log is read and played again. beat() ends it.
  void busy();
  void ends();

 private:
  using Clock = std::chrono::steady_clock;
  void say(const std::string& text) const;

  int socket_ = -1;
  std::string watchdog_us_;  ///< as the manager gave it; empty: it does not watch
  Clock::duration every_{};
  std::optional<Clock::time_point> said_at_;
  bool busy_ = false;
};

}  // namespace mortise
