#include "common/depth/cells/cover_outside.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

namespace mortise {
namespace {

// A part with more slabs across its axis is taken for a box.
constexpr std::size_t kMostSlabs = 24;
// Axes are the same that differ by no more than this, mm, anywhere along the part.
constexpr double kSameAxis_mm = 1e-4;
// Planes of a polytope beside those of a box, and how many faces are tried, largest first.
constexpr std::size_t kMostPlanes = 12, kMostFacesTried = 24;
// Normals with a larger cosine do not make a polytope much smaller.
constexpr double kSimilar = 0.999;

// r = at_zero + slope * z, or a ball about the height at_zero; and how far it is off in a layer,
// along its normal.
struct OuterLine {
  double at_zero = 0.0, slope = 0.0;
  LayerOffsets offsets{};
  double ball_r = 0.0;  // 0: a line
  bool is_ball() const { return ball_r > 0.0; }
  double r(double z) const {
    if (!is_ball()) return at_zero + slope * z;
    return std::sqrt(std::max(0.0, (ball_r - (z - at_zero)) * (ball_r + z - at_zero)));
  }
  // How far a point is outside: of a line along r, no less than along its normal. Convex.
  double beyond(double z, double off_axis) const {
    return is_ball() ? std::hypot(z - at_zero, off_axis) - ball_r : off_axis - r(z);
  }
  bool operator==(const OuterLine&) const = default;
};

struct Slab {
  double z0 = 0.0, z1 = 0.0;
  std::optional<OuterLine> line;     // of round faces
  std::vector<std::uint32_t> faces;  // of the band, that the line is of
  std::vector<bool> has_point;       // by point of the mesh: of such a face
  double rest_r = 0.0;               // of all others
  bool sticks_out = false;           // beyond the line
  bool is_round() const { return line && !sticks_out; }
  OuterLine outermost(double travel_mm) const {
    if (is_round()) return *line;
    double r = rest_r;
    if (line) r = std::max({r, line->r(z0), line->r(z1)});
    return {r, 0.0, {travel_mm, travel_mm}};
  }
};

// That about which a part is turned.
struct TurningAxis {
  Vec3 point = Vec3::Zero(), along = Vec3::UnitZ();
  double height(const Vec3& x) const { return (x - point).dot(along); }
  double off(const Vec3& x) const { return (x - point - height(x) * along).norm(); }
};

bool is_turned(const Surface* s) {
  return s != nullptr && (s->kind == SurfaceKind::kCylinder || s->kind == SurfaceKind::kCone ||
                          s->kind == SurfaceKind::kSphere);
}

// That of the largest outer face, else of the largest bore; of a ball any.
std::optional<TurningAxis> turning_axis(const CoverFaces& f) {
  std::map<std::uint16_t, double> area;
  for (std::uint32_t t = 0; t < f.count(); ++t) {
    if (!is_turned(f.surface(t))) continue;
    const Vec3 n = (f.mesh().corner(t, 1) - f.mesh().corner(t, 0))
                       .cross(f.mesh().corner(t, 2) - f.mesh().corner(t, 0));
    area[f.body.face_index(t)] += n.norm();
  }
  std::optional<TurningAxis> axis;
  double most = 0.0;
  const double all = f.body.solid->bvh().extent_mm * f.body.solid->bvh().extent_mm * 1e3;
  for (const auto& [face, a] : area) {
    const Surface& s = *f.body.band->faces[face].surface;
    const bool has_axis = s.kind != SurfaceKind::kSphere;
    const double weight = a + (s.inward ? 0.0 : all) + (has_axis ? 2.0 * all : 0.0);
    if (weight <= most) continue;
    most = weight;
    axis = TurningAxis{s.point, s.axis};
  }
  return axis;
}

// The line of a round outer face, where its axis is the same along all of the part.
std::optional<OuterLine> line_of(const TurningAxis& axis, double extent_mm, const Surface& s,
                                 const LayerOffsets& offsets) {
  const bool is_ball = s.kind == SurfaceKind::kSphere;
  const double tilt_mm = is_ball ? 0.0 : s.axis.cross(axis.along).norm() * 2.0 * extent_mm;
  const double off_mm = axis.off(s.point) + tilt_mm;
  if (s.inward || off_mm > kSameAxis_mm) return std::nullopt;
  OuterLine line{s.radius_mm, 0.0, {offsets[0] + off_mm, offsets[1] + off_mm}};
  if (is_ball) {
    line.ball_r = s.radius_mm;
    line.at_zero = axis.height(s.point);
  } else if (s.kind == SurfaceKind::kCone) {
    line.slope = (s.axis.dot(axis.along) > 0.0 ? 1.0 : -1.0) * std::sin(s.half_angle_rad) /
                 std::cos(s.half_angle_rad);
    line.at_zero = -line.slope * axis.height(s.point);
  }
  return line;
}

class Turned {
 public:
  explicit Turned(const CoverFaces& faces) : f_(faces) {}

