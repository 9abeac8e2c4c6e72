#pragma once
#include <string>

#include "common/messages/verdict.h"

namespace mortise {

/// The overlap of the meshes as the explaining sentence tells it, mm: of a bracket that was left
/// open the end that decided. Negative for a gap.
double told_overlap_mm(const Verdict& verdict);

/// "overlap 48.2 µm", "overlap at least 253.7 µm", "apart 3.0 µm".
std::string told_overlap_text(const Verdict& verdict);

}  // namespace mortise
