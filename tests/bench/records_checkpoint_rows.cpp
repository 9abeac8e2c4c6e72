// What checkpoints take from the thread of the ticks: CPU time, which others on the machine do not
// lengthen.
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "common/io/checkpoint.h"
#include "common/io/open_scene.h"
#include "common/session/session_state.h"
#include "common/session/step.h"
#include "tests/bench/records_sections.h"
#include "tests/bench/statistics.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kMedianBar_percent = 1.0, kTickBar_ms = 0.5;
// Servers begin one every ten seconds at most, or with each second of work.
constexpr int kEvery_ticks = 120;

/// CPU seconds of each tick, and of what a checkpoint took of it.
struct Costs {
  std::vector<double> step, all, copied, finished, written;
  std::size_t memos = 0, bytes = 0, touched = 0;
};

class Session {
 public:
  explicit Session(World& world) : world_(world) { maker_.begin(world_); }

  void tick(std::span<const Decision> decisions, std::vector<Increment> increments) {
    for (const Decision& decision : decisions) apply_decision(world_, decision);
    const Stopwatch stepping;
    step(world_, increments, scratch_);
    costs.step.push_back(stepping.elapsed_s());
    const bool due = ++ticks_ % kEvery_ticks == 0;
    running_ = running_ || due;
    costs.touched = std::max(costs.touched, world_.state->touched.size());
    const Stopwatch making;
    StateDraft draft = maker_.after_tick(world_, due);
    const double took_s = making.elapsed_s();
    costs.all.push_back(took_s);
    if (running_) (draft ? costs.finished : costs.copied).push_back(took_s);
    if (!draft) return;
    running_ = false;
    const Stopwatch writing;
    costs.bytes = draft().size();
    costs.written.push_back(writing.elapsed_s());
    costs.memos = world_.state->memos.size();
  }

  Costs costs;

 private:
  World& world_;
  Scratch scratch_;
  CheckpointMaker maker_;
  std::size_t ticks_ = 0;
  bool running_ = false;
};

std::optional<Costs> of_the_demo() {
  const auto* played = demo_session();
  if (played == nullptr) return {};
  const auto reading = read_scenario_text(played->header.scenario_yaml, "demo");
  auto scene = reading ? load_scene(reading->scenario, default_meshes())
                       : Result<LoadedScene>(reading.error());
  if (!scene) return {};
  Session session(scene->world);
  for (const TickRecord& record : played->ticks) session.tick(record.decisions, record.increments);
  return session.costs;
}

/// Rods that lean over, side by side: the boxes of each meet those of hundreds of others, their
/// surfaces none. Every tenth is held and swings to and fro, by one of `kUsers` users.
constexpr int kUsers = 64;
class Rods {
 public:
  explicit Rods(int count) : seq_(kUsers) {
    const SolidPtr rod = shapes::solid(shapes::box({2, 2, 400}));
    const int side = static_cast<int>(std::ceil(std::sqrt(count)));
    const Quat lean(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitX()));
    for (int i = 0; i < count; ++i) {
      Part part;
      part.id = PartId{static_cast<std::uint32_t>(i + 1)};
      part.name = "rod_" + std::to_string(i + 1);
      part.solid = rod;
      part.band = nominal_band();
      part.moving = i % 10 == 0;
      part.X_WP_scenario = part.X_WP = Pose{lean, Vec3(12.0 * (i % side), 24.0 * (i / side), 0)};
      world.parts.push_back(std::move(part));
    }
    world.name = "rods";
    world.policy = Policy::kStop;
  }
  std::vector<Decision> everybody_joins() {
    std::vector<Decision> decisions;
    for (std::uint32_t user = 1; user <= kUsers; ++user) {
      Decision join;
      join.kind = Decision::Kind::kJoin;
      join.user = UserId{user};
      join.user_name = "user" + std::to_string(user);
      decisions.push_back(join);
    }
    return decisions;
  }
  /// Hands let go and take others now and then, so that there is something to be undone.
  void change_hands(std::size_t tick) {
    for (std::uint32_t user = 1; user <= kUsers; ++user) {
      const auto ask = [&](CommandKind kind, PartId part) {
        Decision unused;
        static_cast<void>(apply_command(world, {UserId{user}, part, ++commands_, kind}, unused));
      };
      PartId& held = held_[user];
      if (held.value != 0) ask(CommandKind::kRelease, held);
      const std::size_t movers = (world.parts.size() + 9) / 10;
      held = PartId{static_cast<std::uint32_t>(1 + 10 * ((user * 7 + tick / 60 * 64) % movers))};
      ask(CommandKind::kGrab, held);
    }
  }
  std::vector<Increment> pushes(std::size_t tick) {
    std::vector<Increment> increments;
    const double along = 2.0 * std::cos(0.1 * static_cast<double>(tick));
    for (std::uint32_t user = 1; user <= kUsers; ++user) {
      const Part* part = world.find(held_[user]);
      if (part == nullptr || part->holder != UserId{user}) continue;
      increments.push_back({UserId{user}, part->id, ++seq_[user - 1],
                            along * Vec3(0, -std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2),
                            Vec3::Zero()});
    }
    return increments;
  }

  World world;

 private:
  std::vector<std::uint64_t> seq_;  ///< by user
  std::map<std::uint32_t, PartId> held_;
  std::uint64_t commands_ = 0;
};

