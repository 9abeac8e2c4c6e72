// What a log takes on disk, and what writing it takes from the tick.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include "common/io/log/log_records.h"
#include "common/io/log/replay.h"
#include "tests/bench/records_sections.h"
#include "tests/bench/statistics.h"
#include "tests/network/program.h"

namespace mortise::bench {
namespace {

constexpr double kIncrementBar_bytes = 60.0, kMovedPartBar_bytes = 40.0;
constexpr double kMedianBar_percent = 1.0, kTickBar_ms = 0.5, kVerifyBar = 10.0;
// A message of MCAP around a record: opcode, length, channel, sequence, two times.
constexpr double kMessageBytes = 31.0;
constexpr SlowDisk kSlowDisk{0.005, 0.100};
constexpr double kTicksPerSecond = 2000.0;  // 33 times the pace of a session

double wall_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Sizes {
  double increments = 0, increment_bytes = 0, parts = 0, part_bytes = 0, messages = 0,
         part_messages = 0;
};

void add(Sizes& sizes, const TickRecord& tick) {
  if (!tick.increments.empty()) {
    sizes.increments += static_cast<double>(tick.increments.size());
    sizes.messages += 1.0;
    sizes.increment_bytes +=
        static_cast<double>(log_records::encode(tick.tick, std::span(tick.increments)).size());
  }
  if (!tick.report.moved.empty()) {
    sizes.parts += static_cast<double>(tick.report.moved.size());
    sizes.part_messages += 1.0;
    sizes.part_bytes +=
        static_cast<double>(log_records::encode(tick.tick, std::span(tick.report.moved)).size());
  }
}

// Every number of every increment is in use, after ten hours, among a thousand parts.
std::vector<TickRecord> busy_ticks(std::size_t users, std::size_t count) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  std::vector<TickRecord> ticks;
  for (std::size_t i = 0; i < count; ++i) {
    TickRecord tick;
    tick.tick = tick.report.tick = 2'000'000 + i;
    for (std::size_t user = 0; user < users; ++user) {
      const UserId id{static_cast<std::uint32_t>(1 + user)};
      const PartId part{static_cast<std::uint32_t>(1000 + user)};
      tick.increments.push_back({id, part, 2'000'000 + i, vector(), 0.01 * vector()});
      const Quat q(normal(random), normal(random), normal(random), normal(random));
      tick.report.moved.push_back({part, id, Pose{q.normalized(), 100.0 * vector()}});
    }
    ticks.push_back(std::move(tick));
  }
  return ticks;
}

}  // namespace

void section_size(Report& report, const RecordsOptions&) {
  report.table("Bytes before compression: of our records, and with the MCAP message around them",
               {"session", "increments", "bytes each", "with MCAP", "moved parts", "bytes each ",
                "with MCAP "});
  double increment = 0.0, part = 0.0, framed = 0.0, framed_part = 0.0;
  const auto row = [&](const std::string& name, const Sizes& s, bool is_alone) {
    const double bytes = s.increment_bytes / s.increments, part_bytes = s.part_bytes / s.parts;
    const double whole = bytes + kMessageBytes * s.messages / s.increments;
    const double whole_part = part_bytes + kMessageBytes * s.part_messages / s.parts;
    report.row({name, static_cast<long long>(s.increments), bytes, whole,
                static_cast<long long>(s.parts), part_bytes, whole_part});
    increment = std::max(increment, bytes);
    part = std::max(part, part_bytes);
    if (is_alone) return;
    framed = std::max(framed, whole);
    framed_part = std::max(framed_part, whole_part);
  };
  Sizes demo;
  if (const auto* session = demo_session())
    for (const TickRecord& tick : session->ticks) add(demo, tick);
  row("the demo, four users", demo, false);
  for (const std::size_t users : {1, 8, 64}) {
    Sizes sizes;
    for (const TickRecord& tick : busy_ticks(users, 200)) add(sizes, tick);
    row(std::to_string(users) + (users == 1 ? " user" : " users") + ", all six numbers", sizes,
        users == 1);
  }
  report.bar("bytes per increment", increment, kIncrementBar_bytes, BoundKind::kAtMost);
  report.bar("bytes per moved part and tick", part, kMovedPartBar_bytes, BoundKind::kAtMost);
  report.bar("bytes per increment with MCAP, several users", framed, kIncrementBar_bytes,
             BoundKind::kAtMost);
  report.bar("bytes per moved part and tick with MCAP, several users", framed_part,
             kMovedPartBar_bytes, BoundKind::kAtMost);
}

