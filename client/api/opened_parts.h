#pragma once
#include <mortise/geometry.h>

#include <string>
#include <vector>

#include "common/io/scenario/open_scene.h"

namespace mortise::api {

/// A part with its place and name in a scene.
struct PlacedBody {
  Part part;
  std::string name;
  mortise::Pose X_WP;
  bool moving = true;
};

/// What is said of pairs, in the words of a scenario.
struct PairSayings {
  struct Fit {
    std::size_t a = 0, b = 0;  ///< of the parts
    std::string feature_a, feature_b, code;
  };
  struct Exclusion {
    std::size_t a = 0, b = 0;
    std::string reason;
  };
  std::vector<Fit> fits;
  std::vector<Exclusion> exclusions;
};

/// A scene of parts that are in memory, read as a scenario of their files would be: so both give
/// the same bits. Fails with the first finding that is an error.
mortise::Result<mortise::OpenedScene> open_parts(const std::vector<PlacedBody>& parts,
                                                 const PairSayings& sayings);

/// "pin", "pin_2": a name that is not among those taken.
std::string unlike(const std::string& name, const std::vector<PlacedBody>& taken);

}  // namespace mortise::api
