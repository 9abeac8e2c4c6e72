#include "common/io/scenario/scenario_file.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/file_text.h"
#include "common/base/in_quotes.h"
#include "common/base/length_unit.h"
#include "common/base/plain_text.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/scenario/scenario_assembly.h"
#include "common/io/scenario/scenario_parts.h"
#include "common/io/scenario/scenario_tolerance.h"
#include "common/io/scenario/scenario_yaml.h"

namespace mortise {
namespace {

constexpr const char* kBadSceneName =
    "must be short and printable: up to 128 bytes that one can see";

// 1. the head: everything but the lists

void read_units(YamlContext& context, const YamlMap& top) {
  const auto text = top.text("units");
  if (!text) {
    if (!top.has("units"))
      top.error(
          "units is missing: say in which unit lengths are written, e.g. units: mm "
          "(known: mm, cm, m, in, um)");
    return;
  }
  if (const auto mm = length_unit_mm(*text))
    context.unit_mm = *mm;
  else
    top.error("units",
              in_quotes(*text) + " is not known" + did_you_mean(*text, length_unit_names()));
}

// As many as the server may be started with.
constexpr double kMostThreads = 256.0;

void read_head(YamlContext& context, const YamlMap& top, Scenario& scenario) {
  read_units(context, top);
  if (const auto name = top.text("name")) {
    scenario.name = *name;
    if (!is_name(*name)) top.error("name", kBadSceneName);
  } else if (!top.has("name")) {
    top.error("name is missing: give the scenario a name, e.g. name: my_scene");
  }

  if (const auto rate = top.number("tick_rate_hz")) {
    if (*rate >= 1.0 && *rate <= 1000.0)
      scenario.tick_rate_hz = *rate;
    else
      top.error("tick_rate_hz", "must lie between 1 and 1000");
  }
  if (const auto threads = top.number("threads")) {
    if (*threads >= 1.0 && *threads <= kMostThreads && *threads == std::floor(*threads))
      scenario.threads = static_cast<int>(*threads);
    else
      top.error("threads", "must be a whole number between 1 and 256");
  }
  if (const auto policy = top.text("policy")) {
    if (const auto known = policy_named(*policy))
      scenario.policy = *known;
    else
      top.error("policy", "'" + *policy + "' is not known; write " + std::string(kPolicyNames));
  }
  scenario.undeclared = read_deviation(top);
  if (const auto jump = top.positive_length_mm("max_jump")) scenario.max_jump_mm = *jump;
  if (const auto gap = top.positive_length_mm("min_gap")) scenario.min_gap_mm = *gap;
  if (const auto lease = top.number("lease_s")) {
    if (*lease >= 0.1 && *lease <= 86400.0)
      scenario.lease_s = *lease;
    else
      top.error("lease_s", "must lie between 0.1 and 86400");
  }
}

// 2. rules

// "plate.bore" -> part and feature; without a dot the whole part.
struct Side {
  std::string part, feature;
};

Side split_side(const std::string& text) {
  const std::size_t dot = text.find('.');
  return dot == std::string::npos ? Side{text, ""}
                                  : Side{text.substr(0, dot), text.substr(dot + 1)};
}

std::optional<std::vector<std::string>> read_between(const YamlMap& map) {
  const auto between = map.texts("between");
  if (!between) {
    if (!map.has("between")) map.error("between is missing: name the two sides, between: [a, b]");
    return std::nullopt;
  }
  if (between->size() == 2) return between;
  map.error("between", "expected two names, e.g. [plate.bore, pin.journal]");
  return std::nullopt;
}

void read_fit(YamlContext& context, const YAML::Node& node, Scenario& scenario) {
  const YamlMap map(
      context, node, "fit",
      {"between", "code", "plus_minus", "profile", "unequal", "lower", "upper", "nominal"});
  if (!map.usable()) return;
  const auto between = read_between(map);
  Scenario::FitSpec fit;
  fit.at.line = map.line();
  const std::string way = read_fit_statement(context, map, fit);
  if (!between) return;
  const Side a = split_side((*between)[0]), b = split_side((*between)[1]);
  fit.part_a = a.part, fit.feature_a = a.feature;
  fit.part_b = b.part, fit.feature_b = b.feature;
  if (way.empty() || (way != "code" && !fit.tolerance)) return;
  scenario.fits.push_back(std::move(fit));
}

void read_pair_reason(const YamlMap& map, const std::string& needed_for,
                      std::vector<Scenario::PairReason>& list) {
  if (!map.usable()) return;
  Scenario::PairReason pair;
  pair.at.line = map.line();
  const auto between = read_between(map);
  const auto reason = map.text("reason");
  if (!map.has("reason"))
    map.error("reason is missing: the report must say why the pair is " + needed_for);
  if (!between || !reason) return;
  pair.part_a = (*between)[0], pair.part_b = (*between)[1];
  pair.reason = *reason;
  list.push_back(std::move(pair));
}

void read_exclusion(YamlContext& context, const YAML::Node& node, Scenario& scenario) {
  read_pair_reason({context, node, "exclusion", {"between", "reason"}}, "left out",
                   scenario.exclusions);
}

void read_approval(YamlContext& context, const YAML::Node& node, Scenario& scenario) {
  read_pair_reason({context, node, "approval", {"between", "reason"}}, "approved",
                   scenario.approvals);
}

void read_min_gap(YamlContext& context, const YAML::Node& node, Scenario& scenario) {
  const YamlMap map(context, node, "min_gap", {"between", "min_gap"});
  if (!map.usable()) return;
  const auto between = read_between(map);
  const auto gap_mm = map.positive_length_mm("min_gap");
  if (!map.has("min_gap")) map.error("min_gap is missing: how far apart must the parts be?");
  if (between && gap_mm)
    scenario.min_gaps.push_back({(*between)[0], (*between)[1], *gap_mm, {map.line()}});
}

void read_user(YamlContext& context, const YAML::Node& node, Scenario& scenario) {
  const YamlMap map(context, node, "user", {"name", "may_hold", "may", "role"});
  if (!map.usable()) return;
  Scenario::UserSpec user;
  user.at.line = map.line();
  if (const auto name = map.text("name")) {
    user.name = *name;
    if (!is_name(*name, kMostUserName_bytes))
      map.error("name", "must be short and printable: up to 64 bytes that one can see");
  } else if (!map.has("name")) {
    map.error("name is missing: give the user one, e.g. name: ann");
  }
  if (const auto may_hold = map.texts("may_hold"))
    user.may_hold = *may_hold;
  else if (!map.has("may_hold"))
    map.error("may_hold is missing: list part names ('*' allowed); [] makes an observer");
  if (const auto may = map.texts("may")) {
    user.may.emplace();
    for (const std::string& word : *may) {
      if (const auto right = right_named(word))
        user.may->push_back(*right);
      else
        map.error("may",
                  "'" + word + "' is not known; list policy, tolerance, exclusions, review, parts");
    }
  }
  if (const auto word = map.text("role")) {
    const auto role = role_named(*word);
    if (!role) map.error("role", "'" + *word + "' is not known; write designer, observer or bot");
    user.role = role.value_or(Role::kUnknown);
  }
  scenario.users.push_back(std::move(user));
}

template <class Read>
void read_list(YamlContext& context, const YamlMap& top, std::string_view key, Scenario& scenario,
               Read read) {
  const YAML::Node list = top.find(key);
  if (!list) return;
  if (!list.IsSequence()) {
    top.error(key, "expected a list, one '- ' an entry");
    return;
  }
  for (const auto& entry : list) {
    if (scenario.parts.size() > kMaxParts) return;
    read(context, entry, scenario);
  }
}

// 3. what only the whole can tell

template <class Named>
void check_names(YamlContext& context, const std::string& what, const std::vector<Named>& all) {
  std::set<std::string> names;
  for (const Named& one : all)
    if (!one.name.empty() && !names.insert(one.name).second)
      context.error(one.at.line,
                    what + " " + in_quotes(one.name) + " stands here twice; rename or remove one");
}

ScenarioReading read_document(const YAML::Node& document, const std::string& name) {
  ScenarioReading reading;
  reading.scenario.file = name;
  YamlContext context;
  context.file = name;
  const YamlMap top(
      context, document, "scenario",
      {"name", "units", "tick_rate_hz", "threads", "policy", "max_jump", "lease_s", "deviation",
       "min_gap", "min_gaps", "assembly", "parts", "fits", "exclusions", "approvals", "users"});
  if (top.usable()) {
    read_head(context, top, reading.scenario);
    read_list(context, top, "parts", reading.scenario, read_part);
    read_list(context, top, "fits", reading.scenario, read_fit);
    read_list(context, top, "exclusions", reading.scenario, read_exclusion);
    read_list(context, top, "approvals", reading.scenario, read_approval);
    read_list(context, top, "min_gaps", reading.scenario, read_min_gap);
    read_list(context, top, "users", reading.scenario, read_user);
    if (top.has("assembly")) read_assembly(context, top.find("assembly"), reading.scenario);
    if (!top.has("parts") && !top.has("assembly"))
      top.error("parts is missing: a scenario needs at least one part, or an assembly");
    if (top.has("parts") && top.find("parts").IsSequence() && top.find("parts").size() == 0)
      context.warning(top.find("parts"),
                      "parts is empty; a session of it waits for parts that users add");
    if (reading.scenario.parts.size() > kMaxParts)
      top.error("parts", "more than " + std::to_string(kMaxParts) + " parts; split the scenario");
    check_names(context, "part", reading.scenario.parts);
    check_names(context, "user", reading.scenario.users);
  }
  reading.scenario.unit_mm = context.unit_mm;
  reading.findings = std::move(context.findings);
  return reading;
}

}  // namespace

bool ScenarioReading::usable() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.is_error; });
}

