#pragma once
#include <string>

#include "common/math/interval.h"

namespace mortise {

/// A length to read: "48.2 µm" below 1 mm, else "11.286 mm"; "unbounded" when it is not finite.
std::string length_text(double mm);

/// A bracket to read: "48.2 to 50.1 µm", one length where both ends read alike or are as near as
/// depth refines them, "at least 48.2 µm" without a finite upper end.
std::string range_text(Interval mm);

/// Less than what length_text() can show?
bool reads_as_zero(double mm);

}  // namespace mortise
