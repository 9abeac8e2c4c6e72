#include "tests/bench/judgement_csg.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"
#include "common/evaluation/band.h"
#include "common/geometry/recognition/recognition.h"
#include "tests/bench/judgement_program.h"
#include "tests/support/shapes.h"

namespace mortise::bench {

using std::numbers::pi;

double CsgFace::height_mm(const Vec3& x) const {
  if (kind == Kind::kPlane) return n.dot(x) - c;
  const double rho = std::hypot(x.x() - axis_x, x.y() - axis_y);
  if (kind == Kind::kMeridian) return across * rho + up * x.z() - c;
  const double from = std::hypot(rho - ring, x.z() - z) - radius;  // a ball has no ring
  return hollow ? -from : from;
}

Vec3 CsgFace::gradient(const Vec3& x) const {
  if (kind == Kind::kPlane) return n;
  Vec3 radial(x.x() - axis_x, x.y() - axis_y, 0.0);
  const double rho = radial.norm();
  radial = rho > 0.0 ? Vec3(radial / rho) : Vec3(Vec3::UnitX());
  if (kind == Kind::kMeridian) return across * radial + up * Vec3::UnitZ();
  const double out = rho - ring, above = x.z() - z, from = std::hypot(out, above);
  if (from == 0.0) return Vec3::UnitZ();
  const Vec3 away = (out * radial + above * Vec3::UnitZ()) / from;
  return hollow ? Vec3(-away) : away;
}

double CsgFace::offset(CsgLayer layer) const {
  if (cut || layer == CsgLayer::kModelled) return 0.0;
  return layer == CsgLayer::kLeast ? offset_mm.lo : offset_mm.hi;
}

Surface CsgFace::surface() const {
  Surface s;
  s.point = Vec3(axis_x, axis_y, 0.0);
  switch (kind) {
    case Kind::kPlane:
      s.kind = SurfaceKind::kPlane;
      s.point = c * n;
      s.axis = n;
      break;
    case Kind::kMeridian:
      s.inward = across < 0.0;
      if (up == 0.0) {
        s.kind = SurfaceKind::kCylinder;
        s.radius_mm = c / across;
        break;
      }
      s.kind = SurfaceKind::kCone;  // rho = (c - up z) / across
      s.point.z() = c / up;
      s.axis = -up / across > 0.0 ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ());
      s.half_angle_rad = std::atan(std::abs(up / across));
      break;
    case Kind::kBall:
      s.kind = SurfaceKind::kSphere;
      s.point.z() = z;
      s.radius_mm = radius;
      s.inward = hollow;
      break;
    case Kind::kTorus:
      s.kind = SurfaceKind::kTorus;
      s.point.z() = z;
      s.radius_mm = ring;
      s.tube_radius_mm = radius;
      s.inward = hollow;
      break;
  }
  return s;
}

std::uint32_t CsgPart::add(CsgFace face, const std::string& name) {
  face.name = name + "_" + std::to_string(faces.size());
  faces.push_back(face);
  return static_cast<std::uint32_t>(faces.size() - 1);
}

double CsgPart::depth_in_cell_mm(std::size_t cell, const Vec3& x, CsgLayer layer) const {
  double depth = 1e300;
  for (const std::uint32_t f : cells[cell])
    depth = std::min(depth, faces[f].offset(layer) - faces[f].height_mm(x));
  return depth;
}

double CsgPart::depth_mm(const Vec3& x, CsgLayer layer) const {
  double depth = -1e300;
  for (std::size_t i = 0; i < cells.size(); ++i)
    depth = std::max(depth, depth_in_cell_mm(i, x, layer));
  return depth;
}

double CsgPair::depth_mm(const Vec3& x_B, CsgLayer layer) const {
  return std::min(a->depth_mm(X_BA.inverse() * x_B, layer), b->depth_mm(x_B, layer));
}

namespace {

/// Climbs from a point to where the lesser depth in one cell of each part is largest.
class Climb {
 public:
  Climb(const CsgPair& pair, CsgLayer layer) : pair_(pair), X_AB_(pair.X_BA.inverse()) {
    layer_ = layer;
  }

  /// Once the climb ends it goes on in the cells that are deepest there.
  CsgPoint from(const Vec3& start, double radius_mm) {
    CsgPoint best{start, pair_.depth_mm(start, layer_)};
    for (int i = 0; i < 4; ++i) {
      const double before_mm = best.depth_mm;
      choose_cells(best.x_B);
      best = in_cells(best.x_B, radius_mm);
      best.depth_mm = std::max(best.depth_mm, pair_.depth_mm(best.x_B, layer_));
      if (best.depth_mm < before_mm + 1e-8) break;
    }
    return best;
  }

