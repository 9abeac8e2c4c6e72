// A long session for people: one hour of eight users at 60 Hz.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>

#include "tests/bench/records_sections.h"

namespace mortise::bench {
namespace {

constexpr double kExportBar_s = 60.0, kExportBar_mb = 1000.0;
constexpr int kUsers = 8;

// Events of the demo, as clashes that begin, change and end again and again.
std::vector<ClashEvent> verdicts_of(const test::PlayedSession& session) {
  std::vector<ClashEvent> events;
  for (const TickRecord& tick : session.ticks)
    for (const ClashEvent& event : tick.report.events)
      if (event.kind == ClashEvent::Kind::kBegin) events.push_back(event);
  return events;
}

// Each user moves a part in every tick, and has a clash of five seconds in every ten.
Status write_hour(const test::PlayedSession& session, const std::filesystem::path& file,
                  std::uint64_t ticks) {
  LogOptions options;
  options.queue_ticks = ticks;  // it comes faster than any session
  auto writer = SessionLogWriter::create(file, session.header, options);
  if (!writer) return writer.error();
  std::vector<PartId> moving;
  for (const Part& part : session.scene.world.parts)
    if (part.moving) moving.push_back(part.id);
  const std::vector<ClashEvent> verdicts = verdicts_of(session);
  if (verdicts.empty() || moving.size() < kUsers)
    return fail(Code::kRuntime, "the demo has no clashes to repeat");
  std::uint64_t event_seq = 0;
  std::uint32_t clash = 0;
  std::vector<ClashEvent> open(kUsers);
  for (std::uint64_t t = 1; t <= ticks; ++t) {
    TickRecord tick;
    tick.tick = tick.report.tick = t;
    tick.time_ns = static_cast<std::int64_t>(static_cast<double>(t) / 60.0 * 1e9);
    for (int user = 0; user < kUsers; ++user) {
      const UserId id{static_cast<std::uint32_t>(user + 1)};
      const PartId part = moving[static_cast<std::size_t>(user)];
      if (t == 1) {
        Decision join;
        join.kind = Decision::Kind::kJoin;
        join.user = id;
        join.role = Role::kDesigner;
        join.user_name = "user " + std::to_string(user + 1);
        tick.decisions.push_back(join);
      }
      const double angle = 0.01 * static_cast<double>(t) + user;
      tick.increments.push_back({id, part, t,
                                 Vec3(0.1 * std::sin(angle), 0.1 * std::cos(angle), 0.01),
                                 Vec3(0, 0, 0.001)});
      const Pose X = Pose::translation(Vec3(100 * std::sin(angle), 100 * std::cos(angle), 50));
      tick.report.moved.push_back({part, id, X});
      const std::uint64_t phase = (t + 75u * static_cast<unsigned>(user)) % 600;
      if (phase != 0 && phase != 150 && phase != 300) continue;
      ClashEvent& event = open[static_cast<std::size_t>(user)];
      if (phase == 0) {
        event = verdicts[clash % verdicts.size()];
        event.clash = ClashId{++clash};
        event.begin_tick = t;
        event.user = id;
      } else if (!event.clash) {
        continue;
      }
      event.kind = phase == 0     ? ClashEvent::Kind::kBegin
                   : phase == 150 ? ClashEvent::Kind::kChange
                                  : ClashEvent::Kind::kEnd;
      event.tick = t;
      event.seq = ++event_seq;
      tick.report.events.push_back(event);
    }
    (*writer)->record(std::move(tick));
  }
  return (*writer)->close();
}

struct Run {
  int exit_code = -1;
  double wall_s = 0.0, cpu_s = 0.0, most_mb = 0.0;
};

Run run(const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const auto from = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    execv(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) != child) return {};
  Run result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
  result.cpu_s = static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                 1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
  result.most_mb = static_cast<double>(used.ru_maxrss) / 1024.0;
  return result;
}

}  // namespace

void section_hour(Report& report, const RecordsOptions& options) {
  const auto* session = demo_session();
  if (session == nullptr) return;
  const std::uint64_t ticks = options.quick ? 21'600 : 216'000;
  const ScratchFile log("hour.mcap"), html("hour.html"), sqlite("hour.db");
  if (const Status written = write_hour(*session, log.path(), ticks); !written)
    return report.note(written.error().text);
  const Run both =
      run({std::string(MORTISE_BIN_DIR) + "/mortise-replay", "export", log.path().string(),
           "--html", html.path().string(), "--sqlite", sqlite.path().string()});
  if (both.exit_code != 0) {
    report.note("export ended with " + std::to_string(both.exit_code));
    return report.bar("export ran", 0.0, 1.0, BoundKind::kAtLeast);
  }
  const auto mb = [](const std::filesystem::path& file) {
    return static_cast<double>(std::filesystem::file_size(file)) * 1e-6;
  };
  report.table(
      options.quick ? "Six minutes of eight users at 60 Hz" : "One hour of eight users at 60 Hz",
      {"log, MB", "page, MB", "database, MB", "wall, s", "CPU, s", "memory, MB"});
  report.row(
      {mb(log.path()), mb(html.path()), mb(sqlite.path()), both.wall_s, both.cpu_s, both.most_mb});
  report.bar("an hour to page and database, s (CPU)", both.cpu_s, kExportBar_s, BoundKind::kAtMost);
  report.bar("an hour to page and database, MB", both.most_mb, kExportBar_mb, BoundKind::kAtMost);
}

}  // namespace mortise::bench
