#include "common/ccd/contact_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/base/check.h"
#include "common/ccd/pair_tree.h"
#include "common/math/unit.h"

namespace mortise {
namespace {

using namespace ccd;

// A face that turns away from the normal by more than this is seen edge-on (sine).
constexpr double kFacing = 1e-3;
// Directions that differ by less are one (chord of unit normals).
constexpr double kSameDirection = 1e-9;
// Ways around a normal along which the outermost place is kept.
constexpr int kOutermost = 8;

Vec3 face_normal(const Triangle& t) { return (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized(); }

// A convex polygon of few corners in the plane across a normal.
struct Patch {
  std::array<Eigen::Vector2d, 9> at;
  int count = 0;
  void add(const Eigen::Vector2d& x) {
    if (count < static_cast<int>(at.size())) at[static_cast<std::size_t>(count++)] = x;
  }
};

// Sutherland and Hodgman (1974): what of the patch lies left of the line from p to q.
Patch left_of(const Patch& patch, const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
  const auto side = [&](const Eigen::Vector2d& x) {
    return (q.x() - p.x()) * (x.y() - p.y()) - (q.y() - p.y()) * (x.x() - p.x());
  };
  Patch cut;
  for (int i = 0; i < patch.count; ++i) {
    const Eigen::Vector2d& x = patch.at[static_cast<std::size_t>(i)];
    const Eigen::Vector2d& y = patch.at[static_cast<std::size_t>((i + 1) % patch.count)];
    const double sx = side(x), sy = side(y);
    if (sx >= 0.0) cut.add(x);
    if ((sx > 0.0 && sy < 0.0) || (sx < 0.0 && sy > 0.0)) cut.add(x + sx / (sx - sy) * (y - x));
  }
  return cut;
}

// Coordinates across the normal, and heights along it.
struct Across {
  Vec3 e, f, n;
  explicit Across(const Vec3& normal) : n(normal) {
    int least = 0;
    normal.cwiseAbs().minCoeff(&least);
    e = normal.cross(Vec3::Unit(least)).normalized();
    f = normal.cross(e);
  }
  Eigen::Vector2d flat(const Vec3& x) const { return {e.dot(x), f.dot(x)}; }
  // Height of the triangle's plane above a place.
  double height(const Triangle& t, const Vec3& facing, const Eigen::Vector2d& x) const {
    const Vec3 foot = x.x() * e + x.y() * f;
    return facing.dot(t[0] - foot) / facing.dot(n);
  }
};

Patch flat(const Across& across, const Triangle& t) {
  Patch patch;
  for (const Vec3& x : t) patch.add(across.flat(x));
  const Eigen::Vector2d u = patch.at[1] - patch.at[0], v = patch.at[2] - patch.at[0];
  if (u.x() * v.y() - u.y() * v.x() < 0.0) std::swap(patch.at[1], patch.at[2]);
  return patch;
}

class Places {
 public:
  explicit Places(double reach_mm) : reach_mm_(reach_mm) {}

  // x of A, y of B, both in the frame of the answer.
  void add(const Triangle& x, const Triangle& y) {
    const TriangleSeparation apart = triangle_separation_outside(x, y);
    const Vec3 n = -apart.normal;  // from B to A
    // A unit vector, or zero where triangles cross.
    if (!(n.squaredNorm() > 0.5) || apart.distance_mm > reach_mm_) return;
    const Vec3 out_a = face_normal(x), out_b = face_normal(y);
    if (-n.dot(out_a) < kFacing || n.dot(out_b) < kFacing) return;
    const Across across(n);
    Patch patch = flat(across, x);
    const Patch other = flat(across, y);
    for (int k = 0; k < 3 && patch.count > 0; ++k)
      patch = left_of(patch, other.at[static_cast<std::size_t>(k)],
                      other.at[static_cast<std::size_t>((k + 1) % 3)]);
    for (int i = 0; i < patch.count; ++i) {
      const Eigen::Vector2d& at = patch.at[static_cast<std::size_t>(i)];
      const double top = across.height(x, out_a, at), bottom = across.height(y, out_b, at);
      if (top - bottom > reach_mm_ || top - bottom < -reach_mm_) continue;
      places_.push_back({at.x() * across.e + at.y() * across.f + bottom * n, n, top - bottom});
    }
  }

  // Of each direction the outermost places, seen in the plane.
  std::vector<ContactPlace> outermost() const {
    std::vector<ContactPlace> kept;
    std::vector<char> done(places_.size(), 0);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (done[i]) continue;
      std::vector<std::size_t> alike;
      for (std::size_t j = i; j < places_.size(); ++j)
        if (!done[j] && is_same_direction(places_[j].normal_W, places_[i].normal_W)) {
          done[j] = 1;
          alike.push_back(j);
        }
      keep_outermost(alike, kept);
    }
    return kept;
  }

 private:
  // Most are far from it, and need no root.
  static bool is_same_direction(const Vec3& x, const Vec3& y) {
    const double chord2 = (x - y).squaredNorm();
    return chord2 < 2.0 * kSameDirection * kSameDirection && std::sqrt(chord2) <= kSameDirection;
  }

  // Triangles that share a corner show it once.
  void add(std::size_t place, std::vector<std::size_t>& chosen) const {
    for (const std::size_t other : chosen)
      if (other == place ||
          (places_[other].point_W - places_[place].point_W).norm() <= 1e-3 * reach_mm_)
        return;
    chosen.push_back(place);
  }

  void keep_outermost(const std::vector<std::size_t>& alike,
                      std::vector<ContactPlace>& kept) const {
    const Across across(places_[alike.front()].normal_W);
    std::vector<Eigen::Vector2d> flat;
    for (const std::size_t j : alike) flat.push_back(across.flat(places_[j].point_W));
    std::vector<std::size_t> chosen;
    for (int k = 0; k < kOutermost; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.3) / kOutermost;
      const Eigen::Vector2d way(std::cos(angle), std::sin(angle));
      std::size_t best = 0;
      double most = way.dot(flat.front());
      for (std::size_t j = 1; j < flat.size(); ++j)
        if (const double along = way.dot(flat[j]); along > most) {
          most = along;
          best = j;
        }
      add(alike[best], chosen);
    }
    // And the deepest, wherever it is.
    std::size_t deepest = alike.front();
    for (const std::size_t j : alike)
      if (places_[j].gap_mm < places_[deepest].gap_mm) deepest = j;
    add(deepest, chosen);
    for (const std::size_t j : chosen) kept.push_back(places_[j]);
  }

