#pragma once
#include <cstdint>
#include <string>

#include "common/base/ids.h"
#include "common/math/interval.h"
#include "common/math/types.h"

namespace mortise {

/// The paper's three classes. kNone: nothing to report (no overlap, nor any possible).
enum class CollisionClass : std::uint8_t { kNone = 0, kFake = 1, kPotential = 2, kReal = 3 };

/// Where the knowledge of the mesh error comes from, best first. A verdict names the worst grade
/// that it used.
enum class DeviationGrade : std::uint8_t {
  kUnknown = 0,
  kPlanar = 1,  ///< planar faces: no error
  kDeclaredFeature = 2,
  kRecognizedFeature = 3,
  kDeclaredChord = 4,
  kEstimated = 5,  ///< never called guaranteed
  kNominal = 6,    ///< nothing known: the mesh is taken for the surface
};

/// Does the designer, or a plane, answer for the surface, and not its mesh alone? Only then may a
/// finding be said to hold however the parts are made.
inline bool is_declared(DeviationGrade grade) {
  return grade == DeviationGrade::kPlanar || grade == DeviationGrade::kDeclaredFeature;
}

/// Shape of a face, or of the pair of faces of a region (concave-convex determination of the
/// paper).
enum class FaceShape : std::uint8_t { kUnknown = 0, kPlanar, kConvex, kConcave, kSaddle, kEdge };

/// How the shortest verified motion separates part A from part B.
enum class SeparationWay : std::uint8_t {
  kNone = 0,      ///< none was found
  kBack = 1,      ///< back along the tick's motion
  kNormal = 2,    ///< along the normal of the region
  kFitted = 3,    ///< a small turn and shift, fitted to the contact points
  kAxis = 4,      ///< along the axis of a round face: drawn out of its hole
  kStraight = 5,  ///< along another straight line
};

/// What is known of the way of a separating motion, before its end.
enum class SeparationPath : std::uint8_t {
  kUnknown = 0,  ///< not asked
  kFree = 1,     ///< the pair comes out without going deeper, and no other part is met
  kDeeper = 2,   ///< the pair goes deeper before it comes free, or meets again
  kBlocked = 3,  ///< another part is in the way
};

inline constexpr double kProbabilityUnknown = -1.0;

/// The judged collision of one region of one pair of parts. World frame, mm.
/// delta: overlap of the meshes, -min_p(sd_A + sd_B), negative when apart. Class by the two
/// thresholds: real iff delta > real_above, fake iff delta <= fake_below (over every pair of faces
/// of the region), else potential.
struct Verdict {
  CollisionClass collision_class = CollisionClass::kNone;
  Interval delta_mm;
  Interval gpd_mm;  ///< generalized penetration depth, bracket
  double fake_below_mm = 0.0;
  double real_above_mm = 0.0;
  double margin_mm =
      0.0;  ///< distance of delta to the nearest threshold that would change the class, >= 0
  double probability = 0.0;  ///< P(interference): 0 for fake, 1 for real; of kPotential where the
                             ///< surfaces are known but for tolerances, else kProbabilityUnknown
  double travel_mm = 0.0;  ///< path length from contact to target, largest over the region's points
  double normal_travel_mm = 0.0;  ///< its part along the normal
  Vec3 point_W = Vec3::Zero();
  Vec3 normal_W = Vec3::Zero();  ///< from B to A
  double area_mm2 = 0.0;
  bool has_witness = false;
  Vec3 witness_W = Vec3::Zero();  ///< a point inside both real parts, for kReal
  Vec3 separation_translation_mm =
      Vec3::Zero();  ///< the motion that reaches gpd_mm.hi and separates: of separation_about_W
  Vec3 separation_rotation_rad = Vec3::Zero();  ///< about that point, with constant speed
  Vec3 separation_about_W = Vec3::Zero();       ///< a point of the part that moves, as it stands
  bool separation_of_b = false;                 ///< B moves and A stays, else A moves
  SeparationWay separation_way = SeparationWay::kNone;
  SeparationPath separation_path = SeparationPath::kUnknown;
  PartId separation_blocker;  ///< of kBlocked: the first part that is met
  FaceShape shape_a = FaceShape::kUnknown;
  FaceShape shape_b = FaceShape::kUnknown;
  DeviationGrade grade = DeviationGrade::kUnknown;
  std::string face_a, face_b;  ///< feature names, empty when none
  std::string explanation;     ///< one sentence
};

inline bool has_probability(const Verdict& verdict) { return verdict.probability >= 0.0; }

}  // namespace mortise
