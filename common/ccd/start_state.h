#pragma once
#include "common/ccd/leaf_pair.h"

// What is already the case at t = 0.
namespace mortise::ccd {

struct StartState {
  bool near = false;         ///< some pair of triangles is within contact_mm, or crosses
  bool overlapping = false;  ///< some triangle lies deeper than twice accuracy_mm in another
  bool skin_shared = false;  ///< nothing crosses, and yet the interiors meet behind a common skin
  bool pressing = false;     ///< a pair at or below `deep_mm` closes by more than it may
  Nearest nearest;           ///< deepest, else nearest pair; signed when the triangles cross
};

struct StartQuery {
  double contact_mm = 0.0;  ///< separation + accuracy
  double accuracy_mm = 0.0;
  double deep_mm = 0.0;  ///< signed distance at or below which motion is looked at
};

/// motion.state() must be at t = 0.
StartState start_state(PairMotion& motion, const Solid& a, const Solid& b, const StartQuery& query,
                       CcdScratch& scratch, CcdWork& work);

}  // namespace mortise::ccd

namespace mortise {

/// Unknown: a shell of one part lies within the box of the other, of which nobody can say what is
/// inside: it has no inside, or a crack there.
enum class Containment : std::uint8_t { kNo = 0, kUnknown, kYes };

/// Does a shell of one part lie inside the other, deeper than margin_mm, at these poses? For
/// surfaces that do not cross.
Containment containment(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                        double margin_mm);

/// The same where it is known.
bool contained(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
               double margin_mm);

}  // namespace mortise
