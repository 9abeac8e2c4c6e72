#include "common/depth/cells/convex_cell.h"

#include <algorithm>
#include <cmath>

#include "common/depth/cells/outline.h"

namespace mortise {
namespace {

// Corners closer than this share of the size of a cell are one; a corner is on every plane that it
// is so close to. Far below what counts as touching.
constexpr double kSameShare = 1e-10;
// Three planes whose normals span less have no corner of their own.
constexpr double kLeastSpan = 1e-9;
// Rounds of projections onto the planes of a polytope.
constexpr int kRounds = 4;

}  // namespace

Arc::Arc(const Vec3& first, const Vec3& halfway, const Vec3& last)
    : whole(false), from(first), middle(halfway), to(last), cosine(first.dot(halfway)) {}

Vec3 Arc::farthest(const Vec3& d, const Vec3& otherwise) const {
  const double length = d.norm();
  if (!(length > 0.0)) return whole ? otherwise : middle;
  if (holds(d)) return d / length;
  return from.dot(d) > to.dot(d) ? from : to;
}

double ConvexCell::support_mm(const Vec3& n) const {
  double most = -kInfinity;
  if (!round) {
    most = corners.farthest(n).reach_mm;
    for (const ConvexCell& piece : pieces) most = std::max(most, piece.support_mm(n));
    return most;
  }
  const double along = n.dot(axis), off = arc.most(n - along * axis);
  for (const Circle& circle : circles)
    most = std::max(most, along * circle.z_mm + off * circle.r_mm);
  const double length = zones.empty() ? 0.0 : n.norm();
  for (const Zone& zone : zones)
    if (length > 0.0 && is_zone(zone, zone.z_mm + zone.r_mm * along / length))
      most = std::max(most, along * zone.z_mm + zone.r_mm * length);
  return most + n.dot(point);
}

std::optional<Vec3> ConvexCell::on_zone(const Zone& zone, const Vec3& d) const {
  const double length = d.norm();
  if (!is_zone(zone, zone.z_mm + zone.r_mm * d.dot(axis) / length)) return std::nullopt;
  return point + zone.z_mm * axis + zone.r_mm / length * d;
}

double ConvexCell::farthest_from_mm(const Vec3& x, Vec3& at) const {
  double most = -kInfinity;
  const auto take = [&](const Vec3& of, double far) {
    if (far <= most) return;
    most = far;
    at = of;
  };
  if (!round) {
    for (std::size_t i = 0; i < corners.size(); ++i) take(corners[i], (corners[i] - x).norm());
    for (const ConvexCell& piece : pieces) {
      Vec3 of = Vec3::Zero();
      const double far = piece.farthest_from_mm(x, of);
      take(of, far);
    }
    return most;
  }
  const double z = (x - point).dot(axis);
  const Vec3 off = point + z * axis - x;
  const double r = off.norm();
  const Vec3 u = r > 0.0 ? Vec3(off / r) : across[0];
  for (const Circle& circle : circles)
    take(point + circle.z_mm * axis + circle.r_mm * u,
         std::hypot(circle.z_mm - z, r + circle.r_mm));
  for (const Zone& zone : zones) {
    const Vec3 away = point + zone.z_mm * axis - x;
    const double far = away.norm();
    if (!(far > 0.0))
      take(point + zone.z_mm * axis + zone.r_mm * across[0], zone.r_mm);
    else if (const auto of = on_zone(zone, away))
      take(*of, far + zone.r_mm);
  }
  return most;
}

Vec3 ConvexCell::farthest(const Vec3& n) const {
  double most = -kInfinity;
  if (!round) {
    const HullCorners::Farthest corner = corners.farthest(n);
    most = corner.reach_mm;
    Vec3 farthest_at = corners.size() > 0 ? corners[corner.index] : middle;
    for (const ConvexCell& piece : pieces)
      if (const Vec3 x = piece.farthest(n); n.dot(x) > most) {
        most = n.dot(x);
        farthest_at = x;
      }
    return farthest_at;
  }
  const double along = n.dot(axis);
  const Vec3 across_axis = n - along * axis;
  const double off = arc.most(across_axis);
  const Circle* far = nullptr;
  for (const Circle& circle : circles)
    if (const double s = along * circle.z_mm + off * circle.r_mm; s > most) {
      most = s;
      far = &circle;
    }
  for (const Zone& zone : zones)
    if (const auto x = on_zone(zone, n); x && n.dot(*x - point) > most) return *x;
  if (far == nullptr) return middle;
  return point + far->z_mm * axis + far->r_mm * arc.farthest(across_axis, across[0]);
}

std::vector<Vec3> ConvexCell::around_farthest(const Vec3& n, double slack_mm) const {
  const double least = support_mm(n) - slack_mm;
  std::vector<Vec3> around;
  const auto add = [&](const Vec3& x) {
    if (n.dot(x) >= least) around.push_back(x);
  };
  if (!round) {
    for (std::size_t i = 0; i < corners.size(); ++i) add(corners[i]);
    for (const ConvexCell& piece : pieces) add(piece.farthest(n));
    return around;
  }
  const Vec3 across_axis = n - n.dot(axis) * axis;
  const Vec3 u = across_axis.norm() > 0.0 ? Vec3(across_axis.normalized()) : across[0];
  const Vec3 v = axis.cross(u);
  for (const Circle& circle : circles)
    for (const Vec3& off : {u, Vec3(-u), v, Vec3(-v)})
      add(point + circle.z_mm * axis + circle.r_mm * off);
  if (!zones.empty()) add(farthest(n));
  return around;
}

Vec3 ConvexCell::farthest_middle(const Vec3& n, double slack_mm) const {
  const std::vector<Vec3> around = around_farthest(n, slack_mm);
  if (around.empty()) return farthest(n);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : around) sum += x;
  return sum / static_cast<double>(around.size());
}

