#pragma once
#include <string>

#include "common/io/scenario/scene_load.h"

namespace mortise::test {

/// Text of the first finding that makes a scene unusable; "" when there is none.
inline std::string first_error(const LoadedScene& scene) {
  for (const Finding& f : scene.findings)
    if (f.is_error) return f.text;
  return "";
}

}  // namespace mortise::test
