#pragma once
#include <string>

#include "common/base/result.h"

namespace mortise::web {

/// Creates a file with secrets, readable by its owner only. Fails, without touching it, when the
/// file exists.
Status write_private(const std::string& file, const std::string& text);

}  // namespace mortise::web
