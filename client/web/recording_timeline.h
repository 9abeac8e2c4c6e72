#pragma once
#include "client/web/recording.h"

namespace mortise::web {

/// The message `timeline` (protocol.md): where a log begins and ends, and what it was like over
/// time.
Json timeline_of(const Recording& recording);

}  // namespace mortise::web