Costs of_rods(int count, std::size_t ticks) {
  Rods rods(count);
  Session session(rods.world);
  session.tick(rods.everybody_joins(), {});
  for (std::size_t i = 1; i < ticks; ++i) {
    if (i % 60 == 1) rods.change_hands(i);
    session.tick({}, rods.pushes(i));
  }
  return session.costs;
}

void show(Report& report, const std::string& name, const Costs& costs, double clock_s) {
  const auto row = [&](const std::string& what, const std::vector<double>& s) {
    if (s.empty()) return;
    report.row({name + what, 1e6 * median(s), 1e6 * quantile(s, 0.99), 1e6 * largest(s),
                static_cast<long long>(s.size())});
  };
  row(": the tick's engine", costs.step);
  row(": checkpoints, any tick", costs.all);
  row(": ticks that copy a slice", costs.copied);
  row(": ticks that bring one to its end", costs.finished);
  row(": the writer's part of one", costs.written);
  report.note(name + ": " + std::to_string(costs.memos) + " pairs remembered, at most " +
              std::to_string(costs.touched) + " of them to be copied again, " +
              std::to_string(costs.bytes) + " bytes");
  report.bar(name + ": checkpoints begun", static_cast<double>(costs.written.size()), 3.0,
             BoundKind::kAtLeast);
  report.bar(name + ": checkpoints, longest CPU time of any tick, ms", 1e3 * largest(costs.all),
             kTickBar_ms, BoundKind::kAtMost);
  report.bar(name + ": checkpoints, % of the engine's tick, medians",
             100.0 * std::max(0.0, median(costs.all) - clock_s) / median(costs.step),
             kMedianBar_percent, BoundKind::kAtMost);
}

}  // namespace

void section_checkpoint(Report& report, const RecordsOptions& options) {
  std::vector<double> clock;
  for (int i = 0; i < 10'000; ++i) {
    const Stopwatch nothing;
    clock.push_back(nothing.elapsed_s());
  }
  report.table("What checkpoints take from the thread of the ticks, us of its CPU",
               {"session", "median", "p99", "longest", "ticks"});
  report.row({std::string("nothing: the clock itself"), 1e6 * median(clock),
              1e6 * quantile(clock, 0.99), 1e6 * largest(clock),
              static_cast<long long>(clock.size())});
  const double clock_s = median(clock);
  if (const auto demo = of_the_demo()) show(report, "the demo", *demo, clock_s);
  const std::size_t ticks = options.quick ? 480 : 1800;
  show(report, "1,000 rods", of_rods(1000, ticks), clock_s);
  show(report, "4,000 rods", of_rods(4000, ticks), clock_s);
}

}  // namespace mortise::bench
