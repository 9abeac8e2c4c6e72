#include "common/io/scenario/product_information.h"

#include <algorithm>
#include <cmath>

#include "common/evaluation/tolerance.h"

namespace mortise {
namespace {

using Kind = StepStatement::Kind;

// A stated size that is off the modelled one by more than this is of another state of the part.
constexpr double kSameSize_mm = 1e-3;

bool stated(double x) { return !std::isnan(x); }

std::string signed_text(double mm) { return (mm >= 0.0 ? "+" : "") + size_text(mm); }

std::string words_of(const StepStatement& s) {
  std::string text = s.name.empty() ? "statement" : s.name;
  if (stated(s.value)) text += " " + size_text(s.value);
  if (!s.code.empty()) text += " " + s.code;
  if (stated(s.upper) && stated(s.lower))
    text += " " + signed_text(s.upper) + "/" + signed_text(s.lower);
  if (stated(s.limit_upper) && stated(s.limit_lower))
    text += " " + size_text(s.limit_lower) + " to " + size_text(s.limit_upper);
  if (!s.modifiers.empty()) text += " (" + s.modifiers + ")";
  return text;
}

class StatementReader {
 public:
  StatementReader(const StepDocument& document, const std::vector<StepPartGiven>& given)
      : document_(document), given_(given), stated_(given.size()) {}

  std::vector<PartStatements> run(std::vector<Scenario::AssemblySpec::Listed>& listed) {
    for (const StepStatement& s : document_.statements) {
      Scenario::AssemblySpec::Listed entry;
      entry.text = "#" + std::to_string(s.entity) + " " + words_of(s);
      entry.reason = use(s, entry.text);
      entry.used = entry.reason.empty();
      listed.push_back(std::move(entry));
    }
    return std::move(stated_);
  }

 private:
  // Empty when it was used, else why not.
  std::string use(const StepStatement& s, std::string& text) {
    switch (s.kind) {
      case Kind::kSize:
        return use_size(s, text);
      case Kind::kDistance:
        return "distances of two faces are not judged: there are no datum systems";
      case Kind::kAngle:
        return "angles are not judged";
      case Kind::kDatum:
        return "there are no datum systems";
      case Kind::kGeometric:
        return use_geometric(s, text);
      case Kind::kUnknown:
        break;
    }
    return "of no known kind";
  }

  struct Target {
    std::uint32_t part = 0;
    const Feature* feature = nullptr;
  };

  std::vector<Target> targets(const StepStatement& s) const {
    std::vector<Target> targets;
    for (const StepFaceRef& ref : s.faces) {
      const std::int32_t f = given_[ref.part].feature_of_face[ref.face];
      if (f < 0) continue;
      const Feature& feature = given_[ref.part].part->features[static_cast<std::size_t>(f)];
      if (std::none_of(targets.begin(), targets.end(),
                       [&](const Target& t) { return t.feature == &feature; }))
        targets.push_back({ref.part, &feature});
    }
    return targets;
  }

  std::string use_size(const StepStatement& s, std::string& text) {
    const bool limits = stated(s.limit_upper) && stated(s.limit_lower);
    const bool plus_minus = stated(s.upper) && stated(s.lower) && stated(s.value);
    if (!limits && !plus_minus && s.code.empty())
      return stated(s.value) ? "a size without a tolerance: the general one holds"
                             : "the file gives no value";
    std::vector<Target> all = targets(s);
    if (all.empty())
      return s.faces_lost > 0 ? "its faces are not among those of the parts" : "it names no face";
    std::erase_if(all, [](const Target& t) {
      const SurfaceKind kind = t.feature->surface.kind;
      return kind != SurfaceKind::kCylinder && kind != SurfaceKind::kSphere;
    });
    if (all.empty()) return "a size of faces that are neither cylinders nor spheres";
    // A size is a diameter, unless its name says radius.
    const bool radius =
        s.name.find("radius") != std::string::npos || s.name.find("radial") != std::string::npos;
    const double factor = radius ? 2.0 : 1.0;
    Interval diameter;
    if (limits)
      diameter = {factor * s.limit_lower, factor * s.limit_upper};
    else if (plus_minus)
      diameter = {factor * (s.value + std::min(s.lower, s.upper)),
                  factor * (s.value + std::max(s.lower, s.upper))};
    std::string refused;
    bool used = false;
    for (const Target& target : all) {
      const std::string why = state_size(s, target, diameter, limits || plus_minus);
      if (why.empty()) {
        used = true;
        text += (text.find(" on ") == std::string::npos ? " on " : ", ") +
                given_[target.part].part->product + "." + target.feature->name;
      } else {
        refused = why;
      }
    }
    return used ? "" : refused;
  }

