#pragma once
#include <span>
#include <vector>

#include "common/base/constants.h"
#include "common/base/result.h"
#include "common/geometry/feature.h"
#include "common/math/pose.h"
#include "common/messages/constraint.h"

namespace mortise {

/// Singular values below this share of the largest count as zero when a part is guided, so that
/// what two constraints have in common to a millionth counts once. Far above the rounding of
/// features that were fitted to a mesh (1e-9), far below what a designer means by an angle. Read by
/// session.
inline constexpr double kGuideRankShare = 1e-6;

/// A guided part satisfies its constraints up to this, mm, and constraints that cannot all be
/// satisfied this closely contradict each other. A thousandth of the distance at which meshes count
/// as touching, so that drift of a guided part never matters to a collision. Read by session.
inline constexpr double kGuideAccuracy_mm = 1e-9;
static_assert(kGuideAccuracy_mm <= 1e-3 * kAccuracyDefault_mm);

enum class ElementKind : std::uint8_t { kPoint, kLine, kPlane };

/// The element of a feature that a constraint uses: a centre, an axis, a plane. mm.
struct Element {
  ElementKind kind = ElementKind::kPoint;
  Vec3 point = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();  ///< unit; of the axis, or the outward normal
};

/// One constraint as geometry. Lines and planes of a relation are parallel (a line lies in the
/// direction of a plane), at distance_mm: from a plane along its normal, else >= 0; two lines, a
/// line and a point, or two points at distance 0 coincide.
struct Relation {
  Element a, b;          ///< a moves
  bool opposed = false;  ///< directions point against each other
  double distance_mm = 0.0;
};

/// The relation that a constraint of this kind requires of two surfaces, each in its own frame. An
/// error explains in one sentence why the kind cannot hold between them. Tangent: cylinders touch
/// along a line, their axes parallel.
Result<Relation> relation_between(ConstraintKind kind, const Surface& a, const Surface& b,
                                  double distance_mm);

Element moved(const Element& element, const Pose& X);

/// Rigid displacement of a body: x -> center + shift_mm + turn * (x - center).
struct Displacement {
  Quat turn = Quat::Identity();
  Vec3 shift_mm = Vec3::Zero();
};

struct GuideQuery {
  std::span<const Relation> relations;  ///< world frame, a before the displacement
  Vec3 center_W = Vec3::Zero();
  double lever_mm = 1.0;  ///< a turn by w counts as a shift by lever_mm * w: the body's radius
  Displacement wanted;
};

/// The displacement that the relations allow.
struct GuidedDisplacement {
  Displacement displacement;  ///< nearest to the wanted one, to second order in the difference
  double residual_mm = 0.0;   ///< largest violation left, turns times the lever
  int freedom = 6;            ///< motions left to first order, 0..6
};

/// Newton steps of least norm (shift, lever * turn) from the wanted displacement to the relations.
/// They converge quadratically, to rounding, from any near start. Redundant relations are the
/// normal case: singular values below kGuideRankShare of the largest count as zero. Contradicting
/// relations end at the least-squares solution, with residual_mm > 0. At most kMostRelations
/// relations.
GuidedDisplacement guided(const GuideQuery& query);
inline constexpr std::size_t kMostRelations = 8;  ///< six leave no freedom

/// The rows over (shift, lever * turn) that must stay zero to first order, at the wanted
/// displacement.
std::vector<Eigen::Matrix<double, 6, 1>> guide_rows(const GuideQuery& query);

/// Largest violation of the relations at the wanted displacement, mm, turns times the lever.
double violation_mm(const GuideQuery& query);

}  // namespace mortise
