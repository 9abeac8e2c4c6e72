#include "common/io/mesh/mesh_import.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "common/geometry/topology.h"
#include "common/io/mesh/importer_process.h"
#include "common/io/mesh/mesh_clean.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 6> kReadable = {".stl", ".obj", ".ply", ".gltf", ".glb", ".dae"};

/// Ten kilometres: beyond it doubles resolve less than a nanometre in the engine's products, and no
/// part is so large; a wrong unit is.
constexpr double kLargestCoordinate_mm = 1e7;

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

/// Empty when the file may be given to the importer.
std::string objection(const fs::path& file, const std::string& extension, double unit_mm) {
  if (!std::isfinite(unit_mm) || unit_mm <= 0.0)
    return "the unit must be a positive number of mm, not " + number(unit_mm);
  if (extension == ".3mf")
    return "3MF is not read (its reader crashes on valid files); export STL, OBJ, PLY, glTF or DAE";
  if (extension == ".step" || extension == ".stp" || extension == ".iges" || extension == ".igs")
    return "STEP and IGES hold exact surfaces, no triangles; tessellate it in CAD (e.g. to STL)";
  if (std::find(kReadable.begin(), kReadable.end(), extension) == kReadable.end())
    return "unknown format '" + extension + "'; known are .stl .obj .ply .gltf .glb .dae";
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) return "there is no such file; paths are relative to the scenario";
  if (!fs::is_regular_file(status)) return "this is not a regular file";
  const auto size = fs::file_size(file, error);
  if (error) return "it cannot be read: " + error.message();
  if (size == 0) return "the file is empty; export it again";
  return {};
}

/// The importer's own words for what it could not read, with advice.
std::string refusal_text(const std::string& words, const ImportLimits& limits) {
  if (words.find("bad_alloc") != std::string::npos)
    return "reading it needs more than " + std::to_string(limits.memory_bytes >> 20U) +
           " MB of memory; the file is damaged, or raise the memory limit of the import";
  return words + "; export the file again, or repair it";
}

double largest_coordinate(const std::vector<double>& coordinates) {
  double largest = 0.0;
  for (const double x : coordinates) largest = std::max(largest, std::abs(x));
  return largest;
}

/// Turns all triangles when that makes the mesh a solid.
void orient(TriangleMesh& mesh, Topology& topology, ImportReport& report) {
  const bool tight = topology.boundary_edges == 0 && topology.non_manifold_edges == 0 &&
                     topology.misoriented_edges == 0;
  if (!tight || topology.volume_mm3 >= 0.0) return;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  topology.volume_mm3 = -topology.volume_mm3;
  report.flipped = true;
  report.notes.emplace_back("all triangles faced inwards and were turned");
}

void note_findings(const RawSoup& soup, double unit_mm, ImportReport& report) {
  const auto note = [&](std::uint64_t count, const std::string& what) {
    if (count > 0) report.notes.push_back(std::to_string(count) + " " + what);
  };
  if (soup.stated_unit_mm > 0.0 && std::abs(soup.stated_unit_mm / unit_mm - 1.0) > 1e-6)
    report.notes.push_back("the file states a unit of " + number(soup.stated_unit_mm) +
                           " mm, the scenario " + number(unit_mm) + " mm; the scenario's is taken");
  note(report.degenerate_dropped, "triangles without area were dropped");
  note(report.duplicate_triangles, "triangles occur twice");
  note(report.points_and_lines_dropped, "points and lines were left out");
  note(report.boundary_edges, "open edges: the part has no inside");
  note(report.non_manifold_edges, "edges of more than two triangles: the part has no inside");
  note(report.misoriented_edges, "edges between triangles that face opposite ways: no inside");
}

Result<ImportedMesh> made_of(const RawSoup& soup, const std::string& file, double unit_mm) {
  const double largest_mm = largest_coordinate(soup.coordinates) * unit_mm;
  if (largest_mm > kLargestCoordinate_mm)
    return fail(Code::kInvalidInput, file + ": a coordinate of " + number(largest_mm) +
                                         " mm lies beyond 10 km; check the unit of the mesh");
  ImportedMesh imported;
  ImportReport& report = imported.report;
  report.file = file;
  report.format = soup.format;
  report.raw_vertices = soup.raw_vertices;
  report.raw_triangles = soup.coordinates.size() / 9;
  report.points_and_lines_dropped = soup.points_and_lines;
  report.quantum_mm = soup.quantum * unit_mm;
  CleanMesh clean = weld(soup.coordinates, unit_mm);
  imported.mesh = std::move(clean.mesh);
  report.degenerate_dropped = clean.degenerate_dropped;
  report.triangles_split = clean.triangles_split;
  report.duplicate_triangles = clean.duplicate_triangles;
  report.points = imported.mesh.points_mm.size();
  report.triangles = imported.mesh.triangles.size();
  if (imported.mesh.triangles.empty())
    return fail(Code::kInvalidInput,
                file + ": no triangles are left (" + std::to_string(report.raw_triangles) +
                    " read, all without area; " + std::to_string(report.points_and_lines_dropped) +
                    " points and lines); export the part as a solid");
  Topology topology = build_topology(imported.mesh);
  orient(imported.mesh, topology, report);
  report.boundary_edges = topology.boundary_edges;
  report.non_manifold_edges = topology.non_manifold_edges;
  report.misoriented_edges = topology.misoriented_edges;
  report.components = topology.components;
  report.volume_mm3 = topology.volume_mm3;
  report.closed = topology.closed();
  note_findings(soup, unit_mm, report);
  return imported;
}

}  // namespace

Result<ImportedMesh> import_mesh(const fs::path& file, double unit_mm,
                                 const ImportLimits& limits) try {
  const std::string extension = lower_extension(file);
  if (const std::string no = objection(file, extension, unit_mm); !no.empty()) {
    std::error_code ignored;
    const Code code = fs::exists(file, ignored) ? Code::kInvalidInput : Code::kNotFound;
    return fail(code, file.string() + ": " + no);
  }
  Result<RawSoup> soup = run_importer(file, extension, limits);
  if (!soup) return fail(soup.error().code, file.string() + ": " + soup.error().text);
  if (!soup->refusal.empty())
    return fail(Code::kInvalidInput, file.string() + ": " + refusal_text(soup->refusal, limits));
  return made_of(*soup, file.string(), unit_mm);
} catch (const std::exception& error) {  // memory of our own, names that are no paths
  return fail(Code::kRuntime, file.string() + ": cannot be imported: " + error.what());
}

}  // namespace mortise
