#include "common/io/scenario/session_scenario.h"

#include <yaml-cpp/yaml.h>

namespace mortise {

Result<std::string> session_scenario(const std::string& text, const std::filesystem::path& folder,
                                     const AssemblyWishes& wishes,
                                     const std::vector<Scenario::PairReason>& approvals) try {
  YAML::Node scenario = YAML::Load(text);
  YAML::Node assembly = scenario["assembly"];
  if (!assembly || !assembly["file"])
    return fail(Code::kInvalidInput, "the scenario has no assembly; name a STEP file in it");
  assembly["file"] =
      std::filesystem::absolute(folder / assembly["file"].as<std::string>()).string();
  if (!wishes.general.empty()) assembly["general"] = wishes.general;
  for (const std::string& path : wishes.fixed) assembly["fixed"].push_back(path);
  for (const std::string& path : wishes.bought) assembly["bought"].push_back(path);
  for (const Scenario::PairReason& approval : approvals) {
    YAML::Node pair;
    pair["between"].push_back(approval.part_a);
    pair["between"].push_back(approval.part_b);
    pair["reason"] = approval.reason;
    scenario["approvals"].push_back(pair);
  }
  YAML::Emitter out;
  out << scenario;
  return std::string(out.c_str()) + "\n";
} catch (const YAML::Exception& error) {
  return fail(Code::kInvalidInput, "the scenario is not valid YAML: " + error.msg);
}

}  // namespace mortise
