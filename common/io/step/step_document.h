#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/feature.h"
#include "common/geometry/mesh.h"
#include "common/math/interval.h"
#include "common/math/pose.h"

namespace mortise {

/// How the surface of a face of a STEP file is known.
enum class StepFaceGrade : std::uint8_t {
  kUnknown = 0,     ///< freeform, and its mesh could not be measured
  kExact = 1,       ///< the file states a plane, cylinder, cone, sphere or torus
  kRecognized = 2,  ///< a freeform surface that is one of these, checked on a grid
  kMeasured = 3,    ///< freeform; the deviation of its mesh was sampled
};

/// One face of a part. Part frame, mm.
struct StepFace {
  StepFaceGrade grade = StepFaceGrade::kUnknown;
  Surface surface;           ///< kind kUnknown: freeform
  double residual_mm = 0.0;  ///< largest distance of a corner of its mesh from `surface`
  /// Of a freeform face: true surface minus mesh, outward positive, as sampled; wider than what was
  /// seen by the share that samples may miss.
  Interval deviation_mm;
};

/// One distinct product of the file: its solids, tessellated and joined by topology.
struct StepPart {
  std::string name;
  TriangleMesh mesh;
  std::vector<std::uint32_t> face_of_triangle;  ///< indices of `faces`
  std::vector<StepFace> faces;
  double volume_mm3 = 0.0;  ///< of the exact solids
  std::uint32_t solids = 0;
  std::uint32_t open_edges = 0;      ///< edges of the mesh that do not balance
  std::uint32_t untriangulated = 0;  ///< faces without triangles
  std::uint32_t loose_faces = 0;     ///< faces of the product that bound no solid: left out
  bool mirrored = false;
};

inline constexpr std::uint32_t kNoColour = 0xffff'ffff;

/// One place of a part in the tree.
struct StepInstance {
  std::string path;      ///< names of the instances from the root, '/' between; unique
  std::string products;  ///< names of the products on the same way
  std::uint32_t part = 0;
  Pose X_WP;
  std::uint32_t colour = kNoColour;  ///< 0xRRGGBB
};

struct StepFaceRef {
  std::uint32_t part = 0, face = 0;
  friend bool operator==(const StepFaceRef&, const StepFaceRef&) = default;
};

/// One statement of the product's manufacturing information (PMI). A number that the file does not
/// give is NaN. mm; angles in degrees.
struct StepStatement {
  enum class Kind : std::uint8_t { kUnknown = 0, kSize, kDistance, kAngle, kGeometric, kDatum };
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Kind kind = Kind::kUnknown;
  std::uint32_t entity = 0;  ///< its number in the file, the 12 of "#12="
  std::string name;          ///< "diameter", "position", ...
  double value = kNone;
  double upper = kNone, lower = kNone;              ///< deviations, as signed in the file
  double limit_upper = kNone, limit_lower = kNone;  ///< limits of size
  double outside = kNone;                           ///< of a profile: what of it is outside (U)
  std::string code;                                 ///< ISO class, "H7"; empty: none
  std::string modifiers;                            ///< "maximum_material_requirement", ...
  std::vector<StepFaceRef> faces, other_faces;      ///< of which it speaks; of a distance both ends
  std::uint32_t faces_lost = 0;  ///< named by the file, but not among the faces of the parts
};

/// What the importer says of a file: a refusal, or the assembly.
struct StepDocument {
  std::string refusal;  ///< not empty: nothing else is set
  std::vector<StepPart> parts;
  std::vector<StepInstance> instances;
  std::vector<StepStatement> statements;
  std::vector<std::string> not_solid;  ///< paths of instances without a solid: left out
  std::vector<std::string> notes;      ///< what was left out or found strange, one line each
};

/// Most of each, so that a hostile file ends in a refusal and not in a full memory.
inline constexpr std::uint64_t kMostStepInstances = 100'000, kMostStepTriangles = 20'000'000;

/// The bytes that the importer sends, and that a session log keeps.
std::vector<std::byte> encode(const StepDocument& document);

/// Do the bytes begin as those of a document?
bool is_step_document(std::span<const std::byte> bytes);

/// The file may have taken over the sender: every length, index and number is checked.
Result<StepDocument> decode_step(std::span<const std::byte> bytes);

/// What the importer is asked of two of its parts at a relative pose, and its answer: the volume
/// that their exact solids have in common, and how thick it is: 2 V / F of a piece of it with the
/// surface F, the largest of all pieces. A negative volume: the operation failed, was ended, or
/// came too late.
struct StepCommonQuery {
  std::uint32_t part_a = 0, part_b = 0;
  Pose X_AB;
};
struct StepCommon {
  double volume_mm3 = -1.0, thickness_mm = 0.0;
};
/// Of all operations for one list of queries.
inline constexpr unsigned kCommons_s = 15;
std::vector<std::byte> encode(std::span<const StepCommonQuery> queries);
Result<std::vector<StepCommonQuery>> decode_step_queries(std::span<const std::byte> bytes);
std::vector<std::byte> encode(std::span<const StepCommon> answers);
Result<std::vector<StepCommon>> decode_step_commons(std::span<const std::byte> bytes);

}  // namespace mortise
