#include "common/depth/cells/sharp_window.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/base/constants.h"
#include "common/depth/body.h"
#include "common/depth/cells/linear_program.h"
#include "common/depth/triangles_in.h"
#include "common/geometry/across_material.h"
#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

// Points of proof keep away from planes by more than rounding and the corners' distance from them.
constexpr double kLeastApart_mm = 1e-8;
constexpr double kNoises = 4.0;
// A point in the plane of faces is at least so many times what points of proof keep away off the
// part: what that plane is off its faces is little beside it.
constexpr double kOffPart = 8.0;
// A polygon with less area holds no point of proof, mm^2.
constexpr double kLeastArea_mm2 = 1e-8;
// A window is wider than its reach by room for points of proof: by so many times what they keep
// away, and so that a facet across it has area.
constexpr double kRoom = 4.0, kLeastRoom_mm = 2e-4;
// A point of proof near a corner of what is left of a facet: this share of the way to it.
constexpr double kTowardsCorner = 0.98;
// Clauses that are kept of one question; the shortest.
constexpr std::size_t kMostClauses = 8;

double area(const std::vector<Vec3>& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  return 0.5 * sum.norm();
}

Vec3 middle_of(const std::vector<Vec3>& polygon) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& corner : polygon) sum += corner;
  return sum / static_cast<double>(polygon.size());
}

bool shorter(FaceSet a, FaceSet b) {
  const int of_a = std::popcount(a), of_b = std::popcount(b);
  return of_a != of_b ? of_a < of_b : a < b;
}

}  // namespace

void clip(std::vector<Vec3>& polygon, std::vector<Vec3>& spare, const Vec3& n, double c) {
  bool any_above = false, any_below = false;
  for (const Vec3& corner : polygon) {
    const double at = n.dot(corner) - c;
    any_above |= at > 0.0;
    any_below |= at < 0.0;
  }
  if (!any_above) return;
  spare.clear();
  for (std::size_t i = 0; any_below && i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    const double at_a = n.dot(a) - c, at_b = n.dot(b) - c;
    if (at_a <= 0.0) spare.push_back(a);
    if ((at_a < 0.0 && at_b > 0.0) || (at_a > 0.0 && at_b < 0.0))
      spare.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  if (spare.size() < 3) spare.clear();
  polygon.swap(spare);
}

SharpWindow::SharpWindow(const Solid& solid, const PlaneFaces& planes, const Box& core,
                         double reach_mm, double depth_mm)
    : solid_(solid), planes_(planes) {
  apart_mm_ = std::max({kLeastApart_mm, kNoises * planes.noise_mm,
                        kRoundingFactor * kUnitRoundoff * solid.bvh().extent_mm});
  box_ = core.grown(reach_mm + std::max(kLeastRoom_mm, kRoom * apart_mm_));
  gather();
  if (state_ == State::kReady) need_reach(core, depth_mm);
  if (state_ == State::kReady && !(needed_reach_mm_ <= reach_mm)) state_ = State::kTooSharp;
}

void SharpWindow::gather() {
  for_each_triangle_in(solid_.bvh(), box_, [&](std::uint32_t t, const std::array<Vec3, 3>& c) {
    const std::uint32_t face = planes_.face_of_triangle[t];
    if (face == PlaneFaces::kWithoutArea) return true;
    polygon_.assign(c.begin(), c.end());
    if (!clip_to_box()) return true;
    if (face == PlaneFaces::kNone) {
      state_ = State::kNotPlane;
      return false;
    }
    const auto known = std::find(faces_.begin(), faces_.end(), face);
    const auto index = static_cast<std::size_t>(known - faces_.begin());
    if (known == faces_.end()) {
      if (faces_.size() == kMostFaces) {
        state_ = State::kCrowded;
        return false;
      }
      faces_.push_back(face);
      plane_of_.push_back(planes_.faces[face]);
      triangles_.emplace_back();
      facets_.emplace_back();
    }
    triangles_[index].push_back(t);
    facets_[index].push_back({.first = static_cast<std::uint32_t>(corners_.size()),
                              .count = static_cast<std::uint32_t>(polygon_.size())});
    corners_.insert(corners_.end(), polygon_.begin(), polygon_.end());
    return true;
  });
  all_ = faces_.size() == kMostFaces ? ~FaceSet{0} : (FaceSet{1} << faces_.size()) - 1;
}

void SharpWindow::need_reach(const Box& core, double depth_mm) {
  const Topology& topology = solid_.topology();
  const auto take = [&](double travel_mm) {
    needed_reach_mm_ = std::max(needed_reach_mm_, travel_mm);
  };
  for (std::size_t i = 0; i < faces_.size(); ++i)
    for (const std::uint32_t t : triangles_[i])
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t beyond =
            across_material(solid_.mesh(), topology, t, static_cast<std::uint32_t>(k)).triangle;
        if (beyond == Topology::kNone) continue;  // the part is open there
        const std::uint32_t other = planes_.face_of_triangle[beyond];
        if (other < PlaneFaces::kWithoutArea && other > faces_[i])
          take(edge_travel(plane_of_[i], planes_.faces[other]).by_mm(depth_mm));
      }
  for (const std::uint32_t point : planes_.sharp_points) {
    const Vec3& at = solid_.mesh().points_mm[point];
    const double travel_mm = planes_.travel_of[point].by_mm(depth_mm);
    if ((at - at.cwiseMax(core.lo).cwiseMin(core.hi)).norm() <= travel_mm) take(travel_mm);
  }
}

