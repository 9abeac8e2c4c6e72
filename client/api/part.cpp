#include <algorithm>
#include <cmath>

#include "client/api/convert.h"
#include "client/api/part_body.h"
#include "common/base/ranges.h"
#include "common/generators/generators.h"
#include "common/geometry/recognition/recognized.h"
#include "common/geometry/topology.h"
#include "common/io/build_info.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/scenario/scene_meshes.h"
#include "common/messages/names.h"

namespace mortise::api {
namespace {

Feature feature_of(const mortise::Feature& f) {
  return {f.name,
          std::string(name_of(f.surface.kind)),
          f.surface.point,
          f.surface.axis,
          f.surface.radius_mm,
          f.surface.tube_radius_mm,
          f.surface.half_angle_rad,
          f.surface.inward,
          f.residual_mm};
}

// Those of the file or the generator, and what is recognized beside them.
std::vector<Feature> features_of(const PartBody& body) {
  std::vector<Feature> features;
  if (body.spec.mesh.given) {
    for (const mortise::Feature& f : body.spec.mesh.given->features)
      features.push_back(feature_of(f));
    return features;
  }
  if (!body.spec.mesh.generator.empty())
    if (const auto generated =
            mortise::generate(body.spec.mesh.generator, body.spec.mesh.parameters))
      for (const mortise::Feature& f : generated->features) features.push_back(feature_of(f));
  const auto found = mortise::recognized(*body.solid, {.quantum_mm = body.report.quantum_mm});
  for (const mortise::Feature& f : found->features) features.push_back(feature_of(f));
  return features;
}

}  // namespace

Part part_of(mortise::ImportedMesh imported, mortise::Scenario::PartSpec spec,
             const std::string& name) {
  auto body = std::make_shared<PartBody>();
  body->spec = std::move(spec);
  body->report = std::move(imported.report);
  body->notes = mortise::notes_of(body->report);
  body->solid = std::make_shared<const mortise::Solid>(std::move(imported.mesh));
  return Part(std::make_shared<const Part::Impl>(Part::Impl{name, std::move(body)}));
}

Part::Part(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

Result<Part> Part::from_mesh(const Mesh& mesh, const std::string& name) {
  const auto bad = [&](const std::string& what) {
    return Error{Code::kInvalidInput, "part " + name + ": " + what};
  };
  for (std::size_t i = 0; i < mesh.points_mm.size(); ++i)
    if (!is_within(mesh.points_mm[i], kLongestInPart_mm))
      return bad("point " + std::to_string(i) +
                 " is not finite or lies beyond 10 km; check the unit");
  std::vector<double> coordinates;
  coordinates.reserve(9 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t corner : mesh.triangles[t]) {
      if (corner >= mesh.points_mm.size())
        return bad("triangle " + std::to_string(t) + " names point " + std::to_string(corner) +
                   " of " + std::to_string(mesh.points_mm.size()));
      const Vec3& x = mesh.points_mm[corner];
      coordinates.insert(coordinates.end(), {x.x(), x.y(), x.z()});
    }
  mortise::Result<mortise::ImportedMesh> imported =
      mortise::mesh_of_triangles(std::move(coordinates), "part " + name);
  if (!imported) return error_of(imported.error());
  mortise::Scenario::PartSpec spec;
  spec.undeclared = mortise::UndeclaredSurface::kRecognized;
  return part_of(std::move(*imported), std::move(spec), mortise::part_name_of(name));
}

Result<Part> Part::generate(const std::string& generator,
                            const std::map<std::string, double>& parameters,
                            const std::string& name) {
  mortise::Scenario::PartSpec spec;
  spec.mesh.generator = generator;
  spec.mesh.parameters = parameters;
  spec.undeclared = mortise::UndeclaredSurface::kRecognized;
  mortise::Result<mortise::ImportedMesh> mesh = mortise::default_meshes()({}, spec);
  if (!mesh) return error_of(mesh.error());
  return part_of(std::move(*mesh), std::move(spec), mortise::part_name_of(name));
}

const std::string& Part::name() const { return impl_->name; }

Part Part::named(const std::string& name) const {
  return Part(std::make_shared<const Impl>(Impl{mortise::part_name_of(name), impl_->body}));
}

std::size_t Part::triangle_count() const { return impl_->body->solid->mesh().triangles.size(); }

Mesh Part::mesh() const {
  const mortise::TriangleMesh& mesh = impl_->body->solid->mesh();
  return {mesh.points_mm, mesh.triangles};
}

double Part::volume_mm3() const { return impl_->body->solid->topology().volume_mm3; }
bool Part::has_inside() const { return impl_->body->solid->has_inside(); }
std::string Part::hash() const { return impl_->body->solid->hash(); }
const std::vector<std::string>& Part::notes() const { return impl_->body->notes; }

const std::vector<Feature>& Part::features() const {
  const PartBody& body = *impl_->body;
  std::call_once(body.once, [&] { body.features = features_of(body); });
  return body.features;
}

std::string version() { return mortise::engine_version(); }

}  // namespace mortise::api
