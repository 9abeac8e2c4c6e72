#pragma once
#include <cstddef>

namespace mortise::web {

/// Limits for strangers. Every refusal by one of them is counted and logged.
struct Limits {
  std::size_t connections = 256;    ///< open at one time; beyond, the oldest idle one gives way
  std::size_t browsers = 64;        ///< WebSockets at one time
  std::size_t header_bytes = 8192;  ///< of a request
  std::size_t message_bytes = 16384;
  std::size_t upload_bytes = 128u << 20;         ///< of a mesh file, as the server's own limit
  std::size_t uploads_of_page = 4;               ///< files that are asked for and not here yet
  std::size_t upload_bytes_in_all = 512u << 20;  ///< of all such files
  double messages_per_s = 300.0;                 ///< of one browser; a burst may have twice as many
  std::size_t bad_messages = 5;                  ///< in 10 s, then it is closed
  double views_per_s = 10.0;                     ///< how often a browser's view is forwarded
  std::size_t unsent_bytes = 8u << 20;           ///< of text that a browser does not take
  double request_s = 5.0;   ///< for a whole request, a TLS or WebSocket handshake
  double idle_s = 30.0;     ///< between two requests; for taking an answer
  double stalled_s = 10.0;  ///< for taking one WebSocket message
  double silent_s = 20.0;   ///< without anything, pongs included
};

/// Tokens that refill at `per_s` up to `burst`; each message takes one.
class Rate {
 public:
  Rate(double per_s, double burst) : per_s_(per_s), burst_(burst), tokens_(burst) {}
  bool take(double now_s) {
    if (last_s_ > 0.0) tokens_ = tokens_ + (now_s - last_s_) * per_s_;
    if (tokens_ > burst_) tokens_ = burst_;
    last_s_ = now_s;
    if (tokens_ < 1.0) return false;
    tokens_ -= 1.0;
    return true;
  }

 private:
  double per_s_, burst_, tokens_, last_s_ = 0.0;
};

}  // namespace mortise::web
