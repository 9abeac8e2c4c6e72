#include "common/io/scenario/scene_meshes.h"

#include <filesystem>
#include <fstream>
#include <utility>

#include "common/generators/generators.h"
#include "common/io/mesh/topology_report.h"
#include "common/io/scenario/brought_part.h"

namespace mortise {
namespace {

Result<ImportedMesh> generated_mesh(const Scenario::PartSpec& part) {
  Result<GeneratedPart> generated = generate(part.mesh.generator, part.mesh.parameters);
  if (!generated) return generated.error();
  mirror_part(*generated, part.mesh.mirror);
  return with_report(std::move(generated->mesh), "generator " + part.mesh.generator, "generated");
}

ImportedMesh given_mesh(const GivenPart& given) {
  ImportedMesh imported = with_report(given.mesh, given.file, "STEP");
  imported.report.notes = given.notes;
  return imported;
}

// A part of a STEP file as a session saved it.
Result<ImportedMesh> brought_file(const std::filesystem::path& file,
                                  const Scenario::MeshSource& source) {
  // It is read as a whole. A mesh of kMostStepTriangles triangles and half as many points takes
  // 0.6 GB; three times that with its faces.
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{2} << 30;
  if (source.mirror != 0 || source.unit_mm != 1.0)
    return fail(Code::kInvalidInput, file.string() +
                                         ": states its faces in mm, as they lie; leave out mirror "
                                         "and scale, and write unit: mm");
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return fail(Code::kNotFound, file.string() + ": cannot be read: " + error.message());
  if (size > kMostBytes) return fail(Code::kLimit, file.string() + ": has more than 2 GB");
  std::vector<std::byte> bytes(size);
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) return fail(Code::kNotFound, file.string() + ": cannot be read");
  Result<TriangleMesh> mesh = brought_mesh(std::move(bytes));
  if (!mesh) return fail(mesh.error().code, file.string() + ": " + mesh.error().text);
  return with_report(std::move(mesh).value(), file.string(), "STEP");
}

}  // namespace

void mirror_part(GeneratedPart& part, unsigned axes) {
  if (axes == 0) return;
  const Vec3 sign(axes & 1U ? -1.0 : 1.0, axes & 2U ? -1.0 : 1.0, axes & 4U ? -1.0 : 1.0);
  for (Vec3& point : part.mesh.points_mm) point = point.cwiseProduct(sign);
  if (sign.prod() < 0.0)
    for (auto& triangle : part.mesh.triangles) std::swap(triangle[1], triangle[2]);
  for (Feature& feature : part.features) {
    feature.surface.point = feature.surface.point.cwiseProduct(sign);
    feature.surface.axis = feature.surface.axis.cwiseProduct(sign);
  }
}

MeshProvider default_meshes() {
  return [](const Scenario& scenario, const Scenario::PartSpec& part) -> Result<ImportedMesh> {
    if (part.mesh.given) return given_mesh(*part.mesh.given);
    if (!part.mesh.generator.empty()) return generated_mesh(part);
    const std::filesystem::path folder = std::filesystem::path(scenario.file).parent_path();
    if (part.mesh.file.ends_with(kBroughtEnding))
      return brought_file(folder / part.mesh.file, part.mesh);
    Result<ImportedMesh> imported = import_mesh(folder / part.mesh.file, part.mesh.unit_mm);
    if (!imported || part.mesh.mirror == 0) return imported;
    GeneratedPart mirrored{std::move(imported->mesh), {}};
    mirror_part(mirrored, part.mesh.mirror);
    imported->mesh = std::move(mirrored.mesh);
    return imported;
  };
}

}  // namespace mortise
