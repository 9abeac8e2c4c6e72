#include "tests/bench/judgement_oracle.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/bench/judgement_score.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

std::size_t column_of(CollisionClass collision_class) {
  if (collision_class == CollisionClass::kReal) return 0;
  return collision_class == CollisionClass::kPotential ? 1 : 2;
}

std::string told(const std::optional<Interval>& bracket) {
  if (!bracket) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "[%.6f, %.6f]", bracket->lo, bracket->hi);
  return text;
}

std::string told(const std::optional<double>& value) {
  return value ? std::to_string(*value) : "-";
}

}  // namespace

CollisionClass OracleTruth::collision_class() const {
  if (certain_mm > 0.0) return CollisionClass::kReal;
  return possible_mm <= 0.0 ? CollisionClass::kNone : CollisionClass::kPotential;
}

double OracleTruth::margin_mm() const {
  return std::min(std::abs(certain_mm), std::abs(possible_mm));
}

const char* name_of(Fault fault) {
  constexpr const char* kNames[kFaults] = {"false real",      "false fake or none", "no witness",
                                           "witness outside", "delta outside",      "certain above",
                                           "possible below"};
  return kNames[static_cast<std::size_t>(fault)];
}

const char* word_of(CollisionClass collision_class) {
  switch (collision_class) {
    case CollisionClass::kReal:
      return "real";
    case CollisionClass::kPotential:
      return "potential";
    case CollisionClass::kFake:
      return "fake";
    case CollisionClass::kNone:
      return "none";
  }
  return "";
}

bool refines(CollisionClass lazy, CollisionClass full) {
  return column_of(lazy) == column_of(full) || lazy == CollisionClass::kPotential;
}

std::vector<Fault> faults_of(const OracleTruth& truth, const Word& word,
                             std::optional<double> witness_depth_mm) {
  std::vector<Fault> wrong;
  const std::size_t said = column_of(word.collision_class);
  if (said == 0) {
    if (!truth.searched && truth.certain_mm < -kTouch_mm) wrong.push_back(Fault::kFalseReal);
    if (!witness_depth_mm) wrong.push_back(Fault::kNoWitness);
    if (witness_depth_mm.value_or(0.0) < -kTouch_mm) wrong.push_back(Fault::kWitnessOutside);
  }
  if (said == 2 && truth.possible_overlap_mm() > kOff_mm) wrong.push_back(Fault::kFalseNone);
  if (truth.mesh_depth_mm && word.depth_mm &&
      (word.depth_mm->lo > *truth.mesh_depth_mm + kOff_mm ||
       word.depth_mm->hi < *truth.mesh_depth_mm - kOff_mm))
    wrong.push_back(Fault::kDepth);
  const double certain_mm = truth.certain_depth_mm.value_or(truth.certain_mm);
  if (!truth.searched && word.certain_mm &&
      word.certain_mm->lo > kOff_mm + std::max(0.0, certain_mm) &&
      (truth.certain_mm < 0.0 || truth.certain_depth_mm))
    wrong.push_back(Fault::kCertain);
  if (word.possible_mm && truth.possible_overlap_mm() > kOff_mm &&
      word.possible_mm->hi < truth.possible_overlap_mm() - kOff_mm)
    wrong.push_back(Fault::kPossible);
  return wrong;
}

bool OracleScore::add(const OracleTruth& truth, const Word& word, const std::vector<Fault>& wrong) {
  ++cases;
  capped += word.capped;
  time_s.push_back(word.time_s);
  for (const Fault fault : wrong) ++faults[static_cast<std::size_t>(fault)];
  const std::size_t is = column_of(truth.collision_class()), said = column_of(word.collision_class);
  ++confusion[is][said];
  if (is == 1 || truth.margin_mm() <= kMargin_mm) return false;
  ++decided;
  found += said == is;
  return said != is;
}

double OracleScore::found_percent() const {
  return decided == 0 ? std::numeric_limits<double>::quiet_NaN()
                      : 100.0 * static_cast<double>(found) / static_cast<double>(decided);
}

long long OracleScore::contradictions() const {
  return faults[0] + faults[1] + faults[2] + faults[3];
}

long long OracleScore::false_numbers() const { return faults[4] + faults[5] + faults[6]; }

void tell_oracle(const std::string& what, const OracleTruth& truth, const Word& word,
                 const std::string& text) {
  std::printf(
      "%s: said %s%s, truth %s (certain %.7f, possible %.7f; overlaps %s, %s, mesh %s), mesh %s, "
      "certain %s, possible %s, %.3f ms; %s\n",
      what.c_str(), word_of(word.collision_class), word.capped ? " (work cap)" : "",
      word_of(truth.collision_class()), truth.certain_mm, truth.possible_mm,
      told(truth.certain_depth_mm).c_str(), told(truth.possible_depth_mm).c_str(),
      told(truth.mesh_depth_mm).c_str(), told(word.depth_mm).c_str(), told(word.certain_mm).c_str(),
      told(word.possible_mm).c_str(), 1e3 * word.time_s, text.c_str());
  std::fflush(stdout);
}

