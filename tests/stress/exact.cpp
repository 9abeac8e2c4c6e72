#include "tests/stress/exact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::stress {
namespace {

constexpr int next(int k) { return k == 2 ? 0 : k + 1; }

Real clamp01(Real x) { return std::clamp<Real>(x, 0, 1); }

Real square(const Point& p) { return dot(p, p); }

struct Nearest {
  Real mm2 = std::numeric_limits<Real>::infinity();
  Point on_a, on_b;

  void take(const Point& p, const Point& q) {
    const Real d2 = square(q - p);
    if (d2 >= mm2) return;
    mm2 = d2;
    on_a = p;
    on_b = q;
  }
};

Point on_edge(const Point& p, const Point& from, const Point& to) {
  const Point e = to - from;
  const Real length2 = square(e);
  return length2 > 0 ? from + clamp01(dot(p - from, e) / length2) * e : from;
}

// Twice as many digits, in software: asked where long double cannot tell, which is where triangles
// are needles and where they touch.
__extension__ typedef __float128 Quad;

struct QuadPoint {
  Quad x, y, z;
  explicit QuadPoint(const Point& p) : x(p.x), y(p.y), z(p.z) {}
  QuadPoint(Quad a, Quad b, Quad c) : x(a), y(b), z(c) {}
};

QuadPoint operator-(const QuadPoint& a, const QuadPoint& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Quad dot(const QuadPoint& a, const QuadPoint& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
QuadPoint cross(const QuadPoint& a, const QuadPoint& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

constexpr Real kUnit = std::numeric_limits<Real>::epsilon();
constexpr Real kNeedle2 = 1e-6;  // square of the sine of a corner below which Quad is asked

// Foot of p on the plane of t when it lies over the face.
bool over_face(const Point& p, const Corners& t, Point& foot) {
  const Point u = t[1] - t[0], v = t[2] - t[0], n = cross(u, v);
  const Real nn = square(n);
  if (nn > kNeedle2 * square(u) * square(v)) {
    foot = p - (dot(p - t[0], n) / nn) * n;
    for (int k = 0; k < 3; ++k)
      if (dot(cross(t[next(k)] - t[k], foot - t[k]), n) < 0) return false;
    return true;
  }
  const QuadPoint q(p), a(t[0]), b(t[1]), c(t[2]), qn = cross(b - a, c - a);
  const Quad qnn = dot(qn, qn);
  if (!(qnn > 0)) return false;
  const Quad up = dot(q - a, qn) / qnn;
  const QuadPoint f(q.x - up * qn.x, q.y - up * qn.y, q.z - up * qn.z);
  if (dot(cross(b - a, f - a), qn) < 0 || dot(cross(c - b, f - b), qn) < 0 ||
      dot(cross(a - c, f - c), qn) < 0)
    return false;
  foot = {static_cast<Real>(f.x), static_cast<Real>(f.y), static_cast<Real>(f.z)};
  return true;
}

// Where the common perpendicular of two lines meets both within the edges.
void inner_points(const Corners& a, int i, const Corners& b, int j, Nearest& nearest) {
  const Point u = a[next(i)] - a[i], v = b[next(j)] - b[j], r = b[j] - a[i];
  const Point n = cross(u, v);
  const Real nn = square(n);
  if (!(nn > 0)) return;
  const Real s = dot(cross(r, v), n) / nn, t = dot(cross(r, u), n) / nn;
  if (s > 0 && s < 1 && t > 0 && t < 1) nearest.take(a[i] + s * u, b[j] + t * v);
}

// Sign of the volume of a tetrahedron.
int side(const Point& p, const Point& q, const Point& r, const Point& s) {
  const Point u = q - p, v = r - p, w = s - p;
  const Real volume = dot(u, cross(v, w));
  const auto size = [](const Point& x) { return std::abs(x.x) + std::abs(x.y) + std::abs(x.z); };
  if (std::abs(volume) > 16 * kUnit * size(u) * size(v) * size(w)) return volume > 0 ? 1 : -1;
  const QuadPoint o(p);
  const Quad exact = dot(QuadPoint(q) - o, cross(QuadPoint(r) - o, QuadPoint(s) - o));
  return exact > 0 ? 1 : (exact < 0 ? -1 : 0);
}

bool edge_passes(const Point& p, const Point& q, const Corners& t) {
  if (side(t[0], t[1], t[2], p) * side(t[0], t[1], t[2], q) >= 0) return false;
  const int x = side(p, q, t[0], t[1]);
  return x != 0 && x == side(p, q, t[1], t[2]) && x == side(p, q, t[2], t[0]);
}

}  // namespace

Real norm(const Point& a) { return std::sqrt(square(a)); }

Placement placement_of(const Pose& X) {
  const Real w = X.q.w(), x = X.q.x(), y = X.q.y(), z = X.q.z();
  const Real s = 2 / (w * w + x * x + y * y + z * z);  // divides by the norm: a rotation always
  Placement P;
  P.row[0] = {1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)};
  P.row[1] = {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)};
  P.row[2] = {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)};
  P.shift = point_of(X.p);
  return P;
}