void section_cost(Report& report, const RecordsOptions& options) {
  const auto* session = demo_session();
  if (session == nullptr) return;
  // 1. What a whole tick of the demo takes in the server, without a log.
  const test::TestFolder folder;
  const std::string scenarios = std::string(MORTISE_SOURCE_DIR) + "/scenarios/";
  const std::vector<std::string> domain = {"--domain", "229", "--quiet"};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), domain.begin(), domain.end());
    return arguments;
  };
  test::Program server(
      folder.path(), "mortise-server",
      with({scenarios + "gearbox.yaml", "--no-log", "--json", "--duration", "30"}));
  test::Program bots(folder.path(), "mortise-bot",
                     with({"--wait", "10", "--behaviour", "script", "--play",
                           scenarios + "gearbox.play.yaml", "--duration", "28"}));
  bots.wait(60.0);
  server.wait(60.0);
  const auto closing = nlohmann::json::parse(server.out(), nullptr, false);
  if (!closing.is_object()) return report.note("the server did not end in order");
  const auto tick_us = [&](const char* what, const char* key) {
    return closing["times_us"][what][key].get<double>();
  };
  // 2. The same ticks recorded again and again, as the tick loop does it, on a slow disk.
  const ScratchFile file("cost.mcap");
  auto writer = SessionLogWriter::create(file.path(), session->header);
  if (!writer) return report.note("no log could be written: " + writer.error().text);
  make_slow(file.path(), kSlowDisk);
  std::vector<const TickRecord*> busy;
  for (const TickRecord& tick : session->ticks)
    if (!tick.increments.empty()) busy.push_back(&tick);
  const std::size_t count = options.quick ? 10'000 : 100'000;
  std::vector<double> cpu_s, wall, undisturbed;
  long long waits = 0;
  const double start_s = wall_s();
  for (std::size_t i = 0; i < count; ++i) {
    TickRecord tick = *busy[i % busy.size()];  // as the engine leaves it to the tick loop
    // Reading the clock of the CPU costs as much as recording: every other tick is held by one of
    // them.
    const bool by_cpu = i % 2 == 0;
    rusage before{}, after{};
    getrusage(RUSAGE_THREAD, &before);
    const double from_s = wall_s();
    const double from_cpu_s = by_cpu ? thread_cpu_s() : 0.0;
    TickRecord record = (*writer)->spare();
    record.tick = i + 1;
    record.time_ns = static_cast<std::int64_t>(static_cast<double>(i) / 60.0 * 1e9);
    record.decisions.swap(tick.decisions);
    record.increments.swap(tick.increments);
    record.report = std::move(tick.report);
    (*writer)->record(std::move(record));
    if (by_cpu)
      cpu_s.push_back(thread_cpu_s() - from_cpu_s);
    else
      wall.push_back(wall_s() - from_s);
    getrusage(RUSAGE_THREAD, &after);
    waits += after.ru_nvcsw - before.ru_nvcsw;
    if (!by_cpu && after.ru_nivcsw == before.ru_nivcsw) undisturbed.push_back(wall.back());
    const double due_s = start_s + static_cast<double>(i + 1) / kTicksPerSecond;
    if (const double left_s = due_s - wall_s(); left_s > 0.0)
      std::this_thread::sleep_for(std::chrono::duration<double>(left_s));
  }
  const std::uint64_t dropped = (*writer)->dropped_ticks();
  make_slow({}, {});
  (void)(*writer)->close();
  const SlowCalls slow = slow_calls();
  report.table("Recording one tick of the demo, us",
               {"what", "median", "p99", "p99.9", "longest", "ticks"});
  const auto row = [&](const std::string& what, const std::vector<double>& s) {
    report.row({what, 1e6 * median(s), 1e6 * quantile(s, 0.99), 1e6 * quantile(s, 0.999),
                1e6 * largest(s), static_cast<long long>(s.size())});
  };
  for (const char* what : {"tick", "step"})
    report.row({what == std::string("tick") ? "the whole tick in the server, wall"
                                            : "of it the engine, wall",
                tick_us(what, "p50"), tick_us(what, "p99"), std::string("–"), tick_us(what, "max"),
                static_cast<long long>(closing["times_us"][what]["count"].get<double>())});
  row("recording, CPU", cpu_s);
  row("recording, wall", wall);
  row("recording, wall, where the scheduler left it alone", undisturbed);
  report.note("the disk waited 5 ms in each of " + std::to_string(slow.writes) +
              " writes and 100 ms in each of " + std::to_string(slow.syncs) + " syncs; " +
              std::to_string(dropped) + " ticks were dropped; record() itself waited " +
              std::to_string(waits) + " times");
  report.bar("writes and syncs that the disk held up",
             static_cast<double>(slow.writes + slow.syncs), 10.0, BoundKind::kAtLeast);
  report.bar("recording, % of the whole tick of the demo, medians",
             100.0 * 1e6 * median(undisturbed) / tick_us("tick", "p50"), kMedianBar_percent,
             BoundKind::kAtMost);
  report.bar("recording, longest of any tick that the scheduler left alone, ms",
             1e3 * largest(undisturbed), kTickBar_ms, BoundKind::kAtMost);
  report.bar("recording, longest CPU time of any tick, ms", 1e3 * largest(cpu_s), kTickBar_ms,
             BoundKind::kAtMost);
}

void section_verify(Report& report, const RecordsOptions&) {
  const auto* session = demo_session();
  if (session == nullptr) return;
  const ScratchFile file("verify.mcap");
  if (const Status written = test::write_log(*session, file.path()); !written)
    return report.note(written.error().text);
  const double from_s = wall_s();
  const Stopwatch watch;
  const auto log = read_session_log(file.path());
  const auto replayed = log ? verify(*log, 1) : Result<ReplayReport>(log.error());
  const double cpu_s = watch.elapsed_s(), took_s = wall_s() - from_s;
  if (!replayed || replayed->difference) return report.note("the demo does not verify");
  const double ticks = static_cast<double>(session->ticks.back().tick);
  const double session_s = ticks / session->scene.world.tick_rate_hz;
  report.table("The demo computed again, log read included",
               {"session, s", "CPU, s", "wall, s", "times its own time"});
  report.row({session_s, cpu_s, took_s, session_s / cpu_s});
  report.bar("verify, times real time (CPU)", session_s / cpu_s, kVerifyBar, BoundKind::kAtLeast);
}

}  // namespace mortise::bench
