#include "tests/bench/judgement_score.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace mortise::bench {
namespace {

// Facets of a round that is no prism that somebody drew.
constexpr int kNoPrism = 65;

std::size_t column_of(CollisionClass collision_class) {
  if (collision_class == CollisionClass::kReal) return 0;
  return collision_class == CollisionClass::kPotential ? 1 : 2;
}

// An end that the truth puts beyond touch must not be denied.
bool contradicts(const Truth& truth, const Word& word) {
  const std::size_t said = column_of(word.collision_class);
  if (said == 0) return truth.certain_mm < -kTouch_mm;
  return said == 2 && truth.possible_mm > kTouch_mm;
}

}  // namespace

double bracket_error_mm(const Interval& bracket, double exact_mm) {
  return std::max(std::abs(bracket.lo - exact_mm), std::abs(bracket.hi - exact_mm));
}

double JudgementScore::Share::percent() const {
  return all == 0 ? std::numeric_limits<double>::quiet_NaN()
                  : 100.0 * static_cast<double>(right) / static_cast<double>(all);
}

double JudgementScore::left_open_percent() const {
  return decided_truths == 0
             ? std::numeric_limits<double>::quiet_NaN()
             : 100.0 * static_cast<double>(left_open) / static_cast<double>(decided_truths);
}

std::string JudgementScore::add(const JudgedCase& c, const Truth& truth, const Word& word) {
  ++cases;
  const std::size_t is = column_of(truth.collision_class()), said = column_of(word.collision_class);
  ++confusion[is][said];
  capped += word.capped;
  time_s.push_back(word.time_s);
  if (word.time_s > slowest_s) {
    slowest_s = word.time_s;
    slowest = name_of(c);
  }
  const bool wrong = contradicts(truth, word);
  contradictions += wrong;
  bool missed = false;
  if (is != 1) {
    ++decided_truths;
    left_open += said == 1;
    if (truth.margin_mm() > kMargin_mm) {
      Share& share = c.facets() != 0 && c.facets() < 24 ? coarse : fine;
      ++share.all;
      share.right += said == is;
      if (c.facets() >= kNoPrism) {
        ++no_prism.all;
        no_prism.right += said == is;
      }
      missed = said != is && &share == &fine;
    }
  }
  if (wrong) return "contradiction";
  return missed ? "not found" : "";
}

void ErrorScore::add_ours(const JudgedCase& c, const Truth& truth, const Word& word) {
  time_s.push_back(word.time_s);
  capped += word.capped;
  if (c.mesh_depth_mm)
    depth_mm.push_back(word.depth_mm ? bracket_error_mm(*word.depth_mm, *c.mesh_depth_mm)
                                     : *c.mesh_depth_mm);
  // Below zero nobody looks closer than the verdict needs.
  if (!c.overlap_is_depth || truth.certain_mm <= 0.0) return;
  overlap_mm.push_back(word.certain_mm
                           ? std::max(bracket_error_mm(*word.certain_mm, truth.certain_mm),
                                      bracket_error_mm(*word.possible_mm, truth.possible_mm))
                           : truth.possible_mm);
}

void ErrorScore::add_peer(const JudgedCase& c, const Word& word) {
  time_s.push_back(word.time_s);
  if (c.mesh_depth_mm) depth_mm.push_back(bracket_error_mm(*word.depth_mm, *c.mesh_depth_mm));
  if (!c.overlap_is_depth || c.truth(false).certain_mm <= 0.0) return;
  overlap_mm.push_back(bracket_error_mm(*word.depth_mm, std::max(0.0, c.overlap_mm({}))));
}

std::string name_of(const JudgedCase& c) {
  return std::string(name_of(c.family)) + ":" + std::to_string(c.seed);
}

}  // namespace mortise::bench
