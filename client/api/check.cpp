#include "client/tools/check/run_check.h"

#include <mortise/io.h>

#include "client/api/convert.h"
#include "client/api/judgement.h"
#include "client/tools/check/check_tables.h"
#include "client/tools/check/check_text.h"
#include "common/base/json_text.h"
#include "common/base/length_unit.h"

namespace mortise::api {
namespace {

std::string path_of(const mortise::World& world, mortise::PartId id) {
  const mortise::Part* part = world.find(id);
  return part != nullptr ? part->name : std::string();
}

CheckedPair pair_of(const mortise::World& world, const mortise::CheckedPair& in) {
  CheckedPair out;
  out.part_a = path_of(world, in.a);
  out.part_b = path_of(world, in.b);
  out.collision_class = static_cast<CollisionClass>(in.collision_class);
  out.contact = in.is_contact;
  out.relation = mortise::name_of(in.mating.relation);
  out.relation_text = in.mating.text;
  out.explained = in.explained;
  out.reason = in.reason;
  out.count = in.all.size();
  for (const auto& [a, b] : in.all)
    out.instances.emplace_back(path_of(world, a), path_of(world, b));
  out.inside = in.inside;
  out.muted = in.muted;
  out.accuracy_mm = in.accuracy_mm;
  if (in.common_mm3 >= 0.0) {
    out.common_mm3 = in.common_mm3;
    out.thickness_mm = in.thickness_mm;
  }
  for (const mortise::Verdict& verdict : in.verdicts)
    out.places.push_back(
        clash_of(verdict, {out.part_a, out.part_b, path_of(world, verdict.separation_blocker)}));
  return out;
}

// As the command line says it; nothing where there is no such unit.
std::optional<mortise::CheckCommand> command_of(const std::vector<std::string>& files,
                                                const CheckOptions& options) {
  mortise::CheckCommand command;
  command.files = files;
  if (options.unit.length_mm != 1.0) {
    for (const mortise::LengthUnit& unit : mortise::kLengthUnits)
      if (unit.mm == options.unit.length_mm) command.unit = unit.name;
    if (command.unit.empty()) return std::nullopt;
  }
  command.fit = options.fit;
  command.baseline = options.baseline;
  command.bought = options.bought;
  command.general = options.general;
  command.check.min_gap_mm = options.min_gap_mm;
  command.check.unexplained.insert(options.no_explain.begin(), options.no_explain.end());
  command.check.exact_volumes = options.exact_volumes;
  command.check.threads = options.threads;
  return command;
}

Result<CheckReport> check_all(const std::vector<std::string>& files, const CheckOptions& options) {
  const auto wrong = [](const std::string& text) { return Error{Code::kInvalidInput, text}; };
  if (files.empty()) return wrong("no file is named");
  if (!is_thread_count(options.threads)) return wrong("threads must lie between 1 and 256");
  if (!(options.min_gap_mm >= 0.0)) return wrong("min_gap_mm must be 0 or more");
  const auto command = command_of(files, options);
  if (!command) return wrong("the unit of meshes is one of mm, cm, metre, inch and micron");
  mortise::Result<mortise::CheckOutcome> outcome = mortise::run_check(*command);
  if (!outcome) return error_of(outcome.error());
  const mortise::OpenedScene& opened = outcome->opened;
  const mortise::World& world = opened.scene.world;
  CheckReport report;
  for (const mortise::CheckedPair& pair : outcome->report.pairs)
    report.pairs.push_back(pair_of(world, pair));
  for (const mortise::NearPair& near : outcome->report.near)
    report.near.push_back(
        {path_of(world, near.a), path_of(world, near.b), interval_of(near.gap_mm)});
  report.not_judged = outcome->report.not_judged;
  report.notes = outcome->report.notes;
  for (const mortise::Finding& finding : opened.findings) report.notes.push_back(finding.text);
  for (const auto& [name, count] : outcome->document.at("counts").items())
    report.counts[name] = count.get<std::size_t>();
  report.json = mortise::json_text(outcome->document) + "\n";
  report.text = mortise::check_text(opened, outcome->report, {}) + outcome->changes;
  if (options.html) report.html = mortise::check_page(opened, outcome->report);
  return report;
}

}  // namespace

Result<CheckReport> check(const std::string& file, const CheckOptions& options) {
  return check_all({file}, options);
}

Result<CheckReport> check_meshes(const std::vector<std::string>& files,
                                 const CheckOptions& options) {
  return check_all(files, options);
}

}  // namespace mortise::api
