#pragma once
#include <string>
#include <vector>

#include "client/report/session_tables.h"

namespace mortise {

/// The clashes of one pair of parts, as rows of the table of clashes. The worst leads: by class,
/// then by how far beyond its threshold, how probable (behind these by depth, where that is not
/// known), or how near to its threshold.
struct PairGroup {
  std::size_t lead = 0;
  std::vector<std::size_t> others;  ///< worst first
  std::size_t places = 0;           ///< of the others, those beside the lead at the same time
  std::size_t times() const { return others.size() - places; }  ///< those before or after it
};

/// Worst first. O(n log n) in rows.
std::vector<PairGroup> pair_groups(const Table& clashes);

/// "+7 places, +2 times"; nothing where the lead is alone.
std::string also_text(const PairGroup& group);

}  // namespace mortise
