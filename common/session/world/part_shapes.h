#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/ids.h"
#include "common/base/shared_vector.h"
#include "common/geometry/feature.h"
#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"

namespace mortise {

struct StatedPart;  ///< io/scenario/scene_rules.h

/// A mesh, and what its surface is: as long as nobody has stated anything of it, or as a part of
/// which something was stated.
struct PartShape {
  SolidPtr solid;
  SharedVector<Feature> features;
  SurfaceBand band;
  std::shared_ptr<const StatedPart> stated = {};  ///< what was stated; null: nothing
  std::vector<std::string> notes = {};            ///< what people should know of it, one line each
};
using PartShapePtr = std::shared_ptr<const PartShape>;

/// Builds now what the first queries of the mesh and its surface would build, for so many threads
/// that judge. Any thread but those.
void build_derived(const PartShape& shape, int threads);

/// The meshes of which parts of a running session can be made. A mesh comes here before the
/// decision that names it: from the scenario, from an upload, or from a log.
class PartShapes {
 public:
  /// The shape of a mesh whose corners its file may have put off by so much. Pure, and slow for
  /// large meshes: a server calls it outside of its ticks. Any thread.
  using Make = std::function<PartShape(SolidPtr, double quantum_mm)>;

  explicit PartShapes(Make make) : make_(std::move(make)) {}
  const Make& make() const { return make_; }

  void add(SolidPtr solid, double quantum_mm);
  /// With its shape, made before.
  void add(const PartShapePtr& shape, double quantum_mm);

  struct Mesh {
    SolidPtr solid;  ///< null: no such mesh is here
    double quantum_mm = 0.0;
  };
  Mesh find(const std::string& mesh_hash) const;
  /// How exact a mesh that is here is: a log has it in the decisions alone.
  void note_quantum(const std::string& mesh_hash, double quantum_mm) {
    meshes_.at(mesh_hash).quantum_mm = quantum_mm;
  }
  const std::map<std::string, Mesh>& meshes() const { return meshes_; }  ///< by hash

  /// The shape, made now where it was not before; null: no such mesh is here.
  PartShapePtr shape(const std::string& mesh_hash, double quantum_mm);
  bool is_made(const std::string& mesh_hash, double quantum_mm) const {
    return shapes_.contains({mesh_hash, quantum_mm});
  }

  /// A part that takes other meshes, with what was stated of it so far.
  struct AsPart {
    PartId part;
    std::uint64_t said = 0;  ///< another number: something else was stated
    Make make;               ///< any thread, also after the part has changed
  };
  /// The same of a mesh as that part. One made for it is kept until something else is stated.
  PartShapePtr shape(const std::string& mesh_hash, const AsPart& as);
  bool is_made(const std::string& mesh_hash, const AsPart& as) const;
  void add(const PartShapePtr& shape, const AsPart& as);

 private:
  struct Taken {
    std::uint64_t said = 0;
    std::map<std::string, PartShapePtr> shapes;  ///< by mesh
  };
  Make make_;
  std::map<std::string, Mesh> meshes_;
  std::map<std::pair<std::string, double>, PartShapePtr> shapes_;
  std::map<PartId, Taken> taken_;
};

}  // namespace mortise