  std::string state_size(const StepStatement& s, const Target& target, Interval diameter,
                         bool has_limits) {
    const Surface& surface = target.feature->surface;
    Scenario::FeatureSpec& spec = spec_of(target);
    if (!has_limits) {
      const double nominal = stated(s.value) ? s.value : 2.0 * surface.radius_mm;
      const auto said = iso_statement(s.code, nominal, surface, target.feature->residual_mm);
      if (!said) return said.error().text;
      spec.iso_class = s.code;
      spec.nominal_mm = nominal;
      return {};
    }
    const double modelled = 2.0 * surface.radius_mm;
    const bool is_size =
        (stated(s.value) &&
         std::fabs(s.value * (modelled / s.value > 1.5 ? 2.0 : 1.0) - modelled) <= kSameSize_mm) ||
        (modelled >= diameter.lo - kSameSize_mm && modelled <= diameter.hi + kSameSize_mm);
    if (!is_size) return "the modelled diameter is " + size_text(modelled) + " mm, another size";
    const double lo = 0.5 * diameter.lo - surface.radius_mm;
    const double hi = 0.5 * diameter.hi - surface.radius_mm;
    // Outward of the material: a larger hole is inward.
    spec.tolerance = Scenario::Tolerance{
        surface.inward ? Interval{-hi, -lo} : Interval{lo, hi},
        "Ø" + size_text(diameter.lo) + " to " + size_text(diameter.hi) + " (PMI)"};
    return {};
  }

  std::string use_geometric(const StepStatement& s, std::string& text) {
    if (!stated(s.value)) return "the file gives no value";
    const auto is = [&](const char* word) { return s.name.find(word) != std::string::npos; };
    if (!is("SurfaceProfile"))
      return is("Position") ? "positions refer to datums, and there are no datum systems"
                            : "within the limits of size: it widens nothing";
    const std::vector<Target> all = targets(s);
    if (all.empty())
      return s.faces_lost > 0 ? "its faces are not among those of the parts" : "it names no face";
    for (const Target& target : all) {
      Scenario::FeatureSpec& spec = spec_of(target);
      if (spec.tolerance || !spec.iso_class.empty()) continue;  // the size is narrower
      spec.tolerance = Scenario::Tolerance{{-0.5 * s.value, 0.5 * s.value},
                                           "profile " + size_text(s.value) + " mm (PMI)"};
    }
    text += " on " + std::to_string(all.size()) + " features of " +
            given_[all.front().part].part->product;
    return {};
  }

  Scenario::FeatureSpec& spec_of(const Target& target) {
    auto& features = stated_[target.part].features;
    const auto known = std::find_if(features.begin(), features.end(),
                                    [&](auto& f) { return f.name == target.feature->name; });
    if (known != features.end()) return *known;
    features.emplace_back();
    features.back().name = target.feature->name;
    return features.back();
  }

  const StepDocument& document_;
  const std::vector<StepPartGiven>& given_;
  std::vector<PartStatements> stated_;
};

}  // namespace

std::vector<PartStatements> statements_of(const StepDocument& document,
                                          const std::vector<StepPartGiven>& given,
                                          std::vector<Scenario::AssemblySpec::Listed>& listed) {
  return StatementReader(document, given).run(listed);
}

}  // namespace mortise
