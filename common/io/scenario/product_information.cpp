#include "common/io/scenario/product_information.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "common/evaluation/tolerance.h"

namespace mortise {
namespace {

using Kind = StepStatement::Kind;

// A stated size that is off the modelled one by more than this is of another state of the part.
constexpr double kSameSize_mm = 1e-3;
constexpr double kOneDirection = 1e-9;  // 1 less the cosine of planes that are parallel
constexpr const char* kComposite = "composite: a wider zone of the same features holds";
constexpr double kLeastZone_mm = 1e-9;  // 0 would be no position at all

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
  if (stated(s.outside)) text += " U " + size_text(s.outside);
  if (!s.modifiers.empty()) text += " (" + s.modifiers + ")";
  return text;
}

bool says(const StepStatement& s, std::string_view word) {
  return s.name.find(word) != std::string::npos;
}

bool has_size(const Surface& surface) {
  return surface.kind == SurfaceKind::kCylinder || surface.kind == SurfaceKind::kSphere;
}

// What a size may be, in the words of the statement; nothing without limits.
std::optional<Interval> limits_of(const StepStatement& s) {
  if (stated(s.limit_upper) && stated(s.limit_lower))
    return Interval{std::min(s.limit_lower, s.limit_upper), std::max(s.limit_lower, s.limit_upper)};
  if (!stated(s.value) || !stated(s.upper) || !stated(s.lower)) return std::nullopt;
  return Interval{s.value + std::min(s.lower, s.upper), s.value + std::max(s.lower, s.upper)};
}

class StatementReader {
 public:
  StatementReader(const StepDocument& document, const std::vector<StepPartGiven>& given)
      : document_(document), given_(given), stated_(given.size()) {}

  std::vector<PartStatements> run(std::vector<Scenario::AssemblySpec::Listed>& listed) {
    std::vector<Scenario::AssemblySpec::Listed> entries(document_.statements.size());
    for (const std::size_t i : order()) {
      const StepStatement& s = document_.statements[i];
      entries[i].text = "#" + std::to_string(s.entity) + " " + words_of(s);
      entries[i].reason = use(s, entries[i].text);
      entries[i].used = entries[i].reason.empty();
    }
    listed.insert(listed.end(), entries.begin(), entries.end());
    return std::move(stated_);
  }

 private:
  // Sizes first, because a position at a material condition counts from them; then the widest zone
  // of a composite tolerance.
  std::vector<std::size_t> order() const {
    std::vector<std::size_t> order(document_.statements.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto zone = [&](std::size_t i) {
      const StepStatement& s = document_.statements[i];
      if (s.kind != Kind::kGeometric) return -std::numeric_limits<double>::infinity();
      return stated(s.value) ? -s.value : 0.0;
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return zone(a) < zone(b); });
    return order;
  }

  // Empty when it was used, else why not.
  std::string use(const StepStatement& s, std::string& text) {
    switch (s.kind) {
      case Kind::kSize:
        return use_size(s, text);
      case Kind::kDistance:
        return use_distance(s, text);
      case Kind::kAngle:
        return "angles are not judged";
      case Kind::kDatum:
        return "there are no datum systems";
      case Kind::kGeometric:
        return use_geometric(s, text);
      case Kind::kUnknown:
        break;
    }
    return "of no known kind, or about several parts";
  }

  struct Target {
    std::uint32_t part = 0;
    const Feature* feature = nullptr;
  };

  std::vector<Target> targets(const std::vector<StepFaceRef>& faces) const {
    std::vector<Target> targets;
    for (const StepFaceRef& ref : faces) {
      const std::int32_t f = given_[ref.part].feature_of_face[ref.face];
      if (f < 0) continue;
      const Feature& feature = given_[ref.part].part->features[static_cast<std::size_t>(f)];
      if (std::none_of(targets.begin(), targets.end(),
                       [&](const Target& t) { return t.feature == &feature; }))
        targets.push_back({ref.part, &feature});
    }
    return targets;
  }

  static std::string no_face(const StepStatement& s) {
    if (!s.faces.empty() || !s.other_faces.empty())
      return "its faces are freeform, and tolerances of those are not judged";
    return s.faces_lost > 0 ? "its faces are not among those of the solids" : "it names no face";
  }

  void name_target(const Target& target, std::string& text) const {
    text += (text.find(" on ") == std::string::npos ? " on " : ", ") +
            given_[target.part].part->product + "." + target.feature->name;
  }

