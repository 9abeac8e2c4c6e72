// First contact beside its peers: the same motions, one thread, CPU time.
#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "tests/bench/contact_summary.h"
#include "tests/bench/score.h"
#include "tests/bench/sections.h"
#include "tests/bench/statistics.h"
#include "tests/unit/ccd/workload.h"

namespace mortise::bench {
namespace {

std::vector<MotionSet> generated_sets(bool quick) {
  const int count = quick ? 12 : 40;
  std::vector<MotionSet> sets;
  sets.push_back(sphere_set(32, 17, count));
  if (!quick) sets.push_back(sphere_set(100, 51, count));
  sets.push_back(peg_set(0.5, 32, count));
  if (!quick) sets.push_back(peg_set(0.1, 32, count));
  sets.push_back(peg_set(0.1, 128, count));
  if (!quick) sets.push_back(peg_set(0.05, 128, count));
  if (!quick) sets.push_back(peg_set(0.01, 128, count));
  if (!quick) sets.push_back(peg_set(0.01, 512, count));
  sets.push_back(wall_set(count));
  sets.push_back(helix_set(count));
  sets.push_back(nut_set(count));
  sets.push_back(gear_set(count));
  return sets;
}

// Where the data are not there the report says so: their rows would be missing in silence.
void add_data_sets(std::vector<MotionSet>& sets, Report& report, bool quick) {
  const int count = quick ? 12 : 40;
  const auto add = [&](MotionSet set, const std::string& name) {
    if (set.items.empty())
      report.note("Not measured: " + name + " is not in " + testing::data_folder() +
                  "; set MORTISE_DATA.");
    else
      sets.push_back(std::move(set));
  };
  if (!quick)
    for (const std::string& id : fit_ids()) add(fit_set(id, count), "fits, " + id);
  for (const std::string& name : testing::workload_names())
    add(measured_set(name, count), "ccd-motions/" + name);
}

std::vector<Asked> ask_everyone(const MotionSet& set, bool quick) {
  std::vector<Asked> asked;
  const auto ask_ours = [&](Method method) {
    std::vector<Answer> answers = ask_all(method, set);
    asked.push_back({std::move(method), std::move(answers)});
  };
  for (int decade = 2; decade <= 9; ++decade)
    if (!quick || decade % 2 == 0 || decade == 9) ask_ours(ours(set, std::pow(10.0, -decade)));
  ask_ours(ours_portable(set, kAccuracyDefault_mm));
  std::vector<Method> peers = fcl_methods(set);
  if (set.convex) peers.push_back(bullet_method(set));
  const Limits limits = quick ? Limits{0.3, 0.3} : Limits{2.0, 2.0};
  for (Method& peer : peers) {
    std::vector<Answer> answers = ask_guarded(peer, set, limits);
    asked.push_back({std::move(peer), std::move(answers)});
  }
  return asked;
}

std::string source_text(TruthSource source) {
  switch (source) {
    case TruthSource::kClosedForm:
      return "closed form";
    case TruthSource::kMeasured:
      return "its own slow method, 1e-7 mm";
    default:
      return "mortise at 1e-10 mm";
  }
}

void sets_table(Report& report, const std::vector<SetRun>& runs) {
  report.table("Motions and their truth",
               {"motions", "triangles moving", "triangles fixed", "asked", "contacts", "truth",
                "advancement on FCL distance agrees", "contradicted"});
  long long contradicted = 0;
  for (const SetRun& run : runs) {
    const CrossCheck check = cross_check(run.set, run.asked);
    const auto contacts = std::count_if(run.set.items.begin(), run.set.items.end(),
                                        [](const MotionSet::Item& i) { return i.contact; });
    report.row({run.set.name, static_cast<long long>(run.set.moving->mesh().triangles.size()),
                static_cast<long long>(run.set.fixed->mesh().triangles.size()),
                static_cast<long long>(run.set.items.size()), static_cast<long long>(contacts),
                source_text(run.set.truth),
                std::to_string(check.confirmed) + " of " + std::to_string(check.asked) + " asked",
                check.contradicted});
    contradicted += check.contradicted;
  }
  report.bar("truths contradicted by an independent method", static_cast<double>(contradicted), 0,
             BoundKind::kAtMost);
}

// Far turns in a thread: many places nearly touch all the way. Answered soon, or an honest
// "undecided".
void large_turns(Report& report, bool quick) {
  MotionSet set = nut_large_turn_set(quick ? 12 : 100);
  find_truth(set);
  const Method method = ours(set, kAccuracyDefault_mm);
  const std::vector<Answer> answers = ask_all(method, set);
  const Score s = score(set, method, answers);
  report.table("First contact: " + set.name, score_columns());
  report.row(score_cells(method.name, s));
  std::vector<double> decided_s;
  for (const Answer& answer : answers)
    if (answer.decided()) decided_s.push_back(answer.time_s);
  const double p99_ms = 1e3 * quantile(decided_s, 0.99);
  report.bar(set.name + ": p99 of the decided, ms", p99_ms, 200, BoundKind::kAtMost);
  report.bar(set.name + ": p99 of the decided, ms (at most 50)", p99_ms, 50, BoundKind::kAtMost);
  report.bar(set.name + ": missed, late or false",
             static_cast<double>(s.missed + s.late + s.false_hits), 0, BoundKind::kAtMost);
}

}  // namespace

void section_rows(Report& report, const Options& options) {
  std::vector<SetRun> runs;
  std::vector<MotionSet> sets = generated_sets(options.quick);
  add_data_sets(sets, report, options.quick);
  for (MotionSet& set : sets) {
    find_truth(set);
    SetRun run;
    run.asked = ask_everyone(set, options.quick);
    run.set = std::move(set);
    report.table("First contact: " + run.set.name, score_columns());
    for (const Asked& asked : run.asked)
      report.row(score_cells(asked.method.name, score(run.set, asked.method, asked.answers)));
    runs.push_back(std::move(run));
  }
  sets_table(report, runs);
  ratio_table(report, runs);
  summary(report, runs, options.plot_file);
  large_turns(report, options.quick);
}

}  // namespace mortise::bench
