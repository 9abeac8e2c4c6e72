#include "common/io/scenario/fit_candidates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/recognition/measure.h"

namespace mortise {
namespace {

// Of the bore: holds H9/d9 from 3 mm on and H11/c11 from 10 mm on.
constexpr double kLikeRadii = 0.03;
// One degree: parts that are drawn in place lie far closer.
constexpr double kLikeAxes_rad = std::numbers::pi / 180.0;
constexpr double kBesideAxis = 0.1;  // of the radius
/// Modelled diameters within this are one nominal size: recognized ones differ by their residuals.
constexpr double kSameNominal_mm = 0.002;
/// Pairs that a sentence bears.
constexpr std::size_t kMostListed = 6;

struct Mating {
  std::size_t of_a = 0, of_b = 0;
  double nominal_mm = 0.0;  ///< 0: the code does not join these sizes
};

std::vector<std::size_t> features_of(const FitEnd& end) {
  std::vector<std::size_t> features;
  for (std::size_t i = 0; i < end.part.features.size(); ++i)
    if (end.feature == kWholePart || end.feature == i) features.push_back(i);
  return features;
}

bool is_round(const Part& part, const Feature& feature) {
  return feature.surface.kind == SurfaceKind::kCylinder &&
         is_round(feature.surface,
                  measure_region(part.solid->mesh(), feature.surface, feature.triangles).arc_rad);
}

// A face that the file does not name, as of the surface around a part, goes by its part.
std::string name_of(const FitEnd& end) {
  const std::string feature =
      end.feature == kWholePart ? std::string() : end.part.features[end.feature].name;
  return end.part.name + (feature.empty() ? "" : ".") + feature;
}

std::vector<Mating> all_matings(const Scenario::FitSpec& fit, const FitEnd& a, const FitEnd& b) {
  std::vector<Mating> near, far;
  for (const std::size_t i : features_of(a))
    for (const std::size_t j : features_of(b)) {
      const Feature &of_a = a.part.features[i], &of_b = b.part.features[j];
      const bool a_holds = of_a.surface.inward;
      const Surface &bore = (a_holds ? of_a : of_b).surface,
                    &shaft = (a_holds ? of_b : of_a).surface;
      if (!bore.inward || shaft.inward || !like_sizes(bore, shaft)) continue;
      if (!is_round(a.part, of_a) || !is_round(b.part, of_b)) continue;
      const Result<FitStatement> said =
          fit_statement(fit.code, fit.nominal_mm, side_of({a.part, i}), side_of({b.part, j}));
      const bool meet =
          axes_meet(bore, (a_holds ? a : b).part.X_WP, shaft, (a_holds ? b : a).part.X_WP);
      (meet ? near : far).push_back({i, j, said ? said->nominal_mm : 0.0});
    }
  const bool wide = has_wildcard(fit.part_a) || has_wildcard(fit.part_b);
  return near.empty() && !wide ? far : near;
}

std::string several(const Scenario::FitSpec& fit, const FitEnd& a, const FitEnd& b,
                    const std::vector<Mating>& all) {
  std::string list;
  for (std::size_t i = 0; i < std::min(all.size(), kMostListed); ++i)
    list += (i == 0 ? "" : ", ") + a.part.name + "." + a.part.features[all[i].of_a].name + " / " +
            b.part.name + "." + b.part.features[all[i].of_b].name + " Ø" +
            size_text(all[i].nominal_mm);
  if (all.size() > kMostListed) list += " and more";
  return "fit " + fit.code + ": " + name_of(a) + " and " + name_of(b) + " meet in several sizes (" +
         list + "); write the size before the code, e.g. Ø" + size_text(all.front().nominal_mm) +
         " " + fit.code + ", or name both features";
}

}  // namespace

bool is_round(const Surface& surface, double arc_rad) {
  return surface.kind == SurfaceKind::kCylinder && arc_rad > std::numbers::pi;
}

bool like_sizes(const Surface& bore, const Surface& shaft) {
  return std::fabs(bore.radius_mm - shaft.radius_mm) <= kLikeRadii * bore.radius_mm;
}

bool axes_meet(const Surface& bore, const Pose& X_WBore, const Surface& shaft,
               const Pose& X_WShaft) {
  const Vec3 of_bore = X_WBore.q * bore.axis, of_shaft = X_WShaft.q * shaft.axis;
  if (std::asin(std::min(1.0, of_bore.cross(of_shaft).norm())) > kLikeAxes_rad) return false;
  const Vec3 d = X_WShaft * shaft.point - X_WBore * bore.point;
  return (d - d.dot(of_bore) * of_bore).norm() <= kBesideAxis * bore.radius_mm;
}

FitSide side_of(const FitEnd& end) {
  const Feature& feature = end.part.features[end.feature];
  return {&feature.surface, feature.residual_mm, name_of(end)};
}

Result<std::vector<FeatureIndices>> fitting_features(const Scenario::FitSpec& fit, const FitEnd& a,
                                                     const FitEnd& b) {
  const bool names_both = a.feature != kWholePart && b.feature != kWholePart;
  if (fit.code.empty() || names_both) return std::vector{FeatureIndices(a.feature, b.feature)};
  std::vector<Mating> all = all_matings(fit, a, b);
  if (all.empty() && !has_wildcard(fit.part_a) && !has_wildcard(fit.part_b))
    return fail(Code::kInvalidInput,
                "fit " + fit.code + ": no hole and shaft of like size are known of " + name_of(a) +
                    " and " + name_of(b) +
                    "; declare both and name them, [plate.bore, pin.journal], or say deviation: "
                    "recognized");
  const auto joined = [](const Mating& m) { return m.nominal_mm > 0.0; };
  // Sizes that the code cannot join are no choice where it joins others; alone they say what is
  // wrong with them, pair by pair.
  if (std::any_of(all.begin(), all.end(), joined))
    std::erase_if(all, [&](const Mating& m) { return !joined(m); });
  const bool one_size = std::all_of(all.begin(), all.end(), [&](const Mating& m) {
    return std::fabs(m.nominal_mm - all.front().nominal_mm) <= kSameNominal_mm;
  });
  if (!one_size) return fail(Code::kInvalidInput, several(fit, a, b, all));
  std::vector<FeatureIndices> pairs;
  for (const Mating& m : all) pairs.emplace_back(m.of_a, m.of_b);
  return pairs;
}

}  // namespace mortise
