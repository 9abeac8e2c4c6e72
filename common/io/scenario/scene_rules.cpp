#include "common/io/scenario/scene_rules.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

#include "common/base/nearest_word.h"
#include "common/evaluation/band.h"
#include "common/io/scenario/fit_candidates.h"
#include "common/session/world/rights.h"

namespace mortise {
namespace {

/// Pairs one scenario may have rules for: each costs memory, and a wildcard on both sides of a
/// large scene is rarely meant.
constexpr std::size_t kMaxRulePairs = 2'000'000;

// The parts of the scene and their features by the names and patterns of a scenario.
class Names {
 public:
  Names(const std::vector<Part>& parts, std::size_t named)
      : parts_(parts), named_(std::span(parts).first(std::min(named, parts.size()))) {}

  const Part& part(PartId id) const { return parts_[id.value - 1]; }

  std::vector<PartId> parts_matching(const std::string& pattern) const {
    std::vector<PartId> ids;
    for (const Part& candidate : named_)
      if (matches_name(pattern, candidate.name)) ids.push_back(candidate.id);
    return ids;
  }

  std::string no_such_part(const std::string& pattern) const {
    std::vector<std::string> names;
    for (const Part& candidate : named_) names.push_back(candidate.name);
    return "no part is called '" + pattern + "'" + did_you_mean(pattern, names);
  }

  std::vector<std::size_t> features_matching(PartId id, const std::string& pattern) const {
    if (pattern.empty()) return {kWholePart};
    std::vector<std::size_t> found;
    const auto& features = part(id).features;
    for (std::size_t i = 0; i < features.size(); ++i)
      if (matches_name(pattern, features[i].name)) found.push_back(i);
    return found;
  }

  std::string no_such_feature(const std::vector<PartId>& ids, const std::string& pattern) const {
    std::vector<std::string> names;
    for (const PartId id : ids)
      for (const Feature& feature : part(id).features) names.push_back(feature.name);
    if (names.empty())
      return "part '" + part(ids.front()).name + "' has no features; declare '" + pattern + "'";
    return "no feature of it is called '" + pattern + "'" + did_you_mean(pattern, names);
  }

  std::string of_end(PartId id, std::size_t feature) const {
    return feature == kWholePart ? part(id).name
                                 : part(id).name + "." + part(id).features[feature].name;
  }

 private:
  const std::vector<Part>& parts_;
  std::span<const Part> named_;
};

// The pairs of which a rule speaks, each with the lower id first, and what is wrong with it.
struct NamedPairs {
  std::vector<std::pair<PartId, PartId>> pairs;
  std::vector<std::string> objections;
};

NamedPairs named_pairs(const Names& names, const std::string& part_a, const std::string& part_b) {
  NamedPairs named;
  const auto ids_a = names.parts_matching(part_a), ids_b = names.parts_matching(part_b);
  if (ids_a.empty()) named.objections.push_back(names.no_such_part(part_a));
  if (ids_b.empty()) named.objections.push_back(names.no_such_part(part_b));
  if (ids_a.size() * ids_b.size() > kMaxRulePairs)
    named.objections.push_back("matches more than " + std::to_string(kMaxRulePairs) +
                               " pairs; name parts more closely");
  if (!named.objections.empty()) return named;
  for (const PartId id_a : ids_a)
    for (const PartId id_b : ids_b)
      if (id_a != id_b) named.pairs.push_back(std::minmax(id_a, id_b));
  if (named.pairs.empty()) named.objections.emplace_back("names one part only; a pair needs two");
  return named;
}

// What an assembly has no longer after another export, or a part with another mesh (unmatched), is
// told, and the rest is used.
class RuleBook {
 public:
  explicit RuleBook(const RuleInput& in)
      : input_(in), scenario_(in.scenario), stated_(in.stated), names_(in.parts, in.named) {}

  RuleOutcome run() {
    for (const auto& fit : scenario_.fits) apply_fit(fit);
    for (const LiveFit& live : input_.live) apply_live(live);
    make_bands();
    note_what_is_tighter();
    if (input_.only) return std::move(out_);
    apply_pair_rules();
    for (const auto& user : scenario_.users) check_user(user);
    return std::move(out_);
  }

 private:
  using PairSide = std::vector<std::optional<PlacedStatement>>;  // by feature; last: whole part
  struct PairStatements {
    PairSide a, b;
    std::vector<std::string> fits;
  };
  // A fit that was resolved, and where: index into LoadedScene::fits.
  struct AppliedFit {
    FeaturePair ends;
    FaceStatement a, b;  // what the fit itself says
    SourceLine at;
  };