 private:
  CsgPoint in_cells(const Vec3& start, double radius_mm) const {
    CsgPoint best{start, depth(start)};
    for (int i = 0; i < 60 && radius_mm > 1e-8; ++i) {
      const auto step = ascend(best, radius_mm);
      if (!step) break;
      const double promised = step->second - best.depth_mm;
      if (promised < 1e-8) break;
      const CsgPoint next{step->first, depth(step->first)};
      const double share = (next.depth_mm - best.depth_mm) / promised;
      if (share > 0.1) best = next;
      radius_mm *= share > 0.7 ? 2.0 : share > 0.3 ? 1.0 : 0.25;
    }
    return best;
  }
  static std::size_t deepest_cell(const CsgPart& part, const Vec3& x, CsgLayer layer) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < part.cells.size(); ++i)
      if (part.depth_in_cell_mm(i, x, layer) > part.depth_in_cell_mm(best, x, layer)) best = i;
    return best;
  }
  void choose_cells(const Vec3& x) {
    cell_a_ = deepest_cell(*pair_.a, X_AB_ * x, layer_);
    cell_b_ = deepest_cell(*pair_.b, x, layer_);
  }
  double depth(const Vec3& x) const {
    return std::min(pair_.a->depth_in_cell_mm(cell_a_, X_AB_ * x, layer_),
                    pair_.b->depth_in_cell_mm(cell_b_, x, layer_));
  }
  // Linear about `at`, in steps of the radius: the point, and the depth that is promised there.
  std::optional<std::pair<Vec3, double>> ascend(const CsgPoint& at, double radius_mm) const {
    OracleProgram program{4, {0, 0, 0, 1}, {}};
    const auto add = [&](const CsgPart& part, std::size_t cell, const Vec3& x, const Quat& q) {
      for (const std::uint32_t f : part.cells[cell]) {
        const CsgFace& face = part.faces[f];
        const double slack = face.offset(layer_) - face.height_mm(x) - at.depth_mm;
        if (slack > 4.0 * radius_mm) continue;
        const Vec3 g = q * face.gradient(x);
        program.rows.push_back({{g.x(), g.y(), g.z(), 1.0}, slack / radius_mm});
      }
    };
    add(*pair_.a, cell_a_, X_AB_ * at.x_B, pair_.X_BA.q);
    add(*pair_.b, cell_b_, at.x_B, Quat::Identity());
    for (std::size_t k = 0; k < 3; ++k)
      for (const double side : {-1.0, 1.0}) {
        OracleProgram::Row row;
        row.g[k] = side;
        row.h = 1.0;
        program.rows.push_back(row);
      }
    program.rows.push_back({{0, 0, 0, 1}, 2.0});
    const auto optimum = program.solve();
    if (!optimum) return std::nullopt;
    const auto& y = optimum->y;
    return std::pair{Vec3(at.x_B + radius_mm * Vec3(y[0], y[1], y[2])),
                     at.depth_mm + radius_mm * y[3]};
  }

  const CsgPair& pair_;
  Pose X_AB_;
  CsgLayer layer_;
  std::size_t cell_a_ = 0, cell_b_ = 0;
};

// Corners of both meshes, middles of their triangles, and of what lies between two of them.
std::vector<CsgPoint> starts_of(const CsgPair& pair, CsgLayer layer) {
  std::vector<CsgPoint> starts;
  const auto add = [&](const Vec3& x) { starts.push_back({x, pair.depth_mm(x, layer)}); };
  const auto of = [&](const CsgPart& part, const Pose& X) {
    for (const Vec3& p : part.mesh.points_mm) add(X * p);
    for (const auto& t : part.mesh.triangles) {
      const Vec3 &a = part.mesh.points_mm[t[0]], &b = part.mesh.points_mm[t[1]],
                 &c = part.mesh.points_mm[t[2]];
      add(X * ((a + b + c) / 3.0));
      add(X * (0.5 * (a + b)));
    }
  };
  of(*pair.a, pair.X_BA);
  of(*pair.b, Pose());
  std::sort(starts.begin(), starts.end(),
            [](const CsgPoint& p, const CsgPoint& q) { return p.depth_mm > q.depth_mm; });
  return starts;
}

}  // namespace

CsgPoint deepest_point(const CsgPair& pair, CsgLayer layer, int starts) {
  const std::vector<CsgPoint> all = starts_of(pair, layer);
  const double size = std::min(pair.a->size_mm, pair.b->size_mm), apart = 0.03 * size;
  std::vector<Vec3> taken;
  CsgPoint best;
  Climb climb(pair, layer);
  for (const CsgPoint& start : all) {
    if (static_cast<int>(taken.size()) >= starts) break;
    if (std::any_of(taken.begin(), taken.end(),
                    [&](const Vec3& x) { return (x - start.x_B).norm() < apart; }))
      continue;
    taken.push_back(start.x_B);
    const CsgPoint found = climb.from(start.x_B, 0.05 * size);
    if (found.depth_mm > best.depth_mm) best = found;
  }
  return best;
}

