#include "tests/bench/pushed_pegs.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "common/io/scenario/scenario_file.h"
#include "common/io/scenario/scene_load.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "tests/bench/scenes.h"
#include "tests/bench/statistics.h"
#include "tests/support/numbers.h"

namespace mortise::bench {
namespace {

constexpr int kRow = 16;
constexpr double kPitch_mm = 80.0;

std::string pegs_of(const Fit& fit, int count, const char* policy) {
  std::string yaml = fmt::format(
      "name: pushed\nunits: mm\npolicy: {}\nparts:\n  - name: plate\n    generator: {{kind: "
      "plate_with_bore, bore: 20, facets: 32}}\n    instances:\n",
      policy);
  const auto place = [&](const char* name, int i, double z) {
    yaml += fmt::format("      - {{name: {}_{}, pose: {{position: [{}, {}, {}]}}}}\n", name, i,
                        kPitch_mm * (i % kRow), kPitch_mm * (i / kRow), z);
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

}  // namespace

Pegs::Pegs(const Fit& fit, int count, const char* policy, int threads)
    : scratch_(threads), count_(count), sequence_(static_cast<std::size_t>(count)) {
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
    const Reply reply =
        apply_command(world_, Command{users_.back(), peg(i), 1, CommandKind::kGrab}, grabbed);
    if (reply.refusal != Refusal::kNone) throw std::runtime_error("a peg cannot be taken");
  }
}

Vec3 Pegs::off_axis(int i) const {
  const Vec3 at = position(i);
  return {at.x() - kPitch_mm * (i % kRow), at.y() - kPitch_mm * (i / kRow), 0.0};
}

StepReport Pegs::push(const std::vector<Vec3>& by_mm, const Vec3& turn_rad) {
  increments_.clear();
  for (int i = 0; i < count_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    increments_.push_back({users_[at], peg(i), ++sequence_[at], by_mm[at], turn_rad});
  }
  return step(world_, increments_, scratch_);
}

Pushed push_all(const Fit& fit, int count, const char* policy, int ticks, int threads) {
  Pegs pegs(fit, count, policy, threads);
  Pushed result;
  std::vector<double> moved_mm(static_cast<std::size_t>(count));
  std::vector<Vec3> by(moved_mm.size()), before(moved_mm.size());
  Dice dice(19);
  for (int tick = 0; tick < ticks; ++tick) {
    const double down_mm = tick / 60 % 2 == 0 ? -0.05 : 0.05;
    for (std::size_t i = 0; i < by.size(); ++i) {
      const double angle = dice.between(0.0, 2.0 * kPi);
      by[i] = Vec3(0.01 * std::cos(angle), 0.01 * std::sin(angle), down_mm);
      before[i] = pegs.position(static_cast<int>(i));
    }
    const Stopwatch watch;
    const auto begun = std::chrono::steady_clock::now();
    const StepReport report = pegs.push(by, Vec3(0, 0, 1e-3 * (tick % 2 == 0 ? 1 : -1)));
    result.tick_ms.push_back(1e3 * watch.elapsed_s());
    result.wall_s +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    result.not_examined += report.counters.not_examined;
    for (std::size_t i = 0; i < by.size(); ++i)
      moved_mm[i] += (pegs.position(static_cast<int>(i)) - before[i]).norm() / ticks;
  }
  for (const double mm : moved_mm) result.mm_a_tick += mm / count;
  result.least_mm_a_tick = *std::min_element(moved_mm.begin(), moved_mm.end());
  return result;
}

Shaken shake_all(const Fit& fit, int count, int ticks) {
  constexpr double kAgainst_mm = 0.8, kAway_mm = 0.2, kFromAxis_mm = 0.1;
  Pegs pegs(fit, count, "stop");
  Shaken result;
  Dice dice(23);
  std::vector<Vec3> way(static_cast<std::size_t>(count)), by(way.size()), before(way.size());
  for (int tick = 0; tick < ticks; ++tick) {
    const bool away = tick % 2 == 1;
    for (std::size_t i = 0; i < way.size(); ++i) {
      const double angle = dice.between(0.0, 2.0 * kPi);
      if (!away) way[i] = Vec3(std::cos(angle), std::sin(angle), 0.0);
      const Vec3 off = pegs.off_axis(static_cast<int>(i));
      if (away && off.norm() > kFromAxis_mm) way[i] = -off.normalized();
      by[i] = (away ? kAway_mm : kAgainst_mm) * way[i];
      before[i] = pegs.position(static_cast<int>(i));
    }
    const Stopwatch watch;
    const StepReport report = pegs.push(by, Vec3::Zero());
    result.tick_ms.push_back(1e3 * watch.elapsed_s());
    result.not_examined += report.counters.not_examined;
    for (std::size_t i = 0; away && i < way.size(); ++i) {
      ++result.away;
      result.carried_out +=
          (pegs.position(static_cast<int>(i)) - before[i] - by[i]).norm() < 1e-3 * kAway_mm;
    }
  }
  return result;
}

}  // namespace mortise::bench
