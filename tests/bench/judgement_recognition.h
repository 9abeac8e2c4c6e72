#pragma once
#include <optional>
#include <vector>

#include "common/geometry/recognition/recognition.h"
#include "tests/bench/judgement_parts.h"

namespace mortise::bench {

/// How far a surface may be from the one that it should be: 0.1 um + 1e-6 R.
double recognition_bound_mm(const Surface& truth);

/// Largest distance of a recognized surface from places of the true one that the mesh's facets
/// stand for: their corners, moved onto the true surface. Infinite for another kind, or material
/// on the other side. Cylinders and spheres: and the difference of the radii.
double surface_error_mm(const TriangleMesh& mesh, const Feature& truth, const Surface& found);

/// The recognized feature that is the true one within the bound.
std::optional<std::size_t> find_feature(const Recognition& recognition, const TriangleMesh& mesh,
                                        const Feature& truth);

}  // namespace mortise::bench
