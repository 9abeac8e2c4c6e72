#pragma once
#include "tests/stress/meshes.h"
#include "tests/stress/oracle.h"

namespace mortise::stress {

/// Two random shapes; B near the origin, A passes it, stops short of it or ends in it. Any path,
/// one mover or two, rotations from none to half a turn, accuracies 1e-2 ... 1e-9 mm, a quarter of
/// the cases with a minimum separation. The seed alone makes the case.
Case random_case(std::uint64_t seed);

/// The same kind of path between other poses.
Motion same_path(const Motion& like, const Pose& X_W0, const Pose& X_W1, const Vec3& reference_P);

/// All lengths times `factor`, accuracy and separation included.
Case scaled(const Case& c, double factor);
/// The whole scene moved by G.
Case moved(const Case& c, const Pose& G);
/// The mesh of A far from its own frame, the frame as far back: the part stays where it was.
Case with_far_mesh(const Case& c, const Vec3& away_mm);

}  // namespace mortise::stress
