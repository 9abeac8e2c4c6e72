#include "client/picture/told_overlap.h"

#include <cmath>

#include "common/evaluation/open_bracket.h"
#include "common/messages/length_text.h"

namespace mortise {

double told_overlap_mm(const Verdict& verdict) {
  const Interval& delta = verdict.delta_mm;
  if (!is_open(delta)) return delta.middle();
  return verdict.collision_class == CollisionClass::kFake ? delta.hi : delta.lo;
}

std::string told_overlap_text(const Verdict& verdict) {
  const double told = told_overlap_mm(verdict);
  const bool open = is_open(verdict.delta_mm), at_most = told == verdict.delta_mm.hi;
  const char* bound = !open ? "" : at_most != (told < 0.0) ? "at most " : "at least ";
  return std::string(told < 0.0 ? "apart " : "overlap ") + bound + length_text(std::fabs(told));
}

}  // namespace mortise
