#pragma once
#include <cstdint>

#include "common/messages/verdict.h"

namespace mortise {

/// The colours of a class, 0xRRGGBB: of words and marks on light and on dark ground, and of heat
/// from the lightest to the deepest of its zone. The page has the same table
/// (client/web/page/session/class_colours.js); a test compares them.
struct ClassColours {
  std::uint32_t light, dark, heat_light, heat_deep;
};

constexpr ClassColours class_colours(CollisionClass collision_class) {
  switch (collision_class) {
    case CollisionClass::kReal:
      return {0xc62828, 0xff6b6b, 0xe8575b, 0x8a0d2a};
    case CollisionClass::kPotential:
      return {0xa86300, 0xf5b942, 0xf8dc6a, 0xe8842a};
    case CollisionClass::kFake:
      return {0x1668b3, 0x63b3f4, 0xb5d8f5, 0x2b76b8};
    case CollisionClass::kNone:
      break;
  }
  return {0x73737a, 0x73737a, 0x73737a, 0x73737a};
}

}  // namespace mortise
