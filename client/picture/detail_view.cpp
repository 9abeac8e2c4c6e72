#include "client/picture/detail_view.h"

#include "client/picture/told_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

// Room around what has to be seen, as a share of it; facets of a round face that the window shows.
constexpr double kRoom = 0.45, kFacetsShown = 2.7;

// Half an angle of a circle that is unrolled at most, rad, so that what is cut off stays convex.
constexpr double kWidestHalfAngle_rad = 1.2;

// Points along one piece of a line that is bent by unrolling or by its true surface.
constexpr int kPieceParts = 48;

// Least height of a window, mm: below, rounding of the coordinates shows.
constexpr double kLowestWindow_mm = 1e-3;

bool is_round(const SurfaceBand::Face& face) {
  return face.surface && face.surface->kind != SurfaceKind::kPlane;
}

Vec3 any_perpendicular(const Vec3& n) {
  int best = 0;
  for (int k = 1; k < 3; ++k)
    if (std::fabs(n[k]) < std::fabs(n[best]) - 1e-9) best = k;
  const Vec3 axis = Vec3::Unit(best);
  return (axis - axis.dot(n) * n).normalized();
}

// The direction or its opposite, whichever points up in the world.
Vec3 upwards(const Vec3& n) {
  for (const int k : {2, 1, 0})
    if (std::fabs(n[k]) > 1e-6) return n[k] > 0.0 ? n : Vec3(-n);
  return n;
}

// One part of the pair, with what the band says of it.
struct Side {
  const Part* part = nullptr;
  const SurfaceBand* band = nullptr;
  const SurfaceBand::Face* face = nullptr;  // the deciding one
  Pose X_PW;

  Vec3 in_part(const Vec3& x_W) const { return X_PW * x_W; }
};

const SurfaceBand::Face* face_of(const Side& side, const std::string& name, const Vec3& x_W) {
  for (std::size_t i = 1; i < side.band->faces.size(); ++i)
    if (!name.empty() && side.band->faces[i].name == name) return &side.band->faces[i];
  return &side.band->face_of(nearest_point(*side.part->solid, side.in_part(x_W)).triangle);
}

// Centre of curvature of a round surface across the direction in which it goes straight on; world.
struct Curvature {
  Vec3 center_W;
  double radius_mm = 0.0;
  Vec3 across_W;  // tangent in which it is bent most
};

std::optional<Curvature> curvature_of(const Side& side, const Vec3& x_W) {
  if (!is_round(*side.face)) return std::nullopt;
  const Surface& s = *side.face->surface;
  const Vec3 x = side.in_part(x_W);
  const Vec3 out = s.outward_normal(x);
  const Vec3 foot = x - s.signed_distance_mm(x) * out;
  const Vec3 away = s.inward ? Vec3(-out) : out;  // from the centre
  double radius = s.radius_mm;
  Vec3 across = s.axis.cross(away);
  if (s.kind == SurfaceKind::kCone) {
    const Vec3 d = foot - s.point;
    radius = (d - d.dot(s.axis) * s.axis).norm() / std::cos(s.half_angle_rad);
  }
  if (s.kind == SurfaceKind::kTorus) {
    radius = s.tube_radius_mm;
    across = across.cross(away);
  }
  if (s.kind == SurfaceKind::kSphere || across.norm() < 1e-6) across = any_perpendicular(away);
  const Pose& X_WP = side.part->X_WP;
  return Curvature{X_WP * Vec3(foot - radius * away), radius, X_WP.q * across.normalized()};
}

class Detail {
 public:
  Detail(const RegionQuery& query, double aspect)
      : verdict_(*query.verdict), point_W_(query.verdict->point_W), aspect_(aspect) {
    const PairRule* rule = query.world->rule(query.a, query.b);
    for (int i = 0; i < 2; ++i) {
      Side& side = sides_[i];
      side.part = query.world->find(i == 0 ? query.a : query.b);
      const auto& own = i == 0 ? (rule ? rule->band_a : nullptr) : (rule ? rule->band_b : nullptr);
      side.band = own ? own.get() : &side.part->band;
      side.X_PW = side.part->X_WP.inverse();
      side.face = face_of(side, i == 0 ? verdict_.face_a : verdict_.face_b, point_W_);
      view_.parts[i].name = side.part->name;
      view_.parts[i].face = side.face->name;
    }
  }

  DetailView run() {
    choose_plane();
    for (int i = 0; i < 2; ++i)
      lines_[i] = cut_lines(sides_[i].part->solid->mesh(), sides_[i].part->X_WP, view_.plane);
    measure_point();
    choose_window();
    for (int i = 0; i < 2; ++i) draw_part(i);
    mark_witness();
    return std::move(view_);
  }