  void error(SourceLine at, const std::string& text) { say(true, at, text); }
  void say(bool is_error, SourceLine at, const std::string& text) {
    out_.findings.push_back({is_error, place_of(scenario_, at) + text});
  }
  void unmatched(SourceLine at, const std::string& text) {
    say(!scenario_.assembly && !input_.revised, at, text);
  }
  const Part& part(PartId id) const { return names_.part(id); }

  // 1. fits
  std::optional<std::vector<std::pair<PartId, std::size_t>>> ends_of(
      SourceLine at, const std::string& part_pattern, const std::string& feature_pattern) {
    const std::vector<PartId> ids = names_.parts_matching(part_pattern);
    if (ids.empty()) {
      unmatched(at, "fit: " + names_.no_such_part(part_pattern));
      return std::nullopt;
    }
    std::vector<std::pair<PartId, std::size_t>> ends;
    for (const PartId id : ids)
      for (const std::size_t feature : names_.features_matching(id, feature_pattern))
        ends.emplace_back(id, feature);
    if (ends.empty()) {
      unmatched(at, "fit: " + part_pattern + ": " + names_.no_such_feature(ids, feature_pattern));
      return std::nullopt;
    }
    return ends;
  }

  void apply_fit(const Scenario::FitSpec& fit) {
    const auto ends_a = ends_of(fit.at, fit.part_a, fit.feature_a);
    const auto ends_b = ends_of(fit.at, fit.part_b, fit.feature_b);
    if (!ends_a || !ends_b) return;
    if (ends_a->size() * ends_b->size() > kMaxRulePairs) {
      error(fit.at, "fit: matches more than " + std::to_string(kMaxRulePairs) +
                        " pairs; name parts more closely");
      return;
    }
    std::set<FeaturePair> seen;  // `*` on both sides names every pair twice
    std::size_t applied = 0;
    const std::size_t findings_before = out_.findings.size();
    for (auto [id_a, feature_a] : *ends_a)
      for (auto [id_b, feature_b] : *ends_b) {
        if (id_a == id_b) continue;
        auto [a, fa, b, fb] = std::tuple(id_a, feature_a, id_b, feature_b);
        if (b < a) std::swap(a, b), std::swap(fa, fb);
        if (!is_asked(a, b)) continue;
        if (!seen.insert({a, fa, b, fb}).second) continue;
        const auto pairs = fitting_features(fit, {part(a), fa}, {part(b), fb});
        if (!pairs) unmatched(fit.at, pairs.error().text);
        if (pairs)
          for (const auto& [i, j] : *pairs) applied += state_pair(fit, a, i, b, j) ? 1 : 0;
        if (out_.findings.size() > findings_before + 20) return;  // the same mistake many times
      }
    if (applied == 0 && out_.findings.size() == findings_before && !input_.only)
      unmatched(fit.at, "fit: matches no pair of a hole and a shaft of two different parts");
  }

  bool is_asked(PartId a, PartId b) const {
    return !input_.only || *input_.only == a || *input_.only == b;
  }

  // A statement of the running session takes the place of what the file says of the same ends.
  bool is_replaced(const FeaturePair& ends) const {
    return std::any_of(input_.live.begin(), input_.live.end(),
                       [&](const LiveFit& live) { return live.ends == ends; });
  }

  void apply_live(const LiveFit& live) {
    const auto [a, fa, b, fb] = live.ends;
    if (!live.fit || !is_asked(a, b) || fa == kNoFace || fb == kNoFace) return;
    in_live_ = true;
    state_pair(*live.fit, a, fa, b, fb);
    in_live_ = false;
  }

