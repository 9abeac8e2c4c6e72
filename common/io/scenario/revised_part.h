#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/same_face.h"
#include "common/io/scenario/scene_rules.h"
#include "common/session/world/part_shapes.h"

/// A part of a running session whose mesh is replaced: what was stated of it goes over to the new
/// mesh, face by face. Private to scene_load.
namespace mortise {

/// What holds of a part whichever mesh it has: all that was ever stated of it, and each face that
/// ever had a name.
struct PartMemory {
  struct Face : SoughtFace {
    FeatureOrigin origin = FeatureOrigin::kRecognized;
  };
  /// The mesh with which the part began. What is known of it cannot be found again in a mesh alone:
  /// the surfaces of a generator, of an exact file.
  struct First {
    std::string mesh;
    SharedVector<Feature> features;
    SurfaceBand band;
    std::vector<Scenario::FeatureSpec> declared;  ///< what was stated then
  };
  std::shared_ptr<const First> first;
  std::map<std::string, Face> faces;
  std::vector<Scenario::FeatureSpec> declared;  ///< with what is stated of them; by name
  PlacedStatement rest;
  std::optional<double> chord_error_mm;
  UndeclaredSurface undeclared = UndeclaredSurface::kNominal;
};

/// Adds what the part has and what is stated of it now.
void remember(PartMemory& memory, const Part& part, const StatedPart& stated);

/// The mesh as that part. Where its file states its faces, those are its faces: one that the part
/// had before keeps its name, and what people said of it; of the others, and of faces of which
/// nobody said anything, holds what the file says. Of any other mesh: a declared face is found by
/// its surface, a recognized one by what is recognized; what is found keeps its name, and no other
/// face gets it. Statements about the others wait in the memory. Pure; as slow as the recognition.
PartShape revised(const PartMemory& memory, SolidPtr solid, double quantum_mm);

}  // namespace mortise
