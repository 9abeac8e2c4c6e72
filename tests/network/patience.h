#pragma once

namespace mortise::test {

/// How long what must happen is waited for: on a busy machine too, only a fault takes so long.
inline constexpr double kPatience_s = 60.0;

}  // namespace mortise::test
