// Whole ticks of a session, step() and its statistics: what a tick costs in which nothing moves,
// and how the cost grows with the number of movers and of static parts.
#include <cmath>

#include "common/math/rotation.h"
#include "common/session/tick/statistics.h"
#include "common/session/tick/step.h"
#include "common/session/world/decisions.h"
#include "tests/bench/broad_phase_rows.h"
#include "tests/bench/scenes.h"
#include "tests/bench/sections.h"
#include "tests/bench/statistics.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kIdleBar_us = 20.0;
constexpr double kPitch_mm = 80.0;

// Static prisms at the nodes of a lattice, tilted so that boxes meet where the parts are 14 mm or
// more apart; balls go to and fro in the corridors between them, as a part does in a designer's
// hand.
class Hall {
 public:
  Hall(int fixed, int movers) : dice_(9) {
    const int n = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(fixed))));
    const SolidPtr prism = testing::solid(testing::prism_mesh(22, 32, -30, 30));
    const SolidPtr ball = testing::solid(testing::sphere_mesh(8, 24, 12));
    const Quat tilt = rotation_exp(Vec3(0.25 * 3.14159265358979323846, 0, 0));
    for (int i = 0; i < fixed; ++i)
      add(prism, Pose{tilt, kPitch_mm * Vec3(i % n, i / n % n, i / (n * n))}, false);
    const int corridors = std::max(1, (n - 1) * (n - 1));
    join();
    for (int i = 0; i < movers; ++i) {
      const int c = i % corridors, k = i / corridors, side = std::max(1, n - 1);
      const Vec3 p(60.0 * k + 30.0, kPitch_mm * (c % side + 0.5), kPitch_mm * (c / side + 0.5));
      home_.push_back(p.x());
      step_mm_.push_back(dice_.between(0.1, 1.0));
      movers_.push_back(add(ball, Pose::translation(p), true));
      world_.parts.back().holder = UserId{1};
    }
    run({});
  }

  /// One tick in which the first `moving` of the movers move, CPU time in us, statistics included.
  double tick_us(int moving) {
    increments_.clear();
    for (int i = 0; i < moving; ++i) {
      const Part& part = *world_.find(movers_[i]);
      if (std::abs(part.X_WP.p.x() + step_mm_[i] - home_[i]) > 20.0) step_mm_[i] = -step_mm_[i];
      increments_.push_back(
          {UserId{1}, part.id, ++seq_, Vec3(step_mm_[i], 0, 0), Vec3(0, 0, 0.01)});
    }
    return run(increments_);
  }
  const StepCounters& counters() const { return counters_; }
  void forget_counters() { counters_ = {}; }

 private:
  PartId add(const SolidPtr& solid, const Pose& X_WP, bool moving) {
    Part part;
    part.id = PartId{static_cast<std::uint32_t>(world_.parts.size() + 1)};
    part.solid = solid;
    part.band = nominal_band();
    part.moving = moving;
    part.X_WP_scenario = part.X_WP = X_WP;
    world_.parts.push_back(std::move(part));
    return world_.parts.back().id;
  }
  void join() {
    Decision decision;
    decision.kind = Decision::Kind::kJoin;
    decision.user_name = "bench";
    apply_decision(world_, decision);
  }
  double run(const std::vector<Increment>& increments) {
    const Stopwatch watch;
    const StepReport report = step(world_, increments, scratch_);
    statistics_.add(report);
    const double time_us = 1e6 * watch.elapsed_s();
    accumulate(counters_, report.counters);
    return time_us;
  }

  Dice dice_;
  World world_;
  Scratch scratch_;
  SessionStatistics statistics_;
  StepCounters counters_;
  std::vector<PartId> movers_;
  std::vector<double> home_, step_mm_;
  std::vector<Increment> increments_;
  std::uint64_t seq_ = 0;
};

void idle_rows(Report& report, bool quick) {
  report.table("A tick in which nothing moves, 200 movers at rest, us",
               {"static parts", "median", "p99", "largest"});
  double worst_us = 0.0;
  for (const int fixed : {100, 1000, 10'000}) {
    Hall hall(fixed, 200);
    hall.tick_us(200);
    std::vector<double> times_us;
    for (int i = 0; i < (quick ? 200 : 2000); ++i) times_us.push_back(hall.tick_us(0));
    worst_us = quantile(times_us, 0.99);
    report.row({static_cast<long long>(fixed), median(times_us), worst_us, largest(times_us)});
  }
  report.bar("tick in which nothing moves, 10,000 static parts, p99 us", worst_us, kIdleBar_us,
             BoundKind::kAtMost);
}

void moving_rows(Report& report, bool quick) {
  report.table(
      "A tick of moving parts, us",
      {"static parts", "movers", "moving", "median", "p99", "pairs with a mover", "asleep %",
       "boxes meet a tick", "distance measured a tick", "first contact asked a tick"});
  struct Movers {
    int all, moving;
  };
  const int ticks = quick ? 40 : 200;
  for (const int fixed : {100, 1000, 10'000})
    for (const Movers movers :
         {Movers{1, 1}, Movers{10, 10}, Movers{50, 50}, Movers{200, 20}, Movers{200, 200}}) {
      Hall hall(fixed, movers.all);
      for (int i = 0; i < 5; ++i) hall.tick_us(movers.moving);
      hall.forget_counters();
      std::vector<double> times_us;
      for (int i = 0; i < ticks; ++i) times_us.push_back(hall.tick_us(movers.moving));
      const StepCounters& c = hall.counters();
      const auto a_tick = [&](std::uint64_t sum) { return static_cast<double>(sum) / ticks; };
      // Asleep: no geometry was asked for the pair.
      const double pairs = a_tick(c.pairs.in - c.pairs_static);
      const double asked = a_tick(c.distance_queries + c.first_contact_queries);
      report.row({static_cast<long long>(fixed), static_cast<long long>(movers.all),
                  static_cast<long long>(movers.moving), median(times_us), quantile(times_us, 0.99),
                  static_cast<long long>(pairs), 100.0 * (pairs - asked) / pairs,
                  a_tick(c.pairs_budget + c.pairs.out), a_tick(c.distance_queries),
                  a_tick(c.first_contact_queries)});
    }
}

}  // namespace

void section_tick(Report& report, const Options& options) {
  broad_phase_rows(report, options.quick);
  idle_rows(report, options.quick);
  moving_rows(report, options.quick);
}

}  // namespace mortise::bench
