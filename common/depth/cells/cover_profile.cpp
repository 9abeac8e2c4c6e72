#include "common/depth/cells/cover_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/depth/cells/outline.h"

namespace mortise {
namespace {

// Axes and planes that are off by less are along the axis.
constexpr double kAlongProfile = 1e-9;
// A round face of so many sides of an outline, or fewer, is tried.
constexpr std::size_t kMostArcs = 16, kMostProfilePlanes = 24;
// Beside a plane whose normal is so near to that of a tangent no edge is seen.
constexpr double kSmooth = 0.9998;
// Corners of a profile that are so far outside of an arc, as a share of its size, are cut off.
constexpr double kCutShare = 1e-9;
// Lines that bound any profile; tangents that bound an arc, and points of it that tell its area.
constexpr int kBox = 4;
constexpr int kArcTangents = 4, kAreaPoints = 1024;

bool same_cylinder(const Surface& a, const Surface& b) {
  return a.point == b.point && a.axis == b.axis && a.radius_mm == b.radius_mm;
}

// The unit direction in which x is off the axis of a cylinder.
Vec3 off_axis(const Surface& s, const Vec3& axis, const Vec3& x) {
  const Vec3 d = x - s.point;
  return (d - d.dot(axis) * axis).normalized();
}

// What lies between the ends of the widest gap between its triangles; all: it has no such gap.
Arc arc_of(const CoverFaces& f, const ProfileArc& own, const Vec3& axis) {
  const Vec3 e1 = axis.unitOrthogonal(), e2 = axis.cross(e1);
  struct Piece {
    double from, to;
    Vec3 first, last;
  };
  std::vector<Piece> pieces;
  for (const std::uint32_t t : own.triangles) {
    const Vec3 start = off_axis(*own.surface, axis, f.mesh().corner(t, 0));
    Piece piece{0.0, 0.0, start, start};
    for (int k = 1; k < 3; ++k) {
      const Vec3 u = off_axis(*own.surface, axis, f.mesh().corner(t, k));
      const double turn = std::atan2(start.cross(u).dot(axis), start.dot(u));
      if (turn < piece.from) piece = {turn, piece.to, u, piece.last};
      if (turn > piece.to) piece = {piece.from, turn, piece.first, u};
    }
    const double at = std::atan2(start.dot(e2), start.dot(e1));
    piece.from += at;
    piece.to += at;
    pieces.push_back(piece);
  }
  std::sort(pieces.begin(), pieces.end(),
            [](const Piece& a, const Piece& b) { return a.from < b.from; });
  // What comes around beyond the beginning, then one after the other.
  double to = -kInfinity, widest = 0.0;
  Vec3 last = Vec3::Zero(), before = last, after = last;
  const auto reach = [&](const Piece& piece, double turned) {
    if (piece.to + turned <= to) return;
    to = piece.to + turned;
    last = piece.last;
  };
  for (const Piece& piece : pieces) reach(piece, -2.0 * std::numbers::pi);
  for (const Piece& piece : pieces) {
    if (piece.from - to > widest) {
      widest = piece.from - to;
      before = last;
      after = piece.first;
    }
    reach(piece, 0.0);
  }
  if (!(widest > kAlongProfile)) return {};
  Vec3 middle = axis.cross(after) - axis.cross(before);
  // Neighbours that look opposite ways cancel: their sum says the middle then.
  if (middle.norm() < 0.5) middle = (widest < std::numbers::pi ? -1.0 : 1.0) * (after + before);
  return {after, middle.normalized(), before};
}

class Profile {
 public:
  Profile(const CoverFaces& faces, const Vec3& axis) : f_(faces), axis_(axis) {
    e1_ = axis_.unitOrthogonal();
    e2_ = axis_.cross(e1_);
  }

