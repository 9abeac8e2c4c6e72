#pragma once
#include <string>

namespace mortise::test {

/// A belt tensioner of 22 parts in which everything happens that a check tells apart: contacts, a
/// stated fit, a fit that is not stated, threads, inserts, a press fit, clearance holes, and one
/// bracket that really clashes (scenarios/tensioner.step).
bool write_tensioner(const std::string& file);

/// An arm of so many joints; each has the same drive of 14 parts, and a link of its own with many
/// holes.
bool write_arm(const std::string& file, int joints);

}  // namespace mortise::test
