// Pegs in their holes, all pushed at once, and dowels shaken in wide bores: whether everybody gets
// on, and what a tick costs. In this process, through step(), without a network.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "common/io/scenario/scenario_file.h"
#include "common/io/scenario/scene_load.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "tests/bench/scenes.h"
#include "tests/bench/session_sections.h"
#include "tests/bench/statistics.h"
#include "tests/support/numbers.h"

namespace mortise::bench {
namespace {

constexpr double kFewBar = 0.9, kManyBar = 0.5, kAwayBar = 99.0;
constexpr int kFew = 64;

struct Fit {
  const char* name;
  double diameter_mm;
  const char* code;  // empty: nothing is declared
};
constexpr Fit kClearance{"0.1 mm clearance", 19.9, ""};
constexpr Fit kSliding{"H7/g6", 20.0, "Ø20 H7/g6"};
constexpr Fit kLoose{"1 mm clearance", 19.0, ""};

std::string pegs_of(const Fit& fit, int count, const char* policy) {
  std::string yaml = fmt::format(
      "name: pushed\nunits: mm\npolicy: {}\nparts:\n  - name: plate\n    generator: {{kind: "
      "plate_with_bore, bore: 20, facets: 32}}\n    instances:\n",
      policy);
  const auto place = [&](const char* name, int i, double z) {
    yaml += fmt::format("      - {{name: {}_{}, pose: {{position: [{}, {}, {}]}}}}\n", name, i,
                        80 * (i % 16), 80 * (i / 16), z);
  };
  for (int i = 0; i < count; ++i) place("plate", i, 0);
  yaml += fmt::format(
      "  - name: peg\n    generator: {{kind: dowel, diameter: {}, length: 40, chamfer: 1, facets: "
      "32}}\n    moving: true\n    instances:\n",
      fit.diameter_mm);
  for (int i = 0; i < count; ++i) place("peg", i, -10);
  if (*fit.code == '\0') return yaml;
  yaml += "fits:\n";
  for (int i = 0; i < count; ++i)
    yaml +=
        fmt::format("  - {{between: [plate_{0}.bore, peg_{0}.journal], code: {1}}}\n", i, fit.code);
  return yaml;
}

/// Pegs, each held by a designer of its own.
class Pegs {
 public:
  Pegs(const Fit& fit, int count, const char* policy, int threads)
      : scratch_(threads), count_(count) {
    const auto reading = read_scenario_text(pegs_of(fit, count, policy), "pushed.yaml");
    if (!reading) throw std::runtime_error(reading.error().text);
    auto scene = load_scene(reading->scenario, default_meshes());
    if (!scene || !scene->usable()) throw std::runtime_error("the pegs cannot be loaded");
    world_ = std::move(scene->world);
    step(world_, {}, scratch_);
    for (int i = 0; i < count; ++i) {
      Decision joined;
      joined.kind = Decision::Kind::kJoin;
      joined.user_name = "hand" + std::to_string(i);
      joined.role = Role::kDesigner;
      apply_decision(world_, joined);
      users_.push_back(world_.users.back().id);
      Decision grabbed;
      apply_command(world_, Command{users_.back(), peg(i), 1, CommandKind::kGrab}, grabbed);
      apply_decision(world_, grabbed);
    }
    sequence_.assign(static_cast<std::size_t>(count), 0);
  }

  PartId peg(int i) const { return PartId{static_cast<std::uint32_t>(count_ + i + 1)}; }
  Vec3 position(int i) const { return world_.find(peg(i))->X_WP.p; }

  /// One tick; its CPU time, all threads.
  double push(const std::vector<Vec3>& by, const Vec3& turn) {
    increments_.clear();
    for (int i = 0; i < count_; ++i)
      increments_.push_back({users_[static_cast<std::size_t>(i)], peg(i),
                             ++sequence_[static_cast<std::size_t>(i)],
                             by[static_cast<std::size_t>(i)], turn});
    const Stopwatch watch;
    const StepReport report = step(world_, increments_, scratch_);
    const double ms = 1e3 * watch.elapsed_s();
    not_examined += report.counters.not_examined;
    return ms;
  }

  std::uint64_t not_examined = 0;

