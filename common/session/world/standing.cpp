#include "common/session/world/standing.h"

#include <algorithm>
#include <utility>

namespace mortise {

namespace {

bool is_exclusion(Decision::Kind kind) {
  return kind == Decision::Kind::kSetExclusion || kind == Decision::Kind::kDropExclusion;
}

}  // namespace

bool same_target(const Decision& x, const Decision& y) {
  const Details &a = x.details, &b = y.details;
  if (is_exclusion(x.kind) && is_exclusion(y.kind))
    return std::minmax(x.part, a.other_part) == std::minmax(y.part, b.other_part);
  return x.kind == y.kind && x.part == y.part && a.other_part == b.other_part &&
         a.feature == b.feature && a.other_feature == b.other_feature;
}

namespace {

// A fit is the same whichever of its ends is named first.
bool replaces(const Decision& later, const Decision& declared) {
  if (same_target(later, declared)) return true;
  const Details &a = later.details, &b = declared.details;
  return later.kind == declared.kind && later.part == b.other_part &&
         a.other_part == declared.part && a.feature == b.other_feature &&
         a.other_feature == b.feature;
}

// What is said of a part that was removed, or of a face that its mesh no longer has, holds again
// when it comes back.
bool is_of_present(const World& world, const Decision& decision) {
  const auto is_gone = [&](PartId id, const std::string& feature) {
    if (!id) return false;
    const Part* part = world.find_present(id);
    if (part == nullptr) return true;
    return part->edits > 0 && !feature.empty() &&
           std::ranges::none_of(part->features, [&](auto& f) { return f.name == feature; });
  };
  const Details& details = decision.details;
  return !is_gone(decision.part, details.feature) &&
         !is_gone(details.other_part, details.other_feature);
}

// In order. `see` returns false where it has seen enough; then so does this.
template <class See>
bool each_standing(const World& world, See see) {
  for (const Decision& declared : world.declared)
    if (is_of_present(world, declared) &&
        std::ranges::none_of(world.standing, [&](auto& d) { return replaces(d, declared); }) &&
        !see(declared))
      return false;
  for (const Decision& decision : world.standing)
    if (is_of_present(world, decision) && !see(decision)) return false;
  for (const Part& part : world.parts) {
    if (!part.asked_by) continue;
    Decision ask;
    ask.kind = Decision::Kind::kAskHandOver;
    ask.user = part.asked_by;
    ask.part = part.id;
    ask.details.other_user = part.holder;
    if (!see(ask)) return false;
  }
  for (const Guide& guide : world.guides) {
    Decision added;
    added.kind = Decision::Kind::kAddConstraint;
    added.user = guide.user;
    added.part = guide.constraint.held.part;
    added.details.constraint = guide.constraint;
    added.details.constraint_id = guide.id;
    if (!see(added)) return false;
  }
  return true;
}

}  // namespace

std::vector<Decision> standing_decisions(const World& world) {
  std::vector<Decision> standing;
  standing.reserve(world.declared.size() + world.standing.size() + world.guides.size());
  each_standing(world, [&](const Decision& decision) {
    standing.push_back(decision);
    return true;
  });
  return standing;
}

bool are_standing(const World& world, std::span<const Decision> decisions) {
  std::size_t seen = 0;
  const bool all_known = each_standing(world, [&](const Decision& decision) {
    return seen < decisions.size() && decisions[seen++] == decision;
  });
  return all_known && seen == decisions.size();
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