long long OracleRun::contradictions() const {
  long long all = 0;
  for (const auto& [name, score] : ways) all += score.contradictions();
  return all;
}

void OracleRun::add_table(Report& report, const std::string& title) const {
  std::vector<std::string> columns = {"who",
                                      "cases",
                                      "real: real",
                                      "real: potential",
                                      "real: fake or none",
                                      "potential: real",
                                      "potential: potential",
                                      "potential: fake or none",
                                      "none: real",
                                      "none: potential",
                                      "none: fake or none"};
  for (std::size_t i = 0; i < kFaults; ++i) columns.emplace_back(name_of(static_cast<Fault>(i)));
  for (const char* more : {"decided truths", "found %", "us median", "us p99", "at the cap"})
    columns.emplace_back(more);
  report.table(title, columns);
  for (const auto& [name, s] : ways) {
    std::vector<Cell> cells = {name, s.cases};
    for (const auto& is : s.confusion)
      for (const long long count : is) cells.emplace_back(count);
    for (const long long count : s.faults) cells.emplace_back(count);
    cells.emplace_back(s.decided);
    for (const double figure :
         {s.found_percent(), 1e6 * median(s.time_s), 1e6 * quantile(s.time_s, 0.99)})
      cells.emplace_back(figure);
    cells.emplace_back(s.capped);
    report.row(cells);
  }
}

void OracleRun::add_bars(Report& report, const std::string& section, long long least_pairs,
                         double least_found_percent) const {
  long long false_numbers = 0;
  for (const auto& [name, score] : ways) false_numbers += score.false_numbers();
  const auto none = [&](const char* what, long long count) {
    report.bar(section + ": " + what, static_cast<double>(count), 0.0, BoundKind::kAtMost);
  };
  report.bar(section + ": pairs", static_cast<double>(pairs), static_cast<double>(least_pairs),
             BoundKind::kAtLeast);
  none("contradictions of the truth", contradictions());
  none("delta outside its bracket, certain above, possible below the truth by > 0.2 um",
       false_numbers);
  none("lazy and full differ, but for potential that is decided", class_changes);
  none("words that change with the order of the parts", order_changes);
  for (const auto& [name, score] : ways)
    report.bar(section + ", " + name + ": decided truths found, margin > 0.5 um, %",
               score.found_percent(), least_found_percent, BoundKind::kAtLeast);
}

void ask_oracle(const OracleCase& c, const OracleAsk& ask, OracleRun& run) {
  const auto judge = [&](bool full, bool swapped) {
    const AskOurs how = full ? AskOurs{Refinement::kFull, swapped, kFullWorkCap}
                             : AskOurs{Refinement::kDecided, swapped};
    const Word word = ask_ours(c.pair, c.X_WA, c.X_WB, how);
    std::optional<double> depth_mm;
    if (word.witness_W) depth_mm = c.least_depth_mm(*word.witness_W);
    OracleTruth truth = c.truth;
    if (truth.searched && depth_mm) {
      truth.certain_mm = std::max(truth.certain_mm, 2.0 * *depth_mm);
      truth.possible_mm = std::max(truth.possible_mm, truth.certain_mm);
    }
    const std::vector<Fault> wrong = faults_of(truth, word, depth_mm);
    const std::string way = ask.way + (full ? ", full" : "");
    const bool missed = run.ways[way].add(truth, word, wrong);
    std::string what;
    for (const Fault fault : wrong) what += std::string(what.empty() ? "" : ", ") + name_of(fault);
    if (wrong.empty() && missed) what = "missed";
    if (!what.empty() || ask.tell_all)
      tell_oracle((what.empty() ? "answer" : what) + ": --case " + c.name + ", " + way +
                      (swapped ? ", B before A" : ""),
                  truth, word,
                  c.text + (depth_mm ? "; depth at the witness " + std::to_string(*depth_mm) : ""));
    return word.collision_class;
  };
  ++run.pairs;
  const CollisionClass lazy = judge(false, ask.swapped);
  if (ask.other_order) {
    ++run.asked_swapped;
    const CollisionClass other = judge(false, !ask.swapped);
    const bool changed = column_of(other) != column_of(lazy);
    run.order_changes += changed;
    if (changed)
      std::printf("order changes the class: --case %s, %s: %s, %s\n", c.name.c_str(),
                  ask.way.c_str(), word_of(lazy), word_of(other));
  }
  if (!ask.full) return;
  ++run.asked_again;
  const CollisionClass full = judge(true, ask.swapped);
  run.class_changes += !refines(lazy, full);
  if (!refines(lazy, full))
    std::printf("full changes the class: --case %s, %s: %s, %s\n", c.name.c_str(), ask.way.c_str(),
                word_of(lazy), word_of(full));
}

}  // namespace mortise::bench
