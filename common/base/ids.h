#pragma once
#include <compare>
#include <cstdint>
#include <functional>

namespace mortise {

/// A typed id; 0 is "none". Parts and users are numbered from 1 in the order in which a session
/// learns of them.
template <class Tag>
struct Id {
  std::uint32_t value = 0;
  constexpr explicit operator bool() const { return value != 0; }
  friend constexpr auto operator<=>(const Id&, const Id&) = default;
};

using PartId = Id<struct PartTag>;
using UserId = Id<struct UserTag>;
using ClashId = Id<struct ClashTag>;

}  // namespace mortise

template <class Tag>
struct std::hash<mortise::Id<Tag>> {
  std::size_t operator()(mortise::Id<Tag> id) const noexcept { return id.value; }
};
