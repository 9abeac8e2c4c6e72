#include "tests/bench/judgement_convex.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "common/base/check.h"
#include "common/evaluation/band.h"
#include "common/math/rotation.h"
#include "tests/bench/scenes.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

using std::numbers::pi;

// Beyond it a tip is clipped (common/depth/README.md): nothing is promised of such parts.
constexpr double kMostTravel = 19.9;
constexpr double kWidestShare = 5e-3;   ///< of a tolerance zone, of the size
constexpr double kFarthest_mm = 500.0;  ///< of the random pose of everything

std::vector<Vec3> prism_points(const std::vector<Vec3>& outline, double half_height_mm) {
  std::vector<Vec3> points;
  for (const double z : {-half_height_mm, half_height_mm})
    for (const Vec3& p : outline) points.push_back(Vec3(p.x(), p.y(), z));
  return points;
}

std::vector<Vec3> box_points(Dice& dice) {
  const double x = dice.between(0.2, 1.0), y = dice.between(0.2, 1.0);
  return prism_points({{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}}, dice.between(0.2, 1.0));
}

std::vector<Vec3> outline_of(Dice& dice, int corners) {
  std::vector<Vec3> outline;
  const double phase = dice.between(0.0, 2.0 * pi), radius = dice.between(0.4, 1.0);
  for (int i = 0; i < corners; ++i)
    outline.push_back(shapes::on_circle(radius, phase + 2.0 * pi * i / corners, 0.0));
  return outline;
}

// An edge of 10 to 80 degrees at x = 1, about the middle of its outline.
std::vector<Vec3> wedge_points(Dice& dice) {
  const double angle = dice.spread(10.0, 80.0) * pi / 180.0;
  const double up = 1.6 * std::tan(angle * dice.between(0.0, 1.0));
  const double down = 1.6 * std::tan(angle) - up;
  std::vector<Vec3> outline = {{1.0, 0.0, 0}, {-0.6, up, 0}, {-0.6, -down, 0}};
  const Vec3 middle = (outline[0] + outline[1] + outline[2]) / 3.0;
  for (Vec3& p : outline) p -= middle;
  return prism_points(outline, dice.between(0.2, 1.0));
}

std::vector<Vec3> pyramid_points(Dice& dice) {
  const double height = dice.between(0.4, 1.5);
  std::vector<Vec3> points = outline_of(dice, 3 + static_cast<int>(dice.between(0.0, 3.999)));
  for (Vec3& p : points) p.z() = -0.25 * height;
  points.push_back(Vec3(dice.between(-0.3, 0.3), dice.between(-0.3, 0.3), 0.75 * height));
  return points;
}

std::vector<Vec3> random_points(Dice& dice) {
  const Vec3 size(dice.between(0.3, 1.0), dice.between(0.3, 1.0), dice.between(0.3, 1.0));
  std::vector<Vec3> points;
  const int count = 6 + static_cast<int>(dice.between(0.0, 8.999));
  for (int i = 0; i < count; ++i) points.push_back(size.cwiseProduct(dice.direction()));
  return points;
}

constexpr const char* kShapes[] = {"box", "prism", "wedge", "pyramid", "hull"};

std::vector<Vec3> shape_points(Dice& dice, int shape) {
  switch (shape) {
    case 0:
      return box_points(dice);
    case 1:
      return prism_points(outline_of(dice, 3 + static_cast<int>(dice.between(0.0, 6.999))),
                          dice.between(0.2, 1.0));
    case 2:
      return wedge_points(dice);
    case 3:
      return pyramid_points(dice);
    default:
      return random_points(dice);
  }
}

// A zone of either sign about the surface, from 1e-5 to 5e-3 of the size.
void draw_bands(Dice& dice, double size_mm, ConvexPart& part) {
  const double kind = dice.between(0.0, 1.0);
  part.by_face = kind > 0.5;
  const Interval common = kind < 0.15 ? Interval{} : drawn_zone(dice, size_mm, kWidestShare);
  for (ConvexPart::Face& face : part.faces)
    face.offset_mm = part.by_face ? drawn_zone(dice, size_mm, kWidestShare) : common;
}

struct Drawn {
  ConvexPart part;
  std::string text;
};

