// Analytic truth: what every grade, and what users have today, says about random fits.
#include <cstdio>
#include <map>

#include "tests/bench/judgement_oracle.h"
#include "tests/bench/judgement_plot.h"
#include "tests/bench/judgement_score.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

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

// How many cases of a family in a hundred.
struct Share {
  Family family;
  int percent;
};
constexpr Share kShares[] = {{Family::kCylinder, 60},
                             {Family::kCone, 12},
                             {Family::kBall, 8},
                             {Family::kKey, 10},
                             {Family::kBlocks, 10}};

Family family_of(long long i) {
  long long left = i * 37 % 100;  // mixed, so that every stride below meets all of them
  for (const Share& share : kShares)
    if ((left -= share.percent) < 0) return share.family;
  return Family::kBlocks;
}

// Every how manieth case a method is asked: the slow ones less often.
int stride_of(Grade grade) {
  switch (grade) {
    case Grade::kDeclared:
      return 1;
    case Grade::kRecognized:
      return 7;
    case Grade::kChord:
      return 29;
    case Grade::kEstimated:
      return 31;
  }
  return 1;
}
constexpr int kPeerStride = 37, kOrderStride = 11;
const std::string kOurs = "ours, ", kDecided = ", decided only";
constexpr const char* kFcl = "FCL, deepest contact > 0";
constexpr const char* kVertices = "deepest vertex > 0";

class Run {
 public:
  // Full brackets are the slowest of all: some 200 of them in a whole run.
  explicit Run(long long cases) : full_stride_(cases >= 50'000 ? 491 : 41) {}

  void judge(const JudgedCase& c, long long i) {
    for (const Grade grade : kGrades) {
      if (i % stride_of(grade) != 0 || !applies(grade, c)) continue;
      const auto pair = with_grade(c, grade);
      if (!pair) ++not_recognized;
      if (!pair) continue;
      const Truth truth = c.truth(speaks_of_whole(grade, c));
      const bool swapped = i % 2 == 1;
      const Word word = ask_ours(c, *pair, {Refinement::kDecided, swapped});
      note(name_of(grade), c, truth, word);
      if (grade == Grade::kDeclared && i % kOrderStride == 0) {
        ++order_asked;
        const Word other = ask_ours(c, *pair, {Refinement::kDecided, !swapped});
        if (other.collision_class != word.collision_class) {
          ++order_changes;
          tell("in one order", name_of(grade), c, truth, word);
          tell("in the other order", name_of(grade), c, truth, other);
        }
      }
      if (i % full_stride_ == 0) {
        errors[kOurs + name_of(grade) + kDecided].add_ours(c, truth, word);
        errors[kOurs + name_of(grade)].add_ours(
            c, truth, ask_ours(c, *pair, {Refinement::kFull, swapped, kFullWorkCap}));
      }
    }
    if (i % kPeerStride != 0 && i % full_stride_ != 0) return;
    const Truth truth = c.truth(false);
    const Word fcl = FclPair(c).ask(c), vertices = ask_vertices(c);
    if (i % kPeerStride == 0) {
      peers[kFcl].add(c, truth, fcl);
      peers[kVertices].add(c, truth, vertices);
    }
    if (i % full_stride_ == 0) {
      errors[kFcl].add_peer(c, fcl);
      errors[kVertices].add_peer(c, vertices);
    }
  }

  std::map<std::string, JudgementScore> grades, families, peers;
  std::map<std::string, ErrorScore> errors;
  long long order_asked = 0, order_changes = 0, not_recognized = 0;

 private:
  void note(const std::string& method, const JudgedCase& c, const Truth& truth, const Word& word) {
    const std::string wrong = grades[method].add(c, truth, word);
    if (method == name_of(Grade::kDeclared)) families[name_of(c.family)].add(c, truth, word);
    if (wrong == "contradiction" || (!wrong.empty() && (method == name_of(Grade::kDeclared) ||
                                                        method == name_of(Grade::kRecognized))))
      tell(wrong.c_str(), method.c_str(), c, truth, word);
  }

  int full_stride_;
};

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
                                           "right %, 65 facets on",
                                           "right %, 24 facets on",
                                           "right %, 12 to 23",
                                           "us median",
                                           "us p99",
                                           "at the cap",
                                           "slowest"};

void add_row(Report& report, const std::string& name, const JudgementScore& s) {
  std::vector<Cell> cells;
  cells.emplace_back(name);
  cells.emplace_back(s.cases);
  for (const auto& is : s.confusion)
    for (const long long count : is) cells.emplace_back(count);
  cells.emplace_back(s.contradictions);
  for (const double figure :
       {s.left_open_percent(), s.no_prism.percent(), s.fine.percent(), s.coarse.percent(),
        1e6 * median(s.time_s), 1e6 * quantile(s.time_s, 0.99)})
    cells.emplace_back(figure);
  cells.emplace_back(s.capped);
  cells.emplace_back(s.slowest);
  report.row(cells);
}

