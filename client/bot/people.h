#pragma once
#include <memory>

#include "client/bot/behaviour.h"

namespace mortise {

/// Behaviours about each other's parts and about clashes rather than about motion.

/// Wants one part (number `first` of the moving ones): grabs it when it is free, else asks its
/// holder for it. After holding it for hold_s it consents to a request, and declines the first one
/// when `hesitates`.
struct ShareSettings {
  PartId only;
  double hold_s = 0.5;
  bool hesitates = false;
};
std::unique_ptr<Behaviour> make_share(const ShareSettings& settings, std::unique_ptr<Path> path);

/// Leads a part for a while, lets go, takes the move back, repeats it, and begins again.
std::unique_ptr<Behaviour> make_revise(std::size_t first, PartId only, std::unique_ptr<Path> path);

/// Does what `hands` does and sets the status of the open clashes, one a second, from new over
/// active, reviewed and approved to resolved.
std::unique_ptr<Behaviour> make_reviewer(std::unique_ptr<Behaviour> hands);

}  // namespace mortise
