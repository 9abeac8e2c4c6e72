#pragma once
#include <filesystem>

#include "client/report/report.h"

namespace mortise {

/// The clashes as issues: a new BCF 3.0 archive (buildingSMART), one topic a clash with its class
/// as label, review as status and comment, a camera on the place, both parts selected by name, and
/// where a picture was drawn as PNG a snapshot. Numbers of the format are in metres. The same log
/// gives the same GUIDs, so that a second import updates the first. The file must not exist.
Status write_bcf(const SessionReport& report, const SessionLog& log,
                 const std::filesystem::path& file);

}  // namespace mortise