std::uint32_t CsgMesher::point(const Vec3& x) {
  part_.mesh.points_mm.push_back(x);
  return static_cast<std::uint32_t>(part_.mesh.points_mm.size() - 1);
}

void CsgMesher::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t face) {
  part_.mesh.triangles.push_back({a, b, c});
  part_.face_of_triangle.push_back(face);
}

CsgMesher::Ring CsgMesher::ring(const Round& round, double r_mm, double z_mm) {
  const Vec3 middle(round.x_mm, round.y_mm, 0.0);
  Ring ring;
  for (int i = 0; i < (r_mm > 0.0 ? round.facets : 1); ++i)
    ring.push_back(point(
        middle + shapes::on_circle(r_mm, round.phase_rad + 2.0 * pi * i / round.facets, z_mm)));
  return ring;
}

void CsgMesher::between(const Ring& from, const Ring& to, std::uint32_t face) {
  const std::size_t n = std::max(from.size(), to.size());
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = [&](const Ring& ring, std::size_t k) { return ring[k % ring.size()]; };
    if (from.size() > 1) triangle(at(from, i), at(from, i + 1), at(to, i + 1), face);
    if (to.size() > 1) triangle(at(from, i), at(to, i + 1), at(to, i), face);
  }
}

CsgMesher::Ring CsgMesher::chain(const Round& round, Ring from,
                                 const std::vector<Corner>& corners) {
  for (const Corner& corner : corners) {
    Ring to = ring(round, corner.r_mm, corner.z_mm);
    between(from, to, corner.face);
    from = std::move(to);
  }
  return from;
}

void CsgMesher::cap(const std::vector<std::uint32_t>& outline, const Round& round, const Ring* hole,
                    bool down, std::uint32_t face) {
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (down) std::swap(b, c);
    triangle(a, b, c, face);
  };
  const std::size_t k = outline.size();
  if (hole == nullptr) {
    for (std::size_t j = 1; j + 1 < k; ++j) add(outline[0], outline[j], outline[j + 1]);
    return;
  }
  // Each edge of the outline sees the corner of the ring that lies foremost along its normal; each
  // corner of the outline sees those between.
  const std::size_t n = hole->size();
  const auto foremost = [&](std::size_t j) {
    const Vec3 edge =
        part_.mesh.points_mm[outline[(j + 1) % k]] - part_.mesh.points_mm[outline[j % k]];
    const double at = (std::atan2(-edge.x(), edge.y()) - round.phase_rad) * double(n) / (2.0 * pi);
    return static_cast<std::size_t>(std::lround(at) + 4 * static_cast<long>(n)) % n;
  };
  for (std::size_t j = 0; j < k; ++j) {
    const std::uint32_t q = outline[(j + 1) % k];
    const std::size_t first = foremost(j), last = foremost(j + 1);
    add(outline[j], q, (*hole)[first]);
    for (std::size_t i = first; i != last; i = (i + 1) % n)
      add((*hole)[i], q, (*hole)[(i + 1) % n]);
  }
}

Part csg_known_part(std::uint32_t id, const CsgPart& part, bool recognized) {
  JudgedPart judged;
  judged.solid = shapes::solid(part.mesh);
  BandInput input;
  input.solid = judged.solid.get();
  if (recognized) {
    // One statement about the whole part.
    judged.features = recognize_features(*judged.solid).features;
    input.rest = {part.faces[0].offset_mm, "zone"};
    input.of_feature.assign(judged.features.size(), input.rest);
    input.estimate = true;
  } else {
    for (std::uint32_t f = 0; f < part.faces.size(); ++f) {
      std::vector<std::uint32_t> triangles;
      for (std::uint32_t t = 0; t < part.face_of_triangle.size(); ++t)
        if (part.face_of_triangle[t] == f) triangles.push_back(t);
      if (triangles.empty()) continue;
      FeatureDeclaration declared;
      declared.name = part.faces[f].name;
      declared.surface = part.faces[f].surface();
      auto match = check_feature(*judged.solid, declared, triangles);
      MORTISE_CHECK(bool(match), "a made part has the surfaces that it was made from");
      judged.features.push_back(std::move(match->feature));
      input.of_feature.push_back({part.faces[f].offset_mm, "zone"});
    }
  }
  input.features = judged.features;
  return part_of(id, judged, build_band(input));
}

}  // namespace mortise::bench
