#include "common/depth/answer/pair_order.h"

#include <algorithm>
#include <compare>
#include <utility>

namespace mortise {
namespace {

// What is no number is nowhere; it does not come here.
std::strong_ordering ordered(double x, double y) {
  return x < y   ? std::strong_ordering::less
         : y < x ? std::strong_ordering::greater
                 : std::strong_ordering::equal;
}

std::strong_ordering ordered(const Interval& x, const Interval& y) {
  const auto lower = ordered(x.lo, y.lo);
  return lower != 0 ? lower : ordered(x.hi, y.hi);
}

std::strong_ordering ordered(const SurfaceBand::Face& x, const SurfaceBand::Face& y) {
  if (const auto by = ordered(x.tolerance_mm, y.tolerance_mm); by != 0) return by;
  if (const auto by = ordered(x.deviation_mm, y.deviation_mm); by != 0) return by;
  if (const auto by = x.name.compare(y.name) <=> 0; by != 0) return by;
  return x.surface.has_value() <=> y.surface.has_value();
}

std::strong_ordering ordered(const SurfaceBand& x, const SurfaceBand& y) {
  if (&x == &y) return std::strong_ordering::equal;
  if (const auto by = x.faces.size() <=> y.faces.size(); by != 0) return by;
  for (std::size_t i = 0; i < x.faces.size(); ++i)
    if (const auto by = ordered(x.faces[i], y.faces[i]); by != 0) return by;
  return x.face_of_triangle <=> y.face_of_triangle;
}

std::strong_ordering ordered(const Pose& x, const Pose& y) {
  for (int i = 0; i < 3; ++i)
    if (const auto by = ordered(x.p[i], y.p[i]); by != 0) return by;
  for (int i = 0; i < 4; ++i)
    if (const auto by = ordered(x.q.coeffs()[i], y.q.coeffs()[i]); by != 0) return by;
  return std::strong_ordering::equal;
}

}  // namespace

bool b_comes_first(const OverlapQuery& query) {
  if (const auto by = query.a->hash().compare(query.b->hash()) <=> 0; by != 0) return by > 0;
  if (const auto by = ordered(*query.band_a, *query.band_b); by != 0) return by > 0;
  return ordered(query.X_WA, query.X_WB) > 0;
}

OverlapQuery mirrored(const OverlapQuery& query) {
  OverlapQuery mirror = query;
  std::swap(mirror.a, mirror.b);
  std::swap(mirror.band_a, mirror.band_b);
  std::swap(mirror.X_WA, mirror.X_WB);
  return mirror;
}

OverlapResult mirrored(OverlapResult result) {
  for (OverlapRegion& region : result.regions) {
    region.normal_W = -region.normal_W;
    std::swap(region.triangle_a, region.triangle_b);
    std::swap(region.deciding_triangle_a, region.deciding_triangle_b);
    std::swap(region.shape_a, region.shape_b);
    if (region.certain_place.known()) region.certain_place.role = 1 - region.certain_place.role;
  }
  return result;
}

}  // namespace mortise
