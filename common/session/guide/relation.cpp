#include "common/session/guide/relation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/math/least_squares.h"
#include "common/math/rotation.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

// A direction relation or a point in a plane gives at most four rows.
constexpr int kMostRows = 4 * static_cast<int>(kMostRelations);
// Newton's steps from a near start are few; after so many the best of them counts.
constexpr int kMostSteps = 40;

std::string name_of_kind(SurfaceKind kind) {
  return (kind == SurfaceKind::kUnknown ? "a surface of kind " : "a ") + std::string(name_of(kind));
}

Element element_of(const Surface& surface) {
  switch (surface.kind) {
    case SurfaceKind::kSphere:
      return {ElementKind::kPoint, surface.point, Vec3::UnitZ()};
    case SurfaceKind::kPlane:
      return {ElementKind::kPlane, surface.point, surface.axis.normalized()};
    default:
      return {ElementKind::kLine, surface.point, surface.axis.normalized()};
  }
}

Error unfit(const char* kind, const Surface& a, const Surface& b, const std::string& why) {
  return fail(Code::kInvalidInput, std::string(kind) + " cannot hold between " +
                                       name_of_kind(a.kind) + " and " + name_of_kind(b.kind) +
                                       ": " + why);
}

// Radius of what touches; 0 for a plane; none for what touches along no line.
std::optional<double> tangent_radius_mm(const Surface& surface) {
  if (surface.kind == SurfaceKind::kPlane) return 0.0;
  if (surface.kind == SurfaceKind::kCylinder || surface.kind == SurfaceKind::kSphere)
    return surface.radius_mm;
  return std::nullopt;
}

Result<Relation> tangent(const Surface& a, const Surface& b) {
  const auto radius_a = tangent_radius_mm(a), radius_b = tangent_radius_mm(b);
  if (!radius_a || !radius_b) return unfit("tangent", a, b, "it needs planes, cylinders, spheres");
  const bool plane = a.kind == SurfaceKind::kPlane || b.kind == SurfaceKind::kPlane;
  if (a.kind == SurfaceKind::kPlane && b.kind == SurfaceKind::kPlane)
    return unfit("tangent", a, b, "two planes are coplanar");
  if (a.inward && b.inward) return unfit("tangent", a, b, "two bores cannot touch");
  if (plane && (a.inward || b.inward)) return unfit("tangent", a, b, "a bore holds no plane");
  Relation relation{element_of(a), element_of(b), false, *radius_a + *radius_b};
  if (a.inward || b.inward) {
    relation.distance_mm = a.inward ? *radius_a - *radius_b : *radius_b - *radius_a;
    if (relation.distance_mm < 0.0)
      return unfit("tangent", a, b, "the bore is smaller than what it should hold");
  }
  return relation;
}

// Rows of J z + r = 0 with z = (shift, lever * turn).
struct Rows {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, 6> J;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1> r;
  int count = 0;
  double lever_mm = 1.0;

  explicit Rows(double lever) : lever_mm(lever) {
    J.setZero(kMostRows, 6);
    r.setZero(kMostRows);
  }
  // The turn about `axis` (unit) is off by angle_rad.
  void add_turn(const Vec3& axis, double angle_rad) {
    J.row(count).tail<3>() = axis.transpose();
    r[count++] = lever_mm * angle_rad;
  }
  // A point of the body at x (from the centre) is off by off_mm along `along` (unit).
  void add_shift(const Vec3& along, const Vec3& x, double off_mm) {
    J.row(count).head<3>() = along.transpose();
    J.row(count).tail<3>() = (x.cross(along) / lever_mm).transpose();
    r[count++] = off_mm;
  }
  double largest() const { return count == 0 ? 0.0 : r.head(count).cwiseAbs().maxCoeff(); }
};

struct Basis {
  Vec3 e, f;
};

Basis across(const Vec3& direction) {
  int least = 0;
  direction.cwiseAbs().minCoeff(&least);
  const Vec3 e = direction.cross(Vec3::Unit(least)).normalized();
  return {e, direction.cross(e)};
}

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : otherwise;
}

