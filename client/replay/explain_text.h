#pragma once
#include <string>

#include "common/io/report_json.h"

namespace mortise {

/// What explain_clash() found, for people, in numbered steps.
std::string explain_text(const Json& chain);

}  // namespace mortise
