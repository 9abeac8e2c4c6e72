#include "common/geometry/recognition/names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <tuple>

#include "common/messages/names.h"

namespace mortise {

std::string stem_of(const Surface& s) {
  if (s.kind == SurfaceKind::kCylinder) return s.inward ? "bore" : "shaft";
  return std::string(name_of(s.kind == SurfaceKind::kUnknown ? SurfaceKind::kPlane : s.kind));
}

namespace {

int rank_of(const Surface& s) {
  constexpr std::array<int, 6> kRank{9, 6, 1, 3, 4, 5};  // by SurfaceKind
  return s.kind == SurfaceKind::kCylinder && s.inward ? 0 : kRank[static_cast<int>(s.kind)];
}

auto key_of(const Feature& feature, const FeatureMeasure& m) {
  // Rounded, so that the last digits of a fit do not decide.
  const auto rounded = [](double x) { return std::llround(x * 1e3); };
  const Surface& s = feature.surface;
  const bool open = m.arc_rad < 2.0 * std::numbers::pi;
  const double size = s.kind == SurfaceKind::kPlane  ? m.area_mm2
                      : s.kind == SurfaceKind::kCone ? m.along_mm.hi * std::tan(s.half_angle_rad)
                                                     : s.radius_mm;
  return std::tuple(rank_of(s), open, -rounded(size), rounded(s.point.x()), rounded(s.point.y()),
                    rounded(s.point.z()), feature.triangles.front());
}

}  // namespace

void name_features(Recognition& recognition) {
  const auto key = [&](std::size_t i) {
    return key_of(recognition.features[i], recognition.measures[i]);
  };
  std::vector<std::size_t> order(recognition.features.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<Feature> features;
  std::vector<FeatureMeasure> measures;
  std::array<int, 10> number{};
  for (const std::size_t i : order) {
    features.push_back(std::move(recognition.features[i]));
    measures.push_back(recognition.measures[i]);
    const Surface& s = features.back().surface;
    features.back().name = stem_of(s) + "_" + std::to_string(++number[rank_of(s)]);
  }
  recognition.features = std::move(features);
  recognition.measures = std::move(measures);
}

}  // namespace mortise
