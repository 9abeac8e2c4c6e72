#include "client/tools/check/baseline.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "common/base/file_text.h"

namespace mortise {
namespace {

// A micrometre: a smaller difference comes from meshing, not from the design.
constexpr double kSameDepth_mm = 1e-3;

// What is compared of one pair of instances.
struct State {
  std::string klass, relation;
  bool explained = false;
  double depth_mm = 0.0;
  bool is_same(const State& other) const {
    return klass == other.klass && relation == other.relation && explained == other.explained &&
           std::fabs(depth_mm - other.depth_mm) <= kSameDepth_mm;
  }
  std::string text() const {
    return klass + (explained ? " (explained)" : "") + fmt::format(", {:.4f} mm", depth_mm);
  }
};
using States = std::map<std::pair<std::string, std::string>, State>;

// Clashes only: contacts and fake ones come and go with the facets.
States states_of(const Json& report) {
  States states;
  for (const Json& pair : report.at("pairs")) {
    State state;
    state.klass = pair.at("class").get<std::string>();
    if (state.klass != "real" && state.klass != "potential") continue;
    if (pair.at("muted").get<bool>()) continue;
    state.relation = pair.at("relation").get<std::string>();
    state.explained = pair.at("explained").get<bool>();
    const Json& depth = pair.at("verdicts").at(0).at("delta_mm").at(0);
    state.depth_mm = depth.is_number() ? depth.get<double>() : 0.0;
    for (const Json& ids : pair.at("instances")) {
      auto names = std::pair(ids.at(0).get<std::string>(), ids.at(1).get<std::string>());
      if (names.second < names.first) std::swap(names.first, names.second);
      states[names] = state;
    }
  }
  return states;
}

}  // namespace

Result<std::string> compare_with_baseline(const std::string& file, Json& report) try {
  const Result<std::string> text = file_text(file);
  if (!text) return text.error();
  const States before = states_of(Json::parse(*text)), now = states_of(report);
  Json changes = {{"new", Json::array()}, {"gone", Json::array()}, {"changed", Json::array()}};
  std::size_t unchanged = 0;
  std::string lines;
  const auto say = [&](const char* what, const auto& names, const std::string& how) {
    changes[what].push_back({{"a", names.first}, {"b", names.second}, {"how", how}});
    lines += fmt::format("  {:<8} {} × {}: {}\n", what, names.first, names.second, how);
  };
  for (const auto& [names, state] : now) {
    const auto old = before.find(names);
    if (old == before.end())
      say("new", names, state.text());
    else if (!state.is_same(old->second))
      say("changed", names, old->second.text() + " → " + state.text());
    else
      ++unchanged;
  }
  for (const auto& [names, state] : before)
    if (!now.contains(names)) say("gone", names, state.text());
  changes["unchanged"] = unchanged;
  const std::string head = fmt::format("\nAgainst {}: {} new, {} gone, {} changed, {} unchanged\n",
                                       file, changes["new"].size(), changes["gone"].size(),
                                       changes["changed"].size(), unchanged);
  report["baseline"] = std::move(changes);
  return head + lines;
} catch (const Json::exception& error) {
  return fail(Code::kInvalidInput,
              file + ": is no report of mortise check --json (" + error.what() + ")");
}

bool fails_on(const std::string& what, const Json& report) {
  const Json& counts = report.at("counts");
  const auto count = [&](const char* name) { return counts.at(name).get<std::size_t>(); };
  if (what == "real") return count("unexplained_real") > 0;
  if (what == "potential") return count("unexplained_real") + count("potential") > 0;
  if (what == "near") return count("unexplained_real") + count("near") > 0;
  if (what == "new") return report.contains("baseline") && !report.at("baseline").at("new").empty();
  return false;
}

}  // namespace mortise
