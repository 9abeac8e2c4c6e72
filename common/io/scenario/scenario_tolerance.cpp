#include "common/io/scenario/scenario_tolerance.h"

#include <cctype>
#include <tuple>

#include "common/base/length_unit.h"
#include "common/evaluation/tolerance.h"

namespace mortise {
namespace {

bool take_prefix(std::string& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.erase(0, prefix.size());
  while (!text.empty() && text.front() == ' ') text.erase(0, 1);
  return true;
}

// "0.1" in the unit of the file, or with a unit of its own: "0.1 mm", "20 µm".
std::optional<double> length_mm(const std::string& text, double unit_mm) {
  const auto number = leading_number(text);
  if (!number) return std::nullopt;
  std::string unit = text.substr(number->second);
  take_prefix(unit, " ");
  if (unit.empty()) return number->first * unit_mm;
  const auto mm = length_unit_mm(unit == "µm" ? "um" : unit);
  return mm ? std::optional(number->first * *mm) : std::nullopt;
}

Scenario::Tolerance plus_minus(double t_mm) {
  return {{-t_mm, t_mm}, "±" + size_text(t_mm) + " mm"};
}

Scenario::Tolerance profile(double t_mm) {
  return {{-0.5 * t_mm, 0.5 * t_mm}, "profile " + size_text(t_mm) + " mm"};
}

constexpr const char* kSizeAlone =
    "is a size alone; write the class behind it: Ø20 H7, or H7/g6 of a fit";

}  // namespace

std::pair<double, std::string> split_nominal(const std::string& code) {
  std::string rest = code;
  take_prefix(rest, "Ø");
  const auto number = leading_number(rest);
  if (!number || number->first <= 0.0) return {0.0, code};
  rest.erase(0, number->second);
  while (!rest.empty() && rest.front() == ' ') rest.erase(0, 1);
  return {number->first, rest};
}

std::optional<Scenario::Tolerance> tolerance_of(const YamlMap& map) {
  const std::string way = map.one_of({"plus_minus", "profile", "lower"});
  if (way == "plus_minus" || way == "profile") {
    if (way == "plus_minus" && map.has("unequal"))
      map.error("unequal", "belongs to a profile zone; write profile: instead of plus_minus:");
    const auto t = map.length_mm(way);
    if (!t) return std::nullopt;
    if (*t < 0.0) {
      map.error(way, "must not be negative");
      return std::nullopt;
    }
    if (way == "plus_minus") return plus_minus(*t);
    if (!map.has("unequal")) return profile(*t);
    const auto outside = map.length_mm("unequal");
    if (!outside) return std::nullopt;
    if (*outside >= 0.0 && *outside <= *t)
      return Scenario::Tolerance{{-(*t - *outside), *outside},
                                 "profile " + size_text(*t) + " mm UZ " + size_text(*outside)};
    map.error("unequal", "is the part of the zone outside the material: between 0 and profile");
    return std::nullopt;
  }
  if (way.empty()) {
    map.error("say plus_minus: 0.05, or profile: 0.1 (with unequal:), or lower: and upper:");
    return std::nullopt;
  }
  const auto lower = map.length_mm("lower"), upper = map.length_mm("upper");
  if (!map.has("upper")) map.error("lower", "needs upper: beside it");
  if (!lower || !upper) return std::nullopt;
  if (*lower > *upper) {
    map.error("lower", "must not be above upper");
    return std::nullopt;
  }
  return Scenario::Tolerance{{*lower, *upper},
                             "surface " + size_text(*lower) + "/" + size_text(*upper) + " mm"};
}

namespace {

std::optional<Scenario::Tolerance> tolerance_without_place(YamlContext& context,
                                                           const YAML::Node& node,
                                                           const std::string& what) {
  if (!node.IsScalar())
    return tolerance_of(
        YamlMap(context, node, what, {"plus_minus", "profile", "unequal", "lower", "upper"}));
  std::string text = node.Scalar();
  const bool symmetric =
      take_prefix(text, "±") || take_prefix(text, "+-") || take_prefix(text, "+/-");
  const bool zone = !symmetric && take_prefix(text, "profile");
  const auto mm = symmetric || zone ? length_mm(text, context.unit_mm) : std::nullopt;
  if (mm && *mm >= 0.0) return symmetric ? plus_minus(*mm) : profile(*mm);
  context.error(node, what + ": '" + node.Scalar() +
                          "' is not understood; write \"±0.05\", {plus_minus: 0.05}, "
                          "{profile: 0.1} or {lower: -0.02, upper: 0.01}");
  return std::nullopt;
}

}  // namespace

std::optional<Scenario::Tolerance> read_tolerance(YamlContext& context, const YAML::Node& node,
                                                  const std::string& what) {
  std::optional<Scenario::Tolerance> tolerance = tolerance_without_place(context, node, what);
  if (tolerance) tolerance->at.line = context.line_of(node);
  return tolerance;
}

std::optional<Position> read_position(YamlContext& context, const YAML::Node& node,
                                      const std::string& what) {
  Position position;
  if (node.IsScalar()) {
    const auto number = leading_number(node.Scalar());
    if (number && number->second == node.Scalar().size() && number->first > 0.0) {
      position.zone_mm = number->first * context.unit_mm;
      return position;
    }
    context.error(node, what + ": '" + node.Scalar() +
                            "' is not understood; write the diameter of the zone, 0.1, or {zone: "
                            "0.1, at: mmc}");
    return std::nullopt;
  }
  const YamlMap map(context, node, what, {"zone", "at"});
  if (!map.usable()) return std::nullopt;
  const auto zone = map.positive_length_mm("zone");
  if (!map.has("zone")) map.error("zone is missing: the diameter of the zone of the axis");
  const std::string at = map.text("at").value_or("rfs");
  if (at == "mmc")
    position.condition = MaterialCondition::kMaximum;
  else if (at == "lmc")
    position.condition = MaterialCondition::kLeast;
  else if (at != "rfs")
    map.error("at", "'" + at + "' is not known; write rfs, mmc or lmc");
  if (!zone) return std::nullopt;
  position.zone_mm = *zone;
  return position;
}

void read_feature_statement(YamlContext& context, const YamlMap& map,
                            Scenario::FeatureSpec& feature) {
  if (const auto iso = map.text("iso")) {
    double nominal = 0.0;
    std::tie(nominal, feature.iso_class) = split_nominal(*iso);
    feature.nominal_mm = nominal * context.unit_mm;
    if (feature.iso_class.empty()) map.error("iso", kSizeAlone);
  }
  if (const auto nominal = map.positive_length_mm("nominal")) feature.nominal_mm = *nominal;
  if (const YAML::Node position = map.find("position"))
    feature.position = read_position(context, position, "feature " + feature.name + ": position")
                           .value_or(Position{});
  if (const auto other = map.text("width_to")) feature.width_to = *other;
  if (map.has("width_to") && feature.iso_class.empty())
    map.error("width_to", "is the other plane of a width under iso:; add iso: or remove it");
  if (map.has("nominal") && feature.iso_class.empty())
    map.error("nominal", "is the size of an iso: class; add iso: or remove it");
  map.one_of({"iso", "tolerance"});
  if (const YAML::Node tolerance = map.find("tolerance"))
    feature.tolerance =
        read_tolerance(context, tolerance, "feature " + feature.name + ": tolerance");
}

std::string read_fit_statement(YamlContext& context, const YamlMap& map, Scenario::FitSpec& fit) {
  if (const auto code = map.text("code")) {
    double nominal = 0.0;
    std::tie(nominal, fit.code) = split_nominal(*code);
    fit.nominal_mm = nominal * context.unit_mm;
    if (fit.code.empty()) map.error("code", kSizeAlone);
  }
  if (const auto nominal = map.positive_length_mm("nominal")) {
    if (fit.nominal_mm > 0.0 && fit.nominal_mm != *nominal)
      map.error("nominal", "contradicts the size in code; keep one");
    fit.nominal_mm = *nominal;
  }
  const std::string way = map.one_of({"code", "plus_minus", "profile", "lower"});
  if (way.empty())
    map.error("say what holds between both: code: H7/g6, or plus_minus: 0.05, or profile: 0.1");
  else if (way != "code")
    fit.tolerance = tolerance_of(map);
  return way;
}

}  // namespace mortise
