#include "common/depth/cells/cover_voids.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

// Holes of a cover, and pockets among them. A hole that is left out makes the cover larger, and so
// more pairs are asked by their triangles.
constexpr std::size_t kMostVoids = 48, kMostPockets = 12;
// A facet between two corners on a rim is no farther inside of it than a chord, and this.
constexpr double kRimMargin = 1.1;
// Halvings of a triangle that is seen against a wall.
constexpr int kWallHalvings = 6;
// Pockets are looked for at so many plane faces, those with most hollow edges first.
constexpr std::size_t kMostFloors = 24, kMostPocketWalls = 8;
// Two faces meet at a hollow edge where one rises so steeply from the other.
constexpr double kHollow = 1e-6;
// A point this share of the part's size above a floor is in its pocket.
constexpr double kAboveShare = 1e-6;
// Above the rounding of a distance, as a share of the part's size.
constexpr double kFarShare = 1e-9;

using Corners = std::array<Vec3, 3>;

Corners corners_of(const TriangleMesh& mesh, std::uint32_t t) {
  return {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
}

bool is_outside(const CoverFaces& f, const Vec3& x) {
  return nearest_surface(*f.body.solid, x).depth_mm < -0.0;
}

bool same_wall(const Surface& a, const Surface& b) {
  return a.kind == b.kind && a.inward == b.inward && a.point == b.point && a.axis == b.axis &&
         a.radius_mm == b.radius_mm && a.half_angle_rad == b.half_angle_rad;
}

struct Ball {
  Vec3 middle;
  double radius_mm = 0.0;
};

// Balls about runs of triangles, which mostly lie on one face, and how far outside of a wall one
// must be to say nothing of its hole, also where that is moved away from it.
struct Balls {
  static constexpr std::uint32_t kRun = 16;  // chosen

  explicit Balls(const CoverFaces& f) : far_mm(f.travel_mm) {
    for (const SurfaceBand::Face& face : f.body.band->faces)
      far_mm = std::max(far_mm, face.deviation_mm.hi);
    far_mm += f.recess_mm + kFarShare * f.body.solid->bvh().extent_mm;
    for (std::uint32_t from = 0; from < f.count(); from += kRun) {
      const std::uint32_t to = std::min(from + kRun, f.count());
      Box box;
      for (std::uint32_t t = from; t < to; ++t)
        for (int k = 0; k < 3; ++k) box.add(f.mesh().corner(t, k));
      of_run.push_back({box.center(), 0.0});
      double& radius = of_run.back().radius_mm;
      for (std::uint32_t t = from; t < to; ++t)
        for (int k = 0; k < 3; ++k)
          radius = std::max(radius, (f.mesh().corner(t, k) - box.center()).norm());
    }
  }
  double far_mm;
  std::vector<Ball> of_run;
};

// Round inner faces and their triangles; faces of one surface are one wall.
struct Walls {
  static constexpr std::size_t kNone = SIZE_MAX;

  explicit Walls(const CoverFaces& f) {
    for (const SurfaceBand::Face& face : f.body.band->faces)
      of_face.push_back(wall_of(Body::surface_of(face, Layer::kUpper)));
    triangles.resize(surfaces.size());
    for (std::uint32_t t = 0; t < f.count(); ++t)
      if (const std::size_t wall = of_face[f.body.face_index(t)]; wall != kNone)
        triangles[wall].push_back(t);
  }

  std::vector<const Surface*> surfaces;
  std::vector<std::vector<std::uint32_t>> triangles;
  std::vector<std::size_t> of_face;

 private:
  std::size_t wall_of(const Surface* s) {
    if (s == nullptr || !s->inward ||
        (s->kind != SurfaceKind::kCylinder && s->kind != SurfaceKind::kCone &&
         s->kind != SurfaceKind::kSphere))
      return kNone;
    for (std::size_t i = 0; i < surfaces.size(); ++i)
      if (same_wall(*surfaces[i], *s)) return i;
    surfaces.push_back(s);
    return surfaces.size() - 1;
  }
};

// The hole of one wall: along its axis up to what stands in it; of a socket all of its ball.
class Bore {
 public:
  Bore(const CoverFaces& faces, const Balls& balls, const Walls& walls, std::size_t own)
      : f_(faces), balls_(balls), walls_(walls), own_wall_(own), s_(*walls.surfaces[own]) {
    wall_.point = s_.point;
    wall_.axis = s_.axis;
    wall_.r_mm = s_.radius_mm;
    wall_.is_socket = s_.kind == SurfaceKind::kSphere;
    if (s_.kind != SurfaceKind::kCone) return;
    wall_.r_mm = 0.0;
    wall_.cosine = std::cos(s_.half_angle_rad);
    wall_.slope = std::sin(s_.half_angle_rad) / wall_.cosine;
  }

  std::optional<LayerVoids> run() {
    find_own();
    const double from = std::max(own_.lo, s_.kind == SurfaceKind::kCone ? 0.0 : -kInfinity);
    if (!(from < own_.hi)) return std::nullopt;
    for (std::uint32_t run = 0; run < balls_.of_run.size(); ++run) {
      if (ball_clearance(balls_.of_run[run]) >= balls_.far_mm) continue;  // see() changes nothing
      const std::uint32_t first = run * Balls::kRun,
                          end = std::min(first + Balls::kRun, f_.count());
      for (std::uint32_t t = first; t < end; ++t)
        if (!is_own(t) && !see(t)) return std::nullopt;
    }
    if (!(free_.lo < free_.hi)) return std::nullopt;
    const double lo = std::max(from, free_.lo), hi = std::min(own_.hi, free_.hi);
    const double middle = wall_.is_socket ? 0.0 : 0.5 * (lo + hi);
    if (!(lo < hi) || !is_outside(f_, s_.point + middle * s_.axis)) return std::nullopt;
    LayerVoids voids;
    for (int layer = 0; layer < 2; ++layer) {
      Void& v = voids.of[layer];
      v.walls = {wall_};
      v.walls.front().r_mm -= offsets_[layer] / wall_.cosine;
    }
    close(free_.lo, 1.0, voids);
    close(free_.hi, -1.0, voids);
    return voids;
  }

 private:
  double height(const Vec3& x) const { return (x - s_.point).dot(s_.axis); }
  Interval heights(const Corners& c) const {
    Interval z{kInfinity, -kInfinity};
    for (const Vec3& x : c) z = hull(z, {height(x), height(x)});
    return z;
  }
  bool is_own(std::uint32_t t) const { return walls_.of_face[f_.body.face_index(t)] == own_wall_; }
  void find_own() {
    own_point_.assign(f_.mesh().points_mm.size(), false);
    bool first = true;
    for (const std::uint32_t t : walls_.triangles[own_wall_]) {
      offsets_ = first ? f_.offsets(t) : larger(offsets_, f_.offsets(t));
      first = false;
      chord_mm_ = std::max(chord_mm_, f_.chord_mm(t));
      for (const std::uint32_t p : f_.mesh().triangles[t]) {
        own_point_[p] = true;
        const double z = height(f_.mesh().points_mm[p]);
        own_ = hull(own_, {z, z});
      }
    }
  }

  // How far the nearest point of a triangle is outside of the wall, from below.
  double clearance(const Corners& c) const {
    Ball ball{(c[0] + c[1] + c[2]) / 3.0, 0.0};
    for (const Vec3& x : c) ball.radius_mm = std::max(ball.radius_mm, (x - ball.middle).norm());
    return ball_clearance(ball);
  }
  double ball_clearance(const Ball& ball) const {
    const Vec3 d = ball.middle - s_.point;
    if (wall_.is_socket) return d.norm() - wall_.r_mm - ball.radius_mm;
    const double z = d.dot(s_.axis);
    return wall_.cosine * ((d - z * s_.axis).norm() - wall_.r_mm - wall_.slope * z) -
           ball.radius_mm;
  }

  static std::array<Corners, 4> quarters(const Corners& c) {
    const Vec3 ab = 0.5 * (c[0] + c[1]), bc = 0.5 * (c[1] + c[2]), ca = 0.5 * (c[2] + c[0]);
    return {Corners{c[0], ab, ca}, Corners{ab, c[1], bc}, Corners{ca, bc, c[2]},
            Corners{ab, bc, ca}};
  }

  // The same by the distance of the axis from the triangle seen along it, and its height nearest to
  // the wall: exact beside a cylinder, and of a triangle at one height.
  double flat_clearance(const Corners& c) const {
    Corners flat;
    for (int k = 0; k < 3; ++k) flat[k] = c[k] - height(c[k]) * s_.axis;
    const Interval z = heights(c);
    const double off = (nearest_on_triangle(s_.point, flat[0], flat[1], flat[2]) - s_.point).norm();
    return wall_.cosine * (off - wall_.r_mm - std::max(wall_.slope * z.lo, wall_.slope * z.hi));
  }

  double least_clearance(const Corners& c) const {
    if (wall_.is_socket)
      return (nearest_on_triangle(s_.point, c[0], c[1], c[2]) - s_.point).norm() - wall_.r_mm;
    if (s_.kind != SurfaceKind::kCone) return flat_clearance(c);
    const Interval z = heights(c);
    return z.hi - z.lo <= f_.same_mm ? flat_clearance(c) : refined(c, kWallHalvings);
  }
  double refined(const Corners& c, int depth) const {
    const double bound = std::max(clearance(c), flat_clearance(c));
    if (depth == 0 || bound >= balls_.far_mm) return bound;
    double least = kInfinity;
    for (const Corners& q : quarters(c)) least = std::min(least, refined(q, depth - 1));
    return least;
  }

  // How far all of a declared surface is outside of the wall: of a socket its distance from the
  // middle, of a cylinder beside another one with its axis that from the axis.
  double whole_clearance(const Surface* s) const {
    const bool is_known =
        s != nullptr &&
        (wall_.is_socket ||
         (s_.kind == SurfaceKind::kCylinder && s->kind == SurfaceKind::kCylinder &&
          s->axis.cross(s_.axis).norm() * f_.body.solid->bvh().extent_mm <= f_.same_mm));
    return is_known ? std::fabs(s->signed_distance_mm(s_.point)) - wall_.r_mm : -kInfinity;
  }

  void raise(double least) {
    for (double& offset : offsets_) offset = std::max(offset, least);
  }

  // False: something stands in the hole between the ends of its own face. What is not trimmed by
  // the wall keeps clear of it, moved by its own offset, or the wall is taken farther in.
  bool see(std::uint32_t t) {
    const CoverFaces::Meeting meeting =
        f_.meeting(t, own_point_, [&](const Vec3& x) { return s_.outward_normal(x); });
    const bool is_trimmed = meeting == CoverFaces::Meeting::kTrimmed;
    if (meeting == CoverFaces::Meeting::kRising) offsets_ = larger(offsets_, f_.offsets(t));
    const double allowed = f_.same_mm + (is_trimmed ? kRimMargin * chord_mm_
                                                    : -(f_.surface(t) ? f_.bulge_mm(t) : 0.0));
    const Corners c = corners_of(f_.mesh(), t);
    const double clear = least_clearance(c), whole = whole_clearance(f_.surface(t));
    if (is_trimmed && clear >= -allowed) return true;
    double least = kInfinity;
    if (clear >= -allowed) least = f_.reach_mm(t) - clear;
    if (whole >= -f_.same_mm) least = std::min(least, f_.offsets(t)[1] - whole);
    if (least < kInfinity) raise(least);
    return least < kInfinity ||
           (!wall_.is_socket && limit(t, c, allowed, is_trimmed, kWallHalvings));
  }

  bool limit(std::uint32_t t, const Corners& c, double allowed, bool is_trimmed, int depth) {
    const Interval z = heights(c);
    if (z.lo >= own_.hi - f_.same_mm) {
      free_.hi = std::min(free_.hi, z.lo);
      return true;
    }
    if (z.hi <= own_.lo + f_.same_mm) {
      free_.lo = std::max(free_.lo, z.hi);
      return true;
    }
    const double clear = std::max(clearance(c), flat_clearance(c));
    if (clear >= -allowed && (is_trimmed || depth == 0 || clear >= balls_.far_mm)) {
      if (!is_trimmed) raise(f_.reach_mm(t) - clear);
      return true;
    }
    if (depth == 0) return false;
    for (const Corners& q : quarters(c))
      if (!limit(t, q, allowed, is_trimmed, depth - 1)) return false;
    return true;
  }

  // A floor at height z: material below it for sign 1, above for -1.
  void close(double z, double sign, LayerVoids& voids) const {
    if (!std::isfinite(z)) return;
    const Vec3 n = sign * s_.axis;
    const double c_mm = n.dot(s_.point) + sign * z;
    const LayerOffsets offsets = f_.border(n, c_mm).offsets;
    for (int layer = 0; layer < 2; ++layer) {
      voids.of[layer].planes.push_back({n, c_mm + offsets[layer]});
      Interval& along = voids.of[layer].walls.front().along_mm;
      double& end = sign > 0.0 ? along.lo : along.hi;
      end = z + sign * offsets[layer];
    }
  }

  const CoverFaces& f_;
  const Balls& balls_;
  const Walls& walls_;
  std::size_t own_wall_;
  const Surface& s_;
  VoidWall wall_;
  std::vector<bool> own_point_;
  LayerOffsets offsets_{};
  double chord_mm_ = 0.0;
  Interval own_{kInfinity, -kInfinity};
  Interval free_{-kInfinity, kInfinity};  // heights without material
};

// The borders of plane faces, each asked for once.
class PlaneBorders {
 public:
  explicit PlaneBorders(const CoverFaces& faces) : f_(faces), known_(faces.planes.faces.size()) {}

  const CoverFaces::Border& of(std::uint32_t face) {
    const PlaneFace& plane = f_.planes.faces[face];
    if (!known_[face]) known_[face] = f_.border(plane.n, plane.c);
    return *known_[face];
  }

 private:
  const CoverFaces& f_;
  std::vector<std::optional<CoverFaces::Border>> known_;
};

// Above a floor and beside all faces that rise from it.
class Pocket {
 public:
  Pocket(const CoverFaces& faces, PlaneBorders& borders, std::vector<std::uint32_t> of)
      : f_(faces), of_(std::move(of)) {
    for (const std::uint32_t face : of_) borders_.push_back(&borders.of(face));
  }

  std::optional<LayerVoids> run() {
    const PlaneFace& floor = f_.planes.faces[of_.front()];
    own_point_.assign(f_.mesh().points_mm.size(), false);
    for (const auto* border : borders_)
      for (std::size_t p = 0; p < own_point_.size(); ++p)
        own_point_[p] = own_point_[p] || border->has_point[p];
    const double above = kAboveShare * f_.body.solid->bvh().extent_mm;
    const Corners seed = corners_of(f_.mesh(), floor.triangle);
    const Vec3 inside = (seed[0] + seed[1] + seed[2]) / 3.0 + above * floor.n;
    for (const std::uint32_t face : of_)
      if (f_.planes.faces[face].n.dot(inside) <= f_.planes.faces[face].c) return std::nullopt;
    if (!is_outside(f_, inside)) return std::nullopt;
    for (std::uint32_t t = 0; t < f_.count(); ++t)
      if (!is_own(t)) see(t);
    if (top_mm_ - f_.travel_mm <= floor.c + 2.0 * above) return std::nullopt;
    LayerVoids voids;
    for (int layer = 0; layer < 2; ++layer) {
      for (std::size_t i = 0; i < of_.size(); ++i) {
        const PlaneFace& plane = f_.planes.faces[of_[i]];
        voids.of[layer].planes.push_back({plane.n, plane.c + borders_[i]->offsets[layer]});
      }
      if (std::isfinite(top_mm_))
        voids.of[layer].planes.push_back({-floor.n, -(top_mm_ - f_.travel_mm)});
    }
    return voids;
  }

 private:
  bool is_own(std::uint32_t t) const {
    const std::uint32_t face = f_.planes.face_of_triangle[t];
    if (face >= f_.planes.faces.size()) return face == PlaneFaces::kWithoutArea;
    return std::any_of(borders_.begin(), borders_.end(),
                       [&](const auto* border) { return border->has_face[face]; });
  }

  double bulge_mm(std::uint32_t t) const {
    return f_.planes.face_of_triangle[t] == PlaneFaces::kNone ? f_.bulge_mm(t) : 0.0;
  }

  // Cuts a triangle down to what is in the pocket. What is left ends it.
  void see(std::uint32_t t) {
    const Corners c = corners_of(f_.mesh(), t);
    const double most = std::max(bulge_mm(t), f_.reach_mm(t));
    for (const std::uint32_t face : of_) {
      const PlaneFace& plane = f_.planes.faces[face];
      const double top = std::max({plane.n.dot(c[0]), plane.n.dot(c[1]), plane.n.dot(c[2])});
      if (top <= plane.c + f_.same_mm - most) return;  // cut away, whatever it reaches
    }
    const bool touches = f_.touches(t, own_point_);
    polygon_.assign(c.begin(), c.end());
    for (const std::uint32_t face : of_) {
      const PlaneFace& plane = f_.planes.faces[face];
      // Of those that end on its faces the nominal place counts, of others the largest.
      const double more = touches ? bulge_mm(t) : f_.reach_mm(t, plane.n);
      leave_beyond(polygon_, plane.n, plane.c + f_.same_mm - more, cut_);
      if (polygon_.empty()) return;
    }
    const PlaneFace& floor = f_.planes.faces[of_.front()];
    for (const Vec3& x : polygon_) top_mm_ = std::min(top_mm_, floor.n.dot(x));
  }

  const CoverFaces& f_;
  std::vector<std::uint32_t> of_;  // plane faces, the floor first
  std::vector<const CoverFaces::Border*> borders_;
  std::vector<bool> own_point_;
  double top_mm_ = kInfinity;
  std::vector<Vec3> polygon_, cut_;
};

// Plane faces that rise from each one, over their common edge.
std::vector<std::vector<std::uint32_t>> hollow_neighbours(const CoverFaces& f) {
  std::vector<std::vector<std::uint32_t>> hollow(f.planes.faces.size());
  const Topology& topology = f.body.solid->topology();
  for (std::uint32_t t = 0; t < f.count(); ++t) {
    const std::uint32_t own = f.planes.face_of_triangle[t];
    if (own >= hollow.size()) continue;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t next = topology.neighbor[t][k];
      if (next == Topology::kNone) continue;
      const std::uint32_t other = f.planes.face_of_triangle[next];
      if (other >= hollow.size() || other == own) continue;
      const PlaneFace& plane = f.planes.faces[own];
      double rises = -kInfinity;
      for (int c = 0; c < 3; ++c)
        rises = std::max(rises, plane.n.dot(f.mesh().corner(next, c)) - plane.c);
      if (rises <= f.same_mm + kHollow * f.body.solid->bvh().extent_mm) continue;
      if (std::find(hollow[own].begin(), hollow[own].end(), other) == hollow[own].end())
        hollow[own].push_back(other);
    }
  }
  return hollow;
}

