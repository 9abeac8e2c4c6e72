#include "tests/bench/contact_summary.h"

#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "tests/bench/plot.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

double ms(double seconds) { return 1e3 * seconds; }

std::string given_up(const Score& s) {
  std::string text = std::to_string(s.undecided);
  if (s.over_time > 0) text += ", " + std::to_string(s.over_time) + " over time";
  if (s.crashed > 0) text += ", " + std::to_string(s.crashed) + " crashed";
  return text;
}

const Asked& ours_at_default(const SetRun& run) {
  return *std::find_if(run.asked.begin(), run.asked.end(), [](const Asked& asked) {
    return asked.method.ours && !asked.method.portable &&
           asked.method.accuracy_mm == kAccuracyDefault_mm;
  });
}

/// One method over all sets.
struct Total {
  Method method;
  Score score;
  std::vector<double> error_mm;  ///< of contacts, early or late, where the truth is the finest
  std::vector<double> times;     ///< by set: how many times as long as ours, at no larger error
  std::vector<double> against;   ///< by set: how many times as long as ours at the default accuracy
  long long larger_error = 0;    ///< sets on which our error is larger at every accuracy
};

std::vector<Total> totals_of(const std::vector<SetRun>& runs) {
  std::vector<Total> totals;
  for (const SetRun& run : runs)
    for (const Asked& asked : run.asked) {
      auto total = std::find_if(totals.begin(), totals.end(), [&](const Total& known) {
        return known.method.name == asked.method.name;
      });
      if (total == totals.end()) {
        totals.emplace_back();
        total = totals.end() - 1;
        total->method = asked.method;
      }
      const Score scored = score(run.set, asked.method, asked.answers);
      total->score.add(scored);
      if (run.set.truth != TruthSource::kMeasured)
        for (std::size_t i = 0; i < scored.late_mm.size(); ++i)
          total->error_mm.push_back(std::max(scored.late_mm[i], scored.early_mm[i]));
      const Asked& base = ours_at_default(run);
      std::vector<double> against;
      for (std::size_t i = 0; i < run.set.items.size(); ++i)
        if (asked.answers[i].decided() && base.answers[i].decided())
          against.push_back(asked.answers[i].time_s / base.answers[i].time_s);
      if (against.empty()) continue;
      total->against.push_back(geometric_mean(against));
      if (asked.method.ours) continue;
      const Ratio r = ratio(run.set, asked, run.asked);
      total->times.push_back(r.times);
      total->larger_error += !r.ours_as_good;
    }
  return totals;
}

void speed_bars(Report& report, const std::vector<Total>& totals) {
  struct Promise {
    const char* peer;
    double times;
  };
  for (const Promise& promise :
       {Promise{kRepairedOBBRSS, 75}, {kRepairedRSS, 400}, {kSubSteps1000, 60}, {kSubSteps100, 10}})
    for (const Total& total : totals)
      if (total.method.name == promise.peer) {
        report.bar(std::string("times as fast as ") + promise.peer, geometric_mean(total.times),
                   promise.times, BoundKind::kAtLeast);
        report.bar(std::string("motion sets with a larger error than ") + promise.peer,
                   static_cast<double>(total.larger_error), 0, BoundKind::kAtMost);
      }
}

void correctness_bars(Report& report, const std::vector<SetRun>& runs,
                      const std::vector<Total>& totals) {
  // 1. At every accuracy.
  Score own;
  for (const Total& total : totals)
    if (total.method.ours) own.add(total.score);
  const auto none = [&](const char* name, long long count) {
    report.bar(name, static_cast<double>(count), 0, BoundKind::kAtMost);
  };
  none("mortise: missed contacts, all accuracies", own.missed);
  none("mortise: contacts late beyond accuracy", own.late);
  none("mortise: false hits beyond accuracy", own.false_hits);
  none("mortise: undecided", own.undecided);
  // 2. Vector code may only discard: without it the same answers.
  long long different = 0;
  for (const SetRun& run : runs) {
    const Asked& base = ours_at_default(run);
    for (const Asked& asked : run.asked)
      for (std::size_t i = 0; asked.method.portable && i < base.answers.size(); ++i)
        different += base.answers[i].outcome != asked.answers[i].outcome ||
                     base.answers[i].t != asked.answers[i].t;
  }
  none("mortise: answers that differ without vector code", different);
}

}  // namespace

const std::vector<std::string>& score_columns() {
  static const std::vector<std::string> columns = {
      "method",       "asked",          "median ms", "p99 ms",     "late p99 mm", "late worst mm",
      "early p99 mm", "early worst mm", "missed",    "false hits", "gave up"};
  return columns;
}

std::vector<Cell> score_cells(const std::string& name, const Score& s) {
  return {name,
          s.asked,
          ms(median(s.time_s)),
          ms(quantile(s.time_s, 0.99)),
          quantile(s.late_mm, 0.99),
          largest(s.late_mm),
          quantile(s.early_mm, 0.99),
          largest(s.early_mm),
          s.missed,
          s.false_hits,
          given_up(s)};
}

void ratio_table(Report& report, const std::vector<SetRun>& runs) {
  report.table("How many times as long the peers take, on the motions that both decided",
               {"motions", "peer", "compared", "geometric mean", "of the sums",
                "accuracy of mortise mm", "error of mortise no larger"});
  for (const SetRun& run : runs)
    for (const Asked& asked : run.asked) {
      if (asked.method.ours) continue;
      const Ratio r = ratio(run.set, asked, run.asked);
      const char* no_larger = r.motions == 0 ? "-" : r.ours_as_good ? "yes" : "NO";
      report.row({run.set.name, asked.method.name, r.motions, r.times, r.times_in_sum,
                  r.accuracy_mm, std::string(no_larger)});
    }
}

void summary(Report& report, const std::vector<SetRun>& runs, const std::string& plot_file) {
  std::vector<double> own_ms;
  for (const SetRun& run : runs) {
    std::vector<double> time_s;
    for (const Answer& answer : ours_at_default(run).answers) time_s.push_back(answer.time_s);
    own_ms.push_back(ms(geometric_mean(time_s)));
  }
  const std::vector<Total> totals = totals_of(runs);
  std::vector<Mark> marks;
  std::vector<std::string> columns = score_columns();
  columns.insert(columns.begin() + 2, {"motion sets", "times the time of mortise at 1e-6 mm"});
  report.table("First contact, all motions", columns);
  for (const Total& total : totals) {
    std::vector<Cell> cells = score_cells(total.method.name, total.score);
    const double times = geometric_mean(total.against);
    cells.insert(cells.begin() + 2, {static_cast<long long>(total.against.size()), times});
    report.row(cells);
    if (total.error_mm.empty() || total.method.portable) continue;
    Mark mark;
    mark.name = total.method.name;
    mark.time_ms = times * geometric_mean(own_ms);
    mark.error_mm = quantile(total.error_mm, 0.99);
    mark.median_error_mm = median(total.error_mm);
    mark.late = total.score.late + total.score.missed > 0;
    mark.missed = total.score.missed;
    mark.contacts = static_cast<long long>(total.score.late_mm.size()) + total.score.missed;
    mark.ours = total.method.ours;
    marks.push_back(mark);
  }
  speed_bars(report, totals);
  correctness_bars(report, runs, totals);
  if (!plot_file.empty()) draw_time_against_error(marks, plot_file);
}

}  // namespace mortise::bench