Drawn draw_part(Dice& dice, double size_mm) {
  for (;;) {
    const int shape = static_cast<int>(dice.between(0.0, 4.999));
    std::vector<Vec3> points = shape_points(dice, shape);
    for (Vec3& p : points) p *= size_mm;
    Drawn drawn{convex_hull(points), kShapes[shape]};
    const bool holds_origin =
        std::all_of(drawn.part.faces.begin(), drawn.part.faces.end(),
                    [&](const ConvexPart::Face& f) { return f.at.c > 0.02 * size_mm; });
    if (!holds_origin) continue;
    draw_bands(dice, size_mm, drawn.part);
    if (worst_travel(drawn.part) > kMostTravel) continue;
    char text[96];
    std::snprintf(text, sizeof text, " of %zu faces, %s [%.6f, %.6f]", drawn.part.faces.size(),
                  drawn.part.by_face ? "zones by face, the first" : "zone",
                  drawn.part.faces[0].offset_mm.lo, drawn.part.faces[0].offset_mm.hi);
    drawn.text += text;
    return drawn;
  }
}

/// Every triangle into four, so many times; then its middle into some of them.
void refine(TriangleMesh& mesh, std::vector<std::size_t>& face_of, int times, Dice& dice) {
  for (int i = 0; i < times; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    TriangleMesh finer{mesh.points_mm, {}};
    std::vector<std::size_t> finer_face;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), finer.points_mm.size());
      if (fresh) finer.points_mm.push_back(0.5 * (mesh.points_mm[a] + mesh.points_mm[b]));
      return at->second;
    };
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [a, b, c] = mesh.triangles[t];
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
        finer.triangles.push_back(part);
        finer_face.push_back(face_of[t]);
      }
    }
    mesh = std::move(finer);
    face_of = std::move(finer_face);
  }
  const std::size_t before = mesh.triangles.size();
  for (std::size_t t = 0; times > 0 && t < before; ++t) {
    if (dice.between(0.0, 1.0) < 0.8) continue;
    const auto [a, b, c] = mesh.triangles[t];
    const auto m = static_cast<std::uint32_t>(mesh.points_mm.size());
    mesh.points_mm.push_back((mesh.points_mm[a] + mesh.points_mm[b] + mesh.points_mm[c]) / 3.0);
    mesh.triangles[t] = {a, b, m};
    for (const auto& part : {std::array{b, c, m}, {c, a, m}}) {
      mesh.triangles.push_back(part);
      face_of.push_back(face_of[t]);
    }
  }
}

Part known_part(std::uint32_t id, const ConvexPart& part, int refinements, Dice& dice) {
  TriangleMesh mesh{part.points_mm, {}};
  std::vector<std::size_t> face_of;
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const std::vector<std::uint32_t>& corners = part.faces[f].corners;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      mesh.triangles.push_back({corners[0], corners[i], corners[i + 1]});
      face_of.push_back(f);
    }
  }
  refine(mesh, face_of, refinements, dice);
  JudgedPart judged;
  judged.solid = shapes::solid(std::move(mesh));
  MORTISE_CHECK(judged.solid->topology().closed(), "a hull is closed");
  BandInput input;
  if (!part.by_face) {
    input.rest = {part.faces[0].offset_mm, "zone"};
  } else {
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      FeatureDeclaration declared;
      declared.name = "face " + std::to_string(f);
      declared.surface.kind = SurfaceKind::kPlane;
      declared.surface.axis = part.faces[f].at.n;
      declared.surface.point = part.faces[f].at.c * part.faces[f].at.n;
      std::vector<std::uint32_t> triangles;
      for (std::uint32_t t = 0; t < face_of.size(); ++t)
        if (face_of[t] == f) triangles.push_back(t);
      auto match = check_feature(*judged.solid, declared, triangles);
      MORTISE_CHECK(bool(match), "the faces of a hull are planes of its mesh");
      judged.features.push_back(std::move(match->feature));
      input.of_feature.push_back({part.faces[f].offset_mm, "zone"});
    }
  }
  input.solid = judged.solid.get();
  input.features = judged.features;
  return part_of(id, judged, build_band(input));
}