  Outside run() {
    Outside outside;
    const auto axis = turning_axis(f_);
    if (!axis) return outside;
    axis_ = *axis;
    if (!find_slabs()) return outside;
    for (Slab& slab : slabs_) note_points(slab);
    for (std::uint32_t t = 0; t < f_.count(); ++t)
      if (!is_of_line(t)) note_rest(t);
    raise_lines();
    for (const Slab& slab : slabs_) lines_.push_back(slab.outermost(f_.travel_mm));
    if (!discs_are_inside()) return outside;
    for (std::size_t k = 0; k < slabs_.size(); ++k) add_cell(k, outside);
    for (std::size_t k = 0; k < slabs_.size(); ++k) {
      const double r = lines_[k].r(0.5 * (slabs_[k].z0 + slabs_[k].z1));
      outside.volume_mm3 += std::numbers::pi * r * r * (slabs_[k].z1 - slabs_[k].z0);
    }
    return outside;
  }

 private:
  double height(const Vec3& x) const { return axis_.height(x); }
  double off_axis(const Vec3& x) const { return axis_.off(x); }

  bool find_slabs() {
    const std::vector<SurfaceBand::Face>& band = f_.body.band->faces;
    line_of_face_.resize(band.size());
    std::vector<Interval> extent(band.size(), {kInfinity, -kInfinity});
    Interval all{kInfinity, -kInfinity};
    for (std::uint32_t t = 0; t < f_.count(); ++t) {
      const std::uint16_t face = f_.body.face_index(t);
      for (int k = 0; k < 3; ++k) {
        const double z = height(f_.mesh().corner(t, k));
        extent[face] = hull(extent[face], {z, z});
        all = hull(all, {z, z});
      }
    }
    std::vector<double> levels{all.lo, all.hi};
    const auto faces = static_cast<std::uint16_t>(band.size());
    for (std::uint16_t i = 0; i < faces; ++i) {
      const Surface* s = Body::surface_of(band[i], Layer::kUpper);
      if (!is_turned(s) || !(extent[i].lo < extent[i].hi)) continue;
      line_of_face_[i] = line_of(
          axis_, f_.body.solid->bvh().extent_mm, *s,
          {Body::offset_of(band[i], Layer::kLower), Body::offset_of(band[i], Layer::kUpper)});
      if (!line_of_face_[i]) continue;
      levels.push_back(extent[i].lo);
      levels.push_back(extent[i].hi);
      // On either side of its middle a ball comes in alone.
      const OuterLine& line = *line_of_face_[i];
      if (line.is_ball() && extent[i].lo < line.at_zero && line.at_zero < extent[i].hi)
        levels.push_back(line.at_zero);
    }
    std::sort(levels.begin(), levels.end());
    for (std::size_t i = 0; i + 1 < levels.size(); ++i)
      if (levels[i + 1] - levels[i] > f_.same_mm)
        slabs_.push_back(
            {slabs_.empty() ? levels[i] : slabs_.back().z1, levels[i + 1], {}, {}, {}});
    if (slabs_.empty() || slabs_.size() > kMostSlabs) return false;
    slabs_.back().z1 = std::max(slabs_.back().z1, all.hi);
    for (std::uint16_t i = 0; i < faces; ++i)
      if (line_of_face_[i]) add_line(i, extent[i]);
    return true;
  }

  // Faces with one line are one; of several lines the outermost counts.
  void add_line(std::uint16_t face, const Interval& extent) {
    const OuterLine& line = *line_of_face_[face];
    for (Slab& slab : slabs_) {
      const double middle = 0.5 * (slab.z0 + slab.z1);
      if (middle < extent.lo || middle > extent.hi) continue;
      if (!slab.line || line.r(middle) > slab.line->r(middle) + f_.same_mm) {
        slab.line = line;
        slab.faces = {face};
      } else if (std::fabs(line.r(slab.z0) - slab.line->r(slab.z0)) <= f_.same_mm &&
                 std::fabs(line.r(middle) - slab.line->r(middle)) <= f_.same_mm &&
                 std::fabs(line.r(slab.z1) - slab.line->r(slab.z1)) <= f_.same_mm) {
        slab.line->offsets = larger(slab.line->offsets, line.offsets);
        slab.faces.push_back(face);
      }
    }
  }

