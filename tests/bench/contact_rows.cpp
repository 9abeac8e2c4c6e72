// Run time against error of first contact: ours, FCL's collision test at a hundred sub-steps, and
// conservative advancement written by hand on FCL's distance. Prints a Markdown table.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "tests/bench/sections.h"
#include "tests/oracle/fcl_model.h"
#include "tests/unit/ccd/shapes.h"
#include "tests/unit/ccd/workload.h"

namespace mortise::testing {
void old_rows();
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLate_mm = 1e-5;
constexpr int kSubSteps = 100;
// Conservative advancement does not end by itself where parts slide; a designer would not wait,
// either.
constexpr int kMostDistanceQueries = 300;
// The peers are slow: they are asked the first motions of each set only, and the table says so.
constexpr std::size_t kPeerMotions = 12;

struct Found {
  bool contact = false, gave_up = false;
  double t = 1.0;
};

struct Scene {
  Workload workload;
  FclModel fcl_moving, fcl_fixed;
};

using Method = std::function<Found(const Scene&, const Motion&)>;

Found ours(const Scene& scene, const Motion& motion, CcdScratch& scratch) {
  ContactQuery query;
  query.a = scene.workload.moving.get();
  query.b = scene.workload.fixed.get();
  query.motion_a = motion;
  const FirstContact c = first_contact(query, scratch);
  return {c.state == ContactState::kContact, c.state == ContactState::kUndecided, c.t_contact};
}

Found sub_steps(const Scene& scene, const Motion& motion) {
  for (int i = 0; i <= kSubSteps; ++i) {
    const double t = static_cast<double>(i) / kSubSteps;
    if (fcl_collide(scene.fcl_moving, motion.pose_at(t), scene.fcl_fixed, {}))
      return {true, false, t};
  }
  return {};
}

Found advancement(const Scene& scene, const Motion& motion) {
  double radius = 0.0;
  for (const Vec3& p : scene.workload.moving->mesh().points_mm)
    radius = std::max(radius, (p - motion.reference_P).norm());
  const double speed = motion.travel_upper_bound_mm(radius, 0.0, 1.0);
  double t = 0.0;
  for (int i = 0; i < kMostDistanceQueries; ++i) {
    const double d = fcl_distance(scene.fcl_moving, motion.pose_at(t), scene.fcl_fixed, {});
    if (d <= kAccuracyDefault_mm) return {true, false, t};
    t += d / speed;
    if (t >= 1.0) return {};
  }
  return {false, true, t};
}

void row(const Scene& scene, const char* name, std::size_t most, const Method& method) {
  int missed = 0, invented = 0, late = 0, gave_up = 0;
  std::vector<double> ms, early_mm;
  double worst_late_mm = 0.0;
  const std::size_t count = std::min(most, scene.workload.rows.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Workload::Row& r = scene.workload.rows[i];
    const auto start = std::chrono::steady_clock::now();
    const Found found = method(scene, r.motion);
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                     .count());
    if (found.gave_up) {
      ++gave_up;
      continue;
    }
    missed += r.contact && !found.contact;
    invented += !r.contact && found.contact;
    if (!r.contact || !found.contact) continue;
    const double error_mm = (found.t - r.t_contact) * r.max_speed_mm;
    late += error_mm > kLate_mm;
    worst_late_mm = std::max(worst_late_mm, error_mm);
    early_mm.push_back(std::max(0.0, -error_mm));
  }
  std::sort(ms.begin(), ms.end());
  std::sort(early_mm.begin(), early_mm.end());
  const auto p99 = [](const std::vector<double>& x) {
    return x.empty() ? 0.0 : x[(99 * (x.size() - 1) + 50) / 100];
  };
  std::printf("| %s | %s | %zu | %d | %d | %d | %d | %.2g | %.2g | %.3f | %.3f |\n",
              scene.workload.name.c_str(), name, count, missed, invented, late, gave_up,
              worst_late_mm, p99(early_mm), ms[ms.size() / 2], p99(ms));
  std::fflush(stdout);
}

void rows(Workload workload) {
  Scene scene;
  scene.workload = std::move(workload);
  scene.fcl_moving = fcl_model(scene.workload.moving->mesh());
  scene.fcl_fixed = fcl_model(scene.workload.fixed->mesh());
  CcdScratch scratch;
  for (const Workload::Row& r : scene.workload.rows) ours(scene, r.motion, scratch);  // warm
  row(scene, "mortise", scene.workload.rows.size(),
      [&](const Scene& s, const Motion& m) { return ours(s, m, scratch); });
  row(scene, "FCL collide x100", kPeerMotions, sub_steps);
  row(scene, "advancement on FCL distance", kPeerMotions, advancement);
}

// Sets whose answers are known in closed form.
Workload foil() {
  Workload w{"cube through a 1 um foil",
             solid(box_mesh({1, 1, 1})),
             solid(box_mesh({0.001, 20, 20}, {5.3, 0, 0})),
             {}};
  for (int i = 0; i < 20; ++i) {
    const double way = 10.0 + 20.0 * i;
    w.rows.push_back({i, slide({0, 0, 0}, {way, 0, 0}), true, 4.7995 / way, way});
  }
  return w;
}

Workload bar() {
  Workload w{"turning bar",
             solid(box_mesh({4, 0.2, 0.2})),
             solid(box_mesh({0.2, 0.2, 0.2}, {0, 1.5, 0})),
             {}};
  for (int i = 0; i < 20; ++i) {
    const double angle = 0.5 * kPi * (1.0 + i / 19.0);
    w.rows.push_back({i, move({}, turn({0, 0, std::min(angle, kPi)})), true,
                      1.428181397 / std::min(angle, kPi), 2.01 * angle});
  }
  return w;
}

Workload sliding_peg() {
  Workload w{"peg slides in its bore, gap 0.05",
             solid(prism_mesh(9.95, 128, -12.5, 12.5)),
             solid(tube_mesh(10, 20, 128, -40, 40)),
             {}};
  for (int i = 0; i < 20; ++i)
    w.rows.push_back({i, slide({0, 0, -5.0}, {0, 0, -4.0 + 0.2 * i}), false, 1.0, 1.0 + 0.2 * i});
  return w;
}

void run() {
  std::printf(
      "| motions | method | asked | missed | invented | late | gave up | worst late mm | p99 early "
      "mm "
      "| median ms | p99 ms |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : workload_names()) {
    Workload workload;
    if (load_workload(name, workload))
      rows(std::move(workload));
    else
      std::fprintf(stderr, "no %s/ccd-motions/%s: set MORTISE_DATA\n", data_folder().c_str(),
                   name.c_str());
  }
  rows(foil());
  rows(bar());
  rows(sliding_peg());
}

}  // namespace

void old_rows() { run(); }

}  // namespace mortise::testing

namespace mortise::bench {

void section_rows(Report&, const Options&) { testing::old_rows(); }

}  // namespace mortise::bench
