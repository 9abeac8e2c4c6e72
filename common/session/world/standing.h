#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "common/messages/command.h"
#include "common/session/world/world.h"

namespace mortise {

/// Are both about the same fit, tolerance, exclusion or policy? The later of two holds.
bool same_target(const Decision& x, const Decision& y);

/// The decisions that are in force, see Snapshot::standing. Each as it was made, but without the
/// user where another user has that id now.
std::vector<Decision> standing_decisions(const World& world);

/// Are these in force, and no others, in the order of standing_decisions()? Makes no list of them.
bool are_standing(const World& world, std::span<const Decision> decisions);

/// The changes from `before` to `after`: first what is no longer in force, then what newly is.
std::vector<StandingChange> standing_changes(std::span<const Decision> before,
                                             std::span<const Decision> after, std::uint64_t tick);

}  // namespace mortise
