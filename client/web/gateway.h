#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/web/feed.h"
#include "client/web/incidents.h"
#include "client/web/limits.h"
#include "client/web/page_files.h"
#include "client/web/tokens.h"

namespace mortise::web {

/// A clash, as it was judged last up to a tick.
struct WantedPicture {
  std::uint32_t clash = 0;
  std::optional<std::uint64_t> until_tick;
};

/// Two parts, as they stand after a tick, or now.
struct WantedGap {
  std::uint32_t a = 0, b = 0;
  std::optional<std::uint64_t> tick;
};

struct GatewayOptions {
  std::string address = "127.0.0.1";  ///< IPv4 to listen on
  int port = 0;                       ///< 0: a free one
  std::vector<std::string> names;     ///< host names that requests may use, beside addresses
  std::vector<std::string> origins;   ///< foreign pages that may connect, "https://host:port"
  std::string certificate, key;       ///< PEM files; empty: no TLS
  Limits limits;
  /// Makes the report of the session for download; called in another thread, one call at a time.
  /// Empty: no report.
  std::function<Result<std::string>()> report;
  /// The same of the session's log up to now, from which it can go on.
  std::function<Result<std::string>()> log;
  /// The same of the session as a scenario with its meshes, in an archive.
  std::function<Result<std::string>()> scenario;
  /// The same of a clash's picture, as SVG; kNotFound where the log does not have that clash.
  std::function<Result<std::string>(const WantedPicture&)> picture;
  /// The same of the gap of two parts, as JSON; kNotFound where one of them is not there.
  std::function<Result<std::string>(const WantedGap&)> gap;
  double turn_s = 0.004;  ///< time between two turns of the feed while a browser is connected
};

/// HTTP and WebSocket for pages, in the thread that calls run(). A slow, stuck or hostile client
/// costs one connection for a limited time.
class Gateway {
 public:
  /// The feed must outlive the gateway. Fails in one line when the address is not ours, the port
  /// is taken, or the certificate cannot be used.
  static Result<std::unique_ptr<Gateway>> open(const GatewayOptions& options, const Tokens& tokens,
                                               PageFiles page, Feed& feed, Incidents::Say say);
  virtual ~Gateway() = default;

  virtual int port() const = 0;
  /// What to give to people: "http://127.0.0.1:8080/#token=...".
  virtual std::string address(const std::string& token) const = 0;
  /// Serves until stop(), then closes all connections in order.
  virtual void run() = 0;
  virtual void stop() = 0;  ///< from any thread
};

}  // namespace mortise::web
