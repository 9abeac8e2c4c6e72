#include "common/io/scenario/scene_features.h"

#include <algorithm>
#include <cmath>

namespace mortise {

const Feature* find_recognized(const Recognition& recognition, const std::string& name) {
  const auto found = std::find_if(recognition.features.begin(), recognition.features.end(),
                                  [&](const Feature& f) { return f.name == name; });
  return found == recognition.features.end() ? nullptr : &*found;
}

std::string recognized_names(const Recognition& recognition) {
  constexpr std::size_t kShown = 8;  // names that a sentence bears
  const auto& features = recognition.features;
  if (features.empty()) return "nothing was recognized in its mesh; add kind: and the surface";
  std::string names = "recognized: ";
  for (std::size_t i = 0; i < std::min(kShown, features.size()); ++i)
    names += (i == 0 ? "" : ", ") + features[i].name;
  if (features.size() > kShown)
    names += " and " + std::to_string(features.size() - kShown) + " more (mortise inspect)";
  return names;
}

std::vector<Feature> undeclared_features(const Recognition& recognition,
                                         const std::vector<Feature>& declared,
                                         std::size_t triangles) {
  std::vector<bool> taken(triangles, false);
  for (const Feature& f : declared)
    for (const std::uint32_t t : f.triangles) taken[t] = true;
  std::vector<Feature> rest;
  for (Feature feature : recognition.features) {
    std::erase_if(feature.triangles, [&](std::uint32_t t) { return taken[t]; });
    if (feature.triangles.empty()) continue;
    const auto same_name = [&](const Feature& f) { return f.name == feature.name; };
    if (std::any_of(declared.begin(), declared.end(), same_name)) feature.name += "_recognized";
    rest.push_back(std::move(feature));
  }
  return rest;
}

std::vector<std::int32_t> owners_of(const std::vector<Feature>& features,
                                    const TriangleMesh& mesh) {
  constexpr double kTie_mm = 1e-9;  // above the rounding of a distance, below any other
  std::vector<std::int32_t> owner(mesh.triangles.size(), -1);
  // All over the triangle: the corners of a narrow flat lie on the round that it is cut from, too.
  const auto off_mm = [&](std::int32_t f, std::uint32_t t) {
    const Interval off = features[f].surface.signed_distance_range_mm(
        mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    return std::max(std::fabs(off.lo), std::fabs(off.hi));
  };
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(features.size()); ++f)
    for (const std::uint32_t t : features[f].triangles)
      if (owner[t] < 0 || off_mm(f, t) < off_mm(owner[t], t) - kTie_mm) owner[t] = f;
  return owner;
}

std::optional<Interval> estimated_deviation_of(const SurfaceBand& band) {
  std::optional<Interval> all;
  for (const SurfaceBand::Face& face : band.faces)
    if (face.grade == DeviationGrade::kEstimated)
      all = hull(all.value_or(face.deviation_mm), face.deviation_mm + face.unsure_mm);
  return all;
}

}  // namespace mortise
