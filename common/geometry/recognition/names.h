#pragma once
#include "common/geometry/recognition/recognition.h"

/// Private to recognition.
namespace mortise {

/// Sorts features and measures into the order that Recognition promises, and names them.
void name_features(Recognition& recognition);

}  // namespace mortise
