#include "common/io/scenario/live_rules.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <tuple>
#include <utility>

#include "common/evaluation/band.h"
#include "common/io/scenario/revised_part.h"
#include "common/io/scenario/scenario_parts.h"
#include "common/io/scenario/scenario_tolerance.h"
#include "common/io/scenario/scenario_yaml.h"

namespace mortise {
namespace {

constexpr const char* kSource = "tolerance";

// The sentence of a finding without the place in a file that it does not come from.
std::string sentence_of(const Finding& finding) {
  const std::size_t end = finding.text.find(": ");
  return end == std::string::npos ? finding.text : finding.text.substr(end + 2);
}

Error first_error(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings)
    if (finding.is_error) return fail(Code::kInvalidInput, sentence_of(finding));
  return fail(Code::kInvalidInput, "the statement is not understood");
}

bool has_error(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(), [](auto& f) { return f.is_error; });
}

// 1. texts, as they stand in a file

// Is it a class ("H7") or a code ("H7/g6", "Ø20 H7"), and not a tolerance?
bool names_a_class(const YAML::Node& node) {
  if (!node.IsScalar()) return false;
  std::string code;
  std::tie(std::ignore, code) = split_nominal(node.Scalar());
  return !code.empty() && std::isalpha(static_cast<unsigned char>(code.front())) != 0 &&
         !code.starts_with("profile");
}

YAML::Node under(const char* key, const YAML::Node& value) {
  YAML::Node map(YAML::NodeType::Map);
  map[key] = value;
  return map;
}

Result<YAML::Node> parse(const std::string& text) {
  Result<YAML::Node> node = parse_yaml(text, kSource);
  if (!node) return fail(Code::kInvalidInput, sentence_of({true, node.error().text}));
  if (!*node || node->IsNull())
    return fail(Code::kInvalidInput, "the statement is blank; write e.g. \"±0.05\"");
  return node;
}

Result<Scenario::Tolerance> part_tolerance(const std::string& text, YamlContext& context,
                                           const std::string& part) {
  const Result<YAML::Node> node = parse(text);
  if (!node) return node.error();
  auto tolerance = read_tolerance(context, *node, "part " + part + ": tolerance");
  if (!tolerance || has_error(context.findings)) return first_error(context.findings);
  tolerance->at = {};
  return *tolerance;
}

Status feature_statement(const std::string& text, YamlContext& context,
                         Scenario::FeatureSpec& feature) {
  const Result<YAML::Node> parsed = parse(text);
  if (!parsed) return parsed.error();
  YAML::Node node = *parsed;
  const auto has = [&](const char* key) { return node.IsMap() && node[key].IsDefined(); };
  if (names_a_class(node))
    node = under("iso", node);
  else if (!has("iso") && !has("tolerance") && !has("position"))
    node = under("tolerance", node);
  const YamlMap map(context, node, "feature " + feature.name,
                    {"iso", "nominal", "width_to", "tolerance", "position"});
  if (map.usable()) read_feature_statement(context, map, feature);
  if (feature.tolerance) feature.tolerance->at = {};
  return has_error(context.findings) ? Status(first_error(context.findings)) : ok();
}

Result<Scenario::FitSpec> fit_of_text(const std::string& text, YamlContext& context) {
  const Result<YAML::Node> parsed = parse(text);
  if (!parsed) return parsed.error();
  YAML::Node node = *parsed;
  Scenario::FitSpec fit;
  if (node.IsScalar() && !names_a_class(node)) {
    fit.tolerance = read_tolerance(context, node, "fit");
  } else {
    if (node.IsScalar()) node = under("code", node);
    const YamlMap map(context, node, "fit",
                      {"code", "plus_minus", "profile", "unequal", "lower", "upper", "nominal"});
    if (map.usable()) (void)read_fit_statement(context, map, fit);
  }
  if (has_error(context.findings)) return first_error(context.findings);
  return fit;
}

// 2. the rules

class LiveRules final : public SurfaceRules {
 public:
  LiveRules(const Scenario& scenario, std::vector<StatedPart> stated)
      : scenario_(scenario), stated_(std::move(stated)), named_(stated_.size()) {}

  Result<Change> restate(const World& world, const Target& target,
                         const std::string& text) override {
    YamlContext context;
    context.file = kSource;
    context.unit_mm = scenario_.unit_mm;
    if (target.other_part) return restate_pair(world, target, text, context);
    return restate_part(world, target, text, context);
  }

