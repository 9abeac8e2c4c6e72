#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "client/report/circumstances.h"
#include "client/report/session_tables.h"
#include "common/io/log/session_log_read.h"

namespace mortise {

/// The number of pictures of a page, worst first. What is left out is counted.
struct PictureLimits {
  std::size_t clashes = 60, parts = 24;
  bool png = false;  ///< each clash as PNG as well
};

/// The place of a clash in its worst moment, as a point of either part; part frames, mm.
struct Touch {
  Vec3 p_A = Vec3::Zero(), p_B = Vec3::Zero();
  double size_mm = 0.0;  ///< radius of the smaller part
};

struct PartPicture {
  std::string part;
  std::string png;
  double deepest_mm = 0.0;
  std::size_t clashes = 0;
};

struct Pictures {
  std::map<std::uint64_t, std::string> of_clash;  ///< section as SVG, by clash
  std::map<std::uint64_t, std::string> png_of_clash;
  std::vector<PartPicture> of_part;                      ///< by class, then overlap
  std::map<std::uint64_t, Touch> touches;                ///< by clash; all of them
  std::map<std::uint64_t, Circumstances> circumstances;  ///< likewise
  std::size_t clashes_left_out = 0, parts_left_out = 0;
  std::string missing;  ///< why there are no pictures, or empty
};

/// Draws the worst moments of the table of clashes. Poses are those of the log, not computed again
/// (client/report/moments.h). Costs loading the scene, one pass, and the drawing. `on_progress`
/// gets the share that is done, 0 to 1.
Pictures pictures_of(const SessionLog& log, const Table& clashes, const PictureLimits& limits,
                     const std::function<void(double share)>& on_progress = {});

}  // namespace mortise
