#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "common/base/result.h"
#include "server/metrics_text.h"

namespace mortise {

/// HTTP for monitoring: GET /metrics (Prometheus text) and GET /healthz (200 while ticks go on, 503
/// when none came for a while). Runs in its own thread: a slow, stuck or hostile client costs one
/// connection for a limited time, never a tick.
class MetricsEndpoint {
 public:
  /// port 0: a free one. Fails in one line when the address is not ours or the port is taken.
  static Result<std::unique_ptr<MetricsEndpoint>> open(const std::string& address, int port);
  virtual ~MetricsEndpoint() = default;  ///< ends the thread and all connections

  virtual int port() const = 0;
  /// Reports that the tick thread is alive. Costs one store.
  virtual void beat() = 0;
  /// Sets new figures for the next request. Never waits for a client.
  virtual void show(SessionFigures figures) = 0;
};

}  // namespace mortise
