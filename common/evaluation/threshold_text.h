#pragma once
#include <string>

#include "common/messages/verdict.h"

namespace mortise {

/// The thresholds on the overlap to read; one below zero is a gap: "fake up to 51.7 µm", "fake from
/// a gap of 3.0 µm".
std::string fake_text(double fake_below_mm);
std::string real_text(double real_above_mm);

/// "P(interference) 31.4 %", "P(interference) 5.82 to 6.31 %" where it is not known to its digits,
/// "P(interference) below 0.01 %". p within [0, 1].
std::string probability_text(Interval p);

/// Is the threshold known, or only a bracket that was left open when the class was decided? Known
/// is what the explaining sentence tells, and zero.
bool states_fake(const std::string& explanation, double fake_below_mm);
bool states_real(const std::string& explanation, double real_above_mm);
inline bool states_fake(const Verdict& v) { return states_fake(v.explanation, v.fake_below_mm); }
inline bool states_real(const Verdict& v) { return states_real(v.explanation, v.real_above_mm); }

}  // namespace mortise
