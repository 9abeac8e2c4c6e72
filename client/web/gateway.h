#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/web/feed.h"
#include "client/web/incidents.h"
#include "client/web/limits.h"
#include "client/web/page_files.h"
#include "client/web/tokens.h"

namespace mortise::web {

struct GatewayOptions {
  std::string address = "127.0.0.1";  ///< IPv4 to listen on
  int port = 0;                       ///< 0: a free one
  std::vector<std::string> names;     ///< hosts that we may be asked for under, beside numbers
  std::vector<std::string> origins;   ///< of pages of others that may connect, "https://host:port"
  std::string certificate, key;       ///< PEM files; empty: no TLS
  Limits limits;
  /// Makes the page that is downloaded as the report of the session; called in a thread of its own,
  /// once at a time. Empty: there is none to download.
  std::function<Result<std::string>()> report;
  double turn_s = 0.004;  ///< the feed is asked so often while somebody looks on
};

/// HTTP and WebSocket for pages, in one thread: that of run(). A client that is slow, stuck or
/// hostile costs a connection and a time limit.
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
  /// Serves until stop(), then takes leave of everybody.
  virtual void run() = 0;
  virtual void stop() = 0;  ///< from any thread
};

}  // namespace mortise::web
