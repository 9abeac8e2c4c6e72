#include "common/session/tick/merge_regions.h"

#include <algorithm>

namespace mortise {
namespace {

// Places on one circle are not farther apart than its diameter; a little more for what overlaps.
constexpr double kCircleShare = 2.1;

struct FacePair {
  std::uint16_t a = 0, b = 0;
  friend bool operator==(const FacePair&, const FacePair&) = default;
};

std::uint16_t face_index(const SurfaceBand& band, std::uint32_t triangle) {
  return band.face_of_triangle.empty() ? std::uint16_t{0} : band.face_of_triangle[triangle];
}

double circle_mm(const SurfaceBand& band, std::uint16_t face) {
  const auto& surface = band.faces[face].surface;
  return surface && surface->kind != SurfaceKind::kPlane ? kCircleShare * surface->radius_mm : 0.0;
}

bool is_worse(const OverlapRegion& x, const OverlapRegion& y) {
  if (x.has_witness != y.has_witness) return x.has_witness;
  return x.certain_mm.lo > y.certain_mm.lo;
}

Interval larger(const Interval& x, const Interval& y) {
  return {std::max(x.lo, y.lo), std::max(x.hi, y.hi)};
}

void merge(OverlapRegion& into, const OverlapRegion& from) {
  OverlapRegion merged = is_worse(from, into) ? from : into;
  merged.delta_mm = larger(into.delta_mm, from.delta_mm);
  merged.certain_mm = larger(into.certain_mm, from.certain_mm);
  merged.possible_mm = larger(into.possible_mm, from.possible_mm);
  merged.area_mm2 = into.area_mm2 + from.area_mm2;
  merged.capped = into.capped || from.capped;
  merged.at_crack = into.at_crack || from.at_crack;
  merged.witnesses_refused = into.witnesses_refused + from.witnesses_refused;
  merged.grade = std::max(into.grade, from.grade);
  merged.estimated = into.estimated || from.estimated;
  merged.points_W = into.points_W;
  merged.points_W.insert(merged.points_W.end(), from.points_W.begin(), from.points_W.end());
  into = std::move(merged);
}

}  // namespace

std::vector<OverlapRegion> merge_regions(const std::vector<OverlapRegion>& regions,
                                         const SurfaceBand& band_a, const SurfaceBand& band_b) {
  std::vector<OverlapRegion> merged;
  std::vector<FacePair> faces;
  for (const OverlapRegion& region : regions) {
    const FacePair pair{face_index(band_a, region.deciding_triangle_a),
                        face_index(band_b, region.deciding_triangle_b)};
    const bool both_declared = pair.a != 0 && pair.b != 0;
    const double circle = std::max(circle_mm(band_a, pair.a), circle_mm(band_b, pair.b));
    std::size_t at = 0;
    for (; at < merged.size(); ++at) {
      if (!(faces[at] == pair)) continue;
      const double apart = (merged[at].point_W - region.point_W).norm();
      if (both_declared || (circle > 0.0 && apart <= circle)) break;
    }
    if (at < merged.size()) {
      merge(merged[at], region);
    } else {
      merged.push_back(region);
      faces.push_back(pair);
    }
  }
  std::stable_sort(
      merged.begin(), merged.end(),
      [](const OverlapRegion& x, const OverlapRegion& y) { return x.delta_mm.lo > y.delta_mm.lo; });
  return merged;
}

}  // namespace mortise
