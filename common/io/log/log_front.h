#pragma once
#include <map>
#include <string>

#include "common/io/log/mcap_writer.h"
#include "common/io/log/session_log.h"

/// What a log needs before its first tick: which session, build and chain it is of, scenario and
/// meshes. It stands at the front of a file, and again at its end, since a single damaged byte
/// there would make all the rest useless.
namespace mortise::log_front {

using Values = std::map<std::string, std::string>;

void write(McapWriter& out, const LogHeader& header);
/// Metadata of a file have no checksum of their own: here they have one. Those of older logs have
/// none, and are whole.
bool is_whole(const Values& metadata);

}  // namespace mortise::log_front
