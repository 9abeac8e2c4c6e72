#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "common/base/result.h"
#include "server/metrics_text.h"

namespace mortise {

/// HTTP for those who watch the server: GET /metrics (Prometheus text) and GET /healthz (200 while
/// ticks go on, 503 when none came for a while). One thread of its own: a client that is slow,
/// stuck or hostile costs a connection and a time limit, never a tick.
class MetricsEndpoint {
 public:
  /// port 0: a free one. Fails in one line when the address is not ours or the port is taken.
  static Result<std::unique_ptr<MetricsEndpoint>> open(const std::string& address, int port);
  virtual ~MetricsEndpoint() = default;  ///< ends the thread and all connections

  virtual int port() const = 0;
  /// The tick thread lives. Costs one store.
  virtual void beat() = 0;
  /// New figures for whoever asks next. Never waits for a client.
  virtual void show(SessionFigures figures) = 0;
};

}  // namespace mortise