  void add_part(const Part& part, const PartShape& shape) override {
    StatedPart& stated = stated_.emplace_back(shape.stated ? *shape.stated : StatedPart{});
    stated.kind = part.kind;
    stated.of_feature.resize(part.features.size());
  }

  PartShapes::AsPart as_part(const Part& part) const override {
    const std::uint64_t said = said_of(part.id);
    Remembered& known = remembered_[part.id];
    if (known.memory && known.as.said == said) return known.as;
    known.memory = std::make_shared<const PartMemory>(memory_of(part));
    known.as = {part.id, said, [memory = known.memory](SolidPtr solid, double quantum_mm) {
                  return revised(*memory, std::move(solid), quantum_mm);
                }};
    return known.as;
  }

  Change revise(const World& world, PartId id, const PartShape& shape) override {
    memories_[id] = remembered_.at(id).memory;  // of the part as it was: the shape came of it
    ++said_[id];
    revised_ = true;
    StatedPart& stated = stated_[id.value - 1];
    stated = *shape.stated;
    stated.kind = world.find(id)->kind;
    for (LiveFit& live : live_) {
      auto& [a, fa, b, fb] = live.ends;
      if (a == id) fa = index_now(world, a, live.name_a);
      if (b == id) fb = index_now(world, b, live.name_b);
    }
    Change change;
    for (auto& [ids, rule] : outcome(world, id).pair_rules) change.pairs.push_back(std::move(rule));
    return change;
  }

 private:
  std::uint64_t said_of(PartId part) const {
    const auto said = said_.find(part);
    return said == said_.end() ? 1 : said->second + 1;
  }

  // What was remembered when the part was revised last, and what has been said since.
  PartMemory memory_of(const Part& part) const {
    const auto known = memories_.find(part.id);
    PartMemory memory = known == memories_.end() ? PartMemory{} : *known->second;
    const std::size_t i = part.id.value - 1;
    const bool is_named = i < named_;
    memory.undeclared = is_named ? scenario_.parts[i].undeclared : scenario_.undeclared_of_meshes();
    if (is_named) memory.chord_error_mm = scenario_.parts[i].chord_error_mm;
    remember(memory, part, stated_[i]);
    return memory;
  }

  Result<Change> restate_part(const World& world, const Target& target, const std::string& text,
                              YamlContext& context) {
    const Part& part = *world.find(target.part);
    StatedPart& stated = stated_[target.part.value - 1];
    const StatedPart before = stated;
    Status said = target.feature.empty() ? say_part(part, text, context, stated)
                                         : say_feature(part, target.feature, text, context, stated);
    if (said) said = combine(part, stated);
    Result<Change> change = said ? change_of(world, target.part) : Result<Change>(said.error());
    if (!change) {
      stated = before;
      return change;
    }
    ++said_[target.part];
    change->bands.emplace_back(target.part,
                               with_statements(part.band, *part.solid, for_band(stated.rest),
                                               for_band(stated.of_feature)));
    return change;
  }

  static Status say_part(const Part& part, const std::string& text, YamlContext& context,
                         StatedPart& stated) {
    stated.rest.statement = FaceStatement{};
    stated.rest.at = SourceLine{};
    if (text.empty()) return ok();
    const auto tolerance = part_tolerance(text, context, part.name);
    if (!tolerance) return tolerance.error();
    stated.rest.statement.offset_mm = tolerance->offset_mm;
    stated.rest.statement.source = tolerance->text;
    return ok();
  }

  static Status say_feature(const Part& part, const std::string& name, const std::string& text,
                            YamlContext& context, StatedPart& stated) {
    // What the mesh alone shows can be spoken of as well, once it has a declaration.
    for (std::size_t i = stated.declared.size(); i < part.features.size(); ++i) {
      Scenario::FeatureSpec& shown = stated.declared.emplace_back();
      shown.name = part.features[i].name;
      shown.surface = part.features[i].surface;
    }
    const auto declared = std::find_if(stated.declared.begin(), stated.declared.end(),
                                       [&](auto& feature) { return feature.name == name; });
    if (declared == stated.declared.end())
      return fail(Code::kInvalidInput, "part " + part.name + ": feature " + name +
                                           ": the part has none of this name; " + known(stated));
    Scenario::FeatureSpec& feature = *declared;
    feature.tolerance.reset();
    feature.iso_class.clear();
    feature.nominal_mm = 0.0;
    feature.width_to.clear();
    feature.position = {};
    feature.at = {};
    feature.by = Scenario::SaidBy::kSession;
    return text.empty() ? ok() : feature_statement(text, context, feature);
  }