  Outside run() {
    arcs_ = profile_arcs(f_, axis_, false);
    if (arcs_.empty() || arcs_.size() > kMostArcs) return {};
    find_planes();
    close_arcs();
    std::erase_if(arcs_, [&](ProfileArc& arc) { return !holds_all(arc); });
    if (arcs_.empty()) return {};
    join_smooth();
    Outside outside;
    for (int layer = 0; layer < 2; ++layer) {
      const std::optional<ConvexCell> cell = cell_of(layer);
      if (!cell) return {};
      outside.cells[layer].push_back(*cell);
      outside.volume_mm3 = area_of(*cell) * along_[layer].width();
    }
    return outside;
  }

 private:
  struct Side {
    Vec3 n;
    double c_mm;
    LayerOffsets offsets;
  };

  Vec2 flat(const Vec3& x) const { return {e1_.dot(x), e2_.dot(x)}; }

  // All other triangles are below the tangents, too; whose faces do not end on the cylinder at an
  // edge are not trimmed by it.
  bool holds_all(ProfileArc& arc) const {
    std::vector<bool> is_own(f_.count(), false);
    for (const std::uint32_t t : arc.triangles) is_own[t] = true;
    for (std::uint32_t t = 0; t < f_.count(); ++t) {
      if (is_own[t]) continue;
      double most = -kInfinity;
      for (int k = 0; k < 3; ++k) most = std::max(most, arc.beyond_mm(f_.mesh().corner(t, k)));
      const bool is_trimmed =
          f_.touches(t, arc.has_point) && !goes_on(arc.arc, f_.body.normal(t), kSmooth);
      if (most > f_.same_mm + arc.residual_mm) return false;
      if (is_trimmed) continue;
      for (double& offset : arc.offsets) offset = std::max(offset, most + f_.reach_mm(t));
    }
    return true;
  }

  // An arc with a gap in which nothing else bounds the part goes all around: beside a keyseat.
  void close_arcs() {
    for (ProfileArc& arc : arcs_) {
      const bool is_alone =
          arcs_.size() == 1 && std::all_of(sides_.begin(), sides_.end() - kBox,
                                           [&](const Side& side) { return arc.arc.holds(side.n); });
      ProfileArc whole = arc;
      whole.arc = {};
      if (is_alone && holds_all(whole)) arc = whole;
    }
  }

  void add_side(const Vec3& n) {
    double c_mm = -kInfinity;
    for (const Vec3& x : f_.mesh().points_mm) c_mm = std::max(c_mm, n.dot(x));
    sides_.push_back({n, c_mm, f_.border(n, c_mm).offsets});
  }

  void find_planes() {
    for (const PlaneFace& face : f_.planes.faces) {
      if (std::fabs(face.n.dot(axis_)) > kAlongProfile || sides_.size() >= kMostProfilePlanes)
        continue;
      const bool known = std::any_of(sides_.begin(), sides_.end(), [&](const Side& side) {
        // Parallel by the second rule, so the first tells the sides alone.
        return side.n.dot(face.n) > 0.5 && side.n.cross(face.n).norm() <= kAlongProfile;
      });
      double most = -kInfinity;
      for (const Vec3& x : f_.mesh().points_mm) most = std::max(most, face.n.dot(x));
      if (!known && most <= face.c + f_.same_mm) add_side(face.n);
    }
    for (const Vec3& n : {e1_, Vec3(-e1_), e2_, Vec3(-e2_)}) add_side(n);
    for (int end = 0; end < 2; ++end) {
      const Vec3 n = end == 0 ? Vec3(-axis_) : axis_;
      double c_mm = -kInfinity;
      for (const Vec3& x : f_.mesh().points_mm) c_mm = std::max(c_mm, n.dot(x));
      const LayerOffsets offsets = f_.border(n, c_mm).offsets;
      for (int layer = 0; layer < 2; ++layer)
        (end == 0 ? along_[layer].lo : along_[layer].hi) =
            end == 0 ? -c_mm - offsets[layer] : c_mm + offsets[layer];
    }
  }

  // Where a plane goes over into an arc neither trims the other one.
  void join_smooth() {
    for (ProfileArc& arc : arcs_)
      for (Side& side : sides_)
        if (goes_on(arc.arc, side.n, kSmooth)) side.offsets = larger(side.offsets, arc.offsets);
  }