void add_pockets(const CoverFaces& f, std::vector<LayerVoids>& voids) {
  const auto hollow = hollow_neighbours(f);
  std::vector<std::uint32_t> floors;
  for (std::uint32_t i = 0; i < hollow.size(); ++i)
    if (!hollow[i].empty() && hollow[i].size() <= kMostPocketWalls) floors.push_back(i);
  std::stable_sort(floors.begin(), floors.end(), [&](std::uint32_t a, std::uint32_t b) {
    return hollow[a].size() > hollow[b].size();
  });
  if (floors.size() > kMostFloors) floors.resize(kMostFloors);
  const std::size_t most = std::min(kMostVoids, voids.size() + kMostPockets);
  PlaneBorders borders(f);
  for (const std::uint32_t floor : floors) {
    if (voids.size() >= most) return;
    std::vector<std::uint32_t> of{floor};
    of.insert(of.end(), hollow[floor].begin(), hollow[floor].end());
    if (auto pocket = Pocket(f, borders, std::move(of)).run()) voids.push_back(std::move(*pocket));
  }
}

}  // namespace

std::vector<LayerVoids> find_voids(const CoverFaces& f) {
  std::vector<LayerVoids> voids;
  const Balls balls(f);
  const Walls walls(f);
  for (std::size_t i = 0; i < walls.surfaces.size() && voids.size() < kMostVoids; ++i)
    if (auto bore = Bore(f, balls, walls, i).run()) voids.push_back(std::move(*bore));
  add_pockets(f, voids);
  return voids;
}

}  // namespace mortise