  // Returns whether the fit speaks of this pair of features.
  bool state_pair(const Scenario::FitSpec& fit, PartId a, std::size_t fa, PartId b,
                  std::size_t fb) {
    if (!in_live_ && is_replaced({a, fa, b, fb})) return true;
    LoadedScene::ResolvedFit resolved;
    FaceStatement of_a, of_b;
    std::string text;
    if (fit.tolerance) {
      of_a = of_b = FaceStatement{fit.tolerance->offset_mm, fit.tolerance->text};
      const Interval both = of_a.offset_mm + of_b.offset_mm;
      resolved.clearance_mm = {-2.0 * both.hi, -2.0 * both.lo};
      text = fit.tolerance->text;
    } else {
      const FitSide side_a = side_of({part(a), fa}), side_b = side_of({part(b), fb});
      const bool wide = has_wildcard(fit.feature_a) || has_wildcard(fit.feature_b);
      if (wide && side_a.surface->inward == side_b.surface->inward) return false;
      Result<FitStatement> statement = fit_statement(fit.code, fit.nominal_mm, side_a, side_b);
      if (!statement) {
        error(fit.at, statement.error().text);
        return false;
      }
      of_a = statement->a, of_b = statement->b;
      resolved.clearance_mm = statement->fit.clearance_mm;
      resolved.nominal_mm = statement->nominal_mm;
      text = statement->text;
    }
    const auto [earlier, fresh] = fit_of_.insert({FeaturePair{a, fa, b, fb}, fit.at.line});
    if (!fresh) {
      error(fit.at, "fit: " + names_.of_end(a, fa) + " and " + names_.of_end(b, fb) +
                        " already have a fit in line " + std::to_string(earlier->second) +
                        "; keep one");
      return false;
    }
    PairStatements& pair = statements_of(a, b);
    if (!put(pair.a, a, fa, {of_a, fit.at}) || !put(pair.b, b, fb, {of_b, fit.at})) return false;
    if (std::find(pair.fits.begin(), pair.fits.end(), text) == pair.fits.end())
      pair.fits.push_back(text);
    resolved.part_a = part(a).name, resolved.part_b = part(b).name;
    if (fa != kWholePart) resolved.feature_a = part(a).features[fa].name;
    if (fb != kWholePart) resolved.feature_b = part(b).features[fb].name;
    resolved.code = text;
    out_.fits.push_back(std::move(resolved));
    applied_.push_back({{a, fa, b, fb}, of_a, of_b, fit.at});
    return true;
  }

  PairStatements& statements_of(PartId a, PartId b) {
    PairStatements& pair = pairs_[{a, b}];
    pair.a.resize(part(a).features.size() + 1);
    pair.b.resize(part(b).features.size() + 1);
    return pair;
  }

  // Statements of one surface in one pair hold together; ones that exclude each other are errors.
  bool put(PairSide& side, PartId id, std::size_t feature, const PlacedStatement& statement) {
    std::optional<PlacedStatement>& slot = feature == kWholePart ? side.back() : side[feature];
    Result<PlacedStatement> both = slot ? both_hold(*slot, statement) : statement;
    if (!both) {
      error(statement.at, "fit: " + names_.of_end(id, feature) + ": " + both.error().text);
      return false;
    }
    slot = std::move(both).value();
    return true;
  }

  // 2. bands of pairs, shared by pairs that say the same of parts that are alike

  // What holds of one face of a part in a pair: the part's and the feature's own statement, the
  // pair's of the whole part, the pair's of the feature. `at` is the last line that was asked.
  struct InPair {
    Result<PlacedStatement> all;
    SourceLine at;
  };
  InPair statement_in_pair(PartId id, const PairSide& side, std::size_t feature) {
    const StatedPart& own = stated_[id.value - 1];
    const PlacedStatement& alone = feature == kWholePart ? own.rest : own.of_feature[feature];
    InPair in_pair{alone, alone.at};
    const auto beside = [&](const std::optional<PlacedStatement>& statement) {
      if (!statement || !in_pair.all) return;
      in_pair = {both_hold(*in_pair.all, *statement), statement->at};
    };
    beside(side.back());
    if (feature != kWholePart) beside(side[feature]);
    return in_pair;
  }

  std::shared_ptr<const SurfaceBand> band_of(PartId id, const PairSide& side) {
    if (std::none_of(side.begin(), side.end(), [](auto& s) { return s.has_value(); }))
      return nullptr;
    const StatedPart& own = stated_[id.value - 1];
    std::vector<FaceStatement> statements;  // by feature; the last one is the rest
    std::string key = std::to_string(own.kind);
    for (std::size_t i = 0; i <= own.of_feature.size(); ++i) {
      const std::size_t feature = i < own.of_feature.size() ? i : kWholePart;
      const auto [all, at] = statement_in_pair(id, side, feature);
      if (!all) {
        error(at, "fit: " + names_.of_end(id, feature) + ": " + all.error().text);
        return nullptr;
      }
      statements.push_back(for_band(*all));
      char bytes[sizeof(Interval)];
      std::memcpy(bytes, &statements.back().offset_mm, sizeof bytes);
      key.append(bytes, sizeof bytes).append(statements.back().source);
      key.push_back(statements.back().is_size ? '\r' : '\n');
    }
    const FaceStatement rest = statements.back();
    statements.pop_back();
    std::shared_ptr<const SurfaceBand>& band = bands_[key];
    if (!band)
      band = std::make_shared<const SurfaceBand>(
          with_statements(part(id).band, *part(id).solid, rest, statements));
    return band;
  }

