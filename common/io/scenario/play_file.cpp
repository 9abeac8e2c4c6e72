#include "common/io/scenario/play_file.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numbers>
#include <set>

#include "common/base/file_text.h"
#include "common/base/in_quotes.h"
#include "common/base/plain_text.h"
#include "common/base/ranges.h"
#include "common/io/scenario/yaml_document.h"

namespace mortise {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Stops the reading at the first fault; never leaves this file.
struct Fault {
  int line;
  std::string text;
};

int line_of(const YAML::Node& node) { return node.Mark().line + 1; }

void only_keys(const YAML::Node& map, std::initializer_list<const char*> known) {
  std::set<std::string> taken;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) throw Fault{line_of(entry.first), "a key must be a word"};
    const std::string& key = entry.first.Scalar();
    if (!taken.insert(key).second)
      throw Fault{line_of(entry.first), "key " + in_quotes(key) + " stands here twice; keep one"};
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string list;
    for (const char* name : known) list += (list.empty() ? "" : ", ") + std::string(name);
    throw Fault{line_of(entry.first), "unknown key " + in_quotes(key) + "; known here: " + list};
  }
}

double number(const YAML::Node& node, const std::string& what) {
  double value = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) ||
      !within(value, kLargestNumber)) {
    throw Fault{line_of(node), what + " must be a finite number up to 1e9"};
  }
  return value;
}

Vec3 vector(const YAML::Node& node, const std::string& what) {
  if (!node.IsSequence() || node.size() != 3) {
    throw Fault{line_of(node), what + " must be a list of three numbers"};
  }
  return {number(node[0], what), number(node[1], what), number(node[2], what)};
}

std::string text_of(const YAML::Node& map, const char* key) {
  const YAML::Node node = map[key];
  if (!node || !node.IsScalar() || !is_name(node.Scalar())) {
    throw Fault{line_of(map), std::string("'") + key + "' is missing or no name; each act has one"};
  }
  return node.Scalar();
}

Play::Step read_step(const YAML::Node& node) {
  if (!node.IsMap()) throw Fault{line_of(node), "a step must be a map {by, rotate_deg, seconds}"};
  only_keys(node, {"by", "rotate_deg", "seconds"});
  Play::Step step;
  if (node["by"]) step.by_mm = vector(node["by"], "by (mm)");
  if (node["rotate_deg"]) {
    step.rotate_rad = vector(node["rotate_deg"], "rotate_deg") * kRadPerDeg;
  }
  if (!node["seconds"]) throw Fault{line_of(node), "'seconds' is missing; how long does it take?"};
  step.seconds = number(node["seconds"], "seconds");
  if (!(step.seconds > 0.0)) throw Fault{line_of(node), "seconds must be above zero"};
  return step;
}

Play::Act read_act(const YAML::Node& node) {
  if (!node.IsMap()) throw Fault{line_of(node), "an act must be a map {user, part, steps}"};
  only_keys(node, {"user", "part", "at", "steps", "release"});
  Play::Act act;
  act.line = line_of(node);
  act.user = text_of(node, "user");
  act.part = text_of(node, "part");
  if (node["at"]) act.at_s = number(node["at"], "at (s)");
  if (act.at_s < 0.0) throw Fault{line_of(node["at"]), "at must not be negative"};
  if (node["release"] && !YAML::convert<bool>::decode(node["release"], act.release)) {
    throw Fault{line_of(node["release"]), "release must be true or false"};
  }
  const YAML::Node steps = node["steps"];
  if (!steps || !steps.IsSequence() || steps.size() == 0) {
    throw Fault{line_of(node), "'steps' must be a list with at least one step"};
  }
  for (const YAML::Node& step : steps) act.steps.push_back(read_step(step));
  return act;
}

Play read_document(const YAML::Node& root) {
  if (!root.IsMap()) throw Fault{1, "the file must be a map with the key 'acts'"};
  only_keys(root, {"acts"});
  const YAML::Node acts = root["acts"];
  if (!acts || !acts.IsSequence() || acts.size() == 0) {
    throw Fault{line_of(root), "'acts' must be a list with at least one act"};
  }
  Play play;
  for (const YAML::Node& act : acts) play.acts.push_back(read_act(act));
  return play;
}

}  // namespace

std::vector<std::string> Play::users() const {
  std::vector<std::string> names;
  for (const Act& act : acts) {
    if (std::find(names.begin(), names.end(), act.user) == names.end()) names.push_back(act.user);
  }
  return names;
}

double Play::seconds() const {
  std::map<std::string, double> end_s;
  double last_s = 0.0;
  for (const Act& act : acts) {
    double& end = end_s[act.user];
    end = std::max(end, act.at_s);
    for (const Step& step : act.steps) end += step.seconds;
    last_s = std::max(last_s, end);
  }
  return last_s;
}

Result<Play> read_play_text(std::string_view yaml, const std::string& name) {
  const Result<YAML::Node> document = parse_yaml(yaml, name);
  if (!document) return document.error();
  try {
    return read_document(*document);
  } catch (const Fault& fault) {
    return fail(Code::kInvalidInput, name + ":" + std::to_string(fault.line) + ": " + fault.text);
  } catch (const YAML::Exception& error) {
    return fail(Code::kInvalidInput,
                name + ":" + std::to_string(error.mark.line + 1) + ": not YAML: " + error.msg);
  }
}

Result<Play> read_play(const std::filesystem::path& file) {
  const Result<std::string> text = file_text(file, kMostYaml_bytes + 1);
  return text ? read_play_text(*text, file.string()) : text.error();
}

}  // namespace mortise