  // A triangle of a round outer face: what it stands for is on its line, whole or under another.
  bool is_of_line(std::uint32_t t) const {
    return line_of_face_[f_.body.face_index(t)].has_value();
  }

  // Of the part of a triangle in a slab: what is beyond its line is largest at a corner.
  template <class Visit>
  void for_each_corner_in(const Slab& slab, std::uint32_t t, Visit&& visit) const {
    for (int k = 0; k < 3; ++k) {
      const Vec3 &p = f_.mesh().corner(t, k), &q = f_.mesh().corner(t, (k + 1) % 3);
      const double zp = height(p), zq = height(q);
      if (slab.z0 <= zp && zp <= slab.z1) visit(zp, off_axis(p));
      for (const double z : {slab.z0, slab.z1})
        if ((zp - z) * (zq - z) < 0.0) visit(z, off_axis(p + (z - zp) / (zq - zp) * (q - p)));
    }
  }

  Interval heights(std::uint32_t t) const {
    Interval z{kInfinity, -kInfinity};
    for (int k = 0; k < 3; ++k) {
      const double at = height(f_.mesh().corner(t, k));
      z = hull(z, {at, at});
    }
    return z;
  }

  // Of the inner half of a hollow torus about the axis: between two heights it is nowhere farther
  // from the axis than at one of them.
  bool is_groove(std::uint32_t t) const {
    const Surface* s = f_.surface(t);
    if (s == nullptr || s->kind != SurfaceKind::kTorus || !s->inward) return false;
    if (off_axis(s->point) + s->axis.cross(axis_.along).norm() * f_.body.solid->bvh().extent_mm >
        kSameAxis_mm)
      return false;
    for (int k = 0; k < 3; ++k)
      if (off_axis(f_.mesh().corner(t, k)) > s->radius_mm) return false;
    return true;
  }

  void note_points(Slab& slab) const {
    slab.has_point.assign(f_.mesh().points_mm.size(), false);
    for (std::uint32_t t = 0; t < f_.count(); ++t)
      if (std::find(slab.faces.begin(), slab.faces.end(), f_.body.face_index(t)) !=
          slab.faces.end())
        for (const std::uint32_t p : f_.mesh().triangles[t]) slab.has_point[p] = true;
  }

  void note_rest(std::uint32_t t) {
    const Interval z = heights(t);
    for (Slab& slab : slabs_) {
      if (z.hi <= slab.z0 + f_.same_mm || z.lo >= slab.z1 - f_.same_mm) continue;
      // What ends on the round face of the slab is trimmed by it.
      const double bulge_mm = f_.touches(t, slab.has_point) || is_groove(t) ? 0.0 : f_.bulge_mm(t);
      for_each_corner_in(slab, t, [&](double at, double r) {
        r += bulge_mm;
        slab.rest_r = std::max(slab.rest_r, r);
        slab.sticks_out |= !slab.line || slab.line->beyond(at, r) > f_.same_mm + slack(slab);
      });
    }
  }
  // Corners where a round face ends are on it as closely as the mesh is made.
  double slack(const Slab& slab) const {
    double most = 0.0;
    for (const std::uint32_t face : slab.faces)
      most = std::max(most, f_.body.band->faces[face].residual_mm);
    return most;
  }

  // Faces that do not meet the round face of a slab are not trimmed by it: moved by their own
  // offsets they stay below the line, or it is taken farther out. One that rises from it a little
  // goes on as far as both are moved differently.
  void raise_lines() {
    for (Slab& slab : slabs_) {
      if (!slab.is_round()) continue;
      const Surface& own = *f_.body.band->faces[slab.faces.front()].surface;
      for (std::uint32_t t = 0; t < f_.count(); ++t) {
        if (f_.meeting(t, slab.has_point, [&](const Vec3& x) { return own.outward_normal(x); }) ==
            CoverFaces::Meeting::kRising)
          slab.line->offsets = larger(slab.line->offsets, f_.offsets(t));
        if (is_of_line(t) || f_.touches(t, slab.has_point)) continue;
        const Interval z = heights(t);
        if (z.hi <= slab.z0 + f_.same_mm || z.lo >= slab.z1 - f_.same_mm) continue;
        for_each_corner_in(slab, t, [&](double at, double r) {
          const double over = slab.line->beyond(at, r) + f_.reach_mm(t);
          for (double& offset : slab.line->offsets) offset = std::max(offset, over);
        });
      }
    }
  }