Placement inverse(const Placement& X) {
  Placement P;
  P.row[0] = {X.row[0].x, X.row[1].x, X.row[2].x};
  P.row[1] = {X.row[0].y, X.row[1].y, X.row[2].y};
  P.row[2] = {X.row[0].z, X.row[1].z, X.row[2].z};
  P.shift = Real(-1) * P.turned(X.shift);
  return P;
}

Placement compose(const Placement& X, const Placement& Y) {
  Placement P;
  const Placement back = inverse(Y);  // rows of the inverse are columns of Y
  for (int i = 0; i < 3; ++i)
    P.row[i] = {dot(X.row[i], back.row[0]), dot(X.row[i], back.row[1]), dot(X.row[i], back.row[2])};
  P.shift = X(Y.shift);
  return P;
}

Placement rotation_by(const Point& w) {
  const Real angle = norm(w);
  Placement P;
  if (!(angle > 0)) return P;
  const Point k = (1 / angle) * w;
  const Real s = std::sin(angle), half = std::sin(angle / 2), c = 2 * half * half;
  P.row[0] = {1 - c * (k.y * k.y + k.z * k.z), c * k.x * k.y - s * k.z, c * k.x * k.z + s * k.y};
  P.row[1] = {c * k.x * k.y + s * k.z, 1 - c * (k.x * k.x + k.z * k.z), c * k.y * k.z - s * k.x};
  P.row[2] = {c * k.x * k.z - s * k.y, c * k.y * k.z + s * k.x, 1 - c * (k.x * k.x + k.y * k.y)};
  return P;
}

Placement place_at(const Motion& motion, Real t) {
  const Placement start = placement_of(motion.X_W0);
  if (motion.kind == PathKind::kStill) return start;
  const Point v = t * point_of(motion.v_W);
  const Placement turn = rotation_by(t * point_of(motion.w_W));
  // The point about which the part turns: the reference point, carried along, or a point of the
  // screw's axis.
  const Point center = motion.kind == PathKind::kScrew ? point_of(motion.axis_W)
                                                       : start(point_of(motion.reference_P));
  // The turn shifts the part's origin by (R - 1) r = s k x r + (1 - c) k x (k x r); r is huge on a
  // screw that hardly turns, and R r - r would cancel.
  const Point w = t * point_of(motion.w_W), r = start.shift - center;
  const Real angle = norm(w);
  Point shift = v;
  if (angle > 0) {
    const Point k = (1 / angle) * w, side = cross(k, r);
    const Real half = std::sin(angle / 2);
    shift = shift + std::sin(angle) * side + (2 * half * half) * cross(k, side);
  }
  Placement P = compose(turn, start);
  P.shift = start.shift + shift;
  return P;
}

Point turn_between(const Quat& q0, const Quat& q1) {
  const Point a{q0.x(), q0.y(), q0.z()}, b{q1.x(), q1.y(), q1.z()};
  const Real wa = q0.w(), wb = q1.w();
  // q1 times the conjugate of q0.
  Real w = wb * wa + dot(b, a);
  Point v = wa * b - wb * a - cross(b, a);
  if (w < 0) {
    w = -w;
    v = Real(-1) * v;
  }
  const Real sine = norm(v);
  return sine > 0 ? (2 * std::atan2(sine, w) / sine) * v : Point{};
}

bool passes_through(const Corners& a, const Corners& b) {
  for (int k = 0; k < 3; ++k)
    if (edge_passes(a[k], a[next(k)], b) || edge_passes(b[k], b[next(k)], a)) return true;
  return false;
}

Gap distance_of(const Corners& a, const Corners& b) {
  Nearest nearest;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      nearest.take(a[i], on_edge(a[i], b[j], b[next(j)]));
      nearest.take(on_edge(b[j], a[i], a[next(i)]), b[j]);
      inner_points(a, i, b, j, nearest);
    }
  Point foot;
  for (int k = 0; k < 3; ++k) {
    if (over_face(a[k], b, foot)) nearest.take(a[k], foot);
    if (over_face(b[k], a, foot)) nearest.take(foot, b[k]);
  }
  return {std::sqrt(nearest.mm2), nearest.on_a, nearest.on_b};
}

Real distance_to(const Point& p, const Corners& t) {
  Nearest nearest;
  for (int k = 0; k < 3; ++k) nearest.take(p, on_edge(p, t[k], t[next(k)]));
  Point foot;
  if (over_face(p, t, foot)) nearest.take(p, foot);
  return std::sqrt(nearest.mm2);
}

Real winding(const Point& p, const TriangleMesh& mesh) {
  Real sum = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    Point r[3];
    Real length[3];
    for (int k = 0; k < 3; ++k) {
      r[k] = point_of(mesh.corner(i, k)) - p;
      length[k] = norm(r[k]);
    }
    const Real up = dot(r[0], cross(r[1], r[2]));
    const Real down = length[0] * length[1] * length[2] + dot(r[0], r[1]) * length[2] +
                      dot(r[1], r[2]) * length[0] + dot(r[2], r[0]) * length[1];
    sum += 2 * std::atan2(up, down);
  }
  return sum / (4 * std::acos(Real(-1)));
}

}  // namespace mortise::stress
