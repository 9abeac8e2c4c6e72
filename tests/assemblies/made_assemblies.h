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

/// Six pairs of parts with faces of every kind, one in the other or on it: of the same size, too
/// large, with clearance.
bool write_random(const std::string& file, int seed);

/// What files from elsewhere have: odd names, a name twice, two solids in a product, an open shell,
/// an edge, an empty assembly. `unit`: of the file, "MM", "INCH" or "M".
bool write_odd(const std::string& file, const std::string& unit);

}  // namespace mortise::test