  double radius_mm(const ProfileArc& arc, int layer) const {
    return arc.surface->radius_mm + arc.offsets[layer] + arc.tilt_mm;
  }

  static std::vector<Vec3> directions(const Arc& arc, const Vec3& axis, int pieces) {
    if (arc.whole) {
      const Vec3 e1 = axis.unitOrthogonal(), e2 = axis.cross(e1);
      const Arc half{e1, e2, -e1}, other{-e1, -e2, e1};
      std::vector<Vec3> all = directions(half, axis, pieces);
      const std::vector<Vec3> rest = directions(other, axis, pieces);
      all.insert(all.end(), rest.begin(), rest.end());
      return all;
    }
    std::vector<Vec3> all{arc.from, arc.middle, arc.to};
    while (static_cast<int>(all.size()) <= pieces) {
      std::vector<Vec3> finer;
      for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        finer.push_back(all[i]);
        finer.push_back((all[i] + all[i + 1]).normalized());
      }
      finer.push_back(all.back());
      all = std::move(finer);
    }
    return all;
  }

  // Extreme points of what is below all lines and arcs are corners of the lines, the tangents at
  // the ends of arcs among them, or on an arc.
  std::optional<ConvexCell> cell_of(int layer) const {
    std::vector<outline::Line> lines;
    for (const Side& side : sides_)
      lines.push_back({flat(side.n), side.c_mm + side.offsets[layer]});
    for (const ProfileArc& arc : arcs_)
      for (const Vec3& u : directions(arc.arc, axis_, kArcTangents))
        lines.push_back({flat(u), u.dot(arc.surface->point) + radius_mm(arc, layer)});
    ConvexCell cell;
    cell.axis = axis_;
    const auto is_within = [&](const Vec2& x) {
      return std::all_of(arcs_.begin(), arcs_.end(), [&](const ProfileArc& arc) {
        const Vec3 at = x.x() * e1_ + x.y() * e2_;
        return arc.beyond_mm(at) <= radius_mm(arc, layer) - arc.surface->radius_mm +
                                        kCutShare * f_.body.solid->bvh().extent_mm;
      });
    };
    const std::vector<Vec2> polygon = outline::within(lines);
    if (polygon.empty()) return std::nullopt;
    for (const Vec2& x : polygon) {
      if (!is_within(x)) continue;
      for (const double z : {along_[layer].lo, along_[layer].hi})
        cell.corners.push_back(x.x() * e1_ + x.y() * e2_ + z * axis_);
      const auto last = static_cast<std::uint16_t>(cell.corners.size() - 1);
      cell.edges.push_back({static_cast<std::uint16_t>(last - 1), last});
    }
    for (const ProfileArc& arc : arcs_) cell.pieces.push_back(piece_of(arc, layer));
    std::vector<Vec3> normals{axis_, -axis_};
    for (const outline::Line& line : lines) normals.push_back(line.n.x() * e1_ + line.n.y() * e2_);
    cell.set_faces(normals);
    const std::vector<Vec3> points = around(cell);
    for (const Vec3& x : points) cell.middle += x / static_cast<double>(points.size());
    cell.middle += (0.5 * (along_[layer].lo + along_[layer].hi) - cell.middle.dot(axis_)) * axis_;
    return cell;
  }

  ConvexCell piece_of(const ProfileArc& arc, int layer) const {
    ConvexCell piece;
    piece.round = true;
    piece.point = arc.surface->point - arc.surface->point.dot(axis_) * axis_;
    piece.axis = axis_;
    piece.across[0] = e1_;
    piece.across[1] = e2_;
    for (const double z : {along_[layer].lo, along_[layer].hi})
      piece.circles.push_back({z, radius_mm(arc, layer)});
    piece.arc = arc.arc;
    piece.set_faces(std::array{axis_, Vec3(-axis_)});
    piece.middle = piece.point + 0.5 * (along_[layer].lo + along_[layer].hi) * axis_;
    return piece;
  }

