#include <algorithm>
#include <cmath>

#include "tests/stress/oracle.h"

namespace mortise::stress {
namespace {

constexpr int kOwnSteps = 150;

// Witness points lie on their triangles, as far apart as is said.
double witness_error(const Case& c, const FirstContact& answer) {
  const auto off = [&](const Solid& solid, const Motion& motion, std::uint32_t i, const Vec3& p) {
    if (i >= solid.mesh().triangles.size()) return Real(1e300);
    const Placement X = place_at(motion, answer.t_contact);
    Corners corners;
    for (int k = 0; k < 3; ++k) corners[k] = X(point_of(solid.mesh().corner(i, k)));
    return distance_to(point_of(p), corners);
  };
  const Real a = off(*c.a, c.motion_a, answer.triangle_a, answer.point_a_W);
  const Real b = off(*c.b, c.motion_b, answer.triangle_b, answer.point_b_W);
  const Real d = norm(point_of(answer.point_a_W) - point_of(answer.point_b_W));
  return static_cast<double>(std::max({a, b, std::abs(d - answer.distance_mm)}));
}

bool times_in_order(const FirstContact& answer) {
  return 0.0 <= answer.t_clear && answer.t_clear <= answer.t_contact && answer.t_contact <= 1.0;
}

// Free on [0, t_end]? By FCL as far as it can tell, by the own distance below, by looks everywhere.
double seen_before(Oracle& oracle, const Case& c, double t_end, int looks, Judgement& result) {
  Oracle::Advanced at;
  if (c.ask_fcl) at = oracle.advance_by_fcl(t_end);
  if (!at.done) {
    const double floor = (t_end < 1.0 ? 1.0 : 1.0 / 64.0) * oracle.accuracy_mm();
    at = oracle.advance(at.t, t_end, floor, kOwnSteps);
  }
  result.tired = at.tired;
  if (at.done && t_end == 1.0) return std::numeric_limits<double>::infinity();
  return oracle.first_seen(t_end, looks);
}

}  // namespace

Judgement judge(const Case& c, const FirstContact& answer, int looks) {
  Oracle oracle(c);
  Judgement result;
  result.wrong = !times_in_order(answer);
  const double accuracy = oracle.accuracy_mm(), rounding = oracle.rounding_mm();
  const Real gap0 = oracle.gap_mm(0.0, 4 * accuracy);
  switch (answer.state) {
    case ContactState::kTouchingAtStart:
      result.at_start = true;
      result.invented = gap0 > accuracy;
      result.wrong |= answer.t_contact != 0.0;
      return result;
    case ContactState::kOverlappingAtStart:
      result.at_start = true;
      result.invented = gap0 > accuracy && !oracle.contained(0.0);
      result.wrong |= answer.t_contact != 0.0;
      return result;
    case ContactState::kContact: {
      result.contact = true;
      const double t = answer.t_contact;
      const Real gap = oracle.gap_mm(t, 64 * accuracy);
      result.early_mm = static_cast<double>(std::max<Real>(gap, 0));
      result.invented = gap > accuracy + rounding;
      const double seen = seen_before(oracle, c, t, looks, result);
      if (seen <= t)
        result.late_mm = std::max(1e-300, static_cast<double>((t - seen) * oracle.speed_mm()));
      result.late = seen <= t;
      result.witness_mm = witness_error(c, answer);
      result.wrong |= result.witness_mm > 4.0 * rounding;
      break;
    }
    case ContactState::kFree:
      result.free = true;
      result.missed = seen_before(oracle, c, 1.0, looks, result) <= 1.0;
      break;
    case ContactState::kUndecided:
      result.undecided = true;
      result.late = answer.t_clear > 0.0 &&
                    seen_before(oracle, c, answer.t_clear, looks, result) <= answer.t_clear;
      break;
    default:
      result.wrong = true;
  }
  if (c.check_contained && gap0 > accuracy && oracle.contained(0.0)) result.missed = true;
  return result;
}

}  // namespace mortise::stress
