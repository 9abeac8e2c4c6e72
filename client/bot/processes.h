#pragma once
#include <functional>
#include <vector>

#include "client/bot/load_report.h"

namespace mortise {

/// Runs `work(k)` in `count` processes of their own, k = 0 .. count - 1, and gathers their reports.
/// To be called before there is any thread. SIGINT and SIGTERM are passed on to the processes.
/// A process that ends without a report is said aloud; the worst exit code is returned.
int run_processes(int count, const std::function<int(int, ProcessReport&)>& work,
                  std::vector<ProcessReport>& reports);

}  // namespace mortise
