#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace mortise {

/// The report of one process, or of all of them together, for people.
std::string load_text(const nlohmann::ordered_json& document);

}  // namespace mortise
