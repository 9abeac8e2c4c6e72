#pragma once
#include <vector>

#include "common/math/types.h"

namespace mortise {

/// One place at which a body touches an obstacle.
struct Hold {
  Vec3 point_W = Vec3::Zero();
  Vec3 normal_W = Vec3::UnitZ();  ///< unit; out of the obstacle
  double gap_mm = 0.0;            ///< how far the body may go against the normal
};

struct Twist {
  Vec3 shift_mm = Vec3::Zero();
  Vec3 turn_rad = Vec3::Zero();
};

struct TangentQuery {
  Twist wanted;
  Vec3 center_W = Vec3::Zero();  ///< the twist is about this point
  double lever_mm = 1.0;         ///< a turn by w counts as a shift by lever_mm * w
  bool may_turn = true;          ///< false: the turn stays as wanted, only the shift gives way
  std::vector<Hold> holds;
  /// Rows over (shift, lever * turn) that have to stay zero: what guides the body.
  std::vector<Eigen::Matrix<double, 6, 1>> guides;
};

struct TangentMove {
  bool possible = false;  ///< false: the holds leave no motion near the wanted one
  Twist twist;
  int active = 0;  ///< holds in contact after the motion
};

/// The twist nearest to the wanted one, |shift|^2 + lever^2 |turn|^2, among those that keep
///   normal . (shift + turn x (point - center)) >= -gap
/// at every hold: the projection onto the tangent cone of the contacts (Moreau 1988, the sweeping
/// process; gaps and all, one step of its catching-up scheme). Solved as least distance programming
/// by non-negative least squares (Lawson and Hanson 1974, ch. 23): finite, no tuning, the same bits
/// for the same holds in the same order. O(holds^2) for the few dozen holds of a contact.
TangentMove on_tangent_cone(const TangentQuery& query);

}  // namespace mortise
