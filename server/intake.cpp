#include "server/intake.h"

namespace mortise {

std::uint64_t InboxCounters::refused_in_all() const {
  std::uint64_t sum = 0;
  for (std::uint64_t count : refused) sum += count;
  return sum;
}

void Intake::clear() {
  decisions.clear();
  increments.clear();
  join_replies.clear();
  replies.clear();
  refused.clear();
  uploads.clear();
  acks.clear();
  turned_away.clear();
  follower_came = superseded = false;
  superseded_by.clear();
  joined = false;
}

}  // namespace mortise
