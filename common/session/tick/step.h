#pragma once
#include <memory>
#include <span>

#include "common/messages/increment.h"
#include "common/messages/report.h"
#include "common/session/world/world.h"

namespace mortise {

/// Memory and threads that ticks reuse. Holds no state of the session: any Scratch gives the same
/// report.
class Scratch {
 public:
  explicit Scratch(int threads = 1);
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// One tick (README): gather, pairs, first contact, depth and verdict, commit, report.
/// Deterministic: same world, same increments, same build -> the same report bit for bit, at any
/// number of threads. No clock, no I/O, no logging.
StepReport step(World& world, std::span<const Increment> increments, Scratch& scratch);

}  // namespace mortise
