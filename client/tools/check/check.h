#pragma once
#include <set>
#include <string>
#include <vector>

#include "client/tools/check/mating.h"
#include "common/io/scenario/open_scene.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/pair_gap.h"

namespace mortise {

struct CheckOptions {
  double min_gap_mm = 0.0;            ///< 0: as the scenario says
  std::set<std::string> unexplained;  ///< names of relations that explain nothing
  int threads = 2;
  bool exact_volumes = true;  ///< keep the exact solids: explanations need their volumes
};

/// Pairs of parts that stand to each other in the same way, judged once.
struct CheckedPair {
  PartId a, b;  ///< the first of them
  std::vector<std::pair<PartId, PartId>> all;
  CollisionClass collision_class = CollisionClass::kNone;  ///< of the worst place
  std::vector<Verdict> verdicts;                           ///< worst first
  Mating mating;
  /// Overlap or gap within what the file itself is accurate to: the parts touch as drawn.
  bool is_contact = false;
  double accuracy_mm = 0.0;  ///< of the surfaces that meet; what a contact may be off
  bool explained = false;
  std::string reason;         ///< why it is explained, or why an explanation does not hold
  double common_mm3 = -1.0;   ///< exact volume in common; negative: not asked, or not known
  double thickness_mm = 0.0;  ///< of the thickest piece of it, 2 V / F
  bool not_examined = false;
  bool muted = false;  ///< inside of a sub-assembly that is bought
  std::string inside;  ///< the product that all of them lie in, or empty
};

struct CheckCounts {
  std::size_t unexplained_real = 0, explained_real = 0, potential = 0, fake = 0, contacts = 0,
              near = 0, not_judged = 0, explained_potential = 0, muted = 0;
};

struct CheckReport {
  std::vector<CheckedPair> pairs;  ///< in the order in which a designer reads them
  std::vector<NearPair> near;      ///< nearest first
  double min_gap_mm = 0.0;         ///< of pairs without one of their own; 0: none is asked
  bool asks_gaps = false;
  std::vector<std::string> not_judged;  ///< bodies and pairs, with why
  std::vector<std::string> notes;
  std::size_t parts = 0, products = 0, candidate_pairs = 0, judged_pairs = 0;
  CheckCounts counts;
};

/// Judges an opened scene as it stands. Where the exact solids of its assembly were not kept, no
/// overlap is explained; they are asked once.
CheckReport check_scene(OpenedScene& opened, const CheckOptions& options);

/// An overlap is explained when its exact volume is at most what hole and shaft explain, plus this
/// share of it for run-outs and points of screws, plus this volume for rounding.
inline constexpr double kExplainedShare = 0.1, kExplainedSlack_mm3 = 1e-3;

/// A contact may be off by what the corners of the file are off its surfaces, and this; at most
/// kMostContact_mm.
inline constexpr double kLeastContact_mm = 1e-3, kMostContact_mm = 0.02;

/// Work of one overlap (see OverlapQuery): of all pairs, and of those that this and the exact
/// solids leave open, and that are told. The first is little where exact solids decide what it
/// leaves open.
inline constexpr std::uint64_t kFirstWork = 3'000, kTellWork = 30'000;

/// Sorts and counts; called by check_scene.
void order_and_count(CheckReport& report);

}  // namespace mortise
