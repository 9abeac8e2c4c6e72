// What is left of a log: after kill -9 of its writer, cut short anywhere, with a bit turned.
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <thread>

#include "common/io/log/replay.h"
#include "tests/bench/records_sections.h"

namespace mortise::bench {
namespace {

constexpr int kKills = 20, kDamages = 1000;
constexpr double kMostLost_s = 1.0;

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Writes the demo at its own pace for ever after; how far it came is told through a pipe.
[[noreturn]] void write_at_pace(const test::PlayedSession& session,
                                const std::filesystem::path& file, int pipe) {
  auto writer = SessionLogWriter::create(file, session.header);
  if (!writer) _exit(1);
  const auto start = std::chrono::steady_clock::now();
  for (const TickRecord& tick : session.ticks) {
    std::this_thread::sleep_until(start + std::chrono::microseconds(tick.tick * 1'000'000 / 60));
    (*writer)->record(tick);
    const std::uint64_t number = tick.tick;
    if (write(pipe, &number, sizeof number) != sizeof number) _exit(2);
  }
  for (;;) pause();
}

struct Killed {
  std::uint64_t recorded = 0, read = 0, verified = 0;
  bool opened = false, agrees = false;
};

Killed kill_once(const test::PlayedSession& session, double after_s) {
  const ScratchFile file("killed.mcap");
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) write_at_pace(session, file.path(), pipe_ends[1]);
  close(pipe_ends[1]);
  std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  Killed killed;
  for (std::uint64_t tick = 0; read(pipe_ends[0], &tick, sizeof tick) == sizeof tick;)
    killed.recorded = tick;
  close(pipe_ends[0]);
  const auto log = read_session_log(file.path());
  if (!log) return killed;
  killed.opened = true;
  killed.read = log->ticks.empty() ? 0 : log->ticks.back().tick;
  const auto report = verify(*log, 1);
  killed.agrees = report && !report->difference && report->not_verifiable.empty();
  if (report) killed.verified = report->verified_to_tick;
  return killed;
}

// What was written, to hold against what is read.
struct Truth {
  std::map<std::uint64_t, std::uint64_t> hash;  // by tick
  std::map<std::uint64_t, std::size_t> events, increments;
  std::string scenario;
};

// Empty: an error, or a log of which every tick is as it was written and the rest is said to be
// missing.
std::string silent_fault(const std::filesystem::path& file, const Truth& truth, bool& opened) {
  const auto log = read_session_log(file);
  opened = static_cast<bool>(log);
  if (!log) return log.error().text.empty() ? "an error without a word" : "";
  // A channel's name stands outside of the chunks: with a bit of it turned its records are unknown,
  // and the checksum of the data section says so.
  const bool said = !log->notes.empty();
  for (const TickRecord& tick : log->ticks) {
    const auto known = truth.hash.find(tick.tick);
    if (known == truth.hash.end()) return "a tick that was never written";
    if (known->second != tick.report.state_hash) return "another state hash";
    if (said) continue;
    if (truth.events.at(tick.tick) != tick.report.events.size()) return "other events";
    if (truth.increments.at(tick.tick) != tick.increments.size()) return "other increments";
  }
  if (log->scenario_yaml != truth.scenario) return "another scenario";
  const bool all = log->ticks.size() == truth.hash.size();
  if (!all && log->complete && log->gaps.empty() && log->notes.empty())
    return "ticks are missing in silence";
  return "";
}

struct Damaged {
  long long opened = 0, refused = 0, silent = 0;
  std::string first_silent;
};

template <class Damage>
Damaged damage(const std::string& bytes, const Truth& truth, const Damage& change) {
  const ScratchFile file("damaged.mcap");
  Damaged result;
  for (int i = 0; i < kDamages; ++i) {
    std::string changed = bytes;
    change(changed);
    std::ofstream(file.path(), std::ios::binary) << changed;
    bool opened = false;
    const std::string fault = silent_fault(file.path(), truth, opened);
    ++(opened ? result.opened : result.refused);
    if (fault.empty()) continue;
    ++result.silent;
    if (result.first_silent.empty()) result.first_silent = fault;
  }
  return result;
}

}  // namespace

void section_killed(Report& report, const RecordsOptions& options) {
  const auto* session = demo_session();
  if (session == nullptr) return;
  std::mt19937_64 random(9);
  const double longest_s = options.quick ? 3.0 : 12.0;
  std::uniform_real_distribution<double> moment(0.2, longest_s);
  long long opened = 0, agrees = 0;
  double most_lost_s = 0.0;
  for (int i = 0; i < kKills; ++i) {
    const Killed killed = kill_once(*session, moment(random));
    opened += killed.opened;
    agrees += killed.agrees && killed.verified == killed.read;
    most_lost_s = std::max(most_lost_s, static_cast<double>(killed.recorded - killed.read) / 60.0);
  }
  report.table("kill -9 of the writer at random moments",
               {"kills", "logs that open", "verified to their end", "most lost, s"});
  report.row({static_cast<long long>(kKills), opened, agrees, most_lost_s});
  report.bar("logs that open after kill -9, of 20", static_cast<double>(opened), kKills,
             BoundKind::kAtLeast);
  report.bar("logs that verify up to there, of 20", static_cast<double>(agrees), kKills,
             BoundKind::kAtLeast);
  report.bar("most that was lost to kill -9, s", most_lost_s, kMostLost_s, BoundKind::kAtMost);
}

void section_damaged(Report& report, const RecordsOptions&) {
  const auto* session = demo_session();
  if (session == nullptr) return;
  const ScratchFile file("whole.mcap");
  if (const Status written = test::write_log(*session, file.path()); !written)
    return report.note(written.error().text);
  Truth truth;
  truth.scenario = session->header.scenario_yaml;
  for (const TickRecord& tick : session->ticks) {
    truth.hash[tick.tick] = tick.report.state_hash;
    truth.events[tick.tick] = tick.report.events.size();
    truth.increments[tick.tick] = tick.increments.size();
  }
  const std::string bytes = bytes_of(file.path());
  std::mt19937_64 random(10);
  const auto cut = [&](std::string& text) { text.resize(random() % text.size()); };
  const auto flip = [&](std::string& text) {
    const std::size_t at = random() % text.size();
    text[at] = static_cast<char>(text[at] ^ (1 << random() % 8));
  };
  report.table("Damage to the log of the demo, 1000 each",
               {"damage", "opened", "refused in a line", "silently wrong"});
  const Damaged cuts = damage(bytes, truth, cut), flips = damage(bytes, truth, flip);
  report.row({std::string("cut short"), cuts.opened, cuts.refused, cuts.silent});
  report.row({std::string("a bit turned"), flips.opened, flips.refused, flips.silent});
  for (const Damaged& damaged : {cuts, flips})
    if (damaged.silent > 0) report.note("silently wrong: " + damaged.first_silent);
  report.bar("damaged logs that are silently wrong, of 2000",
             static_cast<double>(cuts.silent + flips.silent), 0.0, BoundKind::kAtMost);
}

}  // namespace mortise::bench
