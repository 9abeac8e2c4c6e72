#pragma once
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/network/program.h"

namespace mortise::bench {

using Json = nlohmann::json;

/// The one-minute load average of the machine: who else was working while this was measured.
double load_average();
double steady_s();
void sleep_s(double seconds);

/// A server as a program, on the demo scene or another, in a DDS domain of its own.
class BenchServer {
 public:
  explicit BenchServer(const std::string& scenario = "gearbox.yaml",
                       const std::vector<std::string>& more = {});
  int domain() const { return domain_; }
  double cpu_s() const { return program_->cpu_s(); }
  pid_t pid() const { return program_->pid(); }
  double resident_mb() const;
  std::string log() const;
  test::TestFolder& folder() { return folder_; }
  std::string errors() const { return program_->errors(); }
  /// A participant as a program, beside it.
  std::unique_ptr<test::Program> bots(std::vector<std::string> arguments);
  /// Kills it without warning and starts it again in the same domain, from its own log or from the
  /// scenario. Seconds of steady_s() when the new process was started.
  double restart(bool from_log);
  /// Ends it in order: its closing document; null when it did not end well.
  Json close();

 private:
  test::TestFolder folder_;
  int domain_;
  std::string scenario_;
  std::unique_ptr<test::Program> program_;
};

/// Memory over time, and how fast it grows.
struct MemorySlope {
  double first_mb = 0.0, last_mb = 0.0;
  double mb_per_h = 0.0;             ///< least squares over what came after the warm-up
  double resolution_mb_per_h = 0.0;  ///< what one page more over that time would show
  double seconds = 0.0;              ///< of that time
};
MemorySlope slope_of(const std::vector<std::pair<double, double>>& mb_at_s, double warm_up_s);

struct LoadShape {
  int processes = 1, users = 64;
  double rate_hz = 60.0, seconds = 30.0;
  double warm_up_s = 10.0;  ///< of these; then the slope of the memory is taken
  std::string behaviour = "mixed";
};
/// What one load brought, seen by the bots and by the server.
struct LoadResult {
  bool ran = false;
  std::string why_not;
  Json bots, server;
  MemorySlope memory, memory_of_warm_up;  ///< the latter from a third of it on
  double load_average_before = 0.0, load_average_after = 0.0;
  double missed_percent = 0.0;    ///< deadlines missed in the time of the load, of those due in it
  double ran_over_percent = 0.0;  ///< ticks that ran past the next deadline, of those due
  std::int64_t lost_increments = 0;  ///< acknowledged, but neither taken nor refused
  std::int64_t lost_commands = 0;    ///< acknowledged as done to the bots, not done by the server
  double at(const char* distribution, const char* percentile) const {
    return bots[distribution][percentile].get<double>();
  }
};
LoadResult run_load(const LoadShape& shape);

}  // namespace mortise::bench
