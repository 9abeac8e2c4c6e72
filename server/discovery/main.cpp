#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>

#include "common/io/progress_log.h"
#include "server/discovery/options.h"
#include "server/discovery/report.h"

namespace {

constexpr double kTurn_s = 0.1;  // a signal is looked for so often
volatile std::sig_atomic_t stop_asked = 0;
void ask_to_stop(int) { stop_asked = 1; }

}  // namespace

int main(int argc, char** argv) {
  const mortise::DiscoveryCommand command = mortise::read_discovery_command(argc, argv);
  if (command.exit_code >= 0) return command.exit_code;
  mortise::begin_progress_log("mortise-discovery", command.quiet);
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);

  const auto opened = mortise::DiscoveryServer::open(command.where);
  if (!opened) {
    mortise::log_error("{}", opened.error().text);
    return mortise::exit_code_of(opened.error().code);
  }
  mortise::DiscoveryServer& server = **opened;
  mortise::log_info("hears at {}; servers and clients name it with --discovery-server",
                    server.place());
  using Clock = std::chrono::steady_clock;
  const auto left_s = [&command, begun = Clock::now()] {
    const std::chrono::duration<double> past = Clock::now() - begun;
    return command.duration_s > 0.0 ? command.duration_s - past.count() : kTurn_s;
  };
  while (stop_asked == 0 && left_s() > 0.0)
    server.run_for(std::min(kTurn_s, left_s()), [](bool is_warning, const std::string& line) {
      mortise::log_text(is_warning ? mortise::LogLevel::kWarning : mortise::LogLevel::kInfo, line);
    });
  const mortise::DiscoveryCounts counts = server.counts();
  std::fputs((command.json ? discovery_json(counts) : discovery_text(counts)).c_str(), stdout);
  return mortise::kExitOk;
}