 private:
  World world_;
  Scratch scratch_;
  int count_;
  std::vector<UserId> users_;
  std::vector<std::uint64_t> sequence_;
  std::vector<Increment> increments_;
};

struct Pushed {
  double mm_a_tick = 0.0;
  int stuck = 0;
  std::uint64_t not_examined = 0;
  std::vector<double> tick_ms;
};

// Down and up in the hole while the hand trembles and turns.
Pushed pushed(const Fit& fit, int count, const char* policy, int ticks, double least_mm) {
  Pegs pegs(fit, count, policy, 1);
  Pushed result;
  std::vector<double> moved_mm(static_cast<std::size_t>(count));
  Dice dice(19);
  for (int tick = 0; tick < ticks; ++tick) {
    const double down_mm = tick / 60 % 2 == 0 ? -0.05 : 0.05;
    std::vector<Vec3> by, before;
    for (int i = 0; i < count; ++i) {
      const double angle = dice.between(0.0, 2.0 * kPi);
      by.emplace_back(0.01 * std::cos(angle), 0.01 * std::sin(angle), down_mm);
      before.push_back(pegs.position(i));
    }
    result.tick_ms.push_back(pegs.push(by, Vec3(0, 0, 1e-3 * (tick % 2 == 0 ? 1 : -1))));
    for (int i = 0; i < count; ++i)
      moved_mm[static_cast<std::size_t>(i)] +=
          (pegs.position(i) - before[static_cast<std::size_t>(i)]).norm() / ticks;
  }
  for (const double mm : moved_mm) {
    result.mm_a_tick += mm / count;
    result.stuck += mm < 0.1 * least_mm ? 1 : 0;
  }
  result.not_examined = pegs.not_examined;
  return result;
}

struct Shaken {
  long long away = 0, carried_out = 0;
  std::uint64_t not_examined = 0;
  std::vector<double> tick_ms;
};

// Against the wall in one tick, away from it in the next: who is pushed away gets all of it.
Shaken shaken(int users, int ticks) {
  constexpr double kAgainst_mm = 0.8, kAway_mm = 0.2;
  Pegs pegs(kLoose, users, "stop", 1);
  Shaken result;
  Dice dice(23);
  std::vector<Vec3> way(static_cast<std::size_t>(users)), by(way.size()), before(way.size());
  for (int tick = 0; tick < ticks; ++tick) {
    const bool away = tick % 2 == 1;
    for (std::size_t i = 0; i < way.size(); ++i) {
      const double angle = dice.between(0.0, 2.0 * kPi);
      if (!away) way[i] = Vec3(std::cos(angle), std::sin(angle), 0.0);
      // Away from the wall is towards the middle of the bore.
      const Vec3 at = pegs.position(static_cast<int>(i));
      const Vec3 off(at.x() - 80.0 * static_cast<double>(i % 16),
                     at.y() - 80.0 * static_cast<double>(i / 16), 0.0);
      if (away && off.norm() > 0.1) way[i] = -off.normalized();
      by[i] = (away ? kAway_mm : kAgainst_mm) * way[i];
      before[i] = at;
    }
    result.tick_ms.push_back(pegs.push(by, Vec3::Zero()));
    if (!away) continue;
    for (std::size_t i = 0; i < way.size(); ++i) {
      ++result.away;
      result.carried_out +=
          (pegs.position(static_cast<int>(i)) - before[i] - by[i]).norm() < 1e-3 * kAway_mm;
    }
  }
  result.not_examined = pegs.not_examined;
  return result;
}

void pushed_rows(Report& report, const Fit& fit, const char* policy, int ticks) {
  double alone_mm = 0.0;
  for (const int count : {1, 8, 32, 64, 256}) {
    const Pushed p = pushed(fit, count, policy, ticks, alone_mm);
    if (count == 1) alone_mm = p.mm_a_tick;
    const double share = p.mm_a_tick / alone_mm;
    report.row({std::string(fit.name), std::string(policy), static_cast<long long>(count),
                p.mm_a_tick, share, static_cast<long long>(p.stuck),
                static_cast<long long>(p.not_examined), median(p.tick_ms),
                quantile(p.tick_ms, 0.99), largest(p.tick_ms)});
    const std::string of = fmt::format("{}, {}, {} pegs: ", fit.name, policy, count);
    if (count > 1)
      report.bar(of + "mm a tick beside one alone", share, count <= kFew ? kFewBar : kManyBar,
                 BoundKind::kAtLeast);
    report.bar(of + "stuck", p.stuck, 0.0, BoundKind::kAtMost);
    if (count <= kFew)
      report.bar(of + "not examined", static_cast<double>(p.not_examined), 0.0, BoundKind::kAtMost);
  }
}

}  // namespace

void section_pushed(Report& report, const SessionOptions& options) {
  const int ticks = options.quick ? 60 : 240;
  report.table("Pegs in their holes, all pushed at once; one thread; ms of CPU a tick",
               {"fit", "policy", "pegs", "mm a tick and peg", "beside one alone", "stuck",
                "not examined", "ms median", "ms p99", "ms largest"});
  for (const Fit& fit : {kClearance, kSliding})
    for (const char* policy : {"stop", "slide"}) pushed_rows(report, fit, policy, ticks);
  report.table("Dowels of Ø19 shaken in bores of Ø20, stop; one thread; ms of CPU a tick",
               {"designers", "pushes away", "carried out %", "not examined", "ms median", "ms p99",
                "ms largest"});
  for (const int users : {1, 8, 64}) {
    const Shaken s = shaken(users, ticks);
    const double share = 100.0 * static_cast<double>(s.carried_out) / static_cast<double>(s.away);
    report.row({static_cast<long long>(users), s.away, share,
                static_cast<long long>(s.not_examined), median(s.tick_ms),
                quantile(s.tick_ms, 0.99), largest(s.tick_ms)});
    report.bar(fmt::format("{} shaken: pushes away carried out, %", users), share, kAwayBar,
               BoundKind::kAtLeast);
  }
}

}  // namespace mortise::bench
