#pragma once
#include <functional>
#include <thread>

#include "client/web/stream.h"
#include "common/base/result.h"

namespace mortise::web {

/// Makes one report at a time, beside the gateway's thread: seconds for a long session.
class ReportMaker {
 public:
  using Make = std::function<Result<std::string>()>;
  using Done = std::function<void(Result<std::string>)>;

  bool is_busy() const { return busy_; }
  /// Runs `make` in another thread and then posts `done` to `where`. Not while busy.
  void start(asio::any_io_executor where, Make make, Done done);
  /// Waits until the present report is finished.
  void finish();

 private:
  std::jthread thread_;
  bool busy_ = false;  // touched by the gateway's thread only
};

}  // namespace mortise::web
