#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/base/constants.h"
#include "common/ccd/first_contact.h"
#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"
#include "common/math/interval.h"

// All that this room promises. How far two parts overlap: at fixed poses, since when in a tick, and
// how they come apart. What is behind it: answer/, cells/, search/, gpd/.
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
///   parts that are apart. Of points of the surfaces; in the deepest region of inner points, too,
///   where one is found that is deeper: with kFull everywhere, with kDecided where the surfaces
///   show that the parts lie deep in each other. hi is proven of inner points where one is deeper,
///   of convex parts, and with kFull where the search comes to its end (README, section 1).
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

/// Parts that lie deep in each other are deeper inside than at their surfaces. How deep the least
/// parts certainly are, seen from a point where their surfaces are so deep. mm, no less than that.
/// work_cap: evaluations, which are added to `evaluations`.
double certain_depth_inside_mm(const OverlapQuery& query, const Vec3& point_W, double depth_mm,
                               std::uint64_t work_cap, std::uint64_t& evaluations);

/// Are the parts of one mesh, and how far apart are twin points of them at most? Infinity: they are
/// not of one mesh. No more than a hundredth of the radius: duplicates, nobody assembles so.
double twins_apart_mm(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB);
bool are_duplicates(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB);

/// What covers prove of a path.
struct FreeUntil {
  double t = 0.0;        ///< at no time up to this is anything certain deeper than 1e-6 mm, or four
                         ///< times the accuracy where they are deeper than that at the start;
                         ///< 0: nothing is proven, 1: nothing is in the whole tick
  bool touches = false;  ///< nothing is deeper where the path begins
  bool closely = false;  ///< and the depth is 1e-6 mm: a word may rest on it
};

struct SweptQuery {
  OverlapQuery at_target;  ///< poses of the query are ignored
  Motion motion_a, motion_b;
  bool slides = true;         ///< the certain place is wanted where a part can slide along a face
  double accuracy_mm = 1e-4;  ///< how closely the answer is known, along the path of any point
  /// What certain_free_until() says of this query; nullopt: nobody has asked.
  std::optional<FreeUntil> certain_free;
};

/// When the overlap becomes certain (real) in the tick.
struct InterferenceTime {
  bool becomes_real = false;
  double t_free = 1.0;  ///< at no t <= t_free is anything certain deeper than accuracy_mm, or than
                        ///< FreeUntil says, proven; the pose at which `stop` leaves the part
  double t_real = 1.0;  ///< real at t_real, when becomes_real
  bool capped = false;  ///< work cap: t_free is still proven, nothing is known beyond it
  bool real_at_start = false;
  CertainPlace certain_place;  ///< at t_real, where one was found
  std::uint64_t evaluations = 0;
};

/// First time at which certain_mm > 0 somewhere (README, section 6), found by branch and bound
/// over the swept surface, so that a thin wall cannot be passed between ticks even when the meshes
/// overlapped before.
InterferenceTime find_interference_time(const SweptQuery& query, CcdScratch& scratch);

/// By the covers of both parts (README, section 11) alone. Costs a few microseconds for parts that
/// keep apart or slide. Adds the bounds it has looked at to `evaluations`.
FreeUntil certain_free_until(const SweptQuery& query, std::uint64_t& evaluations);
/// Proven by covers: nothing is possible in the whole tick.
bool is_free_of_possible(const SweptQuery& query, std::uint64_t& evaluations);

/// When an overlap becomes possible in the tick.
struct PossibleTime {
  bool becomes_possible = false;
  double t_clear = 1.0;     ///< at no t <= t_clear do any admissible surfaces interfere deeper than
                            ///< accuracy_mm, proven
  double t_possible = 1.0;  ///< some admissible pair interferes there, when becomes_possible
  bool capped = false;      ///< work cap: t_clear is still proven, nothing is known beyond it
  std::uint64_t evaluations = 0;
};

/// The same for possible_mm > 0, over the largest surfaces that the bands admit. With trivial bands
/// both times are those at which the meshes interfere.
PossibleTime find_possible_time(const SweptQuery& query, CcdScratch& scratch);

/// A motion of one part of a pair, the other stays. World frame. The part turns about `about_W`
/// with a constant rotation while that point moves on, along a screw: exp(s ξ), s from 0 to 1.
struct SeparatingMotion {
  bool of_b = false;                   ///< B is moved, not A
  Vec3 translation_mm = Vec3::Zero();  ///< from about_W to where that point ends
  Vec3 rotation_rad = Vec3::Zero();    ///< no more than half a turn
  Vec3 about_W = Vec3::Zero();

