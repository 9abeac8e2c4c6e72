// Whole ticks of a large scene, drain to publish, in this process: the server's own loop on a
// channel in memory. CPU time of the tick's thread, because others work on this machine; wall time
// stands beside it.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "client/client.h"
#include "common/messages/memory_channel.h"
#include "server/tick_loop.h"
#include "tests/bench/scenes.h"
#include "tests/bench/session_load.h"
#include "tests/bench/session_sections.h"
#include "tests/bench/statistics.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kTickP99Bar_ms = 16.0, kTickMedianBar_ms = 2.0, kFarBar = 1.2;
constexpr double kPitch_mm = 80.0;
constexpr int kHeld = 5;

// 10,000 to 50,000 triangles each; solids are shared, as the parts of a real assembly are.
std::vector<SolidPtr> workshop_solids() {
  std::vector<SolidPtr> solids;
  for (const int n : {29, 45, 58})
    solids.push_back(shapes::solid(shapes::box({24, 18, 14}, Vec3::Zero(), n)));
  for (const int n : {52, 80, 110})
    solids.push_back(shapes::solid(shapes::sphere(22.0, Vec3::Zero(), n)));
  for (const int rows : {18, 40, 80})
    solids.push_back(shapes::solid(shapes::peg({16, -24, 24, 256, rows, 0})));
  for (const int rows : {9, 16, 24})
    solids.push_back(shapes::solid(shapes::ring({14, -12, 12, 512, rows, 0}, 24)));
  return solids;
}

std::vector<SolidPtr> solids_between(std::size_t least, std::size_t most) {
  std::vector<SolidPtr> fitting;
  for (SolidPtr& solid : workshop_solids()) {
    const std::size_t triangles = solid->mesh().triangles.size();
    if (triangles >= least && triangles <= most) fitting.push_back(std::move(solid));
  }
  return fitting;
}

/// Static parts on a lattice, moving ones in the corridors between them; the first five of these
/// are held and led about by hand-like swings that touch what stands around. `far_away`: further
/// static parts where nobody ever goes.
class Workshop {
 public:
  Workshop(int fixed, int movers, int far_away) : dice_(31) {
    const std::vector<SolidPtr> solids = solids_between(10'000, 50'000);
    const SolidPtr moved = shapes::solid(shapes::box({12, 10, 8}, Vec3::Zero(), 29));
    const int n = static_cast<int>(std::ceil(std::cbrt(static_cast<double>(fixed))));
    for (int i = 0; i < fixed; ++i)
      add(solids[static_cast<std::size_t>(i) % solids.size()],
          Pose{dice_.orientation(), kPitch_mm * Vec3(i % n, i / n % n, i / (n * n))}, false);
    Dice far_dice(32);  // of its own: what is near must be the same with and without
    for (int i = 0; i < far_away; ++i)
      add(solids[static_cast<std::size_t>(i) % solids.size()],
          Pose{far_dice.orientation(), Vec3(1e4 + kPitch_mm * (i % 100), kPitch_mm * (i / 100), 0)},
          false);
    const int side = std::max(1, n - 1);
    for (int i = 0; i < movers; ++i) {
      const int c = i * 7 % (side * side * side);
      const Vec3 cell(c % side + 0.5, c / side % side + 0.5, c / (side * side) + 0.5);
      add(moved, Pose{dice_.orientation(), kPitch_mm * cell}, true);
    }
    first_mover_ = static_cast<std::uint32_t>(fixed + far_away) + 1;
    world_.name = "workshop";
    world_.policy = Policy::kStop;
    server_ = hub_.open_server();
    loop_ = std::make_unique<TickLoop>(world_, *server_, clock_, nullptr, TickLoopOptions{});
    loop_->open();
    channel_ = hub_.open_client();
    client_ = std::make_unique<Client>(*channel_);
    for (int i = 0; i < kHeld; ++i) {
      client_->add_user("hand" + std::to_string(i + 1), "designer");
      swings_.push_back(
          {dice_.direction(), dice_.direction(), dice_.between(2.0, 5.0), dice_.between(0.0, 6.0)});
    }
    for (int i = 0; i < 5; ++i) turn();
    for (LocalUser user = 0; user < kHeld; ++user) client_->grab(user, part(user));
    for (int i = 0; i < 5; ++i) turn();
  }

