#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace mortise {

/// The role of a user. An observer may not change anything.
enum class Role : std::uint8_t { kUnknown = 0, kDesigner = 1, kObserver = 2, kBot = 3 };
inline constexpr std::uint8_t kRoleCount = 4;

/// "designer", "observer", "bot"; nothing for any other word.
std::optional<Role> role_named(std::string_view name);

}  // namespace mortise
