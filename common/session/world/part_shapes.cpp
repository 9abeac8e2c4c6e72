#include "common/session/world/part_shapes.h"

#include "common/depth/depth.h"

namespace mortise {

void build_derived(const PartShape& shape, int threads) {
  const Solid& solid = *shape.solid;
  solid.bvh();
  solid.shells();
  solid.outline();
  (void)solid.inside_known();  // and with it topology and cracks
  make_body_ready(solid, shape.band, threads);
}

void PartShapes::add(SolidPtr solid, double quantum_mm) {
  const std::string hash = solid->hash();
  meshes_.try_emplace(hash, Mesh{std::move(solid), quantum_mm});
}

void PartShapes::add(const PartShapePtr& shape, double quantum_mm) {
  add(shape->solid, quantum_mm);
  shapes_.try_emplace({shape->solid->hash(), quantum_mm}, shape);
}

PartShapes::Mesh PartShapes::find(const std::string& mesh_hash) const {
  const auto found = meshes_.find(mesh_hash);
  return found == meshes_.end() ? Mesh{} : found->second;
}

PartShapePtr PartShapes::shape(const std::string& mesh_hash, double quantum_mm) {
  const auto mesh = meshes_.find(mesh_hash);
  if (mesh == meshes_.end()) return nullptr;
  mesh->second.quantum_mm = quantum_mm;
  PartShapePtr& shape = shapes_[{mesh_hash, quantum_mm}];
  if (!shape) shape = std::make_shared<const PartShape>(make_(mesh->second.solid, quantum_mm));
  return shape;
}

PartShapePtr PartShapes::shape(const std::string& mesh_hash, const AsPart& as) {
  const auto mesh = meshes_.find(mesh_hash);
  if (mesh == meshes_.end()) return nullptr;
  if (!is_made(mesh_hash, as))
    add(std::make_shared<const PartShape>(as.make(mesh->second.solid, mesh->second.quantum_mm)),
        as);
  return taken_.at(as.part).shapes.at(mesh_hash);
}

bool PartShapes::is_made(const std::string& mesh_hash, const AsPart& as) const {
  const auto taken = taken_.find(as.part);
  return taken != taken_.end() && taken->second.said == as.said &&
         taken->second.shapes.contains(mesh_hash);
}

void PartShapes::add(const PartShapePtr& shape, const AsPart& as) {
  Taken& taken = taken_[as.part];
  if (taken.said != as.said) taken = {as.said, {}};
  taken.shapes.insert_or_assign(shape->solid->hash(), shape);
}

}  // namespace mortise