void error_rows(Report& report, const std::map<std::string, ErrorScore>& errors) {
  report.table("Numbers against the exact ones, full brackets unless said",
               {"who", "cases", "ms median", "ms p99", "depth of the meshes: cases", "mm median",
                "mm p99", "mm largest", "overlap of the true surfaces: cases", "mm median ",
                "mm p99 ", "mm largest ", "at the cap"});
  for (const auto& [name, s] : errors)
    report.row({name, static_cast<long long>(s.time_s.size()), 1e3 * median(s.time_s),
                1e3 * quantile(s.time_s, 0.99), static_cast<long long>(s.depth_mm.size()),
                median(s.depth_mm), quantile(s.depth_mm, 0.99), largest(s.depth_mm),
                static_cast<long long>(s.overlap_mm.size()), median(s.overlap_mm),
                quantile(s.overlap_mm, 0.99), largest(s.overlap_mm), s.capped});
}

double wrong_percent(const JudgementScore& s) {
  return 100.0 * static_cast<double>(s.contradictions) / static_cast<double>(s.cases);
}

void draw(const Run& run, const std::string& svg_file) {
  std::vector<JudgementMark> marks;
  for (const auto& [name, s] : run.errors) {
    if (s.overlap_mm.empty()) continue;
    const bool ours = name.starts_with(kOurs);
    std::string who = ours ? name.substr(kOurs.size()) : name;
    const std::string grade =
        who.ends_with(kDecided) ? who.substr(0, who.size() - kDecided.size()) : who;
    const JudgementScore& words = ours ? run.grades.at(grade) : run.peers.at(name);
    marks.push_back({who, 1e3 * median(s.time_s), quantile(s.overlap_mm, 0.99),
                     median(s.overlap_mm), wrong_percent(words), ours});
  }
  draw_judgement(marks, svg_file);
}

void add_bars(Report& report, const Run& run, long long least_cases) {
  long long cases = 0, contradictions = 0;
  for (const auto& [name, s] : run.grades) {
    if (name == name_of(Grade::kDeclared)) cases = s.cases;
    if (name != name_of(Grade::kEstimated)) contradictions += s.contradictions;
  }
  report.bar("random cases", static_cast<double>(cases), static_cast<double>(least_cases),
             BoundKind::kAtLeast);
  report.bar("contradictions of the truth, all grades but estimated",
             static_cast<double>(contradictions), 0.0, BoundKind::kAtMost);
  for (const auto& [name, s] : run.grades) {
    if (name == name_of(Grade::kEstimated))
      report.bar("contradictions of the truth, estimated, %", wrong_percent(s), 0.1,
                 BoundKind::kAtMost);
    // A coarser round may be a prism, which is never to be called round.
    if (name == name_of(Grade::kRecognized))
      report.bar(name + ": decided truths found, margin > 0.5 um, 65 facets on, %",
                 s.no_prism.percent(), 100.0, BoundKind::kAtLeast);
    if (name != name_of(Grade::kDeclared)) continue;
    report.bar(name + ": decided truths found, margin > 0.5 um, 24 facets on, %", s.fine.percent(),
               100.0, BoundKind::kAtLeast);
    report.bar(name + ": decided truths found, margin > 0.5 um, 12 to 23 facets, %",
               s.coarse.percent(), 99.0, BoundKind::kAtLeast);
  }
  report.bar("words that change with the order of the parts",
             static_cast<double>(run.order_changes), 0.0, BoundKind::kAtMost);
}

}  // namespace

void section_truth(Report& report, const JudgementOptions& options) {
  const long long wanted = options.quick ? 3000 : 100'000;
  const long long count = options.cases > 0 ? options.cases : wanted;
  Run run(count);
  for (long long i = 0; i < count; ++i)
    run.judge(draw_case(family_of(i), static_cast<std::uint64_t>(i)), i);
  report.table("What is said of random fits (columns: truth: word)", kColumns);
  for (const auto& [name, score] : run.grades) add_row(report, name, score);
  for (const auto& [name, score] : run.peers) add_row(report, name, score);
  report.table("By family, declared features", kColumns);
  for (const auto& [name, score] : run.families) add_row(report, name, score);
  report.note(std::to_string(run.not_recognized) +
              " cases are not among the recognized: a stated surface was not found again; " +
              std::to_string(run.order_asked) + " cases were asked in both orders");
  error_rows(report, run.errors);
  add_bars(report, run, wanted);
  if (!options.plot_file.empty()) draw(run, options.plot_file);
}

bool tell_case(const std::string& name) {
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos) return false;
  const std::uint64_t seed = std::strtoull(name.c_str() + colon + 1, nullptr, 10);
  if (name.starts_with("convex:")) {
    tell_convex_case(seed);
    return true;
  }
  if (name.starts_with("csg:")) {
    tell_csg_case(seed);
    return true;
  }
  for (const Family family : kFamilies) {
    if (name.substr(0, colon) != name_of(family)) continue;
    const JudgedCase c = draw_case(family, seed);
    for (const Grade grade : kGrades)
      for (const bool swapped : {false, true}) {
        if (!applies(grade, c)) continue;
        const auto pair = with_grade(c, grade);
        if (!pair) continue;
        for (const Refinement refinement : {Refinement::kDecided, Refinement::kFull})
          tell(refinement == Refinement::kFull ? "full" : "decided", name_of(grade), c,
               c.truth(speaks_of_whole(grade, c)),
               ask_ours(c, *pair, {refinement, swapped, kFullWorkCap}));
      }
    return true;
  }
  return false;
}

}  // namespace mortise::bench
