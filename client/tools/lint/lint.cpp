#include "client/tools/lint/lint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/messages/names.h"

namespace mortise {
namespace {

constexpr double kUmPerMm = 1e3;
// A scene of a thousand instances says a thousand times the same; --json has them all.
constexpr std::size_t kMostRows = 60;

std::string um(const Interval& mm) {
  const auto end = [](double x) {
    return fmt::format("{:+.1f}", std::fabs(x) < 5e-5 ? 0.0 : x * kUmPerMm);
  };
  return fmt::format("[{}, {}]", end(mm.lo), end(mm.hi));
}

std::string more(std::size_t all) {
  return all > kMostRows ? fmt::format("  ... {} more; --json lists all\n", all - kMostRows) : "";
}

std::string findings_text(const OpenedScene& opened, bool color) {
  std::string text;
  for (const Finding& f : opened.findings) {
    const char* word = f.is_error ? "error" : "warning";
    text += color ? fmt::format("\033[{}m{}\033[0m: {}\n", f.is_error ? 31 : 33, word, f.text)
                  : fmt::format("{}: {}\n", word, f.text);
  }
  return text;
}

// What can be said of the inside of a part.
const char* inside_text(const Solid& solid) {
  if (!solid.has_inside()) return "no";
  return solid.inside_known() ? "yes" : "cracked";
}

std::string parts_text(const LoadedScene& scene) {
  std::string text = fmt::format("\n{:<28}{:>10}{:>9}{:>9}{:>34}{:>14}  {}\n", "part", "triangles",
                                 "inside", "moving", "extent, mm", "rounding, µm", "mesh");
  const auto& parts = scene.world.parts;
  for (std::size_t i = 0; i < std::min(parts.size(), kMostRows); ++i) {
    const ImportReport& report = scene.imports[i];
    const Vec3 size = parts[i].solid->bounds().hi - parts[i].solid->bounds().lo;
    text += fmt::format("  {:<26}{:>10}{:>9}{:>9}{:>34}{:>14}  {}\n", parts[i].name,
                        parts[i].solid->mesh().triangles.size(), inside_text(*parts[i].solid),
                        parts[i].moving ? "yes" : "no",
                        fmt::format("{:.4g} × {:.4g} × {:.4g}", size.x(), size.y(), size.z()),
                        fmt::format("{:.2g}", report.quantum_mm * kUmPerMm), report.file);
  }
  return text + more(parts.size());
}

// Planes without a statement say nothing: as modelled, without error.
bool says_something(const LoadedScene::ResolvedTolerance& t) {
  return !t.source.empty() || t.deviation_mm.lo != 0.0 || t.deviation_mm.hi != 0.0;
}

std::string tolerances_text(const LoadedScene& scene) {
  std::string text = fmt::format("\n{:<32}{:>20}{:>20}  {}\n", "outward offsets, µm", "tolerance",
                                 "mesh error", "grade, source");
  std::size_t said = 0;
  for (const auto& t : scene.tolerances) {
    if (!says_something(t) || ++said > kMostRows) continue;
    const std::string name =
        t.feature.empty() ? t.part + " (other faces)" : t.part + "." + t.feature;
    text += fmt::format("  {:<30}{:>20}{:>20}  {}{}\n", name, um(t.offset_mm), um(t.deviation_mm),
                        name_of(t.grade), t.source.empty() ? "" : ", " + t.source);
  }
  if (said == 0)
    return "\nno features, tolerances or chord errors: every verdict will be nominal\n";
  return text + more(said);
}

std::string fits_text(const LoadedScene& scene) {
  if (scene.fits.empty()) return {};
  std::string text =
      fmt::format("\n{:<52}{:>20}  {}\n", "fits, diametral clearance µm", "least, largest", "code");
  for (std::size_t i = 0; i < std::min(scene.fits.size(), kMostRows); ++i) {
    const auto& fit = scene.fits[i];
    const auto end = [](const std::string& part, const std::string& feature) {
      return feature.empty() ? part : part + "." + feature;
    };
    text += fmt::format("  {:<50}{:>20}  {}\n",
                        end(fit.part_a, fit.feature_a) + " / " + end(fit.part_b, fit.feature_b),
                        um(fit.clearance_mm), fit.code);
    for (const std::string& tighter : fit.tighter)
      text += fmt::format("  {:<50}{:>20}  and {}\n", "", "", tighter);
  }
  return text + more(scene.fits.size());
}

std::size_t count_of(const OpenedScene& opened, bool errors) {
  return static_cast<std::size_t>(std::count_if(opened.findings.begin(), opened.findings.end(),
                                                [&](auto& f) { return f.is_error == errors; }));
}

}  // namespace

std::string lint_text(const OpenedScene& opened, bool color) {
  std::string text = findings_text(opened, color);
  const LoadedScene& scene = opened.scene;
  if (!scene.world.parts.empty())
    text += parts_text(scene) + tolerances_text(scene) + fits_text(scene);
  const auto excluded = std::count_if(scene.world.pair_rules.begin(), scene.world.pair_rules.end(),
                                      [](auto& entry) { return entry.second.excluded; });
  return text + fmt::format("\n{}: {} parts, {} fits, {} excluded pairs; {} errors, {} warnings\n",
                            opened.scenario.file, scene.world.parts.size(), scene.fits.size(),
                            excluded, count_of(opened, true), count_of(opened, false));
}

Json lint_json(const OpenedScene& opened) {
  const LoadedScene& scene = opened.scene;
  Json json;
  json["schema"] = "mortise/lint/1";
  json["scenario"] = opened.scenario.name;
  json["file"] = opened.scenario.file;
  json["usable"] = opened.usable();
  json["findings"] = Json::array();
  for (const Finding& f : opened.findings)
    json["findings"].push_back({{"severity", f.is_error ? "error" : "warning"}, {"text", f.text}});
  json["parts"] = Json::array();
  for (std::size_t i = 0; i < scene.world.parts.size(); ++i) {
    const Part& part = scene.world.parts[i];
    const ImportReport& report = scene.imports[i];
    json["parts"].push_back(
        {{"name", part.name},
         {"mesh", report.file},
         {"mesh_hash", part.solid->hash()},
         {"triangles", part.solid->mesh().triangles.size()},
         {"closed", report.closed},
         {"inside", inside_text(*part.solid)},
         {"extent_mm", json_of(Vec3(part.solid->bounds().hi - part.solid->bounds().lo))},
         {"quantum_mm", report.quantum_mm},
         {"notes", report.notes},
         {"moving", part.moving},
         {"largest_offset_mm", part.band.largest_offset_mm}});
  }
  json["tolerances"] = Json::array();
  for (const auto& t : scene.tolerances)
    json["tolerances"].push_back({{"part", t.part},
                                  {"feature", t.feature},
                                  {"source", t.source},
                                  {"offset_mm", json_of(t.offset_mm)},
                                  {"deviation_mm", json_of(t.deviation_mm)},
                                  {"residual_mm", t.residual_mm},
                                  {"grade", name_of(t.grade)}});
  json["fits"] = Json::array();
  for (const auto& fit : scene.fits)
    json["fits"].push_back({{"part_a", fit.part_a},
                            {"feature_a", fit.feature_a},
                            {"part_b", fit.part_b},
                            {"feature_b", fit.feature_b},
                            {"code", fit.code},
                            {"nominal_mm", fit.nominal_mm},
                            {"clearance_mm", json_of(fit.clearance_mm)},
                            {"tighter", fit.tighter}});
  json["exclusions"] = Json::array();
  for (const auto& [ids, rule] : scene.world.pair_rules)
    if (rule.excluded)
      json["exclusions"].push_back({{"part_a", scene.world.find(ids.first)->name},
                                    {"part_b", scene.world.find(ids.second)->name},
                                    {"reason", rule.reason}});
  return json;
}

}  // namespace mortise
