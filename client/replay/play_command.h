#pragma once
#include <filesystem>

#include "idl/dds_channel.h"

namespace mortise {

/// Plays a log to a live session (client/replay/play.h).
struct PlayCommand {
  std::filesystem::path log;
  DdsOptions network;
  double speed = 1.0, from_s = 0.0, to_s = 0.0, wait_s = 10.0;  ///< to_s 0: to the end
  bool json = false;
};
int run_play(const PlayCommand& command);

}  // namespace mortise