Vec3 ConvexCell::nearest_of_round(const Vec3& x) const {
  const Vec3 d = x - point;
  const double z = d.dot(axis);
  const Vec3 off = d - z * axis;
  const double r = off.norm();
  const Vec3 u = r > 0.0 ? Vec3(off / r) : across[0];
  // Borders of the half plane beside the axis: both ends, and what is between the circles.
  double least = kInfinity, at_z = z, at_r = r;
  const auto take = [&](const Circle& p, const Circle& q) {
    const double dz = q.z_mm - p.z_mm, dr = q.r_mm - p.r_mm, square = dz * dz + dr * dr;
    const double s =
        square > 0.0 ? std::clamp(((z - p.z_mm) * dz + (r - p.r_mm) * dr) / square, 0.0, 1.0) : 0.0;
    const double near_z = p.z_mm + s * dz, near_r = p.r_mm + s * dr;
    const double away = (near_z - z) * (near_z - z) + (near_r - r) * (near_r - r);
    if (away >= least) return;
    least = away;
    at_z = near_z;
    at_r = near_r;
  };
  bool inside = circles.front().z_mm <= z && z <= circles.back().z_mm;
  auto zone = zones.begin();
  for (std::size_t i = 0; i + 1 < circles.size(); ++i) {
    const Circle &p = circles[i], &q = circles[i + 1];
    if (zone != zones.end() && zone->circle == i) {
      const double dz = z - zone->z_mm, far = std::hypot(dz, r);
      if (p.z_mm <= z && z <= q.z_mm) inside &= far <= zone->r_mm;
      const Circle on{zone->z_mm + (far > 0.0 ? dz / far : 0.0) * zone->r_mm,
                      (far > 0.0 ? r / far : 1.0) * zone->r_mm};
      if (is_zone(*zone, on.z_mm)) take(on, on);
      take(p, p);
      take(q, q);
      ++zone;
      continue;
    }
    inside &= (r - p.r_mm) * (q.z_mm - p.z_mm) <= (q.r_mm - p.r_mm) * (z - p.z_mm);
    take(p, q);
  }
  if (inside) return x;
  take({circles.front().z_mm, 0.0}, circles.front());
  take({circles.back().z_mm, 0.0}, circles.back());
  return point + at_z * axis + at_r * u;
}

Vec3 ConvexCell::near(const Vec3& x) const {
  if (round) return nearest_of_round(x);
  Vec3 at = x;
  for (int i = 0; i < kRounds; ++i)
    for (const HalfSpace& face : faces)
      if (const double beyond = face.n.dot(at) - face.c_mm; beyond > 0.0) at -= beyond * face.n;
  return at;
}

void ConvexCell::set_faces(std::span<const Vec3> normals) {
  faces.clear();
  for (const Vec3& n : normals) faces.push_back({n, support_mm(n)});
}

namespace {

// The least of a chain of circles and of balls at each height. Between heights where two of them
// meet the same one is the least.
class MeridianCut {
 public:
  using Circle = ConvexCell::Circle;

  MeridianCut(const std::vector<Circle>& chain, std::span<const MeridianBall> balls)
      : chain_(chain), balls_(balls) {}