  /// What it does to points of the world that are fixed to the part, at its end.
  Pose displacement() const;
  /// From X_W to the end, in one tick, and the other way round.
  Motion path(const Pose& X_W, const Solid& part) const;
  Motion backward(const Pose& X_W, const Solid& part) const;
  bool moves() const { return !translation_mm.isZero(0.0) || !rotation_rad.isZero(0.0); }
};

/// Longest path of any point of the part (README, section 7), mm. X_W: where the part begins. Never
/// short, and long by 1e-9 of it at most.
double longest_path_mm(const Solid& part, const Pose& X_W, const SeparatingMotion& motion);

struct GpdQuery {
  OverlapQuery overlap;                    ///< parts, bands, target poses; kFull: a longer search
  std::span<const OverlapRegion> regions;  ///< all of the pair: a motion has to free them all
  bool b_moves = false;                    ///< the part that is held is the one that is moved out
  Motion motion_a, motion_b;               ///< of the tick; still when judged without a motion
  double t_contact = 1.0;                  ///< of the pair
  /// Known from before: it may part them. Then the answer is no longer than this motion.
  const SeparatingMotion* known = nullptr;
  std::uint64_t work_cap = 12'000;  ///< evaluations; where it ends, the bracket stays wider
};

/// Generalized penetration depth of a pair (README, section 7), for the part that is moved.
/// gpd_mm.lo: no motion parts the meshes without moving some point of the part at least so far. By
/// the overlap, by holds and pieces, and by the hulls where both parts are convex.
/// gpd_mm.hi: the longest path of any point under `motion`, which parts them. Finite. Verified at
/// its end: surfaces do not cross, neither part contains the other; the way may pass through.
/// lo = hi, but for rounding and a gap of 1e-7 mm, where both parts are convex.
/// [0, 0] where the meshes are apart and only their zones meet.
struct GeneralizedDepth {
  Interval gpd_mm;
  SeparationWay way = SeparationWay::kNone;
  SeparatingMotion motion;
  std::uint64_t evaluations = 0;
};

GeneralizedDepth generalized_depth(const GpdQuery& query, CcdScratch& scratch);

/// Generalized penetration depth of the least and of the largest bodies (README, section 7):
/// however the parts are made, some motion of hi parts them, and none shorter than lo. Positive
/// exactly where the class of the pair is real, or at least potential. Empty: not known.
struct LayerDepths {
  std::optional<Interval> least_mm, largest_mm;
};

/// Of the pair at the poses of the query, for the part that it moves. Four overlaps and four
/// searches: for whoever asks.
LayerDepths depths_of_layers(const SolidPtr& a, const SolidPtr& b, const GpdQuery& query,
                             CcdScratch& scratch);

/// How far a region has come in since the contact: the motion of A seen from B, mm.
struct TravelSinceContact {
  double path_mm = 0.0;    ///< path from contact to target, largest over the region's points
  double normal_mm = 0.0;  ///< its part along the normal, likewise
};
TravelSinceContact travel_since_contact(const OverlapRegion& region, const Motion& motion_a,
                                        const Motion& motion_b, double t_contact);

/// Do the meshes get deeper on the way than depth_mm, their overlap at the start, by more than the
/// accuracy of the query? The overlap is looked at in some places of the way, from the start to the
/// last contact, each with little work: `false` is no proof between them. After the last contact
/// the way is free by the guarantee of first contact. Cost: some ten short overlaps.
bool way_goes_deeper(const OverlapQuery& start, double depth_mm, const SeparatingMotion& motion,
                     CcdScratch& scratch);

/// When the part meets another one on its way, as a share of it; none: never, by the guarantee of
/// first contact. What touches at the start and is not pressed is let go; what overlaps at the
/// start counts as met where it gets deeper on the way.
std::optional<double> met_on_way(const Solid& part, const Pose& X_WP,
                                 const SeparatingMotion& motion, const Solid& other,
                                 const Pose& X_WO, CcdScratch& scratch);

/// Other motions that part the pair as well and are no longer than length_mm, the longest path of
/// `motion`, but for rounding: straight ones of that length along the main faces of both parts, and
/// `motion` with its shift, its turn or both reversed. Verified at their ends. Cost: some twenty
/// tests whether the meshes cross.
std::vector<SeparatingMotion> ways_as_long(const OverlapQuery& start,
                                           const SeparatingMotion& motion, double length_mm,
                                           CcdScratch& scratch);

/// Works out now, in this thread, what depth derives from a part with this band, so that the first
/// tick that judges it need not. Each of so many threads gets a copy of its own. Changes no answer.
/// O(triangles log triangles) a thread. Any thread.
void make_body_ready(const Solid& solid, const SurfaceBand& band, int threads);

}  // namespace mortise
