#include "client/replay/change.h"

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "common/base/in_quotes.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/scenario/scenario_file.h"
#include "common/session/world/decisions.h"
#include "common/session/world/surface_rules.h"

namespace mortise {
namespace {

// A sweep of more is a slip of the pen.
constexpr std::size_t kMostVariants = 10'000;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string> split(std::string_view text, char at) {
  std::vector<std::string> pieces;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(at, from), text.size());
    pieces.emplace_back(trimmed(text.substr(from, to - from)));
    from = to + 1;
  }
  return pieces;
}

struct Word {
  std::string_view word;
  Change::Kind kind;
  std::size_t things;
  bool has_value;
};
constexpr Word kWords[] = {
    {"policy", Change::Kind::kPolicy, 0, true},    {"tolerance", Change::Kind::kTolerance, 1, true},
    {"fit", Change::Kind::kFit, 2, true},          {"exclude", Change::Kind::kExclude, 2, true},
    {"include", Change::Kind::kInclude, 2, false}, {"mesh", Change::Kind::kMesh, 1, true}};

Error not_understood(std::string_view text, const std::string& why) {
  return fail(Code::kInvalidInput, "change " + in_quotes(text) + ": " + why);
}

// The longest part name that the words begin with; behind its dot stands the feature.
struct Named {
  PartId part;
  std::string feature;
};
Result<Named> named(const World& world, const std::string& words) {
  const Part* best = nullptr;
  for (const Part& part : world.parts) {
    const bool whole = words == part.name;
    const bool feature = words.size() > part.name.size() + 1 && words.starts_with(part.name) &&
                         words[part.name.size()] == '.';
    if ((whole || feature) && (best == nullptr || part.name.size() > best->name.size()))
      best = &part;
  }
  if (best == nullptr) return fail(Code::kInvalidInput, "there is no part " + in_quotes(words));
  return Named{best->id, words == best->name ? "" : words.substr(best->name.size() + 1)};
}

Result<std::vector<std::string>> range_of(const std::string& text, std::string_view piece) {
  const auto dots = piece.find(".."), slash = piece.find('/');
  const auto number = [](std::string_view digits, auto& value) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size();
  };
  double from = 0.0, to = 0.0;
  std::size_t count = 0;
  if (slash == std::string_view::npos || slash < dots ||
      !number(trimmed(piece.substr(0, dots)), from) ||
      !number(trimmed(piece.substr(dots + 2, slash - dots - 2)), to) ||
      !number(trimmed(piece.substr(slash + 1)), count) || count < 2 || count > kMostVariants)
    return not_understood(text, "a range is written [FROM..TO/COUNT], COUNT at least 2");
  std::vector<std::string> values;
  for (std::size_t i = 0; i < count; ++i) {
    char value[32];
    std::snprintf(value, sizeof value, "%.9g",
                  from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1));
    values.emplace_back(value);
  }
  return values;
}

Decision decision_about(const World& world, const Change& change, Status& status) {
  Decision decision;
  const auto first = named(world, change.of[0]);
  if (!first) status = first.error();
  if (first) decision.part = first->part, decision.details.feature = first->feature;
  if (change.of.size() > 1) {
    const auto second = named(world, change.of[1]);
    if (!second) status = second.error();
    if (second)
      decision.details.other_part = second->part, decision.details.other_feature = second->feature;
  }
  decision.details.text = change.value;
  return decision;
}

}  // namespace