  struct Time {
    double cpu_ms = 0.0, wall_ms = 0.0;
  };
  Time tick() {
    time_s_ += 1.0 / 60.0;
    for (LocalUser user = 0; user < kHeld; ++user) {
      const Swing& swing = swings_[user];
      // 45 mm to each side: across the corridor and into what stands there.
      const double w = 2.0 * 3.14159265358979323846 / swing.period_s;
      const double speed = 45.0 * w / 60.0 * std::cos(w * time_s_ + swing.phase);
      client_->send(user, part(user), speed * swing.way, 0.01 * std::cos(w * time_s_) * swing.turn);
    }
    return turn();
  }
  const StepCounters& counters() const { return loop_->statistics().counters(); }
  int held() const {
    int count = 0;
    for (const Part& p : world_.parts) count += p.holder ? 1 : 0;
    return count;
  }
  std::uint64_t clashes() const {
    std::uint64_t count = 0;
    for (const CollisionClass c :
         {CollisionClass::kFake, CollisionClass::kPotential, CollisionClass::kReal})
      count += loop_->statistics().clashes_total(c);
    return count;
  }

 private:
  struct Swing {
    Vec3 way, turn;
    double period_s, phase;
  };
  PartId part(LocalUser user) const {
    return PartId{first_mover_ + static_cast<std::uint32_t>(user)};
  }
  void add(const SolidPtr& solid, const Pose& X_WP, bool moving) {
    Part part;
    part.id = PartId{static_cast<std::uint32_t>(world_.parts.size() + 1)};
    part.name = "part" + std::to_string(part.id.value);
    part.solid = solid;
    part.band = nominal_band();
    part.moving = moving;
    part.X_WP_scenario = part.X_WP = X_WP;
    world_.parts.push_back(std::move(part));
  }
  Time turn() {
    const double wall_s = steady_s();
    const Stopwatch watch;
    loop_->tick();
    const Time time{1e3 * watch.elapsed_s(), 1e3 * (steady_s() - wall_s)};
    client_->poll();
    return time;
  }

  Dice dice_;
  World world_;
  MemoryHub hub_;
  SystemClock clock_;
  std::unique_ptr<ServerChannel> server_;
  std::unique_ptr<TickLoop> loop_;
  std::unique_ptr<ClientChannel> channel_;
  std::unique_ptr<Client> client_;
  std::vector<Swing> swings_;
  std::uint32_t first_mover_ = 0;
  double time_s_ = 0.0;
};

struct Times {
  std::vector<double> cpu_ms, wall_ms;
};

Times measure(Report& report, const std::string& name, Workshop& workshop, int ticks) {
  for (int i = 0; i < 60; ++i) workshop.tick();  // trees are built when first needed
  Times times;
  const StepCounters before = workshop.counters();
  for (int i = 0; i < ticks; ++i) {
    const Workshop::Time time = workshop.tick();
    times.cpu_ms.push_back(time.cpu_ms);
    times.wall_ms.push_back(time.wall_ms);
  }
  const StepCounters& after = workshop.counters();
  report.row({name, static_cast<long long>(workshop.held()), static_cast<long long>(ticks),
              median(times.cpu_ms), quantile(times.cpu_ms, 0.99), largest(times.cpu_ms),
              median(times.wall_ms), quantile(times.wall_ms, 0.99),
              static_cast<long long>(after.first_contact_queries - before.first_contact_queries),
              static_cast<long long>(after.depth_queries - before.depth_queries),
              static_cast<long long>(workshop.clashes()),
              static_cast<long long>(after.not_examined - before.not_examined),
              fmt::format("{:.1f}", load_average())});
  return times;
}

}  // namespace

void section_tick(Report& report, const SessionOptions& options) {
  report.table(
      "A tick of a workshop: 50 moving parts, 5 of them led by hand; parts of 10,000 to "
      "50,000 triangles; ms",
      {"static parts", "held", "ticks", "CPU median", "CPU p99", "CPU largest", "wall median",
       "wall p99", "first contacts", "depths", "clashes", "not examined", "load average"});
  const int ticks = options.quick ? 300 : options.soak ? 18'000 : 1800;
  {
    Workshop thousand(1000, 50, 0);
    const Times times = measure(report, "1000", thousand, ticks);
    report.bar("50 moving, 1000 static parts: tick p99, ms of CPU", quantile(times.cpu_ms, 0.99),
               kTickP99Bar_ms, BoundKind::kAtMost);
    report.bar("50 moving, 1000 static parts: tick median, ms of CPU", median(times.cpu_ms),
               kTickMedianBar_ms, BoundKind::kAtMost);
  }
  Workshop near(100, 50, 0), far(100, 50, 10'000);
  const Times without = measure(report, "100", near, ticks);
  const Times with = measure(report, "100 and 10,000 far", far, ticks);
  double sum_without = 0.0, sum_with = 0.0;
  for (const double ms : without.cpu_ms) sum_without += ms;
  for (const double ms : with.cpu_ms) sum_with += ms;
  report.bar("10,000 far parts more: mean tick / mean tick at 100", sum_with / sum_without, kFarBar,
             BoundKind::kAtMost);
}

}  // namespace mortise::bench
