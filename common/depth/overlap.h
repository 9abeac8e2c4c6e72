#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "common/base/constants.h"
#include "common/ccd/first_contact.h"
#include "common/geometry/surface_band.h"
#include "common/math/interval.h"

namespace mortise {

/// How far to refine. kDecided: until the class of every region is decided; kFull: until the
/// brackets of delta and gpd are narrower than accuracy_mm.
enum class Refinement : std::uint8_t { kDecided, kFull };

struct OverlapQuery {
  const Solid* a = nullptr;
  const Solid* b = nullptr;
  const SurfaceBand* band_a = nullptr;
  const SurfaceBand* band_b = nullptr;
  Pose X_WA, X_WB;  ///< where the overlap is judged (the target of the tick)
  Refinement refinement = Refinement::kDecided;
  double accuracy_mm = kDepthAccuracyDefault_mm;
  /// False: only certain_mm and possible_mm are wanted; delta_mm may be wide.
  bool want_delta = true;
  /// True: only the regions in which something may be certain are wanted, and of them certain_mm;
  /// delta_mm and possible_mm are as wide as may be. Costs less than half.
  bool only_certain = false;
  /// With only_certain: regions in which even the least surfaces are no farther apart than this
  /// are wanted, too. mm, <= 0.
  double certain_from_mm = 0.0;
  /// With only_certain: only whether something is certainly deeper than this is asked.
  double ignore_below_mm = -std::numeric_limits<double>::infinity();
  /// True: where nothing is certain, that is proven as far as work_cap allows. Otherwise, under
  /// kDecided, the search may stop early, and the class is potential.
  bool prove_not_certain = false;
  bool use_covers = true;  ///< false: as if no part had cells (README, section 11)
  std::uint64_t work_cap =
      200'000;  ///< branch-and-bound evaluations; on the cap brackets stay wide, never wrong
};

/// A point of the least surface of one part (A for role 0, B for role 1), near one of its triangles
/// and in its frame, that was found inside the other part for all admissible offsets.
struct CertainPlace {
  int role = -1;  ///< -1: none
  std::uint32_t triangle = 0;
  Vec3 point_S = Vec3::Zero();

  bool known() const { return role >= 0; }
};

/// One connected component of the overlap (or of the near band where only offsets can make the
/// parts meet). World frame. The brackets:
/// - delta_mm: overlap of the meshes, -min(sd_A + sd_B) over the region; minus the distance of
/// parts
///   that are apart. In the deepest region over all points of the parts: with kFull everywhere,
///   with kDecided where the surfaces show that they lie deep in each other.
/// - certain_mm: sup over pairs of faces of (overlap + lower offsets). > 0 means that every
///   admissible pair of real surfaces interferes (README, section 3).
/// - possible_mm: the same with upper offsets. <= 0 means that none does.
///
/// Lower ends are reached at a point (true lower bounds); upper ends are proven over the continuous
/// surface.
struct OverlapRegion {
  Interval delta_mm, certain_mm, possible_mm;
  Vec3 point_W = Vec3::Zero();    ///< where delta.lo is reached
  Vec3 normal_W = Vec3::UnitZ();  ///< from B to A: moving A along it separates
  double area_mm2 = 0.0;
  std::uint32_t triangle_a = 0, triangle_b = 0;  ///< at point_W
  std::uint32_t deciding_triangle_a = 0,
                deciding_triangle_b = 0;  ///< pair of faces that decides the class
  FaceShape shape_a = FaceShape::kUnknown, shape_b = FaceShape::kUnknown;
  bool has_witness = false;
  Vec3 witness_W =
      Vec3::Zero();  ///< inside both real parts for all tolerances, when certain_mm.lo > 0
  CertainPlace certain_place;  ///< the place from which the witness was found
  /// Points that the surfaces called inside both parts and a mesh did not bear out; such a region
  /// is real only by another point.
  std::uint64_t witnesses_refused = 0;
  /// Worst grade of the faces that decide, and whether any face that was used is known by estimate
  /// only.
  DeviationGrade grade = DeviationGrade::kUnknown;
  bool estimated = false;
  bool capped = false;         ///< work cap reached: brackets are wide
  bool closed_form = false;    ///< certain_mm and possible_mm are those of two declared faces
  bool at_crack = false;       ///< within a crack of a part: what is inside there is not known
  std::vector<Vec3> points_W;  ///< sample of contact points for the fitted separating motion
};

struct OverlapResult {
  bool meshes_cross = false;
  bool contained = false;
  bool no_inside = false;              ///< a part has no inside: crossing is known, depth is not
  std::vector<OverlapRegion> regions;  ///< sorted by delta.lo, deepest first
  std::uint64_t evaluations = 0;
};

/// Overlap of two parts at fixed poses, per region. Near pairs that do not cross yield regions only
/// within the band (sum of the largest offsets). Two movers, any poses; deterministic.
OverlapResult find_overlap(const OverlapQuery& query, CcdScratch& scratch);

/// What the covers of both parts (README, section 11) say of the least parts, or of the largest.
struct SaidByCovers {
  bool apart = false;                 ///< no point is in both
  bool touches = false;               ///< a point was found within 0.4 um of both
  std::optional<CertainPlace> place;  ///< a point that is in both, verified
};
/// Neither: they say nothing. Some microseconds.
enum class Named : std::uint8_t {
  kLargest,   ///< a place in both largest parts
  kLeast,     ///< a place in both least parts
  kLeastHere  ///< and, if one is deep, where the cell ends on the mesh: parts slide along its face
};
SaidByCovers said_by_covers(const OverlapQuery& query, Named named, std::uint64_t& evaluations);

/// True implies: the overlap is certain at the poses of the query, because this place is inside.
/// False implies nothing. Adds to `evaluations` one for the nearest point and those of
/// find_witness().
bool is_certain_at(const OverlapQuery& query, const CertainPlace& place,
                   std::uint64_t& evaluations);

}  // namespace mortise
