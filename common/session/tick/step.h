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

/// Judges every pair at the present poses without moving anything (what `mortise judge` shows).
struct PairVerdicts {
  PartId a, b;
  std::vector<Verdict> verdicts;  ///< a region each, worst first
  double distance_mm = 0.0;       ///< of the meshes when they do not cross
  bool excluded = false;
  bool no_inside = false;
};
struct JudgeReport {
  std::vector<PairVerdicts> pairs;  ///< pairs with at least one verdict, and excluded ones
  StepCounters counters;
};
JudgeReport judge(World& world, Scratch& scratch, bool full_brackets);

}  // namespace mortise
