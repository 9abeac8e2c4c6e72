#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/math/types.h"

namespace mortise {

/// What scripted designers do in a session: a play to a scenario. As a file:
///   acts:
///     - user: anna
///       part: shaft
///       at: 1.5                       # seconds after the start; default: when the user's last act
///       ends steps:
///         - {by: [0, 0, -40], seconds: 2}                  # mm, world axes, at constant speed
///         - {rotate_deg: [0, 0, 90], seconds: 1}           # rotation vector about the part's
///         centre
///         - {seconds: 0.5}                                 # hold still
///       release: true                 # default; false keeps the part in hand
/// A user's acts are played in the order of the file.
struct Play {
  struct Step {
    Vec3 by_mm = Vec3::Zero();
    Vec3 rotate_rad = Vec3::Zero();
    double seconds = 0.0;
  };
  struct Act {
    std::string user, part;
    double at_s = 0.0;
    std::vector<Step> steps;
    bool release = true;
    int line = 0;
  };
  std::vector<Act> acts;

  std::vector<std::string> users() const;  ///< each once, in the order of the file
  double seconds() const;                  ///< until the last act of the last user ends
};

/// Strict: unknown keys, wrong types, times that are not positive are errors with file and line.
Result<Play> read_play(const std::filesystem::path& file);
Result<Play> read_play_text(std::string_view yaml, const std::string& name);

}  // namespace mortise