// Directions a (moving) and b become parallel, in the sense given.
void add_parallel(const Vec3& a, const Vec3& b, Rows& rows) {
  const Vec3 side = a.cross(b);
  const double angle = std::atan2(side.norm(), a.dot(b));
  const Vec3 turn = angle * unit_or(side, across(a).e);
  const Basis basis = across(a);
  rows.add_turn(basis.e, -basis.e.dot(turn));
  rows.add_turn(basis.f, -basis.f.dot(turn));
}

// Direction `moving` becomes perpendicular to `fixed`.
void add_perpendicular(const Vec3& moving, const Vec3& fixed, Rows& rows) {
  const Vec3 side = moving.cross(fixed);
  rows.add_turn(unit_or(side, across(fixed).e),
                std::asin(std::clamp(moving.dot(fixed), -1.0, 1.0)));
}

Vec3 nearest_to_center(const Element& e) {
  if (e.kind == ElementKind::kLine) return e.point - e.point.dot(e.direction) * e.direction;
  if (e.kind == ElementKind::kPlane) return e.point.dot(e.direction) * e.direction;
  return e.point;
}

// Distance of a from b across `line` (none: in space); `at` is the body's point that counts.
void add_distance(const Vec3& gap, const Vec3* line, double distance_mm, const Vec3& at,
                  Rows& rows) {
  const Vec3 h = line ? Vec3(gap - gap.dot(*line) * *line) : gap;
  if (distance_mm > 0.0) {
    const Vec3 out = unit_or(h, line ? across(*line).e : Vec3(Vec3::UnitX()));
    rows.add_shift(out, at, h.norm() - distance_mm);
    return;
  }
  if (!line) {
    for (int i = 0; i < 3; ++i) rows.add_shift(Vec3::Unit(i), at, gap[i]);
    return;
  }
  const Basis basis = across(*line);
  rows.add_shift(basis.e, at, basis.e.dot(gap));
  rows.add_shift(basis.f, at, basis.f.dot(gap));
}

// Rows of one relation; elements from the centre of the body, a displaced.
void add_rows(const Relation& relation, const Element& a, const Element& b, Rows& rows) {
  const bool plane_a = a.kind == ElementKind::kPlane, plane_b = b.kind == ElementKind::kPlane;
  const bool point_a = a.kind == ElementKind::kPoint, point_b = b.kind == ElementKind::kPoint;
  const Vec3 at = nearest_to_center(a);
  // 1. directions
  if (!point_a && !point_b) {
    if (plane_a == plane_b)
      add_parallel(a.direction, relation.opposed ? Vec3(-b.direction) : b.direction, rows);
    else
      add_perpendicular(a.direction, b.direction, rows);
  }
  // 2. places
  if (plane_b)
    return rows.add_shift(b.direction, at, b.direction.dot(at - b.point) - relation.distance_mm);
  if (plane_a) {
    const Vec3 x = b.kind == ElementKind::kLine ? nearest_to_center(b) : b.point;
    return rows.add_shift(-a.direction, x, a.direction.dot(x - a.point) - relation.distance_mm);
  }
  if (b.kind == ElementKind::kLine)
    return add_distance(at - b.point, &b.direction, relation.distance_mm, at, rows);
  // The body's line keeps to a fixed point: its place at the point counts.
  if (a.kind == ElementKind::kLine)
    return add_distance(at - b.point, &a.direction, relation.distance_mm, b.point, rows);
  add_distance(a.point - b.point, nullptr, relation.distance_mm, at, rows);
}

// The element from the centre, after the displacement.
Element displaced(const Element& e, const Vec3& center, const Displacement& by) {
  return {e.kind, by.shift_mm + by.turn * (e.point - center), by.turn * e.direction};
}

