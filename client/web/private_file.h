#pragma once
#include <string>

#include "common/base/result.h"

namespace mortise::web {

/// Makes a file with secrets in it, readable by its owner only. One that is there already is not
/// touched: the error says so.
Status write_private(const std::string& file, const std::string& text);

}  // namespace mortise::web
