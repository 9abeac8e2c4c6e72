#include "common/io/mesh/mesh_import.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "common/base/in_quotes.h"
#include "common/base/ranges.h"
#include "common/io/mesh/importer_process.h"
#include "common/io/mesh/mesh_clean.h"
#include "common/io/mesh/mesh_orient.h"
#include "common/io/mesh/topology_report.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 6> kReadable = {".stl", ".obj", ".ply", ".gltf", ".glb", ".dae"};
/// Shapes all the same, and refused with a reason of their own.
constexpr std::array<const char*, 5> kOther = {".3mf", ".step", ".stp", ".iges", ".igs"};

/// Two corners that are one in the drawing are no farther apart than this many times the rounding
/// of a coordinate: each is off by it in three directions, and a little for the sum.
constexpr double kTwins = 4.0;

/// Doubles that were worked out are off by more than their last digit; no drawing tells corners
/// apart that are one float. Share of the largest coordinate.
constexpr double kWorkedOut = 0x1p-25;

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
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::is_directory(status)) return "is a folder; name a mesh file in it";
  if (extension == ".yaml" || extension == ".yml") return "is a scenario, and a mesh is expected";
  if (extension == ".3mf")
    return "3MF is not read (its reader crashes on valid files); export STL, OBJ, PLY, glTF or DAE";
  if (extension == ".step" || extension == ".stp")
    return "STEP is no mesh: it is read whole, as the assembly of a scenario (assembly: " +
           file.filename().string() + "), or by mortise check";
  if (extension == ".iges" || extension == ".igs")
    return "IGES holds exact surfaces, no triangles; export STEP, or tessellate it (e.g. to STL)";
  if (std::find(kReadable.begin(), kReadable.end(), extension) == kReadable.end())
    return (extension.empty() ? "has no ending that says its format"
                              : "unknown format " + in_quotes(extension)) +
           "; known are .stl .obj .ply .gltf .glb .dae";
  if (!fs::exists(status))
    return "there is no such file; a scenario's paths start at the scenario, others here";
  if (!fs::is_regular_file(status)) return "this is not a regular file";
  const auto size = fs::file_size(file, error);
  if (error) return "it cannot be read: " + error.message();
  if (size == 0) return "the file is empty; export it again";
  return {};
}

/// The importer's own words for what it could not read, with advice.
std::string refusal_text(const std::string& words) {
  return words.find(';') != std::string::npos ? words
                                              : words + "; export the file again, or repair it";
}

double largest_coordinate(const std::vector<double>& coordinates) {
  double largest = 0.0;
  for (const double x : coordinates) largest = std::max(largest, std::abs(x));
  return largest;
}

/// Makes an inside of what is closed: faces between bodies go, shells that face inwards are turned.
void make_solid(TriangleMesh& mesh, ImportReport& report) {
  if (const std::uint64_t turned = align_neighbours(mesh); turned > 0)
    report.notes.push_back(std::to_string(turned) +
                           " triangles faced against their neighbours and were turned");
  if (const std::uint64_t inner = take_out_inner_faces(mesh); inner > 0)
    report.notes.push_back(std::to_string(inner) +
                           " triangles between bodies that share a face were dropped");
  const ShellsTurned turned = orient_shells(mesh);
  if (turned.filled > 0)
    report.notes.push_back(std::to_string(turned.filled) +
                           " shells within others face outwards like those: taken for material, "
                           "not for hollows");
  if (turned.turned == 0) return;
  report.flipped = turned.turned == turned.shells;
  if (report.flipped)
    report.notes.emplace_back("all triangles faced inwards and were turned");
  else
    report.notes.push_back(std::to_string(turned.turned) + " of " + std::to_string(turned.shells) +
                           " shells faced inwards and " + (turned.turned == 1 ? "was" : "were") +
                           " turned");
}

