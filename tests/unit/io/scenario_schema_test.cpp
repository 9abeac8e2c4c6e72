#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "common/io/scenario/scenario_file.h"

namespace mortise {
namespace {

nlohmann::json schema() {
  std::ifstream file(std::string(MORTISE_SOURCE_DIR) + "/scenarios/scenario.schema.json");
  return nlohmann::json::parse(file);
}

std::set<std::string> properties(const nlohmann::json& level) {
  std::set<std::string> names;
  for (const auto& [name, value] : level.at("properties").items()) names.insert(name);
  return names;
}

// What the reader says it knows where it meets the key "zzz".
std::set<std::string> known_to_reader(const std::string& yaml) {
  const auto reading = read_scenario_text(yaml, "x.yaml");
  std::set<std::string> names;
  if (!reading) return names;
  for (const Finding& finding : reading->findings) {
    const std::size_t at = finding.text.find("Known: ");
    if (finding.text.find("'zzz'") == std::string::npos || at == std::string::npos) continue;
    std::istringstream list(finding.text.substr(at + 7));
    for (std::string word; std::getline(list, word, ',');) {
      word.erase(0, word.find_first_not_of(' '));
      names.insert(word);
    }
  }
  return names;
}

TEST(ScenarioSchema, KnowsTheKeysThatTheReaderKnows) {
  const nlohmann::json json = schema();
  const std::string head = "name: a\nunits: mm\n";
  const auto part = [&](const std::string& line) {
    return std::string(head)
        .append("parts:\n  - {name: p, generator: {kind: block}, ")
        .append(line)
        .append("}\n");
  };
  const auto list = [&](const std::string& key, const std::string& entry) {
    return std::string(head).append(key).append(": [").append(entry).append("]\n");
  };
  const auto& defs = json.at("$defs");
  EXPECT_EQ(properties(json), known_to_reader("zzz: 1\n"));
  EXPECT_EQ(properties(defs.at("part")), known_to_reader(part("zzz: 1")));
  EXPECT_EQ(properties(defs.at("mesh")),
            known_to_reader(list("parts", "{name: p, mesh: {zzz: 1}}")));
  EXPECT_EQ(properties(defs.at("pose")), known_to_reader(part("pose: {zzz: 1}")));
  EXPECT_EQ(properties(defs.at("axis_angle")),
            known_to_reader(part("pose: {axis_angle: {zzz: 1}}")));
  EXPECT_EQ(properties(defs.at("feature")), known_to_reader(part("features: {f: {zzz: 1}}")));
  EXPECT_EQ(properties(defs.at("tolerance").at("anyOf").at(1)),
            known_to_reader(part("tolerance: {zzz: 1}")));
  EXPECT_EQ(properties(defs.at("position").at("anyOf").at(1)),
            known_to_reader(part("features: {f: {position: {zzz: 1}}}")));
  EXPECT_EQ(properties(defs.at("instance")), known_to_reader(part("instances: [{zzz: 1}]")));
  EXPECT_EQ(properties(defs.at("repeat")), known_to_reader(part("repeat: {zzz: 1}")));
  EXPECT_EQ(properties(defs.at("fit")), known_to_reader(list("fits", "{zzz: 1}")));
  EXPECT_EQ(properties(defs.at("exclusion")), known_to_reader(list("exclusions", "{zzz: 1}")));
  EXPECT_EQ(properties(defs.at("exclusion")), known_to_reader(list("approvals", "{zzz: 1}")));
  EXPECT_EQ(properties(defs.at("min_gap")), known_to_reader(list("min_gaps", "{zzz: 1}")));
  EXPECT_EQ(properties(defs.at("assembly")), known_to_reader(head + "assembly: {zzz: 1}\n"));
  EXPECT_EQ(properties(defs.at("assembly_statement")),
            known_to_reader(head + "assembly: {file: a.step, statements: [{zzz: 1}]}\n"));
  EXPECT_EQ(properties(defs.at("face_address")),
            known_to_reader(head +
                            "assembly: {file: a.step, statements: [{part: a, face: {zzz: 1}}]}\n"));
  EXPECT_EQ(properties(defs.at("user")), known_to_reader(list("users", "{zzz: 1}")));
}

}  // namespace
}  // namespace mortise
