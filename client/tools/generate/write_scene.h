#pragma once
#include <ostream>
#include <string>

#include "common/session/world/world.h"

namespace mortise {

/// All parts of a world at their poses as one Wavefront OBJ, mm, with a material a part;
/// `materials` is the MTL file, named material_file in the OBJ. For viewers: digits of floats.
void write_scene_obj(const World& world, const std::string& material_file, std::ostream& out,
                     std::ostream& materials);

}  // namespace mortise
