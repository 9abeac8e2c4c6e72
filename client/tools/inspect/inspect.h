#pragma once
#include <string>
#include <vector>

#include "common/geometry/recognition/recognition.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/report_json.h"
#include "common/session/world/scenario.h"

namespace mortise {

/// One mesh with what was recognized in it.
struct InspectedPart {
  Scenario::PartSpec spec;  ///< name, mesh file (from here, or absolute) or generator, pose, moving
  SolidPtr solid;
  ImportReport report;
  Recognition found;
  bool placed = false;  ///< by a scenario; else as it lies in its file
};

/// Mesh files, or the parts of one scenario file (.yaml). The first that cannot be read fails all.
Result<std::vector<InspectedPart>> inspect_files(const std::vector<std::string>& files,
                                                 double unit_mm);

/// For people: sizes, features, notes of the import.
std::string inspect_text(const std::vector<InspectedPart>& parts);
Json inspect_json(const std::vector<InspectedPart>& parts);

}  // namespace mortise
