#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/io/log/session_log_read.h"
#include "common/session/world/world.h"

namespace mortise {

/// One change of a what-if, as people write it:
///   policy = report
///   tolerance PART[.FEATURE] = ±0.02        (as behind tolerance: or iso: of a scenario)
///   fit PART[.FEATURE], PART[.FEATURE] = H7/p6
///   exclude PART, PART = why
///   include PART, PART                      (drops an exclusion)
///   mesh PART = FILE                        (numbers in mm)
/// Nothing behind "=" of a tolerance or fit removes the statement.
struct Change {
  enum class Kind { kPolicy, kTolerance, kFit, kExclude, kInclude, kMesh };
  Kind kind = Kind::kPolicy;
  std::vector<std::string> of;  ///< PART[.FEATURE], one or two
  std::string value;
  std::string text;  ///< as it was written
};
Result<Change> read_change(std::string_view text);

/// Every way to fill in the brackets of a text: "±[0.01, 0.02]" is two texts, "±[0.01..0.05/5]"
/// five, evenly from 0.01 to 0.05. Several: each with each. Without brackets the text alone.
Result<std::vector<std::string>> variants_of(std::string_view text);

/// Meshes are changed in the log before its scene is made, everything else in the world before its
/// first tick. A change that changes nothing, or cannot hold, fails with a sentence.
Status change_log(SessionLog& log, const Change& change);
Status change_world(World& world, const Change& change);

}  // namespace mortise