  // Sets what is left: circles, and zones between them. Heights nearer than `same` are one.
  void cut(double same, std::vector<Circle>& circles, std::vector<ConvexCell::Zone>& zones) const {
    double from = chain_.front().z_mm, to = chain_.back().z_mm;
    for (const MeridianBall& ball : balls_) {
      from = std::max(from, ball.z_mm - ball.r_mm);
      to = std::min(to, ball.z_mm + ball.r_mm);
    }
    circles.clear();
    if (!(to - from > same)) return;
    circles.push_back({from, least(from)});
    for (const double z : heights(from, to)) {
      if (z - circles.back().z_mm <= same) {
        circles.back().z_mm = z;  // what is left is larger
        circles.back().r_mm = std::max(circles.back().r_mm, least(z));
        continue;
      }
      const std::size_t owner = owner_at(0.5 * (circles.back().z_mm + z));
      if (owner < balls_.size())
        zones.push_back({circles.size() - 1, balls_[owner].z_mm, balls_[owner].r_mm});
      circles.push_back({z, least(z)});
    }
  }

 private:
  double of_chain(double z) const {
    std::size_t i = 0;
    while (i + 2 < chain_.size() && chain_[i + 1].z_mm < z) ++i;
    const Circle &p = chain_[i], &q = chain_[i + 1];
    // Where the chain ends on the axis, rounding does not carry it across.
    return std::max(0.0, p.r_mm + (q.r_mm - p.r_mm) * (z - p.z_mm) / (q.z_mm - p.z_mm));
  }
  static double of_ball(const MeridianBall& ball, double z) {
    return std::sqrt(std::max(0.0, (ball.r_mm - (z - ball.z_mm)) * (ball.r_mm + z - ball.z_mm)));
  }
  // The number of the ball; that of all balls: the chain.
  std::size_t owner_at(double z) const {
    std::size_t owner = balls_.size();
    double least = of_chain(z);
    for (std::size_t i = 0; i < balls_.size(); ++i)
      if (const double r = of_ball(balls_[i], z); r < least) {
        least = r;
        owner = i;
      }
    return owner;
  }
  double least(double z) const {
    const std::size_t owner = owner_at(z);
    return owner < balls_.size() ? of_ball(balls_[owner], z) : of_chain(z);
  }

  // Where something may change, ascending, the last one `to`.
  std::vector<double> heights(double from, double to) const {
    std::vector<double> all;
    const auto add = [&](double z) {
      if (from < z && z < to) all.push_back(z);
    };
    for (const Circle& circle : chain_) add(circle.z_mm);
    for (const MeridianBall& ball : balls_) {
      for (std::size_t i = 0; i + 1 < chain_.size(); ++i) {
        const Circle &p = chain_[i], &q = chain_[i + 1];
        const double slope = (q.r_mm - p.r_mm) / (q.z_mm - p.z_mm);
        const double at = p.r_mm + slope * (ball.z_mm - p.z_mm);  // over the middle of the ball
        const double square = 1.0 + slope * slope;
        const double under = square * ball.r_mm * ball.r_mm - at * at;
        if (!(under >= 0.0)) continue;
        for (const double sign : {-1.0, 1.0})
          add(ball.z_mm + (-slope * at + sign * std::sqrt(under)) / square);
      }
      for (const MeridianBall& other : balls_)
        if (const double apart = other.z_mm - ball.z_mm; apart > 0.0)
          add(0.5 * (ball.z_mm + other.z_mm +
                     (ball.r_mm - other.r_mm) / apart * (ball.r_mm + other.r_mm)));
    }
    std::sort(all.begin(), all.end());
    all.push_back(to);
    return all;
  }

  const std::vector<Circle>& chain_;
  std::span<const MeridianBall> balls_;
};

}  // namespace

