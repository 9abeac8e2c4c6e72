#pragma once
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace mortise {

/// A PLY file that holds what its header says, row by row: a text has one row of numbers per line.
struct StrictPly {
  std::string bytes;
  std::string note;  ///< what was left out, one line; often empty
};

/// assimp counts to whatever a header says, repeats the last row where a text is cut off, and
/// leaves out what comes behind. Refused in one line: headers that are none, files with fewer or
/// more rows than announced, rows of a text with other numbers than announced. Linear in the bytes.
Result<StrictPly> strict_ply(std::string_view bytes);

}  // namespace mortise