bool SharpWindow::solid_inside() const { return is_inside(box_.center()); }

bool SharpWindow::is_inside(const Vec3& x) const { return inside(solid_, x); }

bool SharpWindow::clip_to_box() {
  for (int k = 0; k < 3 && !polygon_.empty(); ++k) {
    clip(polygon_, spare_, Vec3::Unit(k), box_.hi[k] - apart_mm_);
    if (!polygon_.empty()) clip(polygon_, spare_, -Vec3::Unit(k), -box_.lo[k] - apart_mm_);
  }
  return !polygon_.empty();
}

void SharpWindow::place(Facet& facet) const {
  facet.placed = true;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const PlaneFace& face = plane_of_[i];
    bool none_inside = true, all_inside = true, none_outside = true, all_outside = true;
    for (std::uint32_t k = facet.first; k < facet.first + facet.count; ++k) {
      const double along = face.n.dot(corners_[k]);
      const double beyond = along - (face.c - 2.0 * apart_mm_);
      const double short_of = -along - (-face.c - 2.0 * apart_mm_);
      none_inside &= beyond >= 0.0;
      all_inside &= beyond <= 0.0;
      none_outside &= short_of >= 0.0;
      all_outside &= short_of <= 0.0;
    }
    const FaceSet bit = FaceSet{1} << i;
    if (none_inside && !all_inside) facet.none_inside |= bit;
    if (all_inside) facet.all_inside |= bit;
    if (none_outside && !all_outside) facet.none_outside |= bit;
    if (all_outside) facet.all_outside |= bit;
  }
}

// Mostly one plane keeps all of a facet out, and few go through it.
bool SharpWindow::take_facet(Facet& facet, FaceSet half_spaces, bool outside) {
  if (!facet.placed) place(facet);
  if (half_spaces & (outside ? facet.none_outside : facet.none_inside)) return false;
  const auto first = corners_.begin() + facet.first;
  polygon_.assign(first, first + facet.count);
  const double side = outside ? -1.0 : 1.0;
  for (FaceSet rest = half_spaces & ~(outside ? facet.all_outside : facet.all_inside);
       rest != 0 && !polygon_.empty(); rest &= rest - 1) {
    const PlaneFace& face = plane_of_[static_cast<std::size_t>(std::countr_zero(rest))];
    clip(polygon_, spare_, side * face.n, side * face.c - 2.0 * apart_mm_);
  }
  return !polygon_.empty() && area(polygon_) > kLeastArea_mm2;
}

FaceSet SharpWindow::outside_of(const Vec3& x) const {
  FaceSet set = 0;
  for (std::size_t i = 0; i < plane_of_.size(); ++i)
    if (plane_of_[i].n.dot(x) - plane_of_[i].c > -apart_mm_) set |= FaceSet{1} << i;
  return set;
}

// Points just outside of a facet and inside of all faces that are held.
void SharpWindow::clauses_of_facet(std::size_t face, std::vector<FaceSet>& found) const {
  const std::vector<Vec3>& left = polygon_;
  const Vec3 outwards = apart_mm_ * plane_of_[face].n;
  const Vec3 middle = middle_of(left);
  FaceSet best = 0;
  for (std::size_t i = 0; i <= left.size(); ++i) {
    const Vec3 z = i == left.size()
                       ? middle
                       : Vec3(kTowardsCorner * left[i] + (1.0 - kTowardsCorner) * middle);
    const FaceSet clause = outside_of(z) | FaceSet{1} << face;
    if (best != 0 && !shorter(clause, best)) continue;
    // One point is enough for a clause.
    if (std::find(found.begin(), found.end(), clause) != found.end() || !is_inside(z + outwards))
      best = clause;
  }
  if (best != 0 && std::find(found.begin(), found.end(), best) == found.end())
    found.push_back(best);
}

