#include "common/depth/search/face_below.h"

#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

// Triangles of a plane face that are looked at to see how far it reaches.
constexpr std::size_t kMostOfFace = 24;

}  // namespace

FaceBelow::FaceBelow(const Solid& solid, std::uint32_t triangle)
    : mesh_(solid.mesh()), solid_(solid) {
  origin_ = mesh_.corner(triangle, 0);
  u_ = (mesh_.corner(triangle, 1) - origin_).stableNormalized();
  normal_ = u_.cross(mesh_.corner(triangle, 2) - origin_).stableNormalized();
  v_ = normal_.cross(u_);
  seen_.push_back(triangle);
}

bool FaceBelow::holds(const Corners& corners, const Vec3& center) {
  if (normal_.isZero()) return false;
  for (const Vec3& x : corners) box_.extend(flat(x));
  if (!is_in(seen_.front(), flat(center))) return false;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const std::uint32_t t = seen_[i];
    if (!(area_of(t) > 0.0)) return false;  // a sliver bends nothing, and may hide a fold
    for (int k = 0; k < 3; ++k) {
      off_mm_ = std::max(off_mm_, std::fabs(normal_.dot(mesh_.corner(t, k) - origin_)));
      const Flat from = flat(mesh_.corner(t, k)), to = flat(mesh_.corner(t, (k + 1) % 3));
      if (misses(from, to)) continue;
      if (solid_.topology().edge_kind[t][k] != EdgeKind::kFlat) return false;
      const std::uint32_t next = solid_.topology().neighbor[t][k];
      if (std::find(seen_.begin(), seen_.end(), next) != seen_.end()) continue;
      if (seen_.size() == kMostOfFace) return false;
      seen_.push_back(next);
    }
  }
  return true;
}

double FaceBelow::distance_mm(const Vec3& x) const {
  return std::fabs(normal_.dot(x - origin_)) + off_mm_;
}

double FaceBelow::area_of(std::uint32_t t) const {
  const Flat a = flat(mesh_.corner(t, 1)) - flat(mesh_.corner(t, 0));
  const Flat b = flat(mesh_.corner(t, 2)) - flat(mesh_.corner(t, 0));
  return a.x() * b.y() - a.y() * b.x();
}

bool FaceBelow::is_in(std::uint32_t t, const Flat& x) const {
  for (int k = 0; k < 3; ++k) {
    const Flat from = flat(mesh_.corner(t, k)), to = flat(mesh_.corner(t, (k + 1) % 3));
    const Flat along = to - from, by = x - from;
    if (along.x() * by.y() - along.y() * by.x() < 0.0) return false;
  }
  return true;
}

// Certainly no point of the edge in the box.
bool FaceBelow::misses(const Flat& from, const Flat& to) const {
  if ((from.cwiseMin(to).array() > box_.max().array()).any() ||
      (from.cwiseMax(to).array() < box_.min().array()).any())
    return true;
  const Flat across(from.y() - to.y(), to.x() - from.x());
  const double middle = across.dot(box_.center() - from);
  return std::fabs(middle) > 0.5 * across.cwiseAbs().dot(box_.sizes());
}

}  // namespace mortise
