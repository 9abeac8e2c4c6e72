#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/mesh.h"

namespace mortise {

struct ImportLimits {
  double seconds = 60.0;                    ///< wall time of the child process
  std::uint64_t memory_bytes = 4ULL << 30;  ///< its address space
};

/// What was found in a file and what was corrected.
struct ImportReport {
  std::string file, format;
  std::uint64_t raw_vertices = 0, points = 0, raw_triangles = 0, triangles = 0;
  std::uint64_t degenerate_dropped = 0, duplicate_triangles = 0, points_and_lines_dropped = 0;
  std::uint64_t duplicates_dropped = 0;  ///< of the duplicate ones
  std::uint64_t triangles_split = 0;     ///< split so that no dropped triangle left an open edge
  std::uint64_t boundary_edges = 0, non_manifold_edges = 0, misoriented_edges = 0, components = 0;
  double volume_mm3 = 0.0;
  bool closed = false;   ///< every edge balances, positive volume
  bool flipped = false;  ///< all triangles faced inwards and were turned
  /// How far a corner may be off for the file: half an ulp of the largest coordinate, as floats, or
  /// half of its last digit where the file was written with six or seven, plus what its node
  /// transforms add and what was moved in welding.
  double quantum_mm = 0.0;
  /// What a designer should know, one line each; often empty. Told by every program that reads the
  /// mesh (scene_load makes findings of them), and to all clients of a session.
  std::vector<std::string> notes;
};

struct ImportedMesh {
  TriangleMesh mesh;
  ImportReport report;
};

/// What a designer should know of a mesh, one line each: its notes, and that it has no inside. Told
/// by every program that reads it (scene_load makes findings of them), and to all of a session.
std::vector<std::string> notes_of(const ImportReport& report);

/// Does the name end as that of a mesh or of another shape (STEP)? The file is not looked at.
bool is_mesh_name(const std::filesystem::path& file);

/// Reads STL, OBJ, PLY, glTF/GLB or DAE with assimp in a child process with limits, since a hostile
/// file can crash it. Node transforms applied, all meshes of the file joined, points welded by
/// exact position, degenerate triangles dropped and counted
/// (their neighbours split, so that nothing opens); duplicates are counted and stay.
/// unit_mm: mm per unit of the numbers in the file, the same for every format: a unit or up-axis
/// that the file states itself (DAE, glTF) is not applied; a note tells when it differs. 3MF and
/// STEP are refused. Thread safe. Never throws; the process lives, whatever the file.
Result<ImportedMesh> import_mesh(const std::filesystem::path& file, double unit_mm,
                                 const ImportLimits& limits = {});

/// The same of loose triangles that are in memory, nine finite coordinates each, in mm, none beyond
/// 10 km. `name`: for messages.
Result<ImportedMesh> mesh_of_triangles(std::vector<double> coordinates_mm, const std::string& name);

}  // namespace mortise
