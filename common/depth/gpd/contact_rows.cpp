#include "common/depth/gpd/contact_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/ccd/contact_places.h"
#include "common/math/rotation.h"

namespace mortise::gpd {
namespace {

// Where more pairs of triangles are near, corners all over both parts say more than the first of
// these, which lie in one place (README, section 7).
constexpr std::uint32_t kMostPairs = 4096;
// Of meshes of so many triangles together more are near.
constexpr std::size_t kLarge = 40'000;
// Evaluations that one search of the trees for near triangles counts for.
constexpr std::uint64_t kPlacesWork = 20;
// Corners of each part at which contact is seen; of those that are carried into the frame of the
// other part to find them at most so many, of a large mesh every so-manyth, and so many at the cost
// of one evaluation.
constexpr std::size_t kMostCorners = 160, kMostCarried = 16'384, kCornersAWorkUnit = 256;
// Deeper than rounding is deep, mm.
constexpr double kMeet_mm = 1e-9;

}  // namespace

ContactRows::ContactRows(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                         const TwistFrame& frame, CcdScratch& scratch)
    : parts_{&a, &b},
      X_W_{X_WA, X_WB},
      frame_(frame),
      scratch_(scratch),
      crowded_(a.mesh().triangles.size() + b.mesh().triangles.size() > kLarge) {}

std::vector<Row> ContactRows::at(const Vec6& xi, double reach_mm, double margin_mm,
                                 std::uint64_t& work) {
  const Pose D = frame_.pose_of(xi);
  const Pose X_WA = D * X_W_[0];
  std::vector<Place> places;
  crowded_ = crowded_ || !by_triangles(X_WA, reach_mm, places, work);
  if (crowded_) places = by_corners(X_WA, reach_mm, work);
  // How the centre moves and A turns for a small change of each coordinate of the twist.
  Vec3 shift[6], turn[6];
  const double step = 1e-6 * frame_.radius_mm;
  for (int k = 0; k < 6; ++k) {
    Vec6 near = xi;
    near[k] += step;
    const Pose R = frame_.pose_of(near) * D.inverse();
    turn[k] = rotation_log(R.q.normalized()) / step;
    shift[k] = (R * frame_.center_W - frame_.center_W) / step;
  }
  std::vector<Row> rows(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place& p = places[i];
    for (int k = 0; k < 6; ++k)
      rows[i].g[k] = p.normal_W.dot(shift[k] + turn[k].cross(p.point_W - frame_.center_W));
    rows[i].h = margin_mm - p.gap_mm + rows[i].g.dot(xi);
  }
  return rows;
}

bool ContactRows::by_triangles(const Pose& X_WA, double reach_mm, std::vector<Place>& places,
                               std::uint64_t& work) {
  ContactPlacesQuery query;
  query.a = parts_[0];
  query.b = parts_[1];
  query.X_WA = X_WA;
  query.X_WB = X_W_[1];
  query.reach_mm = reach_mm;
  query.most_pairs = kMostPairs;
  query.all_or_none = true;
  const ContactPlaces found = contact_places(query, scratch_);
  work += kPlacesWork + found.places.size();
  for (const ContactPlace& place : found.places)
    places.push_back({place.point_W, place.normal_W, place.gap_mm});
  return found.all;
}

std::vector<ContactRows::Corner> ContactRows::corners_near(int part, double reach_mm) const {
  const Pose X = X_W_[1 - part].inverse() * X_W_[part];
  const Mat3 R = X.rotation();
  const Box box = parts_[1 - part]->bounds().grown(reach_mm);
  const std::vector<Vec3>& points = parts_[part]->mesh().points_mm;
  const std::size_t every = points.size() > kMostCarried ? (points.size() / kMostCarried) | 1U : 1;
  std::vector<Corner> near;
  for (std::size_t i = 0; i < points.size(); i += every) {
    const Vec3 y = R * points[i] + X.p;
    if ((y.array() >= box.lo.array()).all() && (y.array() <= box.hi.array()).all())
      near.push_back({points[i]});
  }
  // An odd stride, so that of a regular mesh not one row of corners alone is seen.
  const std::size_t stride = (near.size() / kMostCorners) | 1U;
  std::vector<Corner> some;
  for (std::size_t i = 0; i < near.size(); i += stride) some.push_back(near[i]);
  return some;
}

void ContactRows::see_corners(double reach_mm, std::uint64_t& work) {
  if (reach_mm <= corners_reach_mm_) return;
  corners_reach_mm_ = 4.0 * reach_mm;
  for (const int part : {0, 1}) {
    corners_[part] = corners_near(part, corners_reach_mm_);
    work += std::min(parts_[part]->mesh().points_mm.size(), kMostCarried) / kCornersAWorkUnit;
  }
}

SurfacePoint ContactRows::corner_at(int part, Corner& corner, const Pose& X_WA,
                                    std::uint32_t near) const {
  const Pose X = part == 0 ? X_W_[1].inverse() * X_WA : X_WA.inverse() * X_W_[1];
  const SurfacePoint at = nearest_surface(*parts_[1 - part], X * corner.x,
                                          corner.near == Topology::kNone ? near : corner.near);
  corner.near = at.triangle;
  return at;
}

std::vector<ContactRows::Place> ContactRows::by_corners(const Pose& X_WA, double reach_mm,
                                                        std::uint64_t& work) {
  see_corners(reach_mm, work);
  const Pose X_W[2] = {X_WA, X_W_[1]};
  std::vector<Place> places;
  for (const int part : {0, 1}) {
    std::uint32_t near = Topology::kNone;
    for (Corner& corner : corners_[part]) {
      const SurfacePoint at = corner_at(part, corner, X_WA, near);
      near = at.triangle;
      if (std::fabs(at.depth_mm) > reach_mm) continue;
      const Vec3 outward_W = X_W[1 - part].q * at.outward;
      places.push_back(
          {X_W[part] * corner.x, part == 0 ? outward_W : Vec3(-outward_W), -at.depth_mm});
    }
    work += corners_[part].size();
  }
  return places;
}

bool ContactRows::meet_at_corners(const Vec6& xi, std::uint64_t& work) {
  if (corners_reach_mm_ < 0.0) {
    see_corners(0.0, work);
    for (const int part : {0, 1}) {
      std::vector<std::pair<double, Corner>> by_depth;
      std::uint32_t near = Topology::kNone;
      for (Corner& corner : corners_[part]) {
        const SurfacePoint at = corner_at(part, corner, X_W_[0], near);
        near = at.triangle;
        by_depth.push_back({-at.depth_mm, corner});
      }
      std::stable_sort(by_depth.begin(), by_depth.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      for (const auto& [depth_mm, corner] : by_depth) deepest_first_[part].push_back(corner);
      work += corners_[part].size();
    }
    corners_reach_mm_ = 0.0;
  }
  const Pose X_WA = frame_.pose_of(xi) * X_W_[0];
  const Pose X_BA = X_W_[1].inverse() * X_WA, X_of[2] = {X_BA, X_BA.inverse()};
  for (const int part : {0, 1}) {
    const Box& other = parts_[1 - part]->bounds();
    for (Corner& corner : deepest_first_[part]) {
      ++work;
      const Vec3 y = X_of[part] * corner.x;
      if ((y.array() < other.lo.array()).any() || (y.array() > other.hi.array()).any()) continue;
      if (corner_at(part, corner, X_WA).depth_mm > kMeet_mm) return true;
    }
  }
  return false;
}

}  // namespace mortise::gpd
