#include "common/io/mesh/importer/nesting.h"

#include <algorithm>

namespace mortise {

std::string too_deep(const std::string& called) {
  return "its " + called + " are nested deeper than " + std::to_string(kMostLevels) +
         " levels; export it with fewer";
}

// Each is looked at when all that hold it were.
std::string wrong_with_nesting(const std::vector<std::vector<std::size_t>>& holds,
                               const std::string& called) {
  std::vector<std::size_t> holders(holds.size(), 0), level(holds.size(), 1), ready;
  for (const auto& held : holds)
    for (const std::size_t one : held) ++holders[one];
  for (std::size_t i = 0; i < holds.size(); ++i)
    if (holders[i] == 0) ready.push_back(i);
  for (std::size_t next = 0; next < ready.size(); ++next) {
    const std::size_t i = ready[next];
    if (level[i] > kMostLevels) return too_deep(called);
    for (const std::size_t one : holds[i]) {
      level[one] = std::max(level[one], level[i] + 1);
      if (--holders[one] == 0) ready.push_back(one);
    }
  }
  return ready.size() == holds.size() ? "" : "its " + called + " hold each other; export it again";
}

}  // namespace mortise
