#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/motion/motion.h"

namespace mortise {

struct NamedMotion {
  std::string id;
  Motion motion;
};

/// Reads a CSV of motions; the columns are found by their names in the first line, others are
/// passed over. Lengths are multiplied by unit_mm. An error names file, line and column (counted in
/// characters) and what to do.
Result<std::vector<NamedMotion>> read_motions(const std::filesystem::path& file, double unit_mm);

}  // namespace mortise
