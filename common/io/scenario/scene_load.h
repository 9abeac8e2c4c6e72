#pragma once
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/io/scenario/scenario_file.h"
#include "common/io/scenario/scene_meshes.h"
#include "common/session/world/part_shapes.h"
#include "common/session/world/world.h"

namespace mortise {

/// A scenario made ready: meshes loaded once per distinct content, features matched to triangles
/// and checked, tolerances and fits resolved to offsets.
struct LoadedScene {
  World world;
  std::vector<ImportReport> imports;      ///< one per part spec
  std::vector<std::string> mesh_of_part;  ///< hash of the mesh with which each part spec begins
  std::vector<Finding> findings;          ///< errors: the scene must not be played
  struct ResolvedTolerance {
    std::string part, feature, source;
    Interval offset_mm;
    DeviationGrade grade;
    Interval deviation_mm;
    double residual_mm = 0.0;
  };
  std::vector<ResolvedTolerance> tolerances;
  struct ResolvedFit {
    std::string part_a, feature_a, part_b, feature_b, code;
    double nominal_mm = 0.0;
    Interval clearance_mm;  ///< diametral, of all statements about both faces: see `tighter`
    /// Other statements that are tighter than the fit, for each end: "plate.bore: ±0.005 mm".
    std::vector<std::string> tighter;
  };
  std::vector<ResolvedFit> fits;
  /// Clearances that pairs must keep, instead of that of the scenario.
  std::map<std::pair<PartId, PartId>, double> min_gaps_mm;
  /// What the importer said of the assembly of the scenario; null: it has none.
  std::shared_ptr<const std::vector<std::byte>> assembly;
  bool usable() const;
};

/// A mesh of which the scenario says nothing, as a part of it: with the surfaces that it shows,
/// where the scenario takes them.
PartShape shape_of(SolidPtr solid, double quantum_mm, UndeclaredSurface undeclared);

Result<LoadedScene> load_scene(const Scenario& scenario, const MeshProvider& meshes);

}  // namespace mortise