  std::string use_size(const StepStatement& s, std::string& text) {
    const std::optional<Interval> limits = limits_of(s);
    if (!limits && s.code.empty())
      return stated(s.value) ? "a size without a tolerance: the general one holds"
                             : "the file gives no value";
    std::vector<Target> all = targets(s.faces);
    if (all.empty()) return no_face(s);
    if (std::all_of(all.begin(), all.end(), is_plane)) return use_width(s, all, text);
    std::erase_if(all, [](const Target& t) { return !has_size(t.feature->surface); });
    if (all.empty()) return "a size of faces that are neither cylinders nor spheres";
    for (const char* other : {"length", "height", "depth", "thickness", "width", "toroidal"})
      if (says(s, other)) return "a size that is no diameter";
    // A size is a diameter, unless its name says radius.
    const double factor = says(s, "radius") || says(s, "radial") ? 2.0 : 1.0;
    std::string refused;
    bool used = false;
    for (const Target& target : all) {
      const std::string why =
          limits ? state_limits(s, target, factor, *limits) : state_class(s, target);
      if (why.empty()) {
        used = true;
        name_target(target, text);
      } else {
        refused = why;
      }
    }
    return used ? "" : refused;
  }

  std::string state_class(const StepStatement& s, const Target& target) {
    const Surface& surface = target.feature->surface;
    const double nominal = stated(s.value) ? s.value : 2.0 * surface.radius_mm;
    const auto said = iso_statement(s.code, nominal, surface, target.feature->residual_mm);
    if (!said) return said.error().text;
    Scenario::FeatureSpec& spec = spec_of(target);
    spec.iso_class = s.code;
    spec.nominal_mm = nominal;
    return {};
  }

  std::string state_limits(const StepStatement& s, const Target& target, double factor,
                           const Interval& limits) {
    const Surface& surface = target.feature->surface;
    const double modelled = 2.0 * surface.radius_mm;
    const Interval diameter{factor * limits.lo, factor * limits.hi};
    const bool is_size =
        (stated(s.value) && std::fabs(factor * s.value - modelled) <= kSameSize_mm) ||
        (modelled >= diameter.lo - kSameSize_mm && modelled <= diameter.hi + kSameSize_mm);
    if (!is_size) return "the modelled diameter is " + size_text(modelled) + " mm, another size";
    const double lo = 0.5 * diameter.lo - surface.radius_mm;
    const double hi = 0.5 * diameter.hi - surface.radius_mm;
    // Outward of the material: a larger hole is inward.
    spec_of(target).tolerance = Scenario::Tolerance{
        surface.inward ? Interval{-hi, -lo} : Interval{lo, hi},
        "Ø" + size_text(diameter.lo) + " to " + size_text(diameter.hi) + " (PMI)"};
    return {};
  }

  // A distance of two opposite planes is a width.
  std::string use_distance(const StepStatement& s, std::string& text) {
    if (!limits_of(s))
      return stated(s.value) ? "a distance without a tolerance" : "the file gives no value";
    std::vector<Target> all = targets(s.faces), others = targets(s.other_faces);
    if (s.faces_lost == 0 && (s.faces.empty() || s.other_faces.empty()))
      return "it does not name two faces";
    if (all.empty() || others.empty()) return no_face(s);
    all.insert(all.end(), others.begin(), others.end());
    if (!std::all_of(all.begin(), all.end(), is_plane))
      return "a distance of other faces than planes: there are no datum systems";
    return use_width(s, all, text);
  }

  static bool is_plane(const Target& target) {
    return target.feature->surface.kind == SurfaceKind::kPlane;
  }

  // Each plane takes half of the deviations; the middle one stays where it is modelled.
  std::string use_width(const StepStatement& s, const std::vector<Target>& planes,
                        std::string& text) {
    const std::optional<Interval> limits = limits_of(s);
    if (!limits) return "a class of limits of a width: state it as width_to";
    const Surface& first = planes.front().feature->surface;
    double other_mm = 0.0;  // along the normal of the first
    bool has_other = false;
    for (const Target& target : planes) {
      const Surface& plane = target.feature->surface;
      const double along = first.axis.dot(plane.axis);
      const double off_mm = first.axis.dot(plane.point - first.point);
      if (target.part != planes.front().part || std::fabs(along) < 1.0 - kOneDirection)
        return "its planes are not parallel";
      if (along > 0.0 && std::fabs(off_mm) > kSameSize_mm)
        return "a distance of planes that face the same way: there are no datum systems";
      if (along > 0.0) continue;
      if (has_other && std::fabs(off_mm - other_mm) > kSameSize_mm)
        return "a distance of more than two planes";
      has_other = true;
      other_mm = off_mm;
    }
    if (!has_other) return "it names one of two planes";
    const double modelled_mm = std::fabs(other_mm);
    const bool is_size =
        (stated(s.value) && std::fabs(s.value - modelled_mm) <= kSameSize_mm) ||
        (modelled_mm >= limits->lo - kSameSize_mm && modelled_mm <= limits->hi + kSameSize_mm);
    if (!is_size) return "the modelled distance is " + size_text(modelled_mm) + " mm, another size";
    const double lo = 0.5 * (limits->lo - modelled_mm), hi = 0.5 * (limits->hi - modelled_mm);
    const bool is_slot = other_mm > 0.0;  // the first faces the other
    for (const Target& target : planes) {
      widen(spec_of(target), is_slot ? Interval{-hi, -lo} : Interval{lo, hi},
            "width " + size_text(limits->lo) + " to " + size_text(limits->hi) + " (PMI)");
      name_target(target, text);
    }
    return {};
  }

