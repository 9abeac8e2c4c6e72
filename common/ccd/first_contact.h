#pragma once
#include <cstdint>

#include "common/base/constants.h"
#include "common/ccd/ccd_scratch.h"
#include "common/geometry/solid.h"
#include "common/motion/motion.h"

namespace mortise {

enum class ContactState : std::uint8_t {
  kUnknown = 0,
  kFree,             ///< implies: no contact for any t in [0, 1]
  kContact,          ///< implies: none for t < t_clear; at t_contact within accuracy, and not yet
                     ///< overlapping
  kUndecided,        ///< work cap: none for t < t_clear, nothing is said beyond
  kTouchingAtStart,  ///< within separation + accuracy / 4 at t = 0; no triangle lies deeper than
                     ///< twice the accuracy in another
  kOverlappingAtStart,  ///< surfaces cross at t = 0, or one part is inside the other
};

/// Solids with a triangle each, motions that are valid(), lengths from 0 to kLargestCoordinate_mm:
/// anything else is a caller's fault and stops the program with a sentence. Odd but lawful:
/// accuracy 0 is as fine as rounding allows, a work cap of 0 ends in kUndecided at once.
struct ContactQuery {
  const Solid* a = nullptr;
  const Solid* b = nullptr;
  Motion motion_a, motion_b;  ///< either may be still; both may move
  double accuracy_mm = kAccuracyDefault_mm;
  double separation_mm = 0.0;  ///< first time within this distance (0: first touch)
  std::uint64_t work_cap = kCcdWorkCap;
  /// Known to be clear before: t_clear of an answer to this query that came to the end of its work
  /// cap, and with which the parts did not touch at the start. 0: nothing is known.
  double t_from = 0.0;
  bool check_contained = true;  ///< ask whether one starts inside the other
  /// Parts that touch at the start are the normal case in assembly. When set, such a pair is not
  /// answered with kTouchingAtStart; the answer is the first time at which some triangle lies
  /// deeper than accuracy_mm in one of the other part (kContact; at once when the touching places
  /// press on) or that this never happens (kFree: the pair separates, slides or rolls). A pair that
  /// already lies that deep and only slides may go an eighth of the accuracy deeper.
  /// touched_at_start tells the case. Pairs that do not touch at the start are answered as ever.
  bool ignore_touching_at_start = false;
  bool portable = false;  ///< baseline instructions only: the same answer to the last bit, slower
};

struct CcdWork {
  std::uint64_t box_tests = 0, leaf_tests = 0, triangle_tests = 0, advances = 0;
};

/// 0 <= t_clear <= t_contact <= 1. World frame, mm. touching / overlapping at start: both times 0.
/// accuracy_mm is raised to 64 times the rounding of the pair's coordinates where it is finer.
struct FirstContact {
  ContactState state = ContactState::kUnknown;
  double t_clear = 0.0;
  double t_contact = 1.0;
  double distance_mm =
      0.0;  ///< of the meshes at t_contact; at t = 1 a lower bound when free (0: not known)
  std::uint32_t triangle_a = 0, triangle_b = 0;
  Vec3 point_a_W = Vec3::Zero(), point_b_W = Vec3::Zero();
  bool touched_at_start = false;  ///< with ignore_touching_at_start: and was let go
  bool contained = false;  ///< kOverlappingAtStart, and no surfaces were found to cross: one starts
                           ///< inside the other, or they share a skin
  CcdWork work;
};

/// First contact of two rigid meshes in one tick. Guarantee: never a miss, never late; see
/// ContactState. Deterministic. Per-pair advancement on the trees, earliest first
/// (README, sections 2 and 3).
FirstContact first_contact(const ContactQuery& query, CcdScratch& scratch);

/// The slow twin: sub-steps [0,1] and asks distance at each; never proves freedom, finds contacts
/// no finer than a step.
FirstContact first_contact_by_sampling(const ContactQuery& query, int steps, CcdScratch& scratch);

}  // namespace mortise
