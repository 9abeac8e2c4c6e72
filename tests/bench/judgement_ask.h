#pragma once
#include <optional>

#include "common/session/tick/judgement.h"
#include "tests/bench/judgement_parts.h"

namespace mortise::bench {

/// Two parts as they come to the engine, with their bands.
struct KnownPair {
  Part a, b;
};

/// A judged part with what is known of its surface.
Part part_of(std::uint32_t id, const JudgedPart& judged, SurfaceBand band);

/// One word about a case, of ours or of a peer.
struct Word {
  CollisionClass collision_class = CollisionClass::kNone;
  double time_s = 0.0;               ///< CPU
  std::optional<Interval> depth_mm;  ///< of the meshes: bracket, or the one value of a peer
  std::optional<Interval> certain_mm, possible_mm;  ///< of the worst region
  std::optional<Vec3> witness_W;                    ///< that of the verdict
  bool capped = false;
};

constexpr std::uint64_t kFullWorkCap = 200'000;  ///< what a full bracket may take
struct AskOurs {
  Refinement refinement = Refinement::kDecided;
  bool swapped = false;             ///< B before A
  std::uint64_t work_cap = 10'000;  ///< a tick's, see kTickOverlapCap in the session
};
/// Judges the pair at rest, as a tick does.
Word ask_ours(const KnownPair& pair, const Pose& X_WA, const Pose& X_WB, const AskOurs& how);

}  // namespace mortise::bench
