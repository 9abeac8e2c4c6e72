#include "common/session/world/standing.h"

#include <algorithm>

namespace mortise {

std::vector<Decision> standing_decisions(const World& world) {
  std::vector<Decision> standing = world.standing;
  for (const Part& part : world.parts) {
    if (!part.asked_by) continue;
    Decision& ask = standing.emplace_back();
    ask.kind = Decision::Kind::kAskHandOver;
    ask.user = part.asked_by;
    ask.part = part.id;
    ask.details.other_user = part.holder;
  }
  for (const Guide& guide : world.guides) {
    Decision& added = standing.emplace_back();
    added.kind = Decision::Kind::kAddConstraint;
    added.user = guide.user;
    added.part = guide.constraint.held.part;
    added.details.constraint = guide.constraint;
    added.details.constraint_id = guide.id;
  }
  return standing;
}

std::vector<StandingChange> standing_changes(std::span<const Decision> before,
                                             std::span<const Decision> after, std::uint64_t tick) {
  // One tick changes few of them: what is the same at both ends is passed over.
  const auto [first, first_after] = std::ranges::mismatch(before, after);
  before = {first, before.end()};
  after = {first_after, after.end()};
  while (!before.empty() && !after.empty() && before.back() == after.back()) {
    before = before.first(before.size() - 1);
    after = after.first(after.size() - 1);
  }
  std::vector<StandingChange> changes;
  const auto add_missing = [&](std::span<const Decision> from, std::span<const Decision> in,
                               bool holds) {
    for (const Decision& decision : from)
      if (std::ranges::find(in, decision) == in.end()) changes.push_back({tick, holds, decision});
  };
  add_missing(before, after, false);
  add_missing(after, before, true);
  return changes;
}

}  // namespace mortise
