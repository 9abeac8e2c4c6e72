#include "common/session/world/standing.h"

#include <algorithm>
#include <utility>

namespace mortise {

bool same_target(const Decision& x, const Decision& y) {
  const auto is_exclusion = [](Decision::Kind kind) {
    return kind == Decision::Kind::kSetExclusion || kind == Decision::Kind::kDropExclusion;
  };
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
  Decision turned = later;
  turned.part = later.details.other_part;
  turned.details.other_part = later.part;
  std::swap(turned.details.feature, turned.details.other_feature);
  return same_target(turned, declared);
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

}  // namespace

std::vector<Decision> standing_decisions(const World& world) {
  std::vector<Decision> standing;
  standing.reserve(world.declared.size() + world.standing.size() + world.guides.size());
  for (const Decision& declared : world.declared)
    if (is_of_present(world, declared) &&
        std::ranges::none_of(world.standing, [&](auto& d) { return replaces(d, declared); }))
      standing.push_back(declared);
  for (const Decision& decision : world.standing)
    if (is_of_present(world, decision)) standing.push_back(decision);
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