void note_findings(const RawSoup& soup, double unit_mm, ImportReport& report) {
  const auto note = [&](std::uint64_t count, const std::string& what) {
    if (count > 0) report.notes.push_back(std::to_string(count) + " " + what);
  };
  if (soup.stated_unit_mm > 0.0 && std::abs(soup.stated_unit_mm / unit_mm - 1.0) > 1e-6)
    report.notes.push_back("the file states a unit of " + number(soup.stated_unit_mm) +
                           " mm, the scenario " + number(unit_mm) + " mm; the scenario's is taken");
  if (!soup.note.empty()) report.notes.push_back(soup.note);
  note(report.degenerate_dropped, "triangles without area were dropped");
  note(report.duplicate_triangles - report.duplicates_dropped, "triangles occur twice");
  note(report.duplicates_dropped, "triangles that occur twice were dropped");
  note(report.points_and_lines_dropped, "points and lines were left out");
}

Result<ImportedMesh> made_of(const RawSoup& soup, const std::string& file, double unit_mm) {
  const double largest_mm = largest_coordinate(soup.coordinates) * unit_mm;
  if (largest_mm > kLongestInPart_mm)
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
  CleanMesh clean =
      weld(soup.coordinates, unit_mm,
           kTwins * std::max(soup.quantum, kWorkedOut * largest_coordinate(soup.coordinates)));
  imported.mesh = std::move(clean.mesh);
  report.degenerate_dropped = clean.degenerate_dropped;
  report.triangles_split = clean.triangles_split;
  report.duplicate_triangles = clean.duplicate_triangles;
  report.duplicates_dropped = clean.duplicates_dropped;
  report.quantum_mm += clean.moved_mm;
  if (clean.corners_moved > 0)
    report.notes.push_back(std::to_string(clean.corners_moved) +
                           " corners of open edges were up to " + number(1e3 * clean.moved_mm) +
                           " µm apart and were welded");
  if (!imported.mesh.triangles.empty()) make_solid(imported.mesh, report);
  report.points = imported.mesh.points_mm.size();
  report.triangles = imported.mesh.triangles.size();
  if (imported.mesh.triangles.empty())
    return fail(Code::kInvalidInput,
                file + ": no triangles are left (" + std::to_string(report.raw_triangles) +
                    " read, all without area; " + std::to_string(report.points_and_lines_dropped) +
                    " points and lines); export the part as a solid");
  note_topology(imported.mesh, report);
  note_findings(soup, unit_mm, report);
  return imported;
}

}  // namespace

bool is_mesh_name(const fs::path& file) {
  const std::string extension = lower_extension(file);
  const auto is = [&](const char* known) { return extension == known; };
  return std::any_of(kReadable.begin(), kReadable.end(), is) ||
         std::any_of(kOther.begin(), kOther.end(), is);
}

std::vector<std::string> notes_of(const ImportReport& report) {
  std::vector<std::string> notes = report.notes;
  if (!report.closed)
    notes.push_back("is open or not a manifold (" + std::to_string(report.boundary_edges) +
                    " boundary, " + std::to_string(report.non_manifold_edges) + " non-manifold, " +
                    std::to_string(report.misoriented_edges) +
                    " misoriented edges): crossing is found, depth is not; repair it for more "
                    "than potential");
  return notes;
}

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
    return fail(Code::kInvalidInput, file.string() + ": " + refusal_text(soup->refusal));
  return made_of(*soup, file.string(), unit_mm);
} catch (const std::exception& error) {  // memory of our own, names that are no paths
  return fail(Code::kRuntime, file.string() + ": cannot be imported: " + error.what());
}

Result<ImportedMesh> mesh_of_triangles(std::vector<double> coordinates_mm,
                                       const std::string& name) {
  RawSoup soup;
  soup.format = "triangles";
  soup.raw_vertices = coordinates_mm.size() / 3;
  soup.coordinates = std::move(coordinates_mm);
  return made_of(soup, name, 1.0);
}

}  // namespace mortise
