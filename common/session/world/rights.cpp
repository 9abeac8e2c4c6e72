#include "common/session/world/rights.h"

#include <algorithm>

namespace mortise {

bool matches_name(std::string_view pattern, std::string_view text) {
  // Greedy with one point to come back to: linear for every pattern people write.
  std::size_t p = 0, t = 0, star = std::string_view::npos, resume = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

bool may_hold(const World& world, const User& user, const Part& part) {
  if (user.role == Role::kObserver) return false;
  if (world.may_hold.empty()) return true;
  for (const Scenario::UserSpec& spec : world.may_hold)
    if (matches_name(spec.name, user.name))
      for (const std::string& name : spec.may_hold)
        if (matches_name(name, part.name)) return true;
  return false;
}

Refusal refusal_of(const World& world, const Increment& increment) {
  const User* user = world.find(increment.user);
  if (!user || !user->present) return Refusal::kUnknownUser;
  const Part* part = world.find_present(increment.part);
  if (!part) return Refusal::kUnknownPart;
  if (!part->moving) return Refusal::kPartIsStatic;
  if (user->role == Role::kObserver) return Refusal::kObserver;
  if (part->holder != increment.user) return Refusal::kNotHolder;
  return refusal_of(increment, world.max_jump_mm);
}

bool may_change(const World& world, const User& user, Right right) {
  if (user.role == Role::kObserver) return false;
  if (world.may_hold.empty()) return user.role != Role::kBot || right == Right::kReview;
  for (const Scenario::UserSpec& spec : world.may_hold) {
    if (!matches_name(spec.name, user.name)) continue;
    if (!spec.may && right == Right::kReview && !spec.may_hold.empty()) return true;
    if (spec.may && std::find(spec.may->begin(), spec.may->end(), right) != spec.may->end())
      return true;
  }
  return false;
}

Role role_wanted(const World& world, const std::string& user_name) {
  for (const Scenario::UserSpec& spec : world.may_hold)
    if (spec.role != Role::kUnknown && matches_name(spec.name, user_name)) return spec.role;
  return Role::kUnknown;
}

}  // namespace mortise
