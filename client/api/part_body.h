#pragma once
#include <mortise/geometry.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/geometry/solid.h"
#include "common/io/mesh/mesh_import.h"
#include "common/session/world/scenario.h"

namespace mortise::api {

/// What parts of all names share. Immutable but for what is made when first asked for.
struct PartBody {
  mortise::Scenario::PartSpec spec;  ///< shape, stated features, what is assumed of its surfaces
  mortise::ImportReport report;
  mortise::SolidPtr solid;
  std::vector<std::string> notes;
  mutable std::once_flag once;
  mutable std::vector<Feature> features;
};

struct Part::Impl {
  std::string name;
  std::shared_ptr<const PartBody> body;
};

/// A part of an imported mesh. `spec`: its shape and what is stated of it.
Part part_of(mortise::ImportedMesh imported, mortise::Scenario::PartSpec spec,
             const std::string& name);

}  // namespace mortise::api
