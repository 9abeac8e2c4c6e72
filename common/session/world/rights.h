#pragma once
#include <string>

#include "common/messages/increment.h"
#include "common/session/world/world.h"

namespace mortise {

/// Does "pin_3" match "pin*"? '*' stands for any sequence of characters, also an empty one.
bool matches_name(std::string_view pattern, std::string_view text);

/// May the user hold the part, by role and by the `users` of the scenario? Observers hold nothing;
/// without `users` everybody else may hold every moving part.
bool may_hold(const World& world, const User& user, const Part& part);

/// May this increment be carried out, as far as its sequence number does not matter? Its user is
/// present and holds its part, which moves, and its numbers are within their ranges.
Refusal refusal_of(const World& world, const Increment& increment);

/// May the user change this, by role and by the `users` of the scenario? Observers change nothing.
/// Without `users` designers change everything and bots set the review status of clashes. With
/// `users` a user changes what `may` lists; without `may`, users who may hold something may review.
bool may_change(const World& world, const User& user, Right right);

/// The role that the scenario requires of a user of this name; kUnknown: any.
Role role_wanted(const World& world, const std::string& user_name);

}  // namespace mortise