std::optional<Finding> nothing_moves(const Scenario& scenario) {
  if (scenario.parts.empty()) return std::nullopt;
  if (std::any_of(scenario.parts.begin(), scenario.parts.end(), [](auto& p) { return p.moving; }))
    return std::nullopt;
  return Finding{false, scenario.file + ": no part has moving: true; nobody can move anything"};
}

Result<std::string> scenario_text(const std::filesystem::path& file) {
  std::error_code problem;
  if (std::filesystem::is_directory(file, problem))
    return fail(Code::kNotFound, file.string() + ": is a folder; name a scenario file (.yaml)");
  if (is_mesh_name(file))
    return fail(Code::kInvalidInput,
                file.string() +
                    ": is a mesh, and a scenario (.yaml) is expected; mortise inspect " +
                    file.string() + " > scene.yaml writes one, mortise judge takes two meshes");
  if (file.extension() == ".mcap")
    return fail(Code::kInvalidInput, file.string() +
                                         ": is a session log, and a scenario (.yaml) is expected; "
                                         "mortise replay reads logs");
  return file_text(file, kMostYaml_bytes + 1);
}

std::vector<std::filesystem::path> files_of(const Scenario& scenario) {
  const std::filesystem::path own = scenario.file, folder = own.parent_path();
  std::vector<std::filesystem::path> files{own};
  if (scenario.assembly) files.push_back(folder / scenario.assembly->file);
  for (const Scenario::PartSpec& part : scenario.parts)
    if (!part.mesh.file.empty()) files.push_back(folder / part.mesh.file);
  return files;
}

Result<ScenarioReading> read_scenario(const std::filesystem::path& file) {
  const Result<std::string> text = scenario_text(file);
  if (!text) return text.error();
  Result<ScenarioReading> reading = read_scenario_text(*text, file.string());
  if (reading) add_assembly(*reading);
  return reading;
}

Result<ScenarioReading> read_scenario_text(std::string_view yaml, const std::string& name) {
  const Result<YAML::Node> document = parse_yaml(yaml, name);
  if (!document) return document.error();
  if (!*document || document->IsNull())
    return fail(Code::kInvalidInput,
                name + ":1: is empty; a scenario starts with name: and units:");
  try {
    return read_document(*document, name);
  } catch (const std::exception& e) {
    return fail(Code::kInvalidInput, name + ": not a scenario: " + e.what());
  }
}

}  // namespace mortise