  // Faces across the axis end where slabs meet.
  bool discs_are_inside() const {
    for (std::uint32_t t = 0; t < f_.count(); ++t)
      for (int k = 0; k < 3; ++k) {
        const Vec3& x = f_.mesh().corner(t, k);
        const double z = height(x);
        double beyond = kInfinity, slack_mm = 0.0;
        for (std::size_t i = 0; i < slabs_.size(); ++i)
          if (slabs_[i].z0 - f_.same_mm <= z && z <= slabs_[i].z1 + f_.same_mm) {
            beyond = std::min(
                beyond, lines_[i].beyond(std::clamp(z, slabs_[i].z0, slabs_[i].z1), off_axis(x)));
            slack_mm = std::max(slack_mm, slack(slabs_[i]));
          }
        if (beyond > 2.0 * f_.same_mm + slack_mm) return false;
      }
    return true;
  }

  // The plane across the axis at which a cell ends; its offset by layer.
  LayerOffsets end_offsets(double z, double sign) const {
    const Vec3 n = sign * axis_.along;
    return f_.border(n, n.dot(axis_.point) + sign * z).offsets;
  }

  struct Border {
    OuterLine line;
    double end_z = 0.0, sign = 0.0;  // sign 0: a line
    bool operator==(const Border&) const = default;
  };

  // Goes from slab k to one side, as far as all is below what bounds the cell so far. A line that
  // comes down is one more border, a step down the end.
  void extend(std::size_t k, int by, std::vector<Border>& borders) const {
    const auto least = [&](double z) {
      double r = kInfinity;
      for (const Border& border : borders)
        if (border.sign == 0.0) r = std::min(r, border.line.r(z));
      return r;
    };
    // A line beside another one that it never meets: a step, however low.
    const auto steps_down = [&](const OuterLine& line) {
      return std::any_of(borders.begin(), borders.end(), [&](const Border& border) {
        const OuterLine& own = border.line;
        return border.sign == 0.0 && !line.is_ball() && !own.is_ball() && line.slope == own.slope &&
               std::fabs(line.at_zero - own.at_zero) <= f_.same_mm &&
               (line.offsets[0] < own.offsets[0] || line.offsets[1] < own.offsets[1]);
      });
    };
    const auto near_end = [&](std::size_t i) { return by > 0 ? slabs_[i].z0 : slabs_[i].z1; };
    const auto far_end = [&](std::size_t i) { return by > 0 ? slabs_[i].z1 : slabs_[i].z0; };
    // A ball comes in again behind its middle: slabs from the first to this one must keep within,
    // by what faces are moved, but where it joins the last one.
    const auto holds = [&](const OuterLine& ball, std::size_t last, double joint) {
      for (std::size_t i = k;; i += static_cast<std::size_t>(by)) {
        for (const double z : {slabs_[i].z0, slabs_[i].z1})
          if (z != joint && ball.beyond(z, lines_[i].r(z)) > -f_.travel_mm - f_.recess_mm)
            return false;
        if (i == last) return true;
      }
    };
    std::size_t i = k;
    while (by > 0 ? i + 1 < slabs_.size() : i > 0) {
      const std::size_t next = by > 0 ? i + 1 : i - 1;
      const OuterLine& line = lines_[next];
      if (line.r(near_end(next)) < least(near_end(next)) - f_.same_mm || steps_down(line)) break;
      if (line.r(far_end(next)) < least(far_end(next)) - f_.same_mm) {
        if (line.is_ball() && !holds(line, i, near_end(next))) break;
        borders.push_back({line, 0.0, 0.0});
      }
      i = next;
    }
    borders.push_back({{}, far_end(i), static_cast<double>(by)});
  }

