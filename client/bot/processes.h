#pragma once
#include <functional>
#include <vector>

#include "client/bot/load_report.h"

namespace mortise {

/// Runs `work(k)` in `count` processes, k = 0 .. count - 1, and gathers their reports. Call it
/// before any thread is started. SIGINT and SIGTERM are forwarded to the processes. Prints when a
/// process ends without a report; returns the worst exit code.
int run_processes(int count, const std::function<int(int, ProcessReport&)>& work,
                  std::vector<ProcessReport>& reports);

}  // namespace mortise
