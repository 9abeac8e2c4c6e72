#pragma once
#include <span>

#include "common/io/log/session_log_read.h"

namespace mortise {

/// The files of a session in their order: `file` and those that continue it in the same folder. Of
/// two files that continue the same one, the one whose name is later. Reads only the heads of
/// files, where these are whole.
std::vector<std::filesystem::path> chain_from(const std::filesystem::path& file);

/// Several files of one session as one log, each continuing the previous one. Ticks of a file
/// beyond the beginning of the next are left out; ticks in no file are a gap. A single file brings
/// its chain with it. Fails when the files are not of one session, in order.
Result<SessionLog> read_session(std::span<const std::filesystem::path> files,
                                const LogReading& reading = {});
Result<SessionLog> read_session(const std::filesystem::path& file, const LogReading& reading = {});

}  // namespace mortise
