#include "server/service_manager.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string_view>

namespace mortise {
namespace {

constexpr const char* kHour_us = "3600000000";

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// A datagram socket to the address, a path or "@" and an abstract name; -1: none.
int connected(std::string_view address) {
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  if (address.size() < 2 || address.size() >= sizeof to.sun_path) return -1;
  if (address.front() != '/' && address.front() != '@') return -1;
  std::memcpy(to.sun_path, address.data(), address.size());
  if (address.front() == '@') to.sun_path[0] = '\0';
  const int made = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address.size());
  if (made >= 0 && connect(made, reinterpret_cast<const sockaddr*>(&to), length) == 0) return made;
  if (made >= 0) close(made);
  return -1;
}

}  // namespace

ServiceManager::ServiceManager() : socket_(connected(environment("NOTIFY_SOCKET"))) {
  const std::string us(environment("WATCHDOG_USEC"));
  const std::string_view whom = environment("WATCHDOG_PID");
  const long long within_us = std::atoll(us.c_str());
  if (within_us <= 0 || (!whom.empty() && whom != std::to_string(getpid()))) return;
  watchdog_us_ = us;
  every_ = std::chrono::microseconds(within_us / 4);
}

ServiceManager::~ServiceManager() {
  if (socket_ >= 0) close(socket_);
}

void ServiceManager::say(const std::string& text) const {
  // What is not taken now is said again with a later tick; the first word is, too.
  if (socket_ >= 0) (void)!send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
}

void ServiceManager::ready(const std::string& status) { say("READY=1\nSTATUS=" + status); }

void ServiceManager::beat() {
  if (socket_ < 0 || watchdog_us_.empty()) return;
  const Clock::time_point now = Clock::now();
  if (!busy_ && said_at_ && now - *said_at_ < every_) return;
  said_at_ = now;
  say((busy_ ? "WATCHDOG_USEC=" + watchdog_us_ + "\n" : std::string()) + "WATCHDOG=1");
  busy_ = false;
}

void ServiceManager::busy() {
  if (watchdog_us_.empty()) return;
  busy_ = true;
  say(std::string("WATCHDOG_USEC=") + kHour_us + "\nWATCHDOG=1");
}

void ServiceManager::ends() {
  if (!watchdog_us_.empty()) busy();
  say("STOPPING=1");
}

}  // namespace mortise
