#pragma once
#include "client/report/pictures.h"
#include "client/report/session_tables.h"

namespace mortise {

/// Clashes by face of a part, with depth and place of the deepest in the part's frame (null where
/// the log does not contain the pose of the part).
Table by_face_table(const Table& clashes, const std::map<std::uint64_t, Touch>& touches);

/// Counts by class of the worst moments if the zone of every face were wider or narrower to each
/// side. Thresholds move by the zones of both faces, which is exact for faces with a surface and
/// parts that stay where they were; `replay whatif` computes the rest.
Table tolerance_table(const Table& clashes);

/// The class when zones are wider by `widening_mm` to each side; a zone never gets a negative
/// width. Names as in the table of clashes.
std::string class_when_widened(double overlap_lo_mm, double overlap_hi_mm, double fake_below_mm,
                               double real_above_mm, double widening_mm);

}  // namespace mortise
