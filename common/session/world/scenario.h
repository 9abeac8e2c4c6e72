#pragma once
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/evaluation/tolerance.h"
#include "common/geometry/feature.h"
#include "common/geometry/given_part.h"
#include "common/math/pose.h"
#include "common/messages/role.h"

namespace mortise {

/// The line of a statement in its file, for messages; 0 when it was made in code.
struct SourceLine {
  int line = 0;
};

/// What happens to a part at a real contact: it stops there (stop), the rest of its increment goes
/// along the contact (slide), or the contact is only reported (report).
enum class Policy : std::uint8_t { kUnknown = 0, kStop, kReport, kSlide };

constexpr std::string_view name_of(Policy policy) {
  if (policy == Policy::kStop) return "stop";
  if (policy == Policy::kReport) return "report";
  return policy == Policy::kSlide ? "slide" : "unknown";
}
/// Nothing for an unknown name.
constexpr std::optional<Policy> policy_named(std::string_view name) {
  for (const Policy policy : {Policy::kStop, Policy::kReport, Policy::kSlide})
    if (name_of(policy) == name) return policy;
  return std::nullopt;
}
/// Does the policy keep parts out of real collisions?
constexpr bool holds_back(Policy policy) {
  return policy == Policy::kStop || policy == Policy::kSlide;
}

/// All policies, for messages.
inline constexpr std::string_view kPolicyNames = "stop, slide or report";

/// What a user may change while the session runs.
enum class Right : std::uint8_t {
  kUnknown = 0,
  kPolicy,
  kTolerance,
  kExclusions,
  kReview,
  kParts,  ///< which parts there are, what they are made of, which of them move
};

/// "policy", "tolerance", "exclusions", "review", "parts".
std::string_view name_of(Right value);
std::optional<Right> right_named(std::string_view name);

/// A part, or a feature, may be called so: "part.feature" and patterns stay unambiguous.
bool is_part_name(std::string_view name);

/// What is assumed about surfaces without a declaration.
enum class UndeclaredSurface : std::uint8_t {
  kNominal = 0,  ///< the mesh is taken for the surface
  kRecognized,   ///< planes, cylinders, cones, spheres and tori found in the mesh, rest by estimate
  kEstimated,    ///< the same
};

/// A scenario as it is written, in mm and rad; read from YAML by io/scenario/scenario_file, or made
/// in code.
struct Scenario {
  struct MeshSource {
    std::string file;                          ///< relative to the scenario; empty when generated
    double unit_mm = 1.0;                      ///< mm per file unit, times scale
    unsigned mirror = 0;                       ///< bit 0, 1, 2: x, y, z are negated in the part
    std::string generator;                     ///< e.g. "shaft"; empty when from a file
    std::map<std::string, double> parameters;  ///< of the generator, mm, rad or counts
    std::shared_ptr<const GivenPart> given;    ///< of an assembly; then nothing above is set
    std::uint32_t given_number = 0;            ///< of `given` among the parts of the assembly
  };
  struct Tolerance {     ///< outward offset of the surface
    Interval offset_mm;  ///< [-t, +t] for +-t; profile zone: [-t/2, t/2], unequal allowed
    std::string text;    ///< as written
    SourceLine at = {};
  };
  /// Who states something of a face.
  enum class SaidBy : std::uint8_t {
    kScenario = 0,  ///< or nobody
    kFile,          ///< the CAD file of the part itself
    kSession,       ///< somebody in the running session
  };
  struct FeatureSpec {
    std::string name;
    Surface surface;  ///< part frame; kind kUnknown: the generator's feature of this name
    std::optional<Interval> along_mm;  ///< extent along the axis from `point`; none: unbounded
    std::optional<Tolerance> tolerance;
    std::string iso_class;    ///< "H7" or "g6"; empty when none
    double nominal_mm = 0.0;  ///< nominal diameter of iso_class; 0: twice the radius
    std::string width_to;     ///< the other plane of a width under iso_class; empty when none
    Position position = {};   ///< of its axis or centre; zone 0: none stated
    SourceLine at;
    SaidBy by = SaidBy::kScenario;
  };
  struct PartSpec {
    std::string name;
    MeshSource mesh;
    Pose X_WP;
    bool moving = false;
    std::optional<double> chord_error_mm;  ///< declared largest mesh error
    UndeclaredSurface undeclared = UndeclaredSurface::kNominal;
    std::optional<Tolerance> tolerance;  ///< of every face without its own
    std::vector<FeatureSpec> features;
    SourceLine at;
    std::string products;  ///< of an assembly: the products on the way from the root, '/' between
    bool bought = false;   ///< of an assembly: in a sub-assembly that is bought as it is
  };
  /// A face by its geometry, never by a number: so a statement survives another export. In the
  /// frame of its part; what is not said may be anything.
  struct FaceAddress {
    SurfaceKind kind = SurfaceKind::kUnknown;
    double radius_mm = 0.0;
    std::optional<bool> inward;
    std::optional<Vec3> axis;   ///< of either direction; of a plane its outward normal
    std::optional<Vec3> point;  ///< on the plane or the axis; the centre; the apex
  };
  /// A STEP assembly, whose instances are parts beside those of `parts`; a part is named by its
  /// path in the tree, "arm/servo_1/horn".
  struct AssemblySpec {
    struct Statement {
      std::string part;                 ///< a path, '*' allowed
      std::optional<FaceAddress> face;  ///< none: the whole part
      FeatureSpec says;                 ///< class, tolerance, position
      SourceLine at = {};
    };
    /// What became of one statement of the file itself (PMI).
    struct Listed {
      std::string text;  ///< "Ø20 +0.015/+0.002 on plate.bore_1"
      bool used = false;
      std::string reason;  ///< why not
    };
    std::string file;                 ///< relative to the scenario
    std::string general;              ///< class of ISO 2768-1, "m"; empty: none
    std::vector<std::string> fixed;   ///< paths of what does not move
    std::vector<std::string> bought;  ///< paths or products whose inside is not reported
    std::vector<Statement> statements;
    SourceLine at = {};
    // Once it is read:
    std::shared_ptr<const std::vector<std::byte>> sent;  ///< what the importer said of the file
    std::vector<Listed> listed;
    std::vector<std::string> not_solid;  ///< paths of what has no solid
  };
  struct FitSpec {
    std::string part_a, feature_a, part_b, feature_b;  ///< names, '*' allowed
    std::string code;                                  ///< "H7/g6"; empty when +-
    std::optional<Tolerance> tolerance;
    double nominal_mm = 0.0;  ///< 0: from the declared radius
    SourceLine at;
  };
  struct PairReason {
    std::string part_a, part_b;  ///< names, '*' allowed
    std::string reason;
    SourceLine at;
  };
  struct MinGap {
    std::string part_a, part_b;  ///< names, '*' allowed
    double gap_mm = 0.0;
    SourceLine at;
  };
  struct UserSpec {
    std::string name;
    std::vector<std::string> may_hold;  ///< part names, '*' allowed; empty: nothing (observer)
    SourceLine at;
    std::optional<std::vector<Right>> may =
        {};                      ///< absent: review, for users who may hold something
    Role role = Role::kUnknown;  ///< kUnknown: as the user requests
  };

  std::string name;
  std::string file;      ///< path it came from, for messages and relative meshes
  double unit_mm = 1.0;  ///< of a length as its file writes it
  double tick_rate_hz = 60.0;
  int threads = 1;  ///< of the server: ticks get work for so many
  Policy policy = Policy::kStop;
  double max_jump_mm = 50.0;  ///< largest translation of one increment
  double lease_s = 5.0;
  /// Of parts that do not state it themselves. Empty: kRecognized for a mesh file without a stated
  /// chord error, kNominal for the others.
  std::optional<UndeclaredSurface> undeclared;
  UndeclaredSurface undeclared_of_meshes() const {
    return undeclared.value_or(UndeclaredSurface::kRecognized);
  }
  std::vector<PartSpec> parts;
  std::optional<AssemblySpec> assembly;
  double min_gap_mm = 0.0;       ///< clearance that parts must keep; 0: none is asked for
  std::vector<MinGap> min_gaps;  ///< of pairs, instead of that
  std::vector<FitSpec> fits;
  std::vector<PairReason> exclusions;
  std::vector<PairReason> approvals;  ///< of clashes that the parts have where they start
  std::vector<UserSpec> users;        ///< empty: anyone may hold any moving part
};

}  // namespace mortise
