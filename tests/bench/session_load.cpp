#include "tests/bench/session_load.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

namespace mortise::bench {
namespace {

// A scenario of the house that anyone may play in: its list of users is left out, for it has fewer
// than a load.
std::string open_to_all(test::TestFolder& folder, const std::string& name) {
  const std::filesystem::path of_house = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios";
  std::ifstream in(of_house / name);  // `name` as it is, when it is absolute
  std::string text, line;
  bool in_users = false;
  while (std::getline(in, line)) {
    const bool top_level = !line.empty() && line[0] != ' ' && line[0] != '#' && line[0] != '-';
    if (top_level) in_users = line.starts_with("users:");
    if (!in_users) text += line + "\n";
  }
  return folder.write(std::filesystem::path(name).filename().string(), text);
}

// A domain a server, so that none hears what an earlier one left behind.
int next_domain() {
  static int domain = 100 + static_cast<int>(getpid() % 40);
  return domain++;
}

std::int64_t sum_of(const Json& counts) {
  std::int64_t sum = 0;
  for (const auto& [key, count] : counts.items()) sum += count.get<std::int64_t>();
  return sum;
}

}  // namespace

double load_average() {
  double load = 0.0;
  return getloadavg(&load, 1) == 1 ? load : -1.0;
}

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

BenchServer::BenchServer(const std::string& scenario, const std::vector<std::string>& more)
    : domain_(next_domain()), scenario_(open_to_all(folder_, scenario)) {
  std::vector<std::string> arguments = {
      scenario_, "--domain", std::to_string(domain_), "--log", log(), "--json", "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  program_ = std::make_unique<test::Program>(folder_.path(), "mortise-server", arguments);
}

double BenchServer::restart(bool from_log) {
  program_->signal(SIGKILL);
  program_->wait(10.0);
  std::vector<std::string> arguments = {"--domain", std::to_string(domain_), "--json", "--quiet"};
  if (from_log) {
    arguments.insert(arguments.end(),
                     {"--restore", log(), "--log", (folder_.path() / "restored.mcap").string()});
  } else {
    arguments.insert(arguments.begin(), {scenario_, "--no-log"});
  }
  const double start_s = steady_s();
  program_ = std::make_unique<test::Program>(folder_.path(), "mortise-server", arguments);
  return start_s;
}

std::string BenchServer::log() const { return (folder_.path() / "session.mcap").string(); }

double BenchServer::resident_mb() const {
  std::ifstream statm("/proc/" + std::to_string(program_->pid()) + "/statm");
  double total = 0.0, resident = 0.0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

std::unique_ptr<test::Program> BenchServer::bots(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(),
                   {"--domain", std::to_string(domain_), "--wait", "60", "--json", "--quiet"});
  return std::make_unique<test::Program>(folder_.path(), "mortise-bot", arguments);
}

Json BenchServer::close() {
  program_->signal(SIGTERM);
  if (program_->wait(60) != 0) return nullptr;
  return Json::parse(program_->out(), nullptr, false);
}

MemorySlope slope_of(const std::vector<std::pair<double, double>>& mb_at_s, double warm_up_s) {
  MemorySlope slope;
  double n = 0.0, t = 0.0, m = 0.0, tt = 0.0, tm = 0.0;
  double first_s = 0.0, last_s = 0.0;
  for (const auto& [time_s, mb] : mb_at_s) {
    if (time_s < warm_up_s) continue;
    if (n == 0.0) {
      slope.first_mb = mb;
      first_s = time_s;
    }
    slope.last_mb = mb;
    last_s = time_s;
    n += 1.0;
    t += time_s;
    m += mb;
    tt += time_s * time_s;
    tm += time_s * mb;
  }
  slope.seconds = last_s - first_s;
  const double spread = n * tt - t * t;
  if (!(slope.seconds > 0.0) || !(spread > 0.0)) return slope;
  slope.mb_per_h = 3600.0 * (n * tm - t * m) / spread;
  slope.resolution_mb_per_h =
      3600.0 * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6 / slope.seconds;
  return slope;
}

LoadResult run_load(const LoadShape& shape) {
  LoadResult result;
  result.load_average_before = load_average();
  BenchServer server;
  const auto text = [](double value) { return std::to_string(value); };
  auto bots = server.bots({"--processes", std::to_string(shape.processes), "--users",
                           std::to_string(shape.users), "--rate", text(shape.rate_hz), "--seconds",
                           text(shape.seconds), "--behaviour", shape.behaviour, "--seed", "1"});
  std::vector<std::pair<double, double>> mb_at_s;
  const double start_s = steady_s();
  while (bots->running() && steady_s() - start_s < shape.seconds + 180.0) {
    mb_at_s.emplace_back(steady_s() - start_s, server.resident_mb());
    sleep_s(0.5);
  }
  const int exit_code = bots->wait(1.0);
  result.load_average_after = load_average();
  result.server = server.close();
  result.bots = Json::parse(bots->out(), nullptr, false);
  if (exit_code != 0 || !result.bots.is_object() || !result.server.is_object()) {
    result.why_not = "bots ended with " + std::to_string(exit_code) + ": " + bots->errors() +
                     "; server: " + server.errors();
    return result;
  }
  result.ran = true;
  result.memory = slope_of(mb_at_s, shape.warm_up_s);
  std::erase_if(mb_at_s, [&](const auto& at) { return at.first > shape.warm_up_s; });
  result.memory_of_warm_up = slope_of(mb_at_s, shape.warm_up_s / 3.0);
  const Json &b = result.bots, &s = result.server;
  // Held against the ticks of the load alone: the quiet seconds around it would flatter.
  const double due = shape.seconds * s["tick_rate_hz"].get<double>();
  result.missed_percent = 100.0 * s["missed_deadlines"].get<double>() / due;
  result.ran_over_percent = 100.0 * s["overloads"].get<double>() / due;
  // Acknowledged: told by the server to be taken or refused, one by one or by a later one.
  const std::int64_t acknowledged =
      b["sent"].get<std::int64_t>() - b["unacknowledged_increments"].get<std::int64_t>();
  const std::int64_t known =
      s["inbox"]["accepted"].get<std::int64_t>() + sum_of(s["inbox"]["refused"]);
  result.lost_increments = std::max<std::int64_t>(0, acknowledged - known);
  const std::int64_t done = s["inbox"]["commands"].get<std::int64_t>() -
                            s["inbox"]["commands_refused"].get<std::int64_t>();
  result.lost_commands =
      std::max<std::int64_t>(0, b["commands_accepted"].get<std::int64_t>() - done);
  return result;
}

}  // namespace mortise::bench