std::optional<ConvexCell> round_cell(const Vec3& point, const Vec3& axis,
                                     std::span<const MeridianLine> lines,
                                     std::span<const MeridianBall> balls) {
  double size = 0.0;
  for (const MeridianLine& line : lines) size = std::max(size, std::fabs(line.c_mm));
  // Two lines at most 45 degrees apart may meet that much farther out; what is bounded is within.
  const double far = 1e3 * (size + 1.0);
  using Point = ConvexCell::Circle;
  std::vector<Point> polygon = {{-far, 0.0}, {far, 0.0}, {far, far}, {-far, far}}, cut;
  for (const MeridianLine& line : lines) {
    cut.clear();
    const auto beyond = [&](const Point& p) {
      return line.along * p.z_mm + line.off * p.r_mm - line.c_mm;
    };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const double at_p = beyond(p), at_q = beyond(q);
      if (at_p <= 0.0) cut.push_back(p);
      if ((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0)) {
        const double s = at_p / (at_p - at_q);
        cut.push_back({p.z_mm + s * (q.z_mm - p.z_mm), p.r_mm + s * (q.r_mm - p.r_mm)});
      }
    }
    polygon.swap(cut);
    if (polygon.empty()) return std::nullopt;
  }
  ConvexCell cell;
  cell.round = true;
  cell.point = point;
  cell.axis = axis;
  cell.across[0] = axis.unitOrthogonal();
  cell.across[1] = axis.cross(cell.across[0]);
  std::sort(polygon.begin(), polygon.end(), [](const Point& p, const Point& q) {
    return p.z_mm < q.z_mm || (p.z_mm == q.z_mm && p.r_mm > q.r_mm);
  });
  // What is left of a border along the axis is inside the hull of the rest.
  for (const Point& p : polygon)
    if (cell.circles.empty() || p.z_mm - cell.circles.back().z_mm > kSameShare * (size + 1.0))
      cell.circles.push_back(p);
    else
      cell.circles.back().r_mm = std::max(cell.circles.back().r_mm, p.r_mm);
  if (!(cell.circles.back().z_mm > cell.circles.front().z_mm)) return std::nullopt;
  if (!balls.empty()) {
    const std::vector<Point> chain = cell.circles;
    MeridianCut(chain, balls).cut(kSameShare * (size + 1.0), cell.circles, cell.zones);
    if (cell.circles.size() < 2) return std::nullopt;
  }
  cell.set_faces(std::array{axis, Vec3(-axis)});
  cell.middle = point + 0.5 * (cell.circles.front().z_mm + cell.circles.back().z_mm) * axis;
  return cell;
}

std::optional<ConvexCell> polytope_cell(std::span<const HalfSpace> planes) {
  double size = 0.0;
  for (const HalfSpace& plane : planes) size = std::max(size, std::fabs(plane.c_mm));
  const double same = kSameShare * size;
  const auto count = static_cast<std::uint16_t>(planes.size());
  ConvexCell cell;
  std::vector<std::vector<std::uint16_t>> planes_of;
  const auto add = [&](const Vec3& x) {
    for (const HalfSpace& plane : planes)
      if (plane.n.dot(x) > plane.c_mm + same) return;
    for (std::size_t i = 0; i < cell.corners.size(); ++i)
      if ((cell.corners[i] - x).norm() <= same) return;
    cell.corners.push_back(x);
    planes_of.emplace_back();
    for (std::uint16_t p = 0; p < count; ++p)
      if (planes[p].n.dot(x) >= planes[p].c_mm - 4.0 * same) planes_of.back().push_back(p);
  };
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const Vec3 line = planes[i].n.cross(planes[j].n);
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const double span = line.dot(planes[k].n);
        if (std::fabs(span) < kLeastSpan) continue;
        add((planes[i].c_mm * planes[j].n.cross(planes[k].n) +
             planes[j].c_mm * planes[k].n.cross(planes[i].n) + planes[k].c_mm * line) /
            span);
      }
    }
  if (cell.corners.size() < 4) return std::nullopt;
  const auto corners = static_cast<std::uint16_t>(cell.corners.size());
  for (std::uint16_t a = 0; a < corners; ++a)
    for (std::uint16_t b = a + 1; b < corners; ++b) {
      std::size_t shared = 0;
      for (const std::uint16_t p : planes_of[a])
        shared += std::count(planes_of[b].begin(), planes_of[b].end(), p);
      if (shared >= 2) cell.edges.push_back({a, b});
    }
  std::vector<Vec3> normals;
  for (const HalfSpace& plane : planes) normals.push_back(plane.n);
  cell.set_faces(normals);
  cell.middle = cell.corners.middle();
  return cell;
}

std::optional<ConvexCell> prism_cell(const std::array<Vec3, 3>& frame,
                                     const std::vector<Vec2>& polygon, const Interval& along) {
  if (polygon.size() < 3 || !(along.lo < along.hi)) return std::nullopt;
  ConvexCell cell;
  const auto flat = [&](const Vec2& x) { return Vec3(x.x() * frame[0] + x.y() * frame[1]); };
  const auto n = static_cast<std::uint16_t>(polygon.size());
  for (const double z : {along.lo, along.hi})
    for (const Vec2& x : polygon) cell.corners.push_back(flat(x) + z * frame[2]);
  std::vector<Vec3> normals = {frame[2], -frame[2]};
  for (std::uint16_t i = 0; i < n; ++i) {
    const auto next = static_cast<std::uint16_t>(i + 1 == n ? 0 : i + 1);
    const auto above = [&](std::uint16_t k) { return static_cast<std::uint16_t>(k + n); };
    cell.edges.push_back({i, next});
    cell.edges.push_back({above(i), above(next)});
    cell.edges.push_back({i, above(i)});
    normals.push_back(flat(outline::outward(polygon[i], polygon[next])));
  }
  cell.set_faces(normals);
  cell.middle = cell.corners.middle();
  return cell;
}

}  // namespace mortise
