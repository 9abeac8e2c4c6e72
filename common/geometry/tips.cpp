#include "common/geometry/tips.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/geometry/across_material.h"
#include "common/geometry/plane_faces.h"

namespace mortise {
namespace {

// Faces that meet at a smaller sine go over into each other.
constexpr double kLeastSine = 1.0 / PlaneFaces::kMostTravel;
// An edge that moves no more than this beyond its faces is no tip, mm: a tenth of the accuracy to
// which depths are told.
constexpr double kLeastExcess_mm = 1e-5;
// More faces at one corner are those of a fan that approximates a surface.
constexpr std::size_t kMostFacesOfCorner = 12;
// Steps of Newton to where curved faces meet; each squares the error.
constexpr int kSteps = 6;
// Normals of one plane.
constexpr double kSamePlane = 1.0 - 1e-9;

const Surface* round_surface(const SurfaceBand::Face& face) {
  const bool round = face.surface && face.surface->kind != SurfaceKind::kPlane &&
                     face.surface->kind != SurfaceKind::kUnknown;
  return round ? &*face.surface : nullptr;
}

std::uint16_t face_index(const SurfaceBand& band, std::uint32_t t) {
  return band.face_of_triangle.empty() ? std::uint16_t{0} : band.face_of_triangle[t];
}

// Least move that carries a point by `by` along each normal, and whether each counts outwards.
struct Move {
  Vec3 by = Vec3::Zero();
  bool outwards = false;
};

std::optional<Move> move_of(const Vec3& n, double o, const Vec3& m, double p) {
  const double cosine = n.dot(m), span = 1.0 - cosine * cosine;
  if (span < kLeastSine * kLeastSine) return std::nullopt;
  const double of_n = (o - cosine * p) / span, of_m = (p - cosine * o) / span;
  return Move{of_n * n + of_m * m, of_n >= 0.0 && of_m >= 0.0};
}

std::optional<Move> move_of(const std::array<Vec3, 3>& n, const std::array<double, 3>& o) {
  const std::array<Vec3, 3> across = {n[1].cross(n[2]), n[2].cross(n[0]), n[0].cross(n[1])};
  const double span = n[0].dot(across[0]);
  if (std::fabs(span) < kLeastSine * kLeastSine) return std::nullopt;
  Move move{(o[0] * across[0] + o[1] * across[1] + o[2] * across[2]) / span, true};
  // As a sum of the normals none counts negatively: by belongs to their cone.
  const std::array<Vec3, 3>& a = across;
  for (int i = 0; i < 3; ++i) move.outwards &= a[i].dot(move.by) * span >= 0.0;
  return move;
}

class TipFinder {
 public:
  TipFinder(const Solid& solid, const SurfaceBand& band)
      : solid_(solid), mesh_(solid.mesh()), topology_(solid.topology()), band_(band) {}

  std::vector<Tip> run() {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) add_edge(t, k);
    add_corners();
    return std::move(tips_);
  }

 private:
  bool is_one_face(std::uint32_t t, std::uint32_t other) const {
    if (face_index(band_, t) != face_index(band_, other)) return false;
    const SurfaceBand::Face& face = band_.face_of(t);
    if (round_surface(face) != nullptr) return true;
    return !is_plane_band(band_, face) ||
           topology_.normal[t].dot(topology_.normal[other]) > kSamePlane;
  }

  void add_edge(std::uint32_t t, std::uint32_t k) {
    const auto [other, convex] = across_material(mesh_, topology_, t, k);
    if (!convex || other < t || is_one_face(t, other)) return;
    Tip tip;
    tip.triangles = {t, other, other};
    tip.from = mesh_.corner(t, static_cast<int>(k));
    tip.to = mesh_.corner(t, static_cast<int>((k + 1) % 3));
    const LargestFace a(solid_, band_, t), b(solid_, band_, other);
    bool farther = false;
    for (const double share : {0.0, 0.5, 1.0}) {
      // Where a chord of the mesh is inside of a round face, the edge is not.
      const Vec3 x =
          meeting_point(solid_, band_, tip, tip.from + share * (tip.to - tip.from), false);
      const double by_a = -a.above_mm(x), by_b = -b.above_mm(x);
      const auto move = move_of(a.outward(x), by_a, b.outward(x), by_b);
      farther |= move && take(*move, std::max(by_a, by_b), tip);
    }
    if (farther) tips_.push_back(tip);
  }