std::vector<FaceSet> SharpWindow::find_clauses(FaceSet held) {
  std::vector<FaceSet> found;
  for (std::size_t g = 0; g < faces_.size(); ++g) {
    if (held >> g & 1) continue;
    for (Facet& facet : facets_[g])
      if (take_facet(facet, held, false)) clauses_of_facet(g, found);
  }
  if (found.empty()) clauses_in_plane(held, found);
  std::sort(found.begin(), found.end(), shorter);
  if (found.size() > kMostClauses) found.resize(kMostClauses);
  if (!found.empty()) return found;
  // No border of the part lies in what the held faces leave: it is wholly in or wholly out.
  Vec3 z;
  if (middle(held, 0, 0, z) && !is_inside(z)) found.push_back(outside_of(z));
  return found;
}

FaceSet SharpWindow::both_ways(FaceSet half_spaces) const {
  const Vec3 middle = box_.center(), half = box_.half();
  FaceSet found = 0;
  for (std::size_t i = 0; i < faces_.size(); ++i)
    for (std::size_t j = i + 1; j < faces_.size(); ++j) {
      if (!(half_spaces >> i & half_spaces >> j & 1)) continue;
      const PlaneFace &a = plane_of_[i], &b = plane_of_[j];
      const Vec3 n = a.n + b.n;
      const double apart_mm = std::fabs(n.dot(middle) - (a.c + b.c)) + n.cwiseAbs().dot(half);
      if (apart_mm <= apart_mm_) found |= FaceSet{1} << i | FaceSet{1} << j;
    }
  return found;
}

// Between two bodies that touch with an edge a point may hold the faces of both, and there is no
// room inside of them. A point in their plane and far enough off the part is outside of it, too.
void SharpWindow::clauses_in_plane(FaceSet held, std::vector<FaceSet>& found) const {
  const FaceSet plane = both_ways(held);
  if (plane == 0) return;
  for (std::size_t g = 0; g < faces_.size(); ++g) {
    Vec3 z;
    if (held >> g & 1 || !middle(held & ~plane, FaceSet{1} << g, plane, z)) continue;
    if (!is_inside(z) && nearest_point(solid_, z).distance_mm >= kOffPart * apart_mm_)
      found.push_back(outside_of(z) & ~plane);
  }
}

const std::vector<FaceSet>& SharpWindow::clauses(FaceSet held) {
  const auto [place, fresh] = clauses_of_.try_emplace(held);
  if (fresh) place->second = find_clauses(held);
  return place->second;
}

bool SharpWindow::find_least(FaceSet held) {
  const FaceSet failed = all_ & ~held;
  for (std::size_t g = 0; g < faces_.size(); ++g) {
    if (!(held >> g & 1)) continue;
    for (Facet& facet : facets_[g])
      if (take_facet(facet, failed, true) &&
          is_inside(middle_of(polygon_) - apart_mm_ * plane_of_[g].n))
        return true;
  }
  Vec3 y;
  return middle(0, failed, 0, y) && is_inside(y);
}

bool SharpWindow::in_least(FaceSet held) {
  const auto [place, fresh] = least_of_.try_emplace(held);
  if (fresh) place->second = find_least(held);
  return place->second;
}

bool SharpWindow::middle(FaceSet inside_of, FaceSet outside_of, FaceSet in_plane_of,
                         Vec3& at) const {
  const Vec3 half = box_.half(), origin = box_.center();
  LinearProgram program(4, {-half.x(), -half.y(), -half.z(), 0.0},
                        {half.x(), half.y(), half.z(), half.minCoeff()}, {0.0, 0.0, 0.0, 1.0});
  const auto add = [&](const Vec3& n, double c, double weight) {
    program.rows.push_back({{n.x(), n.y(), n.z(), weight}, c - n.dot(origin)});
  };
  for (int k = 0; k < 3; ++k) {
    add(Vec3::Unit(k), box_.hi[k], 1.0);
    add(-Vec3::Unit(k), -box_.lo[k], 1.0);
  }
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const PlaneFace& face = plane_of_[i];
    if (inside_of >> i & 1) add(face.n, face.c, 1.0);
    if (outside_of >> i & 1) add(-face.n, -face.c, 1.0);
    if (in_plane_of >> i & 1) add(face.n, face.c + apart_mm_, 0.0);
  }
  LinearProgram::Optimum optimum;
  if (!program.maximize(optimum) || optimum.y[3] < 2.0 * apart_mm_) return false;
  at = origin + Vec3(optimum.y[0], optimum.y[1], optimum.y[2]);
  return true;
}

}  // namespace mortise
