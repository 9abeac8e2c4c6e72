#pragma once
#include <cstdint>
#include <memory>

#include "common/geometry/plane_faces.h"
#include "common/math/interval.h"
#include "common/math/pose.h"

namespace mortise {

struct SharpDecision;

/// One part of a pair that is decided by the sharp offset bodies of both.
struct SharpPart {
  const Solid* solid = nullptr;
  const PlaneFaces* planes = nullptr;
};

struct SharpQuery {
  SharpPart a, b;
  Pose X_BA;
  double depth_mm = 0.0;  ///< deeper than this is told as at least so deep
  /// The pair is decided already, to a smaller depth: points that were found stay, only what is
  /// deeper is asked for, and little work is done for it.
  const SharpDecision* known = nullptr;
  /// False: a pair with a corner of unknown travel is searched until that is met, for tests. The
  /// state may be another one then, but for kDecided.
  bool ask_ahead = true;
};

/// The deepest common point of one layer of both parts. The depth of x in a body is the largest d
/// such that x is in the body with all faces moved inwards by d.
struct SharpDepth {
  /// Bracket of twice the largest lesser depth: > 0 if and only if the interiors meet; below zero
  /// a gap. Between -2 and 2 depth_mm; beyond that at least so much.
  Interval margin_mm;
  /// A gap of -margin is so much wider between the bodies: -margin / facing, where convex edges and
  /// corners meet. 0 < facing <= 1.
  double facing = 1.0;
  /// With a margin above zero: bracket of the largest sum of both depths, both above zero.
  Interval overlap_mm;
  bool has_point = false;  ///< margin.lo is reached at point_B, verified in both bodies
  Vec3 point_B = Vec3::Zero();
  std::uint32_t face_a = 0, face_b = 0;  ///< that bound the depth at point_B
};

struct SharpDecision {
  enum class State : std::uint8_t {
    kDecided,
    kNotPlane,  ///< round faces, or a band that is a mesh error, near the overlap
    kTooSharp,  ///< a tip or edge travels farther than PlaneFaces::kMostTravel
    kTooMuch,   ///< the limit of work was reached
  };
  State state = State::kDecided;
  SharpDepth least, largest;
  std::uint64_t programs = 0;  ///< linear programs solved
};

/// Where the boxes of both parts, grown by what their corners travel, meet (README, section 10).
/// Deterministic, without memory of other queries.
SharpDecision decide(const SharpQuery& query);

}  // namespace mortise