 private:
  void choose_plane() {
    const Vec3 n = verdict_.normal_W.norm() > 0.5 ? verdict_.normal_W.normalized() : Vec3::UnitZ();
    std::optional<Curvature> round[2] = {curvature_of(sides_[0], point_W_),
                                         curvature_of(sides_[1], point_W_)};
    CutPlane& plane = view_.plane;
    plane.origin_W = point_W_;
    const std::optional<Curvature>& bent = round[0] ? round[0] : round[1];
    plane.right_W = bent ? bent->across_W : across_of_mesh(n);
    // A shaft in a bore: both are seen along the same circle.
    const Vec3 away = bent ? Vec3((point_W_ - bent->center_W).normalized()) : Vec3::Zero();
    const bool unrolled = round[0] && round[1] && std::fabs(away.dot(n)) > 0.9;
    plane.up_W = unrolled ? away : upwards(n);
    view_.upper = plane.up_W.dot(n) > 0.0 ? 0 : 1;
    plane.right_W = (plane.right_W - plane.right_W.dot(plane.up_W) * plane.up_W).stableNormalized();
    if (plane.right_W.norm() < 0.5) plane.right_W = any_perpendicular(plane.up_W);
    if (unrolled) view_.chart = {plane.project(bent->center_W), bent->radius_mm};
    view_.axis_W = plane.normal_W();
  }