  // Several statements about one place of a surface: it may be wherever one of them lets it be.
  static void widen(Scenario::FeatureSpec& spec, const Interval& offset, const std::string& text) {
    if (!spec.tolerance) {
      spec.tolerance = Scenario::Tolerance{offset, text};
      return;
    }
    spec.tolerance->offset_mm = hull(spec.tolerance->offset_mm, offset);
    spec.tolerance->text += ", " + text;
  }

  std::string use_geometric(const StepStatement& s, std::string& text) {
    for (const char* form : {"flatness", "straightness", "cylindricity", "roundness", "runout"})
      if (says(s, form)) return "a form within the limits of size: it widens nothing";
    const bool position = says(s, "position"), profile = says(s, "surface profile");
    if (!position && !profile) return s.name + " refers to datums, and there are no datum systems";
    const bool at_mmc = s.modifiers.find("maximum material") != std::string::npos;
    const bool at_lmc = s.modifiers.find("least material") != std::string::npos;
    if (!stated(s.value) || (s.value <= 0.0 && !at_mmc && !at_lmc))
      return "the file gives no value";
    std::vector<Target> all = targets(s.faces);
    if (all.empty()) return no_face(s);
    if (profile) {
      bool said = false;
      for (const Target& target : all) said |= state_profile(s, target);
      if (!said) return kComposite;
      text += " on " + std::to_string(all.size()) + " features of " +
              given_[all.front().part].part->product;
      return {};
    }
    std::erase_if(all, [](const Target& t) { return !has_size(t.feature->surface); });
    if (all.empty()) return "a position of faces that are neither cylinders nor spheres";
    const MaterialCondition condition = at_mmc   ? MaterialCondition::kMaximum
                                        : at_lmc ? MaterialCondition::kLeast
                                                 : MaterialCondition::kRegardless;
    bool used = false;
    for (const Target& target : all)
      if (state_position(s, target, condition)) {
        used = true;
        name_target(target, text);
      }
    return used ? "" : kComposite;
  }

  bool state_position(const StepStatement& s, const Target& target, MaterialCondition condition) {
    Scenario::FeatureSpec& spec = spec_of(target);
    const bool has_limits = spec.tolerance || !spec.iso_class.empty();
    // Zero at a material condition is a zone that the size alone opens.
    const double zone_mm = std::max(s.value, kLeastZone_mm);
    if (spec.position.zone_mm >= zone_mm) return false;
    spec.position.zone_mm = zone_mm;
    spec.position.condition = has_limits ? condition : MaterialCondition::kRegardless;
    return true;
  }

  bool state_profile(const StepStatement& s, const Target& target) {
    Scenario::FeatureSpec& spec = spec_of(target);
    const bool unequal = stated(s.outside) && s.outside >= 0.0 && s.outside <= s.value;
    const Interval zone = unequal ? Interval{s.outside - s.value, s.outside}
                                  : Interval{-0.5 * s.value, 0.5 * s.value};
    const std::string words = "profile " + size_text(s.value) + " mm" +
                              (unequal ? " UZ " + size_text(s.outside) : "") + " (PMI)";
    if (spec.iso_class.empty()) {
      const bool wider = spec.tolerance && spec.tolerance->offset_mm.lo <= zone.lo &&
                         spec.tolerance->offset_mm.hi >= zone.hi &&
                         spec.tolerance->text.find("profile") != std::string::npos;
      if (!wider) widen(spec, zone, words);
      return !wider;
    }
    // A size by its class: the profile says where it may be.
    const double reach_mm = 2.0 * std::max(-zone.lo, zone.hi);
    if (spec.position.zone_mm >= reach_mm) return false;
    spec.position.zone_mm = reach_mm;
    spec.position.condition = MaterialCondition::kRegardless;
    return true;
  }

  Scenario::FeatureSpec& spec_of(const Target& target) {
    auto& features = stated_[target.part].features;
    const auto known = std::find_if(features.begin(), features.end(),
                                    [&](auto& f) { return f.name == target.feature->name; });
    if (known != features.end()) return *known;
    features.emplace_back();
    features.back().name = target.feature->name;
    features.back().by = Scenario::SaidBy::kFile;
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