  double reach_mm_;
  std::vector<ContactPlace> places_;
};

}  // namespace

ContactPlaces contact_places(const ContactPlacesQuery& query, CcdScratch& scratch) {
  MORTISE_CHECK(query.a != nullptr && query.b != nullptr, "a query needs two solids");
  MORTISE_CHECK(query.reach_mm >= 0.0 && query.most_pairs > 0, "a reach must be a length");
  const Solid &a = *query.a, &b = *query.b;
  PairMotion motion(a, still_motion(query.X_WA), b, still_motion(query.X_WB));
  CcdWork work;
  std::uint32_t left = query.most_pairs;
  Places places(query.reach_mm);
  motion.at(0.0);
  each_leaf_pair_within(
      motion, a.bvh(), b.bvh(), query.reach_mm, scratch, work, [&](LeafPair& leaves) {
        return leaves.each_within(motion, query.reach_mm, work,
                                  [&](const Nearest&, const Triangle& x, const Triangle& y) {
                                    places.add(x, y);
                                    return --left == 0;
                                  });
      });
  // From the origin of B's tree to the world.
  ContactPlaces found{{}, left > 0};
  if (found.all || !query.all_or_none) found.places = places.outermost();
  for (ContactPlace& place : found.places) {
    MORTISE_CHECK(
        is_unit(place.normal_W) && place.point_W.allFinite() && place.gap_mm <= query.reach_mm,
        "a place has a unit normal and lies within reach");
    place.point_W = query.X_WB * Vec3(place.point_W + b.bvh().origin);
    place.normal_W = query.X_WB.q * place.normal_W;
  }
  return found;
}

}  // namespace mortise