  static std::string known(const StatedPart& stated) {
    std::string names;
    for (const auto& feature : stated.declared) names += (names.empty() ? "" : ", ") + feature.name;
    return names.empty() ? "it has no features" : "known: " + names;
  }

  // What part and features say together.
  static Status combine(const Part& part, StatedPart& stated) {
    for (std::size_t i = 0; i < stated.of_feature.size(); ++i) {
      if (i >= stated.declared.size()) {
        stated.of_feature[i] = stated.rest;
        continue;
      }
      Result<PlacedStatement> both = statement_of_feature(
          stated.declared[i], stated.declared, part.features[i].residual_mm, stated.rest);
      if (!both)
        return fail(both.error().code, "part " + part.name + ": feature " +
                                           stated.declared[i].name + ": " + both.error().text);
      stated.of_feature[i] = std::move(both).value();
    }
    return ok();
  }

  Result<Change> restate_pair(const World& world, const Target& target, const std::string& text,
                              YamlContext& context) {
    const auto a = feature_index(world, target.part, target.feature);
    if (!a) return a.error();
    const auto b = feature_index(world, target.other_part, target.other_feature);
    if (!b) return b.error();
    LiveFit live{{target.part, *a, target.other_part, *b},
                 std::nullopt,
                 target.feature,
                 target.other_feature};
    if (target.other_part < target.part) {
      live.ends = {target.other_part, *b, target.part, *a};
      std::swap(live.name_a, live.name_b);
    }
    if (!text.empty()) {
      const auto fit = fit_of_text(text, context);
      if (!fit) return fit.error();
      if (!fit->code.empty() && (target.feature.empty() || target.other_feature.empty()))
        return fail(
            Code::kInvalidInput,
            "fit: a fit code needs a feature on both sides, e.g. [plate.bore, pin.journal]");
      live.fit = *fit;
    }
    const std::vector<LiveFit> before = live_;
    std::erase_if(live_, [&](const LiveFit& old) { return old.ends == live.ends; });
    live_.push_back(std::move(live));
    Result<Change> change = change_of(world, target.part);
    if (!change) live_ = before;
    return change;
  }

  static Result<std::size_t> feature_index(const World& world, PartId id, const std::string& name) {
    if (name.empty()) return kWholePart;
    const Part& part = *world.find(id);
    for (std::size_t i = 0; i < part.features.size(); ++i)
      if (part.features[i].name == name) return i;
    return fail(Code::kInvalidInput,
                "fit: " + part.name + ": no feature of it is called '" + name + "'");
  }

  // The fits of every pair with the part, under what is stated now.
  Result<Change> change_of(const World& world, PartId part) const {
    RuleOutcome rules = outcome(world, part);
    if (has_error(rules.findings)) return first_error(rules.findings);
    Change change;
    for (auto& [ids, rule] : rules.pair_rules) change.pairs.push_back(std::move(rule));
    return change;
  }

  RuleOutcome outcome(const World& world, PartId part) const {
    return rules_of({scenario_, world.parts, stated_, live_, named_, part, revised_});
  }

  static std::size_t index_now(const World& world, PartId id, const std::string& name) {
    const auto index = feature_index(world, id, name);
    return index ? *index : kNoFace;
  }

  Scenario scenario_;
  std::vector<StatedPart> stated_;
  std::size_t named_;  ///< parts of the scenario
  std::vector<LiveFit> live_;
  struct Remembered {
    PartShapes::AsPart as;
    std::shared_ptr<const PartMemory> memory;
  };
  bool revised_ = false;                  ///< some part has taken another mesh
  std::map<PartId, std::uint64_t> said_;  ///< how often what is stated of a part changed
  std::map<PartId, std::shared_ptr<const PartMemory>> memories_;  ///< of parts that were revised
  mutable std::map<PartId, Remembered> remembered_;               ///< a cache, by said_of()
};

}  // namespace

std::shared_ptr<SurfaceRules> make_live_rules(const Scenario& scenario,
                                              std::vector<StatedPart> stated) {
  return std::make_shared<LiveRules>(scenario, std::move(stated));
}

}  // namespace mortise