  // faces_mm: what the faces move there. False: the tip moves no farther.
  static bool take(const Move& move, double faces_mm, Tip& tip) {
    if (!move.outwards) return false;
    const double travel_mm =
        std::min(move.by.norm(), PlaneFaces::kMostTravel * std::max(0.0, faces_mm));
    tip.travel_mm = std::max(tip.travel_mm, travel_mm);
    return travel_mm > std::max(0.0, faces_mm) + kLeastExcess_mm;
  }

  // Triangles of different faces, by corner.
  void add_corners() {
    std::vector<std::uint32_t> at;
    Fans(mesh_, topology_).each([&](std::uint32_t p, const auto& fan) {
      at.clear();
      for (const std::uint32_t t : fan)
        if (std::none_of(at.begin(), at.end(),
                         [&](std::uint32_t other) { return is_one_face(t, other); }))
          at.push_back(t);
      const std::size_t count = at.size();
      if (count < 3 || count > kMostFacesOfCorner) return;
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j)
          for (std::size_t k = j + 1; k < count; ++k)
            add_corner(mesh_.points_mm[p], {at[i], at[j], at[k]});
    });
  }

  void add_corner(const Vec3& x, const std::array<std::uint32_t, 3>& triangles) {
    std::array<Vec3, 3> n;
    std::array<double, 3> by;
    for (int i = 0; i < 3; ++i) {
      const LargestFace face(solid_, band_, triangles[i]);
      n[i] = face.outward(x);
      by[i] = -face.above_mm(x);
    }
    const auto move = move_of(n, by);
    Tip tip{triangles, 3, x, x, 0.0};
    if (move && take(*move, *std::max_element(by.begin(), by.end()), tip)) tips_.push_back(tip);
  }

  const Solid& solid_;
  const TriangleMesh& mesh_;
  const Topology& topology_;
  const SurfaceBand& band_;
  std::vector<Tip> tips_;
};

}  // namespace

LargestFace::LargestFace(const Solid& solid, const SurfaceBand& band, std::uint32_t triangle)
    : surface_(round_surface(band.face_of(triangle))),
      corner_(solid.mesh().corner(triangle, 0)),
      normal_(solid.topology().normal[triangle]),
      offset_mm_((surface_ != nullptr ? band.face_of(triangle).doubt_mm().hi
                                      : band.face_of(triangle).deviation_mm.hi) +
                 band.face_of(triangle).tolerance_mm.hi) {}

double LargestFace::above_mm(const Vec3& x) const {
  return (surface_ != nullptr ? surface_->signed_distance_mm(x) : normal_.dot(x - corner_)) -
         offset_mm_;
}

Vec3 LargestFace::outward(const Vec3& x) const {
  return surface_ != nullptr ? surface_->outward_normal(x) : normal_;
}

Vec3 meeting_point(const Solid& solid, const SurfaceBand& band, const Tip& tip, const Vec3& x,
                   bool moved) {
  std::array<Vec3, 3> n;
  std::array<double, 3> by;
  const LargestFace faces[3] = {{solid, band, tip.triangles[0]},
                                {solid, band, tip.triangles[1]},
                                {solid, band, tip.triangles[2]}};
  Vec3 at = x;
  for (int step = 0; step < kSteps; ++step) {
    for (int i = 0; i < tip.faces; ++i) {
      n[i] = faces[i].outward(at);
      by[i] = -faces[i].above_mm(at) - (moved ? 0.0 : faces[i].offset_mm());
    }
    const auto move = tip.faces == 3 ? move_of(n, by) : move_of(n[0], by[0], n[1], by[1]);
    if (!move) break;
    at += move->by;
  }
  const Vec3 travel = at - x;
  const double length = travel.norm();
  return moved && length > tip.travel_mm ? Vec3(x + tip.travel_mm / length * travel) : at;
}

bool goes_outwards(const LargestFace& a, const LargestFace& b, const Vec3& x) {
  const auto move = move_of(a.outward(x), -a.above_mm(x), b.outward(x), -b.above_mm(x));
  return move && move->outwards;
}

std::vector<Tip> find_tips(const Solid& solid, const SurfaceBand& band) {
  if (band.trivial || !(band.largest_offset_mm > 0.0)) return {};
  return TipFinder(solid, band).run();
}

}  // namespace mortise