  std::vector<Vec3> around(const ConvexCell& cell) const {
    std::vector<Vec3> points = cell.corners.all();
    for (const ConvexCell& piece : cell.pieces)
      for (const Vec3& u : directions(piece.arc, axis_, kAreaPoints))
        points.push_back(piece.point + piece.circles[0].r_mm * u);
    return points;
  }

  // About that: of the corners, and points of the arcs.
  double area_of(const ConvexCell& cell) const {
    std::vector<Vec2> points;
    for (const Vec3& x : around(cell)) points.push_back(flat(x));
    std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
      return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
    });
    std::vector<Vec2> hull;
    for (int side = 0; side < 2; ++side) {
      const std::size_t first = hull.size();
      for (const Vec2& x : points) {
        const auto turns_right = [&] {
          const Vec2 a = hull.back() - hull[hull.size() - 2], b = x - hull.back();
          return a.x() * b.y() - a.y() * b.x() <= 0.0;
        };
        while (hull.size() >= first + 2 && turns_right()) hull.pop_back();
        hull.push_back(x);
      }
      hull.pop_back();
      std::reverse(points.begin(), points.end());
    }
    return outline::area(hull);
  }

  const CoverFaces& f_;
  Vec3 axis_, e1_, e2_;
  std::vector<ProfileArc> arcs_;
  std::vector<Side> sides_;
  Interval along_[2];
};

}  // namespace

double ProfileArc::beyond_mm(const Vec3& x) const {
  const Vec3 d = x - surface->point;
  return arc.most(d - d.dot(surface->axis) * surface->axis) - surface->radius_mm;
}

std::vector<ProfileArc> profile_arcs(const CoverFaces& f, const Vec3& axis, bool inward) {
  std::vector<ProfileArc> arcs;
  for (std::uint32_t t = 0; t < f.count(); ++t) {
    const Surface* s = f.surface(t);
    if (s == nullptr || s->kind != SurfaceKind::kCylinder || s->inward != inward ||
        s->axis.cross(axis).norm() > kAlongProfile)
      continue;
    auto own = std::find_if(arcs.begin(), arcs.end(),
                            [&](const ProfileArc& arc) { return same_cylinder(*arc.surface, *s); });
    if (own == arcs.end()) {
      if (arcs.size() > kMostArcs) return arcs;
      own = arcs.insert(arcs.end(), ProfileArc{});
      own->surface = s;
      own->offsets = f.offsets(t);
      own->has_point.assign(f.mesh().points_mm.size(), false);
      own->tilt_mm = s->axis.cross(axis).norm() * 2.0 * f.body.solid->bvh().extent_mm;
    }
    own->triangles.push_back(t);
    own->offsets = larger(own->offsets, f.offsets(t));
    own->residual_mm = std::max(own->residual_mm, f.body.face(t).residual_mm);
    for (const std::uint32_t p : f.mesh().triangles[t]) own->has_point[p] = true;
  }
  for (ProfileArc& arc : arcs) arc.arc = arc_of(f, arc, axis);
  return arcs;
}

bool goes_on(const Arc& arc, const Vec3& n, double cosine) { return arc.most(n) > cosine; }

Outside profile_outside(const CoverFaces& f) {
  std::vector<double> area(f.body.band->faces.size(), 0.0);
  for (std::uint32_t t = 0; t < f.count(); ++t)
    if (const Surface* s = f.surface(t);
        s != nullptr && s->kind == SurfaceKind::kCylinder && !s->inward)
      area[f.body.face_index(t)] += (f.mesh().corner(t, 1) - f.mesh().corner(t, 0))
                                        .cross(f.mesh().corner(t, 2) - f.mesh().corner(t, 0))
                                        .norm();
  const auto largest = std::max_element(area.begin(), area.end());
  if (largest == area.end() || !(*largest > 0.0)) return {};
  const auto face = static_cast<std::size_t>(largest - area.begin());
  return Profile(f, f.body.band->faces[face].surface->axis).run();
}

}  // namespace mortise
