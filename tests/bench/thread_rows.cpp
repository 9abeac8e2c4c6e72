// Independent pairs over the threads of the session's own pool: the gain, and that no bit of any
// answer depends on it.
#include <algorithm>
#include <chrono>
#include <thread>

#include "common/ccd/first_contact.h"
#include "common/session/tick/worker_pool.h"
#include "tests/bench/scenes.h"
#include "tests/bench/sections.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

struct Pass {
  double wall_s = 0.0, cpu_s = 0.0;
  std::vector<FirstContact> answers;
};

Pass pass_over(const std::vector<ContactQuery>& queries, int threads) {
  WorkerPool pool(threads);
  std::vector<CcdScratch> scratch(static_cast<std::size_t>(threads));
  Pass pass;
  pass.answers.resize(queries.size());
  const double cpu_s = process_cpu_s();
  const auto start = std::chrono::steady_clock::now();
  pool.for_each(queries.size(), [&](std::size_t i, int thread) {
    pass.answers[i] = first_contact(queries[i], scratch[static_cast<std::size_t>(thread)]);
  });
  pass.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  pass.cpu_s = process_cpu_s() - cpu_s;
  return pass;
}

bool same_bits(const Vec3& a, const Vec3& b) { return (a.array() == b.array()).all(); }

bool same(const FirstContact& a, const FirstContact& b) {
  return a.state == b.state && a.t_clear == b.t_clear && a.t_contact == b.t_contact &&
         a.distance_mm == b.distance_mm && a.triangle_a == b.triangle_a &&
         a.triangle_b == b.triangle_b && same_bits(a.point_a_W, b.point_a_W) &&
         same_bits(a.point_b_W, b.point_b_W) && a.work.box_tests == b.work.box_tests &&
         a.work.leaf_tests == b.work.leaf_tests && a.work.advances == b.work.advances;
}

}  // namespace

void section_threads(Report& report, const Options& options) {
  const int copies = options.quick ? 2 : 5;
  const std::vector<MotionSet> sets = {sphere_set(100, 51, 40), peg_set(0.1, 128, 40), gear_set(40),
                                       nut_set(20)};
  std::vector<ContactQuery> queries;
  for (int copy = 0; copy < copies; ++copy)
    for (const MotionSet& set : sets)
      for (const MotionSet::Item& item : set.items) {
        ContactQuery query;
        query.a = set.moving.get(), query.b = set.fixed.get();
        query.motion_a = item.motion;
        queries.push_back(query);
      }
  report.table("Cost against the number of threads (wall clock; " +
                   std::to_string(std::thread::hardware_concurrency()) + " cores)",
               {"threads", "pairs", "wall ms", "times as fast as one", "CPU ms",
                "answers that differ from one thread's"});
  const Pass warm = pass_over(queries, 1);
  double one_s = 0.0;
  long long different_in_all = 0;
  for (const int threads : {1, 2, 4}) {
    Pass best;
    long long different = 0;
    for (int again = 0; again < 3; ++again) {
      Pass next = pass_over(queries, threads);
      for (std::size_t i = 0; i < queries.size(); ++i)
        different += !same(next.answers[i], warm.answers[i]);
      if (again == 0 || next.wall_s < best.wall_s) best = std::move(next);
    }
    if (threads == 1) one_s = best.wall_s;
    report.row({static_cast<long long>(threads), static_cast<long long>(queries.size()),
                1e3 * best.wall_s, one_s / best.wall_s, 1e3 * best.cpu_s, different});
    different_in_all += different;
  }
  report.bar("answers that depend on the number of threads", static_cast<double>(different_in_all),
             0, BoundKind::kAtMost);
}

}  // namespace mortise::bench
