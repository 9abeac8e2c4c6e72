#pragma once
#include "tests/stress/meshes.h"
#include "tests/stress/oracle.h"

namespace mortise::stress {

/// Two random shapes; B near the origin, A passes it, stops short of it or ends in it. Any path,
/// one mover or two, rotations from none to half a turn, accuracies 1e-2 ... 1e-9 mm, a quarter of
/// the cases with a minimum separation. The seed alone makes the case.
Case random_case(std::uint64_t seed);

double uniform(std::mt19937_64& random, double lo, double hi);

}  // namespace mortise::stress
