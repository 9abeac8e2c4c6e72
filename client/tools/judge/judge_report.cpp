#include "client/tools/judge/judge_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/messages/names.h"

namespace mortise {
namespace {

// A round fit touches at every facet; the worst few say it. --json has them all.
constexpr std::size_t kMostRegions = 4;

std::string um(double mm) {
  if (!std::isfinite(mm)) return "inf";
  return fmt::format("{:.1f}", std::fabs(mm) < 5e-5 ? 0.0 : mm * 1e3);  // no "-0.0"
}

std::string class_text(CollisionClass c, bool color) {
  const std::string name(name_of(c));
  if (!color) return name;
  const int code = c == CollisionClass::kReal ? 31 : c == CollisionClass::kPotential ? 33 : 32;
  return fmt::format("\033[{}m{}\033[0m", code, name);
}

// Micrometres as long as they are read as such.
std::string length(double mm) {
  return std::fabs(mm) < 1.0 ? um(mm) + " µm" : fmt::format("{:.3f} mm", mm);
}

std::string range(const Interval& mm) {
  return mm.width() < 5e-5 ? length(mm.lo) : length(mm.lo) + " to " + length(mm.hi);
}

std::string vector(const Vec3& v, int digits) {
  const double least = 0.5 * std::pow(10.0, -digits);  // no "-0.000"
  const auto shown = [&](double x) { return std::fabs(x) < least ? 0.0 : x; };
  return fmt::format("({0:.{3}f}, {1:.{3}f}, {2:.{3}f})", shown(v.x()), shown(v.y()), shown(v.z()),
                     digits);
}

std::string face_text(const std::string& part, const std::string& face, FaceShape shape) {
  return fmt::format("{}{} ({})", part, face.empty() ? "" : "." + face, name_of(shape));
}

std::string depth_text(const Verdict& v) {
  const Interval apart{-v.delta_mm.hi, -v.delta_mm.lo};
  const std::string depth =
      v.delta_mm.hi < 0.0 ? "meshes apart " + range(apart) : "meshes overlap " + range(v.delta_mm);
  const char* edge = v.collision_class == CollisionClass::kReal   ? "beyond real"
                     : v.collision_class == CollisionClass::kFake ? "to spare below potential"
                                                                  : "to the nearer threshold";
  return fmt::format("{}; fake up to {}, real above {}; {} {}", depth, length(v.fake_below_mm),
                     length(v.real_above_mm), length(v.margin_mm), edge);
}

struct RegionNames {
  std::size_t number = 0;
  std::string part_a, part_b;
  bool only_b_moves = false;
};

std::string way_out_text(const Verdict& v, const RegionNames& names) {
  // The motion is that of A; where A stands fast, a shift is told as the opposite one of B.
  const double turn = v.separation_rotation_rad.norm();
  const bool of_b = names.only_b_moves && turn <= 1e-9;
  const std::string& part = of_b ? names.part_b : names.part_a;
  const Vec3 shift = (of_b ? -1.0 : 1.0) * v.separation_translation_mm;
  const std::string least = "at least " + length(v.gpd_mm.lo);
  if (v.separation_way == SeparationWay::kNone)
    return least + "; no motion was found that frees it";
  std::string text = fmt::format("{}, and {} does: {} moved {}", least, length(v.gpd_mm.hi), part,
                                 name_of(v.separation_way));
  if (const double by = shift.norm(); by > 0.0)
    text += fmt::format(", {} towards {}", length(by), vector(shift / by, 3));
  if (turn > 1e-9)
    text += fmt::format(", turned {:.4f}° about {}", turn * 180.0 / std::numbers::pi,
                        vector(v.separation_rotation_rad / turn, 3));
  return text;
}

std::string region_text(const RegionNames& names, const Verdict& v, bool color) {
  std::string text = fmt::format("  [{}] {}  {} / {}\n      {}\n", names.number,
                                 class_text(v.collision_class, color),
                                 face_text(names.part_a, v.face_a, v.shape_a),
                                 face_text(names.part_b, v.face_b, v.shape_b), v.explanation);
  const auto row = [&](const char* what, const std::string& how) {
    text += fmt::format("      {:<12}{}\n", what, how);
  };
  row("depth", depth_text(v));
  row("mesh error", std::string(name_of(v.grade)));
  if (v.gpd_mm.hi > 0.0) row("comes free", way_out_text(v, names));
  row("where", fmt::format("{} mm, normal {}{}", vector(v.point_W, 3), vector(v.normal_W, 3),
                           v.area_mm2 > 0.0 ? fmt::format(", {:.3g} mm²", v.area_mm2) : ""));
  if (v.has_witness)
    row("witness", vector(v.witness_W, 3) + " mm lies inside both, however they are made");
  return text;
}

std::string reason_of(const World& world, const PairVerdicts& pair) {
  const PairRule* rule = world.rule(pair.a, pair.b);
  return rule == nullptr ? "" : rule->reason;
}

// Nothing crosses, but one lies within the box of the other, which has no inside.
std::string hiding_text(const World& world, const PairVerdicts& pair) {
  const Part &a = *world.find(pair.a), &b = *world.find(pair.b);
  const auto sure = [](const Part& part) { return part.solid->inside_known(); };
  const std::string open = sure(a) ? b.name : sure(b) ? a.name : a.name + " and " + b.name;
  return "one may lie inside the other, and " + open +
         (open == a.name || open == b.name ? " is" : " are") +
         " open: the inside is not known there";
}

}  // namespace

bool finds(const JudgeReport& report, CollisionClass at_least) {
  return std::any_of(report.pairs.begin(), report.pairs.end(), [&](const PairVerdicts& pair) {
    return std::any_of(pair.verdicts.begin(), pair.verdicts.end(),
                       [&](const Verdict& v) { return v.collision_class >= at_least; });
  });
}

std::string judge_text(const OpenedScene& opened, const JudgeReport& report, bool color) {
  const World& world = opened.scene.world;
  const SessionNames names = names_of(world);
  std::string text;
  std::size_t number = 0;
  for (const PairVerdicts& pair : report.pairs) {
    text += names.pair(pair.a, pair.b);
    if (pair.excluded) text += "  excluded: " + reason_of(world, pair);
    const PairRule* rule = world.rule(pair.a, pair.b);
    if (rule != nullptr && !rule->fit.empty()) text += "  " + rule->fit;
    if (pair.not_examined)
      text += "  not examined: " + hiding_text(world, pair);
    else if (pair.no_inside)
      text += "  (a part is open: depth unknown)";
    text += "\n";
    const std::size_t shown = std::min(pair.verdicts.size(), kMostRegions);
    for (std::size_t i = 0; i < shown; ++i)
      text += region_text({number + i + 1, names.part(pair.a), names.part(pair.b),
                           !world.find(pair.a)->moving && world.find(pair.b)->moving},
                          pair.verdicts[i], color);
    number += pair.verdicts.size();
    if (shown < pair.verdicts.size())
      text += fmt::format("  ... {} more regions, none worse; --json lists all\n",
                          pair.verdicts.size() - shown);
  }
  const StepCounters& c = report.counters;
  text += fmt::format("{}: {} pairs, {} asked; {} real, {} potential, {} fake; {} excluded",
                      opened.scenario.file, c.pairs.in, c.pairs.out, c.verdicts_by_class[3],
                      c.verdicts_by_class[2], c.verdicts_by_class[1], c.pairs_excluded);
  const auto hidden = static_cast<std::uint64_t>(
      std::count_if(report.pairs.begin(), report.pairs.end(),
                    [](const PairVerdicts& pair) { return pair.not_examined; }));
  if (hidden > 0) text += fmt::format("; {} not examined beside an open part", hidden);
  if (c.not_examined > hidden)
    text += fmt::format("; {} not settled by the work limit", c.not_examined - hidden);
  if (c.parts_without_inside > 0) text += fmt::format("; {} open parts", c.parts_without_inside);
  if (c.judged_plain > 0) text += fmt::format("; {} pairs with nothing declared", c.judged_plain);
  if (c.regions_decided_early > 0)
    text += fmt::format("; {} regions decided before their depth was, --full refines",
                        c.regions_decided_early);
  return text + "\n";
}

Json judge_json(const OpenedScene& opened, const JudgeReport& report) {
  const World& world = opened.scene.world;
  const SessionNames names = names_of(world);
  Json json;
  json["scenario"] = opened.scenario.name;
  json["file"] = opened.scenario.file;
  json["pairs"] = Json::array();
  std::size_t number = 0;
  for (const PairVerdicts& pair : report.pairs) {
    Json entry = json_of(pair, names);
    const PairRule* rule = world.rule(pair.a, pair.b);
    if (rule != nullptr && !rule->fit.empty()) entry["fit"] = rule->fit;
    if (pair.excluded) entry["reason"] = reason_of(world, pair);
    for (Json& verdict : entry["verdicts"]) verdict["region"] = ++number;
    json["pairs"].push_back(std::move(entry));
  }
  json["counters"] = json_of(report.counters);
  return json;
}

}  // namespace mortise