Result<Change> read_change(std::string_view text) {
  const auto equals = text.find('=');
  const std::string_view left = trimmed(text.substr(0, equals));
  const std::string_view word = left.substr(0, left.find(' '));
  const auto known = std::find_if(std::begin(kWords), std::end(kWords),
                                  [&](const Word& w) { return w.word == word; });
  if (known == std::end(kWords))
    return not_understood(text, "begin with policy, tolerance, fit, exclude, include or mesh");
  Change change;
  change.kind = known->kind;
  change.text = trimmed(text);
  if (const std::string_view rest = trimmed(left.substr(word.size())); !rest.empty())
    change.of = split(rest, ',');
  if (change.of.size() != known->things ||
      std::find(change.of.begin(), change.of.end(), "") != change.of.end())
    return not_understood(text, std::string(word) + " needs " +
                                    (known->things == 0   ? "no part"
                                     : known->things == 1 ? "one part"
                                                          : "two parts with a comma between them"));
  if (known->has_value != (equals != std::string_view::npos))
    return not_understood(
        text, known->has_value ? "there is no = with the new value" : "there is no value behind =");
  if (known->has_value) change.value = trimmed(text.substr(equals + 1));
  return change;
}

Result<std::vector<std::string>> variants_of(std::string_view text) {
  std::vector<std::string> made{""};
  for (std::size_t from = 0; from < text.size();) {
    const auto open = std::min(text.find('[', from), text.size());
    for (std::string& variant : made) variant += text.substr(from, open - from);
    if (open == text.size()) break;
    const auto close = text.find(']', open);
    if (close == std::string_view::npos) return not_understood(text, "a [ is not closed");
    const std::string_view inside = text.substr(open + 1, close - open - 1);
    std::vector<std::string> values;
    for (const std::string& piece : split(inside, ',')) {
      if (piece.find("..") == std::string::npos) {
        values.push_back(piece);
        continue;
      }
      const auto range = range_of(std::string(text), piece);
      if (!range) return range.error();
      values.insert(values.end(), range->begin(), range->end());
    }
    if (made.size() * values.size() > kMostVariants)
      return not_understood(text, "more than " + std::to_string(kMostVariants) + " variants");
    std::vector<std::string> grown;
    for (const std::string& variant : made)
      for (const std::string& value : values) grown.push_back(variant + value);
    made = std::move(grown);
    from = close + 1;
  }
  return made;
}

Status change_log(SessionLog& log, const Change& change) {
  if (change.kind != Change::Kind::kMesh) return ok();
  const auto reading = scenario_of(log);
  if (!reading) return reading.error();
  const auto& parts = reading->scenario.parts;
  const auto part = std::find_if(parts.begin(), parts.end(),
                                 [&](const auto& spec) { return spec.name == change.of[0]; });
  const auto index = static_cast<std::size_t>(part - parts.begin());
  if (part == parts.end() || index >= log.mesh_of_part.size())
    return not_understood(change.text, "there is no part " + in_quotes(change.of[0]));
  auto mesh = import_mesh(change.value, 1.0);
  if (!mesh) return mesh.error();
  const std::string hash = mesh_hash(mesh->mesh);
  if (hash == log.mesh_of_part[index])
    return not_understood(change.text, "the part already has this mesh");
  log.mesh_of_part[index] = hash;
  log.imports.resize(log.mesh_of_part.size());
  log.imports[index] = mesh->report;
  log.meshes.emplace_back(hash, std::move(mesh->mesh));
  return ok();
}

Status change_world(World& world, const Change& change) {
  if (change.kind == Change::Kind::kMesh) return ok();
  if (change.kind == Change::Kind::kPolicy) {
    const auto policy = policy_named(change.value);
    if (!policy) return not_understood(change.text, "there is no such policy");
    world.policy = *policy;
    return ok();
  }
  Status status = ok();
  Decision decision = decision_about(world, change, status);
  if (!status) return not_understood(change.text, status.error().text);
  if (change.kind == Change::Kind::kTolerance || change.kind == Change::Kind::kFit) {
    decision.kind = Decision::Kind::kSetTolerance;
    if (const Status set = set_tolerance(world, decision); !set)
      return not_understood(change.text, set.error().text);
  } else {
    decision.kind = change.kind == Change::Kind::kExclude ? Decision::Kind::kSetExclusion
                                                          : Decision::Kind::kDropExclusion;
    apply_decision(world, decision);
  }
  // It is how the session begins, not news in it.
  world.standing.clear();
  return ok();
}

}  // namespace mortise
