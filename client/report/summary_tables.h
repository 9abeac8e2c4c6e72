#pragma once
#include "client/report/pictures.h"
#include "client/report/session_tables.h"

namespace mortise {

/// How deep, and where: clashes by face of a part, with the place of the deepest in the part's
/// frame (null where the log does not say where the part was).
Table by_face_table(const Table& clashes, const std::map<std::uint64_t, Touch>& touches);

/// What the worst moments would be called if the zone of every face were wider or narrower by so
/// much to each side: counts by class. Thresholds move by the zones of both faces, which is exact
/// for faces with a surface and parts that stay where they were; whatif computes the rest.
Table tolerance_table(const Table& clashes);

/// Moves both thresholds for zones that are wider by `widening_mm` to each side; zones that would
/// be less than nothing are nothing. Names as in the table of clashes.
std::string class_when_widened(double overlap_lo_mm, double overlap_hi_mm, double fake_below_mm,
                               double real_above_mm, double widening_mm);

}  // namespace mortise