Rows rows_of(const GuideQuery& query, const Displacement& at) {
  Rows rows(query.lever_mm);
  for (const Relation& relation : query.relations) {
    // The centre of the body goes along: turns are about where it is now.
    Element a = displaced(relation.a, query.center_W, at), b = relation.b;
    a.point -= at.shift_mm;
    b.point -= query.center_W + at.shift_mm;
    add_rows(relation, a, b, rows);
  }
  return rows;
}

}  // namespace

Result<Relation> relation_between(ConstraintKind kind, const Surface& a, const Surface& b,
                                  double distance_mm) {
  const Element ea = element_of(a), eb = element_of(b);
  const bool plane_a = ea.kind == ElementKind::kPlane, plane_b = eb.kind == ElementKind::kPlane;
  if (a.kind == SurfaceKind::kUnknown || b.kind == SurfaceKind::kUnknown)
    return unfit("a constraint", a, b, "its surface is not known");
  switch (kind) {
    case ConstraintKind::kCoaxial:
      if (plane_a || plane_b) return unfit("coaxial", a, b, "a plane has no axis");
      return Relation{ea, eb, false, 0.0};
    case ConstraintKind::kCoplanar:
      if (!plane_a || !plane_b) return unfit("coplanar", a, b, "both must be planes");
      return Relation{ea, eb, false, 0.0};
    case ConstraintKind::kParallelDistance:
      if (!std::isfinite(distance_mm) || std::fabs(distance_mm) > kLargestCoordinate_mm)
        return unfit("parallel at a distance", a, b, "the distance is not a length");
      if (distance_mm < 0.0 && !plane_a && !plane_b)
        return unfit("parallel at a distance", a, b, "only planes have a negative side");
      return Relation{ea, eb, false, distance_mm};
    case ConstraintKind::kTangent:
      return tangent(a, b);
    case ConstraintKind::kUnknown:
      break;
  }
  return fail(Code::kInvalidInput,
              "this kind of constraint is not known; write coaxial, coplanar, "
              "parallel at a distance or tangent");
}

Element moved(const Element& element, const Pose& X) {
  return {element.kind, X * element.point, X.q * element.direction};
}

std::vector<Eigen::Matrix<double, 6, 1>> guide_rows(const GuideQuery& query) {
  const Rows rows = rows_of(query, query.wanted);
  std::vector<Eigen::Matrix<double, 6, 1>> result;
  for (int i = 0; i < rows.count; ++i) result.emplace_back(rows.J.row(i).transpose());
  return result;
}

double violation_mm(const GuideQuery& query) { return rows_of(query, query.wanted).largest(); }

GuidedDisplacement guided(const GuideQuery& query) {
  MORTISE_CHECK(query.relations.size() <= kMostRelations && query.lever_mm > 0.0,
                "few relations and a positive lever");
  GuidedDisplacement result{query.wanted, 0.0, 6};
  if (query.relations.empty()) return result;
  Displacement at = query.wanted;
  double best_mm = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    // 1. how far off; no better than the last time: rounding, or a contradiction
    const Rows rows = rows_of(query, at);
    const double off_mm = rows.largest();
    if (off_mm < best_mm) {
      result.displacement = at;
      result.residual_mm = off_mm;
    }
    // 2. a step of least norm
    int rank = 0;
    const Eigen::VectorXd z = least_norm_solution(rows.J.topRows(rows.count),
                                                  -rows.r.head(rows.count), kGuideRankShare, &rank);
    result.freedom = 6 - rank;
    // Near the solution a step of Newton's leaves far less than nine tenths.
    const bool stuck = step > 3 && off_mm > 0.9 * best_mm;
    best_mm = std::min(best_mm, off_mm);
    if (off_mm == 0.0 || stuck) break;
    Vec3 turn = z.tail<3>() / query.lever_mm;
    if (turn.norm() > 1.0) turn.normalize();
    at.shift_mm += z.head<3>();
    at.turn = (rotation_exp(turn) * at.turn).normalized();
  }
  return result;
}

}  // namespace mortise