  // Says of each fit what else holds of its faces, and what clearance that leaves.
  void note_what_is_tighter() {
    for (std::size_t i = 0; i < applied_.size(); ++i) {
      const AppliedFit& fit = applied_[i];
      const auto [a, fa, b, fb] = fit.ends;
      const PairStatements& pair = pairs_.at({a, b});
      const Result<PlacedStatement> of_a = statement_in_pair(a, pair.a, fa).all;
      const Result<PlacedStatement> of_b = statement_in_pair(b, pair.b, fb).all;
      if (!of_a || !of_b) continue;  // said where the bands were made
      LoadedScene::ResolvedFit& resolved = out_.fits[i];
      const FaceStatement all_a = for_band(*of_a), all_b = for_band(*of_b);
      if (all_a.source != fit.a.source)
        resolved.tighter.push_back(names_.of_end(a, fa) + ": " + all_a.source);
      if (all_b.source != fit.b.source)
        resolved.tighter.push_back(names_.of_end(b, fb) + ": " + all_b.source);
      if (resolved.tighter.empty()) continue;
      const Interval said = fit.a.offset_mm + fit.b.offset_mm;
      const Interval holds = all_a.offset_mm + all_b.offset_mm;
      resolved.clearance_mm.lo -= 2.0 * (holds.hi - said.hi);
      resolved.clearance_mm.hi -= 2.0 * (holds.lo - said.lo);
    }
  }

  void make_bands() {
    for (const auto& [ids, pair] : pairs_) {
      PairRule& rule = out_.pair_rules[ids];
      rule.a = ids.first, rule.b = ids.second;
      rule.band_a = band_of(ids.first, pair.a);
      rule.band_b = band_of(ids.second, pair.b);
      for (const std::string& fit : pair.fits) rule.fit += (rule.fit.empty() ? "" : ", ") + fit;
    }
  }

  // 3. exclusions and users

  std::vector<std::pair<PartId, PartId>> pairs_of(const char* what, const auto& rule) {
    auto [pairs, objections] = named_pairs(names_, rule.part_a, rule.part_b);
    for (const std::string& objection : objections)
      error(rule.at, std::string(what) + ": " + objection);
    return pairs;
  }

  // Of several rules of a pair the first reason stands, and the larger gap.
  void apply_pair_rules() {
    for (const auto& exclusion : scenario_.exclusions)
      for (const auto& key : pairs_of("exclusion", exclusion)) {
        PairRule& rule = out_.pair_rules[key];
        rule.a = key.first, rule.b = key.second;
        if (rule.excluded) continue;
        rule.excluded = true;
        rule.reason = exclusion.reason;
      }
    for (const auto& approval : scenario_.approvals)
      for (const auto& key : pairs_of("approval", approval))
        out_.approved_at_start.try_emplace(key, approval.reason);
    for (const auto& gap : scenario_.min_gaps)
      for (const auto& key : pairs_of("min_gap", gap))
        out_.min_gaps_mm[key] = std::max(out_.min_gaps_mm[key], gap.gap_mm);
  }

  void check_user(const Scenario::UserSpec& user) {
    for (const std::string& pattern : user.may_hold) {
      const auto ids = names_.parts_matching(pattern);
      if (ids.empty())
        error(user.at, "user " + user.name + ": may_hold: " + names_.no_such_part(pattern));
      else if (std::none_of(ids.begin(), ids.end(), [&](PartId id) { return part(id).moving; }))
        error(user.at, "user " + user.name + ": may_hold: no part called '" + pattern +
                           "' has moving: true");
    }
  }

  RuleInput input_;
  const Scenario& scenario_;
  const std::vector<StatedPart>& stated_;
  const Names names_;
  RuleOutcome out_;
  std::map<std::pair<PartId, PartId>, PairStatements> pairs_;
  std::map<FeaturePair, int> fit_of_;
  bool in_live_ = false;
  std::vector<AppliedFit> applied_;  // same index as LoadedScene::fits
  std::map<std::string, std::shared_ptr<const SurfaceBand>> bands_;
};

}  // namespace

std::string place_of(const Scenario& scenario, SourceLine at) {
  const std::string file = scenario.file.empty() ? "scenario" : scenario.file;
  return at.line > 0 ? file + ":" + std::to_string(at.line) + ": " : file + ": ";
}

RuleOutcome rules_of(const RuleInput& input) { return RuleBook(input).run(); }

}  // namespace mortise
