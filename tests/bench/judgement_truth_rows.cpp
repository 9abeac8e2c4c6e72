// Analytic truth: what every grade, and what users have today, says about random fits.
#include <cstdio>
#include <map>

#include "tests/bench/judgement_score.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

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

std::string told(const std::optional<Interval>& bracket) {
  if (!bracket) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "[%.6f, %.6f]", bracket->lo, bracket->hi);
  return text;
}

void tell(const char* what, const char* method, const JudgedCase& c, const Truth& truth,
          const Word& word) {
  std::printf(
      "%s: --case %s:%llu, %s: said %s%s, truth %s (certain %.6f, possible %.6f), mesh %s, "
      "certain %s, possible %s; %s\n",
      what, name_of(c.family), static_cast<unsigned long long>(c.seed), method,
      word_of(word.collision_class), word.capped ? " (work cap)" : "",
      word_of(truth.collision_class()), truth.certain_mm, truth.possible_mm,
      told(word.depth_mm).c_str(), told(word.certain_mm).c_str(), told(word.possible_mm).c_str(),
      c.text.c_str());
  std::fflush(stdout);
}

// How many cases of a family in a hundred, and every how manieth of them each method is asked.
struct Plan {
  Family family;
  int percent;
};
constexpr Plan kPlan[] = {{Family::kCylinder, 60},
                          {Family::kCone, 12},
                          {Family::kBall, 8},
                          {Family::kKey, 10},
                          {Family::kBlocks, 10}};

Family family_of(long long i) {
  long long left = i % 100;
  for (const Plan& plan : kPlan)
    if ((left -= plan.percent) < 0) return plan.family;
  return Family::kBlocks;
}

class Run {
 public:
  explicit Run(bool loud) : loud_(loud) {}

  void judge(const JudgedCase& c, long long i) {
    for (const Grade grade : kGrades) {
      if (!applies(grade, c)) continue;
      const auto pair = with_grade(c, grade);
      if (!pair) continue;
      const Truth truth = c.truth(speaks_of_whole(grade, c));
      const Word word = ask_ours(c, *pair, {Refinement::kDecided, i % 2 == 1});
      note(name_of(grade), c, truth, word);
    }
  }

  std::map<std::string, JudgementScore> scores;
  std::map<std::string, JudgementScore> families;  ///< of the declared grade

 private:
  void note(const std::string& method, const JudgedCase& c, const Truth& truth, const Word& word) {
    const std::string wrong = scores[method].add(c, truth, word);
    if (method == name_of(Grade::kDeclared)) families[name_of(c.family)].add(c, truth, word);
    const bool shown = wrong == "contradiction" || (method != name_of(Grade::kChord) && loud_);
    if (!wrong.empty() && shown) tell(wrong.c_str(), method.c_str(), c, truth, word);
  }
  bool loud_;
};

void add_row(Report& report, const std::string& name, const JudgementScore& s) {
  std::vector<Cell> cells = {name, s.cases};
  for (const auto& is : s.confusion)
    for (const long long count : is) cells.push_back(count);
  cells.push_back(s.contradictions);
  cells.push_back(s.left_open_percent());
  cells.push_back(s.fine.percent());
  cells.push_back(s.coarse.percent());
  cells.push_back(quantile(s.end_error_mm, 0.99));
  cells.push_back(quantile(s.depth_error_mm, 0.99));
  cells.push_back(1e6 * median(s.time_s));
  cells.push_back(1e6 * quantile(s.time_s, 0.99));
  cells.push_back(s.capped);
  report.row(cells);
}

const std::vector<std::string> kColumns = {"who",
                                           "cases",
                                           "real: real",
                                           "real: potential",
                                           "real: fake or none",
                                           "potential: real",
                                           "potential: potential",
                                           "potential: fake or none",
                                           "none: real",
                                           "none: potential",
                                           "none: fake or none",
                                           "contradictions",
                                           "left open %",
                                           "right %, 24 facets on",
                                           "right %, 12 to 23",
                                           "ends mm p99",
                                           "depth mm p99",
                                           "us median",
                                           "us p99",
                                           "capped"};

}  // namespace

void section_truth(Report& report, const JudgementOptions& options) {
  const long long count = options.cases > 0 ? options.cases : options.quick ? 1500 : 100'000;
  Run run(true);
  for (long long i = 0; i < count; ++i)
    run.judge(draw_case(family_of(i), static_cast<std::uint64_t>(i)), i);
  report.table("What is said (columns: truth: word)", kColumns);
  for (const auto& [name, score] : run.scores) add_row(report, name, score);
  report.table("By family, declared features", kColumns);
  for (const auto& [name, score] : run.families) add_row(report, name, score);
}

bool tell_case(const std::string& name) {
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos) return false;
  for (const Family family : kFamilies) {
    if (name.substr(0, colon) != name_of(family)) continue;
    const JudgedCase c = draw_case(family, std::strtoull(name.c_str() + colon + 1, nullptr, 10));
    for (const Grade grade : kGrades)
      for (const bool swapped : {false, true}) {
        if (!applies(grade, c)) continue;
        const auto pair = with_grade(c, grade);
        if (!pair) continue;
        for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull})
          tell(refinement == Refinement::kFull ? "full" : "decided", name_of(grade), c,
               c.truth(speaks_of_whole(grade, c)), ask_ours(c, *pair, {refinement, swapped}));
      }
    return true;
  }
  return false;
}

}  // namespace mortise::bench
