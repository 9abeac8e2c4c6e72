#include "common/geometry/triangle_meeting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/constants.h"

namespace mortise {
namespace {

// Roundings in a height or in a place along a line, in units of the coordinates.
constexpr double kRoundings = 16.0;

struct Heights {
  double of[3];
  double lo, hi;
};

Heights heights(const Triangle& t, const Vec3& normal, const Vec3& on_plane) {
  Heights h{};
  for (int k = 0; k < 3; ++k) h.of[k] = normal.dot(t[k] - on_plane);
  h.lo = std::min({h.of[0], h.of[1], h.of[2]});
  h.hi = std::max({h.of[0], h.of[1], h.of[2]});
  return h;
}

struct Cut {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;  // may be this wide
  double sure_lo = lo, sure_hi = hi;                              // is at least this wide
};

// What a triangle whose corners stand on both sides of a plane cuts out of a line in that plane.
Cut cut_of(const Triangle& t, const Heights& h, const Vec3& line, const Vec3& origin,
           double rounding) {
  Cut cut;
  for (int k = 0; k < 3; ++k) {
    const int j = (k + 1) % 3;
    const double a = h.of[k], b = h.of[j];
    if ((a > 0.0) == (b > 0.0)) continue;
    const double share = a / (a - b);
    const Vec3 edge = t[j] - t[k];
    const double at = line.dot(t[k] + share * edge - origin);
    const double doubt = rounding * (1.0 + edge.norm() / std::fabs(a - b));
    cut.lo = std::min(cut.lo, at - doubt);
    cut.hi = std::max(cut.hi, at + doubt);
    cut.sure_lo = std::min(cut.sure_lo, at + doubt);
    cut.sure_hi = std::max(cut.sure_hi, at - doubt);
  }
  return cut;
}

}  // namespace

Meeting meeting_of(const Triangle& a, const Triangle& b, double tolerance_mm) {
  const Vec3 na = (a[1] - a[0]).cross(a[2] - a[0]), nb = (b[1] - b[0]).cross(b[2] - b[0]);
  const double la = na.norm(), lb = nb.norm();
  if (!(la > 0.0) || !(lb > 0.0)) return Meeting::kDoubtful;
  const Vec3 ua = na / la, ub = nb / lb;
  double extent = 0.0;
  for (int k = 0; k < 3; ++k)
    extent = std::max({extent, (a[k] - a[0]).norm(), (b[k] - a[0]).norm()});
  const double rounding = kRoundings * kUnitRoundoff * (extent + a[0].norm());
  const double tolerance = tolerance_mm + rounding;
  const Heights hb = heights(b, ua, a[0]), ha = heights(a, ub, b[0]);
  if (hb.lo > tolerance || hb.hi < -tolerance || ha.lo > tolerance || ha.hi < -tolerance)
    return Meeting::kApart;
  if (hb.lo >= -tolerance || hb.hi <= tolerance || ha.lo >= -tolerance || ha.hi <= tolerance)
    return Meeting::kDoubtful;
  const Vec3 direction = ua.cross(ub);
  const double sine = direction.norm();
  if (!(sine > 0.0)) return Meeting::kDoubtful;
  const Vec3 line = direction / sine;
  // The line itself turns by the rounding of the normals over the sine of their angle.
  const double doubt = rounding / sine;
  const Cut ca = cut_of(a, ha, line, a[0], rounding), cb = cut_of(b, hb, line, a[0], rounding);
  if (ca.lo > cb.hi + tolerance + doubt || cb.lo > ca.hi + tolerance + doubt)
    return Meeting::kApart;
  const double overlap = std::min(ca.sure_hi, cb.sure_hi) - std::max(ca.sure_lo, cb.sure_lo);
  return overlap > tolerance + doubt ? Meeting::kCrossing : Meeting::kDoubtful;
}

}  // namespace mortise
