#include "tests/bench/judgement_oracle.h"

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <new>

#include "common/base/check.h"
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

Interval drawn_zone(Dice& dice, double size_mm, double widest_share) {
  const double width = size_mm * dice.spread(1e-5, widest_share);
  const double middle = width * dice.between(-1.0, 1.0),
               half = 0.5 * width * dice.between(0.1, 1.0);
  return {middle - half, middle + half};
}

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

/// What a child process found out about one pair.
struct OracleRun::Answers {
  std::optional<Word> lazy, swapped, full;
};

/// What a child leaves behind, whatever becomes of it.
class OracleRun::Ledger {
 public:
  explicit Ledger(std::size_t count) : bytes_(sizeof(Shared) + count * sizeof(Answers)) {
    void* memory = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    MORTISE_CHECK(memory != MAP_FAILED, "no memory to share with a child process");
    shared_ = new (memory) Shared{};
    for (std::size_t i = 0; i < count; ++i) new (answers() + i) Answers{};
  }
  ~Ledger() { munmap(shared_, bytes_); }
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;
  std::size_t& at() { return shared_->at; }  ///< the pair that is worked on
  Answers* answers() { return reinterpret_cast<Answers*>(shared_ + 1); }

 private:
  struct alignas(64) Shared {
    std::size_t at = 0;
  };
  std::size_t bytes_;
  Shared* shared_;
};

void OracleRun::work(const std::vector<Waiting>& waiting, Ledger& ledger) {
  for (; ledger.at() < waiting.size(); ++ledger.at()) {
    const auto& [c, ask] = waiting[ledger.at()];
    Answers& answers = ledger.answers()[ledger.at()];
    const auto asked = [&](const AskOurs& how) { return ask_ours(c.pair, c.X_WA, c.X_WB, how); };
    answers.lazy = asked({Refinement::kDecided, ask.swapped});
    if (ask.other_order) answers.swapped = asked({Refinement::kDecided, !ask.swapped});
    if (ask.full) answers.full = asked({Refinement::kFull, ask.swapped, kFullWorkCap});
  }
}

void OracleRun::add(OracleCase c, const OracleAsk& ask) {
  constexpr std::size_t kTogether = 32;
  waiting_.push_back({std::move(c), ask});
  if (waiting_.size() >= kTogether) finish();
}

void OracleRun::finish() {
  Ledger ledger(waiting_.size());
  std::fflush(nullptr);
  while (ledger.at() < waiting_.size()) {
    const pid_t child = fork();
    MORTISE_CHECK(child >= 0, "no child process for the engine");
    if (child == 0) {
      work(waiting_, ledger);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (ledger.at() >= waiting_.size()) break;
    ++crashes_;
    const OracleCase& c = waiting_[ledger.at()].c;
    tell_oracle("check failed: --case " + c.name, c.truth, {}, c.text);
    ++ledger.at();
  }
  for (std::size_t i = 0; i < waiting_.size(); ++i) judge(waiting_[i], ledger.answers()[i]);
  waiting_.clear();
}

void OracleRun::note(const Waiting& asked, const Word& word, bool full, bool swapped) {
  const OracleCase& c = asked.c;
  std::optional<double> depth_mm;
  if (word.witness_W) depth_mm = c.least_depth_mm(*word.witness_W);
  OracleTruth truth = c.truth;
  if (truth.searched && depth_mm) {
    truth.certain_mm = std::max(truth.certain_mm, 2.0 * *depth_mm);
    truth.possible_mm = std::max(truth.possible_mm, truth.certain_mm);
  }
  const std::vector<Fault> wrong = faults_of(truth, word, depth_mm);
  const std::string way = asked.ask.way + (full ? ", full" : "");
  const bool missed = ways_[way].add(truth, word, wrong);
  std::string what;
  for (const Fault fault : wrong) what += std::string(what.empty() ? "" : ", ") + name_of(fault);
  if (wrong.empty()) what = missed ? "missed" : asked.ask.tell_all ? "answer" : "";
  if (what.empty()) return;
  const std::string witness =
      depth_mm ? "; depth at the witness " + std::to_string(*depth_mm) : std::string();
  tell_oracle(what + ": --case " + c.name + ", " + way + (swapped ? ", B before A" : ""), truth,
              word, c.text + witness);
}

void OracleRun::judge(const Waiting& asked, const Answers& answers) {
  const auto& [c, ask] = asked;
  ++pairs_;
  const auto changes = [&](const char* what, const Word& other) {
    std::printf("%s changes the class: --case %s, %s: %s, %s\n", what, c.name.c_str(),
                ask.way.c_str(), word_of(answers.lazy->collision_class),
                word_of(other.collision_class));
  };
  if (answers.lazy) note(asked, *answers.lazy, false, ask.swapped);
  if (answers.swapped) {
    ++asked_swapped_;
    note(asked, *answers.swapped, false, !ask.swapped);
    const bool changed =
        column_of(answers.swapped->collision_class) != column_of(answers.lazy->collision_class);
    order_changes_ += changed;
    if (changed) changes("order", *answers.swapped);
  }
  if (!answers.full) return;
  ++asked_again_;
  note(asked, *answers.full, true, ask.swapped);
  const bool changed = !refines(answers.lazy->collision_class, answers.full->collision_class);
  class_changes_ += changed;
  if (changed) changes("full", *answers.full);
}

long long OracleRun::contradictions() const {
  long long all = 0;
  for (const auto& [name, score] : ways_) all += score.contradictions();
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
  for (const auto& [name, s] : ways_) {
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
  report.note(std::to_string(asked_swapped_) + " pairs were asked in both orders, " +
              std::to_string(asked_again_) + " in full as well");
}

void OracleRun::add_bars(Report& report, const std::string& section, long long least_pairs,
                         double least_found_percent) const {
  long long false_numbers = 0;
  for (const auto& [name, score] : ways_) false_numbers += score.false_numbers();
  const auto none = [&](const char* what, long long count) {
    report.bar(section + ": " + what, static_cast<double>(count), 0.0, BoundKind::kAtMost);
  };
  report.bar(section + ": pairs", static_cast<double>(pairs_), static_cast<double>(least_pairs),
             BoundKind::kAtLeast);
  none("contradictions of the truth", contradictions());
  none("delta outside its bracket, certain above, possible below the truth by > 0.2 um",
       false_numbers);
  none("checks of the engine that fail", crashes_);
  none("lazy and full differ, but for potential that is decided", class_changes_);
  none("words that change with the order of the parts", order_changes_);
  for (const auto& [name, score] : ways_)
    report.bar(section + ", " + name + ": decided truths found, margin > 0.5 um, %",
               score.found_percent(), least_found_percent, BoundKind::kAtLeast);
}

}  // namespace mortise::bench
