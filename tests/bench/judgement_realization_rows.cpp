// Soundness by realization: real surfaces drawn inside their zones, lobed, tapered, eccentric; none
// may contradict what was said of all of them.
#include <cstdio>
#include <map>
#include <utility>

#include "tests/bench/judgement_realization.h"
#include "tests/bench/judgement_score.h"
#include "tests/bench/judgement_sections.h"

namespace mortise::bench {
namespace {

constexpr int kDraws = 24;
/// Cases that the section truth does not have.
constexpr std::uint64_t kRealizationSeed = 1'000'000;

struct Tally {
  long long cases = 0, real = 0, potential = 0, none = 0, draws = 0, contradictions = 0;
  long long cases_contradicted = 0;
  /// Potential cases of which some draw interferes and another does not: rightly open.
  long long both_seen = 0;
};

void play(const JudgedCase& c, Grade grade, const Word& word, Tally& tally) {
  Dice dice(c.seed);
  bool some = false, all = true, told = false;
  for (int i = 0; i < kDraws; ++i) {
    const Realization drawn = draw_realization(c, speaks_of_whole(grade, c), i, dice);
    auto overlap = sampled_overlap_mm(c, drawn);
    if (!overlap) return;
    // Samples may fall short of an overlap: what would contradict a real is looked at closely.
    if (word.collision_class == CollisionClass::kReal && *overlap < -kTouch_mm)
      overlap = sampled_overlap_mm(c, drawn, true);
    ++tally.draws;
    some |= *overlap > kTouch_mm;
    all &= *overlap > -kTouch_mm;
    const bool wrong = (word.collision_class == CollisionClass::kReal && *overlap < -kTouch_mm) ||
                       (word.collision_class <= CollisionClass::kFake && *overlap > kTouch_mm);
    tally.contradictions += wrong;
    tally.cases_contradicted += wrong && !told;
    if (wrong && !std::exchange(told, true))
      std::printf("contradiction: --case %s:%llu, %s, realization %d overlaps by %.6f mm; %s\n",
                  name_of(c.family), static_cast<unsigned long long>(c.seed), name_of(grade), i,
                  *overlap, c.text.c_str());
  }
  ++tally.cases;
  tally.real += word.collision_class == CollisionClass::kReal;
  tally.none += word.collision_class <= CollisionClass::kFake;
  tally.potential += word.collision_class == CollisionClass::kPotential;
  tally.both_seen += word.collision_class == CollisionClass::kPotential && some && !all;
}

}  // namespace

void section_realization(Report& report, const JudgementOptions& options) {
  const std::uint64_t count = options.quick ? 100 : 2000;
  std::map<Grade, Tally> tallies;
  for (std::uint64_t i = 0; i < count; ++i) {
    const Family family = i % 4 == 0   ? Family::kCone
                          : i % 4 == 1 ? Family::kBall
                                       : Family::kCylinder;
    const JudgedCase c = draw_case(family, kRealizationSeed + i);
    for (const Grade grade : kGrades) {
      if (!applies(grade, c) || (grade >= Grade::kChord && i % 4 != 2)) continue;
      const auto pair = with_grade(c, grade);
      if (pair) play(c, grade, ask_ours(c, *pair, {}), tallies[grade]);
    }
  }
  report.table("Real surfaces drawn inside their zones",
               {"grade", "cases", "said real", "potential", "fake or none", "surfaces drawn",
                "contradictions", "in cases", "potential of which both kinds were drawn"});
  long long contradictions = 0;
  for (const auto& [grade, t] : tallies) {
    report.row({std::string(name_of(grade)), t.cases, t.real, t.potential, t.none, t.draws,
                t.contradictions, t.cases_contradicted, t.both_seen});
    if (grade != Grade::kEstimated) contradictions += t.contradictions;
  }
  report.bar("drawn surfaces that contradict a real or a fake", static_cast<double>(contradictions),
             0.0, BoundKind::kAtMost);
}

}  // namespace mortise::bench
