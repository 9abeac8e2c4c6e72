#include "client/tools/judge/judge_report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "common/base/json_text.h"
#include "common/evaluation/clash_line.h"
#include "common/messages/length_text.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

// A round fit touches at every facet; the worst few explain it. --json has them all.
constexpr std::size_t kMostRegions = 4;

std::string vector(const Vec3& v, int digits) {
  const double least = 0.5 * std::pow(10.0, -digits);  // no "-0.000"
  const auto shown = [&](double x) { return std::fabs(x) < least ? 0.0 : x; };
  return fmt::format("({0:.{3}f}, {1:.{3}f}, {2:.{3}f})", shown(v.x()), shown(v.y()), shown(v.z()),
                     digits);
}

std::string face_text(const std::string& part, const std::string& face, FaceShape shape) {
  return fmt::format("{}{} ({})", part, face.empty() ? "" : "." + face, name_of(shape));
}

struct RegionNames {
  std::size_t number = 0;
  std::string part_a, part_b, blocker;
};

// "turned 25.9764° about (0, 0, 1)": below a full turn, the shorter way round. Nothing where that
// is none.
std::string turn_text(const Vec3& rotation_rad) {
  const double turn_rad = rotation_rad.norm();
  const double less_rad = std::remainder(turn_rad, 2.0 * std::numbers::pi);
  const double turn_deg = std::fabs(less_rad) * 180.0 / std::numbers::pi;
  if (turn_deg < 0.5e-4) return "";
  return fmt::format("turned {:.4f}° about {}", turn_deg,
                     vector(rotation_rad / std::copysign(turn_rad, less_rad), 3));
}

std::string path_text(const Verdict& v, const RegionNames& names) {
  switch (v.separation_path) {
    case SeparationPath::kUnknown:
      return "";
    case SeparationPath::kFree:
      return "; nothing is in the way";
    case SeparationPath::kDeeper:
      return "; they go deeper on the way";
    case SeparationPath::kBlocked:
      return "; " + names.blocker + " is in the way";
  }
  return "";
}

std::string way_out_text(const Verdict& v, const RegionNames& names) {
  const std::string least = length_text(v.gpd_mm.lo);
  const std::string most = length_text(v.gpd_mm.hi);
  const std::string range = least == most ? least : "at least " + least + ", and " + most + " does";
  if (v.separation_way == SeparationWay::kNone)
    return "at least " + least + "; no motion was found that frees it";
  std::string text =
      fmt::format("{}: {} moved {}", range, v.separation_of_b ? names.part_b : names.part_a,
                  name_of(v.separation_way));
  const Vec3& shift = v.separation_translation_mm;
  if (const double by = shift.norm(); by > 0.0)
    text += fmt::format(", towards {}", vector(shift / by, 3));
  if (const std::string turn = turn_text(v.separation_rotation_rad); !turn.empty())
    text += fmt::format(", {} at {} mm", turn, vector(v.separation_about_W, 3));
  return text + path_text(v, names);
}

std::string region_text(const RegionNames& names, const Verdict& v) {
  std::string text = fmt::format("  [{}] {} / {}\n      {}\n", names.number,
                                 face_text(names.part_a, v.face_a, v.shape_a),
                                 face_text(names.part_b, v.face_b, v.shape_b), v.explanation);
  const auto row = [&](const char* what, const std::string& how) {
    text += fmt::format("      {:<12}{}\n", what, how);
  };
  row("mesh error", std::string(name_of(v.grade)));
  if (v.gpd_mm.hi > 0.0) row("comes free", way_out_text(v, names));
  row("where", fmt::format("{} mm, normal {}{}", vector(v.point_W, 3), vector(v.normal_W, 3),
                           v.area_mm2 > 0.0 ? fmt::format(", {:.3g} mm²", v.area_mm2) : ""));
  if (v.has_witness)
    row("witness", vector(v.witness_W, 3) + " mm lies inside both, " +
                       (is_declared(v.grade) ? "however they are made"
                                             : "as far as their meshes tell the surfaces"));
  return text;
}

std::string depth_text(const Interval& depth_mm) {
  if (!(depth_mm.hi > 0.0)) return "free";
  const std::string least = length_text(depth_mm.lo), most = length_text(depth_mm.hi);
  if (least == most) return most;
  return depth_mm.lo > 0.0 ? least + " to " + most : "at most " + most;
}