  // No surface is known: long facets run along the axis of what they stand for.
  Vec3 across_of_mesh(const Vec3& n) const {
    for (int i = 0; i < 2; ++i) {
      const FaceShape shape = i == 0 ? verdict_.shape_a : verdict_.shape_b;
      if (shape != FaceShape::kConvex && shape != FaceShape::kConcave) continue;
      const Part& part = *sides_[i].part;
      const TriangleMesh& mesh = part.solid->mesh();
      const std::uint32_t t = nearest_point(*part.solid, sides_[i].in_part(point_W_)).triangle;
      Vec3 longest = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        const Vec3 edge = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k);
        const bool round_edge = part.solid->topology().edge_kind[t][k] != EdgeKind::kFlat;
        if (round_edge && edge.norm() > longest.norm()) longest = edge;
      }
      const Vec3 across = (part.X_WP.q * longest).cross(n);
      if (across.norm() > 1e-9) return across.normalized();
    }
    return any_perpendicular(n);
  }

  void measure_point() {
    view_.point = view_.chart.to_chart(Vec2::Zero());
    // The point lies on the mesh of one part; the other surface is as far away as the overlap is
    // deep.
    const double depth = told_overlap_mm(verdict_);
    const double to_a =
        nearest_point(*sides_[0].part->solid, sides_[0].in_part(point_W_)).distance_mm;
    const double to_b =
        nearest_point(*sides_[1].part->solid, sides_[1].in_part(point_W_)).distance_mm;
    const double h = view_.point.y();
    const bool on_upper = (view_.upper == 0) == (to_a <= to_b);
    view_.overlap_h_mm = on_upper ? Interval{h, h + depth} : Interval{h - depth, h};
  }

  void choose_window() {
    Interval seen = hull({view_.overlap_h_mm.lo, view_.overlap_h_mm.lo},
                         {view_.overlap_h_mm.hi, view_.overlap_h_mm.hi});
    for (int i = 0; i < 2; ++i) {
      view_.parts[i].zone_at_point = zone_at_point(i);
      if (view_.parts[i].zone_at_point) seen = hull(seen, *view_.parts[i].zone_at_point);
    }
    const double half = std::max(0.5 * kLowestWindow_mm, (0.5 + kRoom) * std::fabs(seen.width()));
    view_.h_mm = {seen.middle() - half, seen.middle() + half};
    double wide = half * aspect_;
    if (!view_.chart.straight())
      wide = std::clamp(0.5 * kFacetsShown * facet_mm(), wide,
                        std::max(wide, kWidestHalfAngle_rad * view_.chart.radius_mm));
    view_.s_mm = {view_.point.x() - wide, view_.point.x() + wide};
  }

  // Length of the longer of the two facets at the point, along the cut.
  double facet_mm() const {
    double longest = 0.0;
    for (const std::vector<CutLine>& lines : lines_) {
      double nearest = std::numeric_limits<double>::infinity(), length = 0.0;
      for (const CutLine& line : lines)
        for (std::size_t k = 0, next = 0; k + 1 < line.points.size(); k = next) {
          // Triangles of one facet are one piece.
          for (next = k + 1; next + 1 < line.points.size(); ++next)
            if (!straight_on(line.points[k], line.points[next], line.points[next + 1])) break;
          const Vec2 &a = line.points[k], d = line.points[next] - a;
          const double share = std::clamp(-a.dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
          const double distance = (a + share * d).norm();
          if (distance < nearest - 1e-9 || (distance < nearest + 1e-9 && d.norm() > length)) {
            nearest = distance;
            length = d.norm();
          }
        }
      longest = std::max(longest, length);
    }
    return longest;
  }

  static bool straight_on(const Vec2& a, const Vec2& b, const Vec2& c) {
    const Vec2 u = b - a, v = c - b;
    return std::fabs(u.x() * v.y() - u.y() * v.x()) <= 1e-9 * u.norm() * v.norm();
  }

  // Along the cut from a point of the mesh to where the true surface has the given signed distance.
  Vec2 on_offset(const Side& side, const Surface& surface, Vec2 x, double offset_mm) const {
    for (int i = 0; i < 8; ++i) {
      const Vec3 x_P = side.in_part(view_.plane.lift(x));
      const Vec3 gradient_W = side.part->X_WP.q * surface.outward_normal(x_P);
      const Vec2 gradient(gradient_W.dot(view_.plane.right_W), gradient_W.dot(view_.plane.up_W));
      const double lacking = offset_mm - surface.signed_distance_mm(x_P);
      if (gradient.squaredNorm() < 1e-6) break;
      x += lacking / gradient.squaredNorm() * gradient;
    }
    return x;
  }

  // Least, most and modelled surface at a point of the mesh on a triangle.
  std::array<Vec2, 3> zone_at(int i, std::uint32_t triangle, const Vec2& x) const {
    const Side& side = sides_[i];
    const SurfaceBand::Face& face = side.band->face_of(triangle);
    if (face.surface)
      return {on_offset(side, *face.surface, x, face.tolerance_mm.lo - face.residual_mm),
              on_offset(side, *face.surface, x, face.tolerance_mm.hi + face.residual_mm),
              on_offset(side, *face.surface, x, 0.0)};
    const TriangleMesh& mesh = side.part->solid->mesh();
    const Vec3 &a = mesh.corner(triangle, 0), &b = mesh.corner(triangle, 1),
               &c = mesh.corner(triangle, 2);
    const Vec3 n_W = side.part->X_WP.q * (b - a).cross(c - a).stableNormalized();
    const Vec2 n(n_W.dot(view_.plane.right_W), n_W.dot(view_.plane.up_W));
    const Vec2 step = n.squaredNorm() > 1e-6 ? Vec2(n / n.squaredNorm()) : Vec2(0.0, 0.0);
    const Interval offset = face.deviation_mm + face.tolerance_mm;
    return {x + offset.lo * step, x + offset.hi * step, x};
  }

  // On the deciding face, straight above or below the point.
  std::optional<Interval> zone_at_point(int i) const {
    const Side& side = sides_[i];
    const NearestPoint near = nearest_point(*side.part->solid, side.in_part(point_W_));
    std::array<Vec2, 3> zone;
    const Vec2 x = view_.plane.project(side.part->X_WP * near.point);
    if (side.face->surface) {
      const SurfaceBand::Face& face = *side.face;
      zone = {on_offset(side, *face.surface, Vec2::Zero(), face.tolerance_mm.lo - face.residual_mm),
              on_offset(side, *face.surface, Vec2::Zero(), face.tolerance_mm.hi + face.residual_mm),
              Vec2::Zero()};
    } else {
      zone = zone_at(i, near.triangle, x);
    }
    const double least = view_.chart.to_chart(zone[0]).y(),
                 most = view_.chart.to_chart(zone[1]).y();
    return Interval{std::min(least, most), std::max(least, most)};
  }

  // What may be seen is cut off in the plane before it is unrolled: a wedge of the circle, or the
  // window with some room.
  struct Border {
    Vec2 normal;
    double offset_mm;
  };
  std::vector<Border> borders() const {
    if (view_.chart.straight()) {
      const double reach = 4.0 * std::max(view_.s_mm.width(), view_.h_mm.width());
      return {{{1, 0}, -reach}, {{-1, 0}, -reach}, {{0, 1}, -reach}, {{0, -1}, -reach}};
    }
    const double half =
        std::min(kWidestHalfAngle_rad, 0.55 * view_.s_mm.width() / view_.chart.radius_mm);
    const Vec2 left(std::cos(half), std::sin(half)), right(-std::cos(half), std::sin(half));
    return {{left, left.dot(view_.chart.center)}, {right, right.dot(view_.chart.center)}};
  }

  ChartLine charted(const std::vector<Vec2>& points) const {
    ChartLine line;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const int parts = view_.chart.straight() ? 1 : kPieceParts;
      for (int j = 0; j < parts; ++j)
        line.push_back(view_.chart.to_chart(points[k] + j * (points[k + 1] - points[k]) / parts));
    }
    if (!points.empty()) line.push_back(view_.chart.to_chart(points.back()));
    return line;
  }

  void draw_part(int i) {
    DrawnPart& part = view_.parts[i];
    const std::vector<Border> around = borders();
    for (const CutLine& line : lines_[i]) {
      if (line.closed) {
        std::vector<Vec2> polygon(line.points.begin(), line.points.end() - 1);
        for (const Border& border : around)
          polygon = clipped(polygon, border.normal, border.offset_mm);
        if (polygon.size() >= 3) {
          polygon.push_back(polygon.front());
          part.fills.push_back(charted(polygon));
        }
      }
      draw_line(i, line, around);
    }
  }

  void draw_line(int i, const CutLine& line, const std::vector<Border>& around) {
    DrawnPart& part = view_.parts[i];
    const SurfaceBand::Face* last_face = nullptr;
    Vec2 last_end(1e300, 1e300);
    for (std::size_t k = 0; k < line.triangles.size(); ++k) {
      Vec2 from = line.points[k], to = line.points[k + 1];
      if (!clip_piece(around, from, to)) continue;
      const SurfaceBand::Face& face = sides_[i].band->face_of(line.triangles[k]);
      const bool goes_on = (from - last_end).norm() <= 1e-12;
      if (!goes_on) part.meshes.emplace_back();
      for (const Vec2& x : charted({from, to})) part.meshes.back().push_back(x);
      if (!goes_on || last_face != &face) {
        part.zones.emplace_back();
        part.zones.back().has_surface = face.surface.has_value();
      }
      for (int j = 0; j <= kPieceParts; ++j) {
        const std::array<Vec2, 3> zone =
            zone_at(i, line.triangles[k], from + j * (to - from) / kPieceParts);
        part.zones.back().least.push_back(view_.chart.to_chart(zone[0]));
        part.zones.back().most.push_back(view_.chart.to_chart(zone[1]));
        part.zones.back().modelled.push_back(view_.chart.to_chart(zone[2]));
      }
      last_face = &face;
      last_end = to;
    }
  }

  static bool clip_piece(const std::vector<Border>& around, Vec2& from, Vec2& to) {
    for (const Border& border : around) {
      const double a = from.dot(border.normal) - border.offset_mm;
      const double b = to.dot(border.normal) - border.offset_mm;
      if (a < 0.0 && b < 0.0) return false;
      if (a < 0.0) from = from + a / (a - b) * (to - from);
      if (b < 0.0) to = to + b / (b - a) * (from - to);
    }
    return true;
  }

  // The verdict's own where it lies in the window; else the middle between the two surfaces of
  // least material, where these overlap at the point.
  void mark_witness() {
    view_.witness_is_declared = is_declared(verdict_.grade);
    if (verdict_.collision_class != CollisionClass::kReal) return;
    if (verdict_.has_witness) {
      const Vec2 at = view_.chart.to_chart(view_.plane.project(verdict_.witness_W));
      const double off =
          std::fabs((verdict_.witness_W - view_.plane.origin_W).dot(view_.plane.normal_W()));
      if (off <= 0.5 * view_.h_mm.width() && view_.s_mm.contains(at.x()) &&
          view_.h_mm.contains(at.y())) {
        view_.witness = at;
        view_.witness_is_of_verdict = true;
        return;
      }
    }
    const auto& above = view_.parts[view_.upper].zone_at_point;
    const auto& below = view_.parts[1 - view_.upper].zone_at_point;
    // The least material above begins at the upper end of its zone, that below ends at the lower.
    if (above && below && below->lo > above->hi)
      view_.witness = Vec2(view_.point.x(), 0.5 * (above->hi + below->lo));
  }

  const Verdict& verdict_;
  const Vec3 point_W_;
  const double aspect_;
  Side sides_[2];
  std::vector<CutLine> lines_[2];
  DetailView view_;
};

}  // namespace

DetailView detail_view(const RegionQuery& query, double aspect) {
  return Detail(query, aspect).run();
}

}  // namespace mortise
