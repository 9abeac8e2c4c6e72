#pragma once
#include <string>

#include "common/session/world/part_shapes.h"
#include "common/session/world/world.h"

namespace mortise {

/// A part takes another mesh (README, section 7).

/// The mesh as this part; null: it is not here. Made now where it was not before, which is slow for
/// large meshes.
PartShapePtr shape_as(const World& world, const Part& part, const std::string& mesh_hash);
/// Is it here, and made?
bool is_made_as(const World& world, const Part& part, const std::string& mesh_hash);
/// What makes a mesh this part.
PartShapes::AsPart as_part(const World& world, const Part& part);

/// What becomes of faces and statements if the part takes this shape: which are as before, gone,
/// new. One sentence, for people; empty where there are none.
std::string told_of_revision(const World& world, const Part& part, const PartShape& shape);

/// The part takes the shape: fits, tolerances and constraints follow their faces. Of the state only
/// what depends on the mesh is dropped; see take_form().
void revise(World& world, Part& part, const PartShape& shape, const Decision& by);

}  // namespace mortise