// Any orientation; or a face of A on a face of B; or an edge direction turned into a face as well.
Quat draw_orientation(Dice& dice, const ConvexPart& a, const ConvexPart& b, Vec3& direction) {
  const auto pick = [&](const ConvexPart& part) {
    return part
        .faces[static_cast<std::size_t>(dice.between(0.0, 0.9999) *
                                        static_cast<double>(part.faces.size()))]
        .at.n;
  };
  const Quat any = dice.orientation();
  if (dice.between(0.0, 1.0) < 0.55) return any;
  const Vec3 of_b = pick(b);
  const Quat q = Quat::FromTwoVectors(any * pick(a), -of_b) * any;
  direction = (of_b + 0.3 * dice.direction()).normalized();
  return q.normalized();
}

// Gaps and overlaps from 0.1 to 100 um, and some deep ones.
double draw_margin(Dice& dice, double size_mm) {
  if (dice.between(0.0, 1.0) < 0.1) return size_mm * dice.spread(1e-3, 0.2);
  return dice.sign() * dice.spread(1e-4, 0.1);
}

OracleTruth truth_of(const ConvexPart& a, const ConvexPart& b, const Pose& X_BA) {
  OracleTruth truth;
  const auto at = [&](std::optional<double> share, std::optional<double>& depth_mm) {
    const auto of_a = a.half_spaces(X_BA, share), of_b = b.half_spaces(Pose(), share);
    const Interval margin = inner_margin_mm(of_a, of_b);
    if (margin.lo > 0.0)
      if (const auto depth = overlap_depth_mm(of_a, of_b)) depth_mm = depth->middle();
    return 2.0 * margin.middle();
  };
  truth.certain_mm = at(0.0, truth.certain_depth_mm);
  truth.possible_mm = at(1.0, truth.possible_depth_mm);
  at(std::nullopt, truth.mesh_depth_mm);
  return truth;
}

double depth_mm(const std::vector<HalfSpace>& faces, const Vec3& p) {
  double depth = std::numeric_limits<double>::infinity();
  for (const HalfSpace& face : faces) depth = std::min(depth, face.c - face.n.dot(p));
  return depth;
}

}  // namespace

std::vector<HalfSpace> ConvexPart::half_spaces(const Pose& X_BP,
                                               std::optional<double> share) const {
  std::vector<HalfSpace> all;
  for (const Face& face : faces) {
    const Vec3 n = X_BP.q * face.at.n;
    double offset = 0.0;
    if (share) offset = face.offset_mm.lo + *share * face.offset_mm.width();
    all.push_back({n, face.at.c + offset + n.dot(X_BP.p)});
  }
  return all;
}

ConvexPart convex_hull(const std::vector<Vec3>& points) {
  ConvexPart part;
  part.points_mm = points;
  double size = 0.0;
  Vec3 inside = Vec3::Zero();
  for (const Vec3& p : points) {
    size = std::max(size, p.norm());
    inside += p / static_cast<double>(points.size());
  }
  const auto count = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t j = 0; j < count; ++j)
      for (std::uint32_t k = j + 1; k < count; ++k) {
        if (i >= j) continue;
        Vec3 n = (points[j] - points[i]).cross(points[k] - points[i]);
        if (n.norm() < 1e-9 * size * size) continue;
        n.normalize();
        if (n.dot(points[i] - inside) < 0.0) n = -n;
        const double c = n.dot(points[i]);
        ConvexPart::Face face{{n, c}, {}, {}};
        bool beyond = false;
        for (std::uint32_t p = 0; p < count && !beyond; ++p) {
          const double above = n.dot(points[p]) - c;
          beyond = above > 1e-9 * size;
          if (above > -1e-9 * size) face.corners.push_back(p);
        }
        const bool known = std::any_of(part.faces.begin(), part.faces.end(),
                                       [&](const auto& f) { return f.corners == face.corners; });
        if (!beyond && !known) part.faces.push_back(face);
      }
  for (ConvexPart::Face& face : part.faces) {
    Vec3 middle = Vec3::Zero();
    for (const std::uint32_t p : face.corners) middle += points[p] / double(face.corners.size());
    const Vec3 u = (points[face.corners[0]] - middle).normalized(), v = face.at.n.cross(u);
    const auto angle = [&](std::uint32_t p) {
      return std::atan2(v.dot(points[p] - middle), u.dot(points[p] - middle));
    };
    std::sort(face.corners.begin(), face.corners.end(),
              [&](std::uint32_t p, std::uint32_t q) { return angle(p) < angle(q); });
  }
  return part;
}