  void add_cell(std::size_t k, Outside& outside) {
    std::vector<Border> borders{{lines_[k], 0.0, 0.0}};
    extend(k, 1, borders);
    extend(k, -1, borders);
    const auto less = [](const Border& a, const Border& b) {
      return std::tie(a.sign, a.end_z, a.line.at_zero, a.line.slope, a.line.offsets,
                      a.line.ball_r) <
             std::tie(b.sign, b.end_z, b.line.at_zero, b.line.slope, b.line.offsets, b.line.ball_r);
    };
    std::sort(borders.begin(), borders.end(), less);
    if (std::find(known_.begin(), known_.end(), borders) != known_.end()) return;
    known_.push_back(borders);
    for (int layer = 0; layer < 2; ++layer) {
      std::vector<MeridianLine> lines;
      std::vector<MeridianBall> balls;
      for (const Border& border : borders) {
        if (border.sign != 0.0) {
          const double out = end_offsets(border.end_z, border.sign)[layer];
          lines.push_back({border.sign, 0.0, border.sign * border.end_z + out});
          continue;
        }
        if (border.line.is_ball()) {
          const double r = border.line.ball_r + border.line.offsets[layer];
          balls.push_back({border.line.at_zero, r});
          lines.push_back({0.0, 1.0, 2.0 * r});  // the lines alone bound it, too
          continue;
        }
        const double length = std::sqrt(1.0 + border.line.slope * border.line.slope);
        lines.push_back({-border.line.slope / length, 1.0 / length,
                         border.line.at_zero / length + border.line.offsets[layer]});
      }
      if (auto cell = round_cell(axis_.point, axis_.along, lines, balls))
        outside.cells[layer].push_back(*cell);
    }
  }

  const CoverFaces& f_;
  TurningAxis axis_;
  std::vector<std::optional<OuterLine>> line_of_face_;  // by face of the band
  std::vector<Slab> slabs_;
  std::vector<OuterLine> lines_;  // by slab
  std::vector<std::vector<Border>> known_;
};

// A plane with all of the part below it: where it is in each layer.
LayerOffsets plane_at(const CoverFaces& f, const Vec3& n) {
  double c_mm = -kInfinity;
  for (const Vec3& x : f.mesh().points_mm) c_mm = std::max(c_mm, n.dot(x));
  const LayerOffsets offsets = f.border(n, c_mm).offsets;
  return {c_mm + offsets[0], c_mm + offsets[1]};
}

}  // namespace

Outside turned_outside(const CoverFaces& faces) { return Turned(faces).run(); }

Outside polytope_outside(const CoverFaces& f) {
  std::vector<Vec3> normals;
  std::vector<std::pair<double, std::size_t>> by_area(f.planes.faces.size());
  for (std::size_t i = 0; i < by_area.size(); ++i) by_area[i] = {0.0, i};
  for (std::uint32_t t = 0; t < f.count(); ++t)
    if (const std::uint32_t face = f.planes.face_of_triangle[t]; face < by_area.size())
      by_area[face].first -= (f.mesh().corner(t, 1) - f.mesh().corner(t, 0))
                                 .cross(f.mesh().corner(t, 2) - f.mesh().corner(t, 0))
                                 .norm();
  std::sort(by_area.begin(), by_area.end());
  const auto has_similar = [&](const Vec3& n) {
    return std::any_of(normals.begin(), normals.end(),
                       [&](const Vec3& known) { return known.dot(n) > kSimilar; });
  };
  for (std::size_t i = 0; i < std::min(kMostFacesTried, by_area.size()); ++i) {
    const PlaneFace& face = f.planes.faces[by_area[i].second];
    if (normals.size() >= kMostPlanes) break;
    if (has_similar(face.n)) continue;
    double most = -kInfinity;
    for (const Vec3& x : f.mesh().points_mm) most = std::max(most, face.n.dot(x));
    if (most <= face.c + f.same_mm) normals.push_back(face.n);
  }
  for (int k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0})
      if (const Vec3 n = sign * Vec3::Unit(k); !has_similar(n)) normals.push_back(n);
  Outside outside;
  std::vector<LayerOffsets> c_mm;
  for (const Vec3& n : normals) c_mm.push_back(plane_at(f, n));
  for (int layer = 0; layer < 2; ++layer) {
    std::vector<HalfSpace> planes;
    for (std::size_t i = 0; i < normals.size(); ++i) planes.push_back({normals[i], c_mm[i][layer]});
    if (auto cell = polytope_cell(planes)) outside.cells[layer].push_back(*cell);
  }
  const Vec3 size = f.body.solid->bounds().hi - f.body.solid->bounds().lo;
  outside.volume_mm3 = size.x() * size.y() * size.z();
  return outside;
}

}  // namespace mortise