// The depth beside its two thresholds: the least bodies have to be moved where the pair is real,
// the largest ones where it is at least potential. Nothing where they are the parts as modelled.
std::string layers_text(const LayerDepths& layers) {
  if (!layers.least_mm || !layers.largest_mm || *layers.least_mm == *layers.largest_mm) return "";
  return fmt::format("      {:<12}made smallest {}, made largest {}\n", "to be free",
                     depth_text(*layers.least_mm), depth_text(*layers.largest_mm));
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

// A pair with its regions, worst first.
struct Clash {
  const PairVerdicts* pair = nullptr;
  std::size_t number = 0;  // of its first region
  CollisionClass worst() const { return pair->verdicts.front().collision_class; }
};

std::vector<Clash> clashes_of(const JudgeReport& report) {
  std::vector<Clash> clashes;
  std::size_t number = 1;
  for (const PairVerdicts& pair : report.pairs) {
    if (!pair.verdicts.empty()) clashes.push_back({&pair, number});
    number += pair.verdicts.size();
  }
  std::stable_sort(clashes.begin(), clashes.end(),
                   [](const Clash& x, const Clash& y) { return x.worst() > y.worst(); });
  return clashes;
}

std::string places_text(const World& world, const Clash& clash) {
  const PairVerdicts& pair = *clash.pair;
  const Part &a = *world.find(pair.a), &b = *world.find(pair.b);
  const std::size_t shown = std::min(pair.verdicts.size(), kMostRegions);
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) {
    const Part* blocker = world.find(pair.verdicts[i].separation_blocker);
    text += region_text({clash.number + i, a.name, b.name, blocker != nullptr ? blocker->name : ""},
                        pair.verdicts[i]);
  }
  text += layers_text(pair.layers);
  if (shown < pair.verdicts.size())
    text += fmt::format("  ... {} more places, none worse; --json lists all\n",
                        pair.verdicts.size() - shown);
  return text;
}

std::string summary_text(const OpenedScene& opened, const JudgeReport& report,
                         const std::vector<Clash>& clashes) {
  const StepCounters& c = report.counters;
  const auto pairs_of = [&](CollisionClass collision_class) {
    return std::count_if(clashes.begin(), clashes.end(),
                         [&](const Clash& clash) { return clash.worst() == collision_class; });
  };
  std::string text = fmt::format(
      "{}: {} pairs, {} asked; {} real, {} potential, {} fake; {} excluded", opened.scenario.file,
      c.pairs.in, c.pairs.out, pairs_of(CollisionClass::kReal),
      pairs_of(CollisionClass::kPotential), pairs_of(CollisionClass::kFake), c.pairs_excluded);
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

}  // namespace

bool finds(const JudgeReport& report, CollisionClass at_least) {
  return std::any_of(report.pairs.begin(), report.pairs.end(), [&](const PairVerdicts& pair) {
    return std::any_of(pair.verdicts.begin(), pair.verdicts.end(),
                       [&](const Verdict& v) { return v.collision_class >= at_least; });
  });
}

std::string judge_text(const OpenedScene& opened, const JudgeReport& report, JudgeTextStyle style) {
  const World& world = opened.scene.world;
  const SessionNames names = names_of(world);
  const std::vector<Clash> clashes = clashes_of(report);
  std::vector<ClashLine> rows;
  for (const Clash& clash : clashes) {
    const PairRule* rule = world.rule(clash.pair->a, clash.pair->b);
    rows.push_back({names.part(clash.pair->a), names.part(clash.pair->b),
                    &clash.pair->verdicts.front(), rule != nullptr ? rule->fit : "",
                    clash.pair->verdicts.size() - 1, ""});
  }
  const std::vector<std::string> lines = clash_lines(rows);
  std::string text;
  for (std::size_t i = 0; i < clashes.size(); ++i) {
    text +=
        (style.color ? coloured_line(lines[i], rows[i].verdict->collision_class) : lines[i]) + "\n";
    if (style.verbose) text += places_text(world, clashes[i]);
  }
  for (const PairVerdicts& pair : report.pairs)
    if (pair.excluded)
      text += fmt::format("excluded  {}: {}\n", names.pair(pair.a, pair.b), reason_of(world, pair));
    else if (pair.not_examined)
      text += fmt::format("not examined  {}: {}\n", names.pair(pair.a, pair.b),
                          hiding_text(world, pair));
  return text + summary_text(opened, report, clashes);
}

Json judge_json(const OpenedScene& opened, const JudgeReport& report) {
  const World& world = opened.scene.world;
  const SessionNames names = names_of(world);
  Json json;
  json["schema"] = "mortise/judge/1";
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

std::string judged(const OpenedScene& opened, const JudgeReport& report,
                   const JudgeOptions& options, const std::string& moved) {
  if (options.json) {
    Json json = judge_json(opened, report);
    if (!moved.empty()) json["moved"] = moved;
    return json_text(json) + "\n";
  }
  const bool color = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  return (moved.empty() ? "" : moved + "\n") + judge_text(opened, report, {color, options.verbose});
}

}  // namespace mortise