double worst_travel(const ConvexPart& part) {
  double worst = 0.0;
  for (std::uint32_t p = 0; p < part.points_mm.size(); ++p) {
    std::vector<const ConvexPart::Face*> at;
    for (const ConvexPart::Face& face : part.faces)
      if (std::count(face.corners.begin(), face.corners.end(), p) > 0) at.push_back(&face);
    for (int layer = 0; layer < 3; ++layer) {
      const auto offset = [&](const ConvexPart::Face& f) {
        return layer == 0 ? 1.0 : layer == 1 ? f.offset_mm.lo : f.offset_mm.hi;
      };
      double most = 0.0;
      for (const ConvexPart::Face* face : at) most = std::max(most, std::abs(offset(*face)));
      if (most == 0.0) continue;
      for (std::size_t i = 0; i < at.size(); ++i)
        for (std::size_t j = i + 1; j < at.size(); ++j)
          for (std::size_t k = j + 1; k < at.size(); ++k) {
            Mat3 n;
            n << at[i]->at.n.transpose(), at[j]->at.n.transpose(), at[k]->at.n.transpose();
            if (std::abs(n.determinant()) < 1e-9) continue;
            const Vec3 x = n.inverse() * Vec3(offset(*at[i]), offset(*at[j]), offset(*at[k]));
            const bool real = std::all_of(at.begin(), at.end(), [&](const ConvexPart::Face* f) {
              return f->at.n.dot(x) <= offset(*f) + 1e-9 * most;
            });
            if (real) worst = std::max(worst, x.norm() / most);
          }
    }
  }
  return worst;
}

OracleCase draw_convex(std::uint64_t seed) {
  Dice dice(seed * 8 + 6);
  OracleCase c;
  const double scale = dice.spread(1e-2, 1e2);
  const double size_a = 10.0 * scale * dice.between(0.3, 1.0);
  const double size_b = 10.0 * scale * dice.between(0.3, 1.0);
  const Drawn a = draw_part(dice, size_a), b = draw_part(dice, size_b);
  Vec3 direction = dice.direction();
  const Quat q = draw_orientation(dice, a.part, b.part, direction);
  // 1. one layer, or the parts as modelled, has the margin that is drawn
  const double which = dice.between(0.0, 3.0);
  std::optional<double> share;
  if (which < 2.0) share = which < 1.0 ? 0.0 : 1.0;
  const auto of_a = a.part.half_spaces({q, Vec3::Zero()}, share);
  const auto of_b = b.part.half_spaces(Pose(), share);
  const double room = std::min(inner_margin_mm(of_a, {}).lo, inner_margin_mm(of_b, {}).lo);
  const double margin = std::min(draw_margin(dice, size_b), room);
  const double shift = shift_to_margin_mm(of_a, of_b, direction, 0.5 * margin);
  const Pose X_BA{q, shift * direction};
  // 2. anywhere
  c.X_WB = {dice.orientation(),
            kFarthest_mm * Vec3(dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1))};
  c.X_WA = c.X_WB * X_BA;
  const int finer_a = std::max(0, static_cast<int>(dice.between(-3.0, 2.999)));
  const int finer_b = std::max(0, static_cast<int>(dice.between(-3.0, 2.999)));
  c.pair = {known_part(1, a.part, finer_a, dice), known_part(2, b.part, finer_b, dice)};
  c.truth = truth_of(a.part, b.part, X_BA);
  const Pose X_BW = c.X_WB.inverse();
  const auto least_a = a.part.half_spaces(X_BA, 0.0), least_b = b.part.half_spaces(Pose(), 0.0);
  c.least_depth_mm = [X_BW, least_a, least_b](const Vec3& p_W) {
    const Vec3 p = X_BW * p_W;
    return std::min(depth_mm(least_a, p), depth_mm(least_b, p));
  };
  c.name = "convex:" + std::to_string(seed);
  char text[96];
  std::snprintf(text, sizeof text, "; margin %.7f of %s, refined %d, %d", margin,
                share ? (*share > 0.5 ? "the largest" : "the least") : "the meshes", finer_a,
                finer_b);
  c.text = a.text + " on " + b.text + text;
  return c;
}

}  // namespace mortise::bench
