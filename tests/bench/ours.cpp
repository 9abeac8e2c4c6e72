#include "common/ccd/first_contact.h"
#include "tests/bench/methods.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

Method make(const MotionSet& set, double accuracy_mm, bool portable) {
  char name[48];
  std::snprintf(name, sizeof name, "mortise%s, %.0e mm", portable ? " scalar" : "", accuracy_mm);
  auto scratch = std::make_shared<CcdScratch>();
  ContactQuery query;
  query.a = set.moving.get();
  query.b = set.fixed.get();
  query.accuracy_mm = accuracy_mm;
  query.portable = portable;
  set.moving->bvh(), set.fixed->bvh();
  return {name, true, portable, accuracy_mm, [query, scratch](const Motion& motion) mutable {
            query.motion_a = motion;
            FirstContact found;
            Answer answer;
            answer.time_s = least_time_s([&] { found = first_contact(query, *scratch); });
            switch (found.state) {
              case ContactState::kFree:
                answer.outcome = Outcome::kFree;
                break;
              case ContactState::kContact:
              case ContactState::kTouchingAtStart:
              case ContactState::kOverlappingAtStart:
                answer.outcome = Outcome::kContact;
                answer.t = found.t_contact;
                break;
              default:
                answer.outcome = Outcome::kUndecided;
            }
            return answer;
          }};
}

}  // namespace

Method ours(const MotionSet& set, double accuracy_mm) { return make(set, accuracy_mm, false); }
Method ours_portable(const MotionSet& set, double accuracy_mm) {
  return make(set, accuracy_mm, true);
}

}  // namespace mortise::bench
