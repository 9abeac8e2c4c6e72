#pragma once
#include <string>
#include <vector>

#include "common/geometry/recognition/recognition.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/report_json.h"
#include "common/math/pose.h"

namespace mortise {

/// One mesh with what was recognized in it.
struct InspectedPart {
  std::string name, file, unit;
  SolidPtr solid;
  ImportReport report;
  Recognition found;
  Pose X_WP;
  bool placed = false;  ///< X_WP is known: from a scenario
};

/// Mesh files, or the parts of one scenario file (.yaml). The first that cannot be read fails all.
Result<std::vector<InspectedPart>> inspect_files(const std::vector<std::string>& files,
                                                 const std::string& unit, double unit_mm);

std::string inspect_text(const std::vector<InspectedPart>& parts);
Json inspect_json(const std::vector<InspectedPart>& parts);

}  // namespace mortise
