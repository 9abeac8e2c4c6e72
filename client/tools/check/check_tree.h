#pragma once
#include <string>
#include <vector>

#include "client/report/session_tables.h"
#include "client/tools/check/check.h"

namespace mortise {

/// One part of the assembly as its file names and colours it.
struct TreeRow {
  std::string path, product;                     ///< '/' between the levels
  std::string colour;                            ///< "#rrggbb"; empty: the file gives none
  CollisionClass worst = CollisionClass::kNone;  ///< of what nothing explains
};

/// In the order of the parts; of a scenario without an assembly just the names.
std::vector<TreeRow> tree_of(const OpenedScene& opened, const CheckReport& report);

Table tree_table(const std::vector<TreeRow>& rows);

/// As nested lists of HTML, which fold.
std::string tree_section(const std::vector<TreeRow>& rows);

}  // namespace mortise
