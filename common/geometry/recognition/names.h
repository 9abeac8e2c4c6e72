#pragma once
#include "common/geometry/recognition/recognition.h"

namespace mortise {

/// The word that names of features of this surface begin with: "bore", "shaft", "cone", "sphere",
/// "torus" or "plane".
std::string stem_of(const Surface& surface);

/// Private to recognition: sorts features and measures into the order that Recognition promises,
/// and names them.
void name_features(Recognition& recognition);

}  // namespace mortise
