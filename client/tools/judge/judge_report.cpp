#include "client/tools/judge/judge_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/messages/names.h"

namespace mortise {
namespace {

// A round fit touches at every facet; the worst few say it. --json has them all.
constexpr std::size_t kMostRegions = 4;

std::string um(double mm) { return std::isfinite(mm) ? fmt::format("{:.1f}", mm * 1e3) : "inf"; }
std::string um(const Interval& mm) { return fmt::format("[{}, {}]", um(mm.lo), um(mm.hi)); }

std::string class_text(CollisionClass c, bool color) {
  const std::string name(name_of(c));
  if (!color) return name;
  const int code = c == CollisionClass::kReal ? 31 : c == CollisionClass::kPotential ? 33 : 32;
  return fmt::format("\033[{}m{}\033[0m", code, name);
}

std::string faces_text(const Verdict& v) {
  if (v.face_a.empty() && v.face_b.empty()) return "";
  const auto face = [](const std::string& name) { return name.empty() ? "other face" : name; };
  return fmt::format("  {} / {}", face(v.face_a), face(v.face_b));
}

std::string region_text(std::size_t number, const Verdict& v, bool color) {
  std::string text =
      fmt::format("  [{}] {}{}\n    {}\n", number, class_text(v.collision_class, color),
                  faces_text(v), v.explanation);
  text += fmt::format("    overlap {} µm, fake up to {} µm, real above {} µm, mesh error: {}\n",
                      um(v.delta_mm), um(v.fake_below_mm), um(v.real_above_mm), name_of(v.grade));
  if (v.gpd_mm.hi > 0.0)
    text += fmt::format("    separating motion {} µm, at ({:.3f}, {:.3f}, {:.3f}) mm\n",
                        um(v.gpd_mm), v.point_W.x(), v.point_W.y(), v.point_W.z());
  return text;
}

std::string reason_of(const World& world, const PairVerdicts& pair) {
  const PairRule* rule = world.rule(pair.a, pair.b);
  return rule == nullptr ? "" : rule->reason;
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
    if (pair.no_inside) text += "  (a part is open: depth unknown)";
    text += "\n";
    const std::size_t shown = std::min(pair.verdicts.size(), kMostRegions);
    for (std::size_t i = 0; i < shown; ++i)
      text += region_text(number + i + 1, pair.verdicts[i], color);
    number += pair.verdicts.size();
    if (shown < pair.verdicts.size())
      text += fmt::format("  ... {} more regions, none worse; --json lists all\n",
                          pair.verdicts.size() - shown);
  }
  const StepCounters& c = report.counters;
  text += fmt::format("{}: {} pairs, {} asked; {} real, {} potential, {} fake; {} excluded",
                      opened.scenario.file, c.pairs.in, c.pairs.out, c.verdicts_by_class[3],
                      c.verdicts_by_class[2], c.verdicts_by_class[1], c.pairs_excluded);
  if (c.not_examined > 0) text += fmt::format("; {} not settled by the work limit", c.not_examined);
  if (c.parts_without_inside > 0) text += fmt::format("; {} open parts", c.parts_without_inside);
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
