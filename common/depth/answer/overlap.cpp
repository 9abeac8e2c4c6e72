#include "common/depth/depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/check.h"
#include "common/ccd/distance.h"
#include "common/depth/answer/crack_regions.h"
#include "common/depth/answer/declared_region.h"
#include "common/depth/answer/deep_region.h"
#include "common/depth/answer/pair_covers.h"
#include "common/depth/answer/pair_order.h"
#include "common/depth/answer/plane_pair.h"
#include "common/depth/answer/region_report.h"
#include "common/depth/answer/regions.h"
#include "common/depth/search/candidates.h"
#include "common/depth/search/convex_edge.h"
#include "common/depth/search/tip_reach.h"

namespace mortise {
namespace {

// Whether only the meshes overlap is searched where so much work is left, which is more than a tick
// gives, and by no more of it: a point inside is found early or not at all.
constexpr std::uint64_t kSecondLook = 20'000;

// Evaluations of a search that only has to find points, not to prove that there are none. Chosen:
// with half or four times as many the classes of 600 random pairs (convex and csg of tests/bench)
// are the same, with a quarter one is lost.
constexpr std::uint64_t kGlance = 400, kGlancePerRoot = 2;
// Evaluations of the overlap of the meshes, where the sharp bodies decide.
constexpr std::uint64_t kMeshAlone = 1000;

// Evaluations after which a search of the meshes that is still open asks their planes, and how much
// more must be left for that.
constexpr std::uint64_t kMeshLook = 2000, kMuchLonger = 8;

// Planes that are fitted to corners which a file has rounded are off by so many of its steps.
constexpr double kFileSteps = 4.0;

// The file is all that the part may be off by: no tolerance, and no more than corners that are off,
// and planes that are fitted to them.
bool is_rounding_alone(const SurfaceBand& band) {
  return std::all_of(band.faces.begin(), band.faces.end(), [&](const SurfaceBand::Face& face) {
    return face.tolerance_mm == Interval{} && is_plane_band(band, face) &&
           std::max(-face.deviation_mm.lo, face.deviation_mm.hi) <= kFileSteps * band.quantum_mm;
  });
}

// Of a region with one point: its two triangles decide it.
OverlapRegion decided_there(const PairFrame& pair, OverlapRegion region) {
  region.deciding_triangle_a = region.triangle_a;
  region.deciding_triangle_b = region.triangle_b;
  region.normal_W = pair.X_W[1].q * pair.bodies[1].normal(region.triangle_b);
  set_shapes(pair, region);
  region.points_W = {region.point_W};
  return region;
}

// Without an inside there is no depth: the crossing itself, or that the parts are near, is the
// finding.
OverlapRegion region_without_depth(const PairFrame& pair, const Candidates& candidates) {
  OverlapRegion region;
  const double depth = 2.0 * pair.smaller_radius_mm();
  if (candidates.cross) {
    region.delta_mm = {0.0, depth};
    region.possible_mm = {0.0, depth};
    region.certain_mm = {-depth, 0.0};
    region.point_W = pair.X_W[1] * candidates.cross_point_B;
    region.triangle_a = candidates.cross_triangle[0];
    region.triangle_b = candidates.cross_triangle[1];
  } else {
    region.delta_mm = {-pair.near_mm, 0.0};
    region.possible_mm = {0.0, pair.near_mm};
    region.certain_mm = {-depth, 0.0};
    region.triangle_a = candidates.triangles[0].front();
    region.triangle_b = candidates.triangles[1].front();
    region.point_W = pair.X_W[0] * pair.bodies[0].mesh->corner(region.triangle_a, 0);
  }
  return decided_there(pair, std::move(region));
}

void add_without_depth(const PairFrame& pair, const Candidates& candidates,
                       std::vector<OverlapRegion>& regions) {
  const bool near = !pair.trivial && !candidates.triangles[0].empty();
  if (!candidates.cross && !near) return;
  for (const OverlapRegion& region : regions)
    if (region.delta_mm.lo > 0.0) return;  // the closed part of the two found it already
  if (!regions.empty() && !candidates.cross) return;
  regions.push_back(region_without_depth(pair, candidates));
}

OverlapRegion region_of(const PairFrame& pair, const TipReach& reach) {
  OverlapRegion region;
  region.delta_mm = {-reach.gap_mm, -reach.gap_mm};
  region.possible_mm = reach.possible_mm;
  region.certain_mm = {-reach.gap_mm - pair.reach_mm(Layer::kLower), 0.0};
  region.triangle_a = reach.role == 0 ? reach.triangle : reach.other_triangle;
  region.triangle_b = reach.role == 0 ? reach.other_triangle : reach.triangle;
  region.point_W = reach.point_W;
  return decided_there(pair, std::move(region));
}

Bracket moved(Bracket bracket, double by_mm) {
  bracket.best.depth_mm += by_mm;
  bracket.hi_mm += by_mm;
  return bracket;
}

Bracket capped(Bracket bracket, double most_mm) {
  bracket.hi_mm = std::min(bracket.hi_mm, most_mm);
  bracket.best.depth_mm = std::min(bracket.best.depth_mm, most_mm);
  return bracket;
}

// A chamfer that keeps clear of the bore in which its shaft sits: one contact, told of the shaft.
bool told_by_another(const KnownFacePair& known, const Candidates& candidates) {
  if (std::isfinite(known.overlap.lo_mm)) return false;
  for (const KnownFacePair& other : candidates.known)
    if (std::isfinite(other.overlap.lo_mm) &&
        (other.face[0] == known.face[0] || other.face[1] == known.face[1]))
      return true;
  return false;
}

// A bound holds over all triangles of the region, a witness by the faces beside it.
void set_grade(const PairFrame& pair, const Regions& regions, std::size_t index,
               const std::array<const Sample*, 2>& decide, OverlapRegion& region) {
  const auto use = [&](int role, std::uint32_t triangle, bool decides) {
    const DeviationGrade grade = pair.s(role).face(triangle).grade;
    if (decides) region.grade = std::max(region.grade, grade);
    region.estimated |= grade == DeviationGrade::kEstimated;
  };
  for (const Sample* sample : decide) {
    if (!std::isfinite(sample->depth_mm)) continue;
    use(sample->role, sample->triangle, true);
    use(1 - sample->role, sample->at.triangle, true);
  }
  if (region.has_witness) return;
  for (const Root& root : regions.roots)
    if (root.region == index) use(root.role, root.triangle, false);
}

// Of the refined search and the lazy one the better: what the lazy one has decided stays decided.
std::vector<Bracket> better_of(std::vector<Bracket> refined, const std::vector<Bracket>& lazily) {
  for (std::size_t i = 0; i < refined.size(); ++i) {
    Bracket& bracket = refined[i];
    if (lazily[i].best.depth_mm > bracket.best.depth_mm) bracket.best = lazily[i].best;
    bracket.hi_mm = std::max(std::min(bracket.hi_mm, lazily[i].hi_mm), bracket.best.depth_mm);
  }
  return refined;
}

// No admissible surfaces of the region interfere; how far from it at the deepest point of the
// mesh.
Bracket proven_apart(const PairFrame& pair, const Bracket& mesh, Layer layer) {
  Bracket apart;
  apart.hi_mm = 0.0;
  apart.best = mesh.best;
  if (std::isfinite(mesh.best.depth_mm))
    apart.best = sample_at(pair, layer, mesh.best.role, mesh.best.triangle,
                           pair.X_KS[1 - mesh.best.role] * mesh.best.point_K);
  apart.best.depth_mm = std::min(apart.best.depth_mm, 0.0);
  return apart;
}

bool is_past_edge(const PairFrame& pair, const Sample& sample) {
  const Vec3 at_W = pair.in_world(sample.role, sample.point_K);
  for (const int i : {0, 1})
    if (is_past_convex_edge(pair.bodies[i], pair.X_W[i].inverse() * at_W, pair.rounding_mm))
      return true;
  return false;
}

// Where a face was found deep beyond the edge that cuts it short, certain is what the witness
// shows, or another point of the face.
void cap_certain(const PairFrame& pair, const Bracket& certain, OverlapRegion& region) {
  if (!region.has_witness || !is_past_edge(pair, certain.best)) return;
  double most_mm = 0.0;
  for (const int i : {0, 1})
    most_mm += std::max(
        0.0, depth_below_convex_edges(pair.bodies[i], pair.X_W[i].inverse() * region.witness_W));
  for (const Sample& sample : certain.samples)
    if (sample.depth_mm > most_mm && !is_past_edge(pair, sample)) most_mm = sample.depth_mm;
  region.certain_mm.lo = std::min(region.certain_mm.lo, most_mm);
}

// A face may be asked beyond its edge: without a point that was checked nothing is certain.
void keep_to_witnesses(std::vector<OverlapRegion>& regions) {
  for (OverlapRegion& region : regions)
    if (!region.has_witness) region.certain_mm.lo = std::min(region.certain_mm.lo, 0.0);
}

void sort_deepest_first(std::vector<OverlapRegion>& regions) {
  std::stable_sort(
      regions.begin(), regions.end(),
      [](const OverlapRegion& a, const OverlapRegion& b) { return a.delta_mm.lo > b.delta_mm.lo; });
}

// Where meshes touch in many places, the search of what may overlap there stays open; by their
// planes it is told.
void settle_touch(const OverlapQuery& query, const PairFrame& pair, OverlapResult& result) {
  const auto is_open = [&](const OverlapRegion& region) {
    return region.delta_mm.lo <= pair.touch_mm && region.delta_mm.hi > pair.touch_mm;
  };
  std::vector<OverlapRegion>& regions = result.regions;
  if (result.no_inside || !std::any_of(regions.begin(), regions.end(), is_open) ||
      !is_rounding_alone(*query.band_a) || !is_rounding_alone(*query.band_b) ||
      !meshes_do_not_overlap(pair))
    return;
  if (pair.trivial) std::erase_if(regions, is_open);
  for (OverlapRegion& region : regions)
    region.delta_mm = without_touch(
        {region.delta_mm.lo, std::min(region.delta_mm.hi, pair.touch_mm)}, pair.touch_mm);
}

// Where meshes are the parts and touch in many places, a search of them ends at its limit only:
// their planes are asked before.
template <class Search>
std::vector<Bracket> until_planes_tell(const PairFrame& pair, std::uint64_t work_cap,
                                       Search&& search) {
  if (!pair.trivial || work_cap < kMuchLonger * kMeshLook) return search(work_cap);
  std::vector<Bracket> soon = search(kMeshLook);
  if (std::none_of(soon.begin(), soon.end(), [](const Bracket& d) { return d.undecided; }))
    return soon;
  const auto touches = [&](const Bracket& d) { return d.best.depth_mm <= pair.touch_mm; };
  if (!std::all_of(soon.begin(), soon.end(), touches) || !meshes_do_not_overlap(pair))
    return search(work_cap);
  for (Bracket& d : soon) d.hi_mm = std::min(d.hi_mm, pair.touch_mm);
  return soon;
}

class Overlap {
 public:
  explicit Overlap(const OverlapQuery& query)
      : query_(query), pair_(query), covers_(pair_, query.use_covers, result_.evaluations) {}

  OverlapResult run() {
    if (told_by_covers() || told_in_one_place()) {
      mark_cracks(pair_, !query_.only_certain, result_);
      return std::move(result_);
    }
    planes_.emplace(pair_);
    result_.no_inside = !pair_.has_insides();
    CandidateQuery near{&pair_, pair_.near_mm, result_.no_inside};
    near.want_meetings = pair_.trivial && !result_.no_inside;
    Candidates candidates = find_candidate_triangles(near);
    known_ = known_overlaps(pair_, candidates);
    look_at(candidates);
    if (may_have_missed_meshes()) {
      closely_ = true;
      look_at(candidates);
    }
    // Regions that were left out because nothing is certain in them are told apart from none.
    if (result_.regions.empty() && !(query_.only_certain && regions_.count > 0))
      if (const auto shared = find_shared_inside(pair_, candidates))
        result_.regions.push_back(region_of(pair_, *shared));
    if (result_.no_inside) add_without_depth(pair_, candidates, result_.regions);
    planes_->tell(query_.only_certain, result_.regions);
    if (!query_.only_certain) settle_touch(query_, pair_, result_);
    if (!query_.only_certain && !planes_->decided() && !covers_.apart(Layer::kUpper)) add_tip();
    if (!query_.only_certain) covers_.tell(result_.regions);
    mark_cracks(pair_, !query_.only_certain, result_);
    for (const OverlapRegion& region : result_.regions)
      result_.meshes_cross |= region.delta_mm.lo > pair_.touch_mm;
    result_.contained = result_.meshes_cross && candidates.triangles[0].empty() &&
                        candidates.triangles[1].empty() && candidates.known.empty();
    if (candidates.cross) result_.meshes_cross = true;
    sort_deepest_first(result_.regions);
    if (!result_.no_inside && query_.want_delta && !query_.only_certain && !result_.regions.empty())
      tell_inner_overlap(pair_, query_,
                         {.layers = planes_->has_brackets(), .closed_form_mm = closed_form_mm_},
                         result_.regions.front(), result_.evaluations);
    if (!query_.only_certain) keep_to_witnesses(result_.regions);
    return std::move(result_);
  }

 private:
  void look_at(Candidates& candidates) {
    for (const KnownFacePair& known : candidates.known)
      if (!told_by_another(known, candidates)) add_declared(known, candidates);
    regions_ = find_regions({&pair_, &candidates, &known_, query_.work_cap / 2, !closely_,
                             query_.only_certain ? kInfinity : covers_.most_mm(Layer::kUpper)},
                            scratch_, result_.evaluations);
    if (regions_.count == 0) return;
    if (query_.only_certain)
      search_certain();
    else
      search_regions();
  }

  // No finding at all says that the meshes do not overlap either, which some points do not show. A
  // tick has no work for that.
  bool may_have_missed_meshes() {
    return !closely_ && query_.want_delta && !query_.only_certain && !pair_.trivial &&
           result_.regions.empty() && work_left() >= kSecondLook && meshes_cross();
  }

  bool told_in_one_place() {
    auto region = find_in_one_place(pair_, query_, result_.evaluations);
    if (!region) return false;
    result_.regions.push_back(std::move(*region));
    result_.contained =
        !are_duplicates(*query_.a, query_.X_WA, *query_.b, query_.X_WB) && !meshes_cross();
    return result_.meshes_cross = true;
  }

  // What was asked for needs no triangle: the layer is apart, or the deepest region is known as
  // closely as it has to be. Those who want what is near, too, want all regions.
  bool told_by_covers() {
    if (query_.want_delta && !query_.only_certain)
      return !pair_.trivial && covers_.apart(Layer::kUpper) && !meshes_cross();
    if (covers_.apart(query_.only_certain ? Layer::kLower : Layer::kUpper)) return true;
    if (query_.only_certain &&
        covers_.most_mm(Layer::kLower) + pair_.rounding_mm <= query_.ignore_below_mm)
      return true;
    if (query_.certain_from_mm < 0.0 && query_.refinement == Refinement::kFull) return false;
    auto region = covers_.region(query_);
    if (!region || (query_.only_certain && !(region->certain_mm.lo > query_.ignore_below_mm)))
      return false;
    result_.regions.push_back(std::move(*region));
    return true;
  }

  // Parts that are apart and whose meshes are so, too, are no finding.
  bool meshes_cross() {
    if (!meshes_cross_) {
      CcdScratch scratch;
      meshes_cross_ = surfaces_cross(*query_.a, query_.X_WA, *query_.b, query_.X_WB, scratch);
    }
    return *meshes_cross_;
  }

  // One region whose brackets in both layers are those of the sharp bodies.
  bool told_by_planes() const { return regions_.count == 1 && planes_->has_brackets(); }

  std::uint64_t work_left() const {
    return query_.work_cap - std::min(query_.work_cap, result_.evaluations);
  }

  // Evaluations at most for whether the meshes overlap, where points do not show it.
  std::uint64_t mesh_work() const {
    return !closely_ ? 0 : query_.refinement == Refinement::kFull ? query_.work_cap : kSecondLook;
  }

  // Lazily a glance is enough where the class does not hang on a proof.
  std::uint64_t glance() const { return kGlance + kGlancePerRoot * regions_.roots.size(); }

  std::vector<Bracket> search(Layer layer, bool sign_only, std::uint64_t work_cap,
                              double ignore_below_mm = -kInfinity) {
    if (regions_.count == 1)
      if (auto bracket = covers_.bracket(layer, query_.accuracy_mm, sign_only))
        return {std::move(*bracket)};
    SearchQuery search;
    search.pair = &pair_;
    search.layer = layer;
    search.known = &known_;
    search.roots = &regions_.roots;
    if (layer == Layer::kMesh) search.middles = &regions_.middles;
    search.regions = regions_.count;
    search.region_of_triangle = &regions_.region_of_triangle;
    search.primary = regions_.primary;
    search.accuracy_mm = std::max(query_.accuracy_mm, pair_.rounding_mm);
    search.ignore_below_mm = ignore_below_mm;
    if (layer != Layer::kMesh && !pair_.trivial)
      search.most_mm = covers_.most_mm(layer) + pair_.rounding_mm;
    search.sign_only = sign_only;
    search.work_cap = std::max<std::uint64_t>(work_cap, regions_.roots.size());
    std::vector<Bracket> brackets = search_depth(search, scratch_, result_.evaluations);
    // Triangles that the flood did not come to may lie deeper than any that it did.
    if (regions_.capped)
      for (Bracket& bracket : brackets)
        bracket.hi_mm = std::max(bracket.hi_mm, pair_.deepest_mm(layer));
    return brackets;
  }

  std::vector<Bracket> search_meshes(bool sign_only, std::uint64_t work_cap) {
    return until_planes_tell(
        pair_, work_cap, [&](std::uint64_t cap) { return search(Layer::kMesh, sign_only, cap); });
  }

  // Per region: of the meshes, of both layers, and of the least one before it was refined.
  struct Found {
    std::vector<Bracket> mesh, upper, lower, lower_lazily;
  };

  Found search_layers() {
    const bool lazy = query_.refinement == Refinement::kDecided;
    Found found;
    auto& [mesh, upper, lower, lower_lazily] = found;
    // Where no layer has to be searched, the meshes may cost more; else they wait for the class.
    if (lazy && closely_)
      mesh = search(Layer::kMesh, true, std::min(work_left() / 3, mesh_work()));
    else if (told_by_planes() || (pair_.trivial && !lazy))
      mesh = search_meshes(false, lazy ? std::min(kMeshAlone, work_left()) : work_left());
    else
      mesh = search_meshes(true, pair_.trivial ? work_left() : std::min(glance(), work_left()));
    // The sign of the depth is not enough where rounding may cover it.
    const auto in_rounding = [&](const Bracket& d) {
      return d.best.depth_mm > 0.0 && d.best.depth_mm <= pair_.reach_mm(Layer::kLower) &&
             d.hi_mm > pair_.reach_mm(Layer::kLower);
    };
    if (lazy && pair_.trivial && std::any_of(mesh.begin(), mesh.end(), in_rounding))
      mesh = search(Layer::kMesh, false, work_left());
    bool any_open = false;
    for (const bool open : regions_.may_interfere) any_open |= open;
    if (told_by_planes()) {
      upper = {planes_->told(mesh.front(), Layer::kUpper)};
      lower = {planes_->told(mesh.front(), Layer::kLower)};
    } else if (!pair_.trivial && ((any_open && !covers_.apart(Layer::kUpper)) || !lazy)) {
      upper = search(Layer::kUpper, true, work_left());
      bool may_be_certain = false;
      for (const Bracket& p : upper) may_be_certain |= p.hi_mm > pair_.touch_mm;
      // What is not seen to be certain is potential: that none of it is needs no proof.
      if ((may_be_certain && !covers_.apart(Layer::kLower)) || !lazy)
        lower = lower_lazily =
            search(Layer::kLower, true,
                   query_.prove_not_certain ? work_left() : std::min(glance(), work_left()));
      if (!lazy) refine(found, any_open);
    }
    return found;
  }

  // After the lazy answer, which a refined one must not leave for want of work.
  // Where no triangle may interfere, nothing that is found does so beyond what a closed form tells.
  void refine(Found& found, bool any_open) {
    found.mesh = better_of(search(Layer::kMesh, false, work_left() / 3), found.mesh);
    found.upper = better_of(search(Layer::kUpper, false, work_left() / 2), found.upper);
    found.lower = better_of(search(Layer::kLower, false, work_left()), found.lower_lazily);
    if (any_open) return;
    for (std::vector<Bracket>* layer : {&found.upper, &found.lower, &found.lower_lazily})
      for (Bracket& bracket : *layer) bracket = capped(std::move(bracket), 0.0);
  }

  void search_regions() {
    const Found found = search_layers();
    for (std::size_t i = 0; i < regions_.count; ++i)
      if (auto region = region_from(found, i)) result_.regions.push_back(std::move(*region));
  }

  // None where the parts only touch: rounding alone makes no collision.
  std::optional<OverlapRegion> region_from(const Found& found, std::size_t i) {
    const Bracket& d = found.mesh[i];
    const Bracket p = pair_.trivial         ? moved(d, pair_.reach_mm(Layer::kUpper))
                      : found.upper.empty() ? proven_apart(pair_, d, Layer::kUpper)
                                            : found.upper[i];
    const Bracket c = pair_.trivial         ? moved(d, -pair_.reach_mm(Layer::kLower))
                      : found.lower.empty() ? proven_apart(pair_, d, Layer::kLower)
                                            : found.lower[i];
    if (d.best.depth_mm <= pair_.touch_mm && (pair_.trivial ? d : p).hi_mm <= pair_.touch_mm)
      return std::nullopt;
    OverlapRegion region;
    region.delta_mm = bracket_of(d);
    region.possible_mm = bracket_of(p);
    region.certain_mm = bracket_of(c);
    region.certain_mm.hi = std::min(region.certain_mm.hi, region.possible_mm.hi);
    region.certain_mm.lo = std::min(region.certain_mm.lo, region.certain_mm.hi);
    region.area_mm2 = d.area_mm2;
    region.capped = regions_.capped || p.undecided ||
                    (query_.refinement == Refinement::kFull && (d.undecided || c.undecided));
    const Sample& deciding = region.possible_mm.lo > 0.0 ? c.best : p.best;
    describe(pair_, d.best, deciding, region);
    for (const Sample& sample : d.samples)
      region.points_W.push_back(pair_.in_world(sample.role, sample.point_K));
    region.points_W.push_back(region.point_W);
    if (region.certain_mm.lo > 0.0 && !told_by_planes()) {
      try_witness(c.best, region);
      if (!found.lower_lazily.empty()) try_witness(found.lower_lazily[i].best, region);
      for (const Sample& sample : c.samples) try_witness(sample, region);
      cap_certain(pair_, c, region);
    }
    set_grade(pair_, regions_, i, {&deciding, &c.best}, region);
    return region;
  }

  void search_certain() {
    const Layer layer = pair_.trivial ? Layer::kMesh : Layer::kLower;
    for (const Bracket& found : search(layer, query_.refinement == Refinement::kDecided,
                                       work_left(), query_.ignore_below_mm)) {
      const Bracket c = pair_.trivial ? moved(found, -pair_.reach_mm(Layer::kLower)) : found;
      if (c.hi_mm <= pair_.touch_mm + query_.certain_from_mm) continue;
      OverlapRegion region = region_of_certain(pair_, c.best, c.hi_mm);
      region.certain_mm = bracket_of(c);
      region.possible_mm.lo = region.certain_mm.lo;
      region.capped = regions_.capped || c.undecided;
      result_.regions.push_back(std::move(region));
    }
  }

  Interval bracket_of(const Bracket& bracket) const {
    return without_touch({bracket.best.depth_mm, bracket.hi_mm}, pair_.touch_mm);
  }

  // From another point of the least surface, where there is no witness yet.
  void try_witness(const Sample& from, OverlapRegion& region) {
    if (region.has_witness || !(from.depth_mm > pair_.touch_mm)) return;
    set_witness(pair_, find_witness(pair_, from, result_.evaluations, &region.witnesses_refused),
                from, region);
  }

  void add_declared(const KnownFacePair& known, Candidates& candidates) {
    DeclaredRegion found =
        find_declared_region(pair_, query_, known, mesh_work(), scratch_, result_.evaluations);
    if (found.left_to_search) leave_to_search(known, candidates, known_);
    if (!found.region) return;
    result_.regions.push_back(std::move(*found.region));
    closed_form_mm_ = std::max(closed_form_mm_, found.most_mm);
  }

  // Where the faces' own offsets keep the parts apart.
  void add_tip() {
    for (const OverlapRegion& region : result_.regions)
      if (region.possible_mm.hi > 0.0) return;
    if (const auto reach = find_tip_reach(pair_, result_.evaluations))
      result_.regions.push_back(region_of(pair_, *reach));
  }

  OverlapResult result_;
  const OverlapQuery& query_;
  const PairFrame pair_;
  /// True: whether the meshes overlap is searched, not only looked for at some points.
  bool closely_ = query_.refinement == Refinement::kFull;
  std::optional<bool> meshes_cross_;  // asked when it counts
  PairCovers covers_;
  double closed_form_mm_ = -1.0;     // of all regions with one
  std::optional<PlanePair> planes_;  // asked once covers do not do
  SearchScratch scratch_;
  KnownOverlaps known_;
  Regions regions_;
};

// By how much the face of a triangle may be off for the rounding of its file. A declared surface is
// known apart from the file; at its rim the face beside it decides, unless a tolerance lets it
// grow.
double file_mm(const SurfaceBand& band, std::uint32_t triangle) {
  const SurfaceBand::Face& face = band.face_of(triangle);
  const bool grows = face.grade == DeviationGrade::kDeclaredFeature && face.tolerance_mm.hi > 0.0;
  return grows ? 0.0 : band.quantum_mm;
}

// Where the meshes do not overlap, the rounding of their files alone makes no collision, nor at
// edges and corners, which it moves farther than faces.
void leave_out_rounding(const OverlapQuery& query, OverlapResult& result) {
  if (query.only_certain || result.no_inside || (query.band_a->trivial && query.band_b->trivial))
    return;
  const bool alone = !result.regions.empty() && is_rounding_alone(*query.band_a) &&
                     is_rounding_alone(*query.band_b);
  std::erase_if(result.regions, [&](const OverlapRegion& region) {
    const double files_mm = file_mm(*query.band_a, region.deciding_triangle_a) +
                            file_mm(*query.band_b, region.deciding_triangle_b);
    if (region.closed_form) return false;
    if (alone && region.delta_mm.hi <= 0.0 &&
        region.possible_mm.hi <= PlaneFaces::kMostTravel * files_mm)
      return true;
    if (region.possible_mm.hi > files_mm + kDepthAccuracyDefault_mm) return false;
    const double touch_mm = PairFrame(query).touch_mm;
    return region.delta_mm.lo <= touch_mm && !(region.certain_mm.lo > 0.0) &&
           region.possible_mm.hi <= files_mm + 2.0 * touch_mm;
  });
}

void check(const OverlapQuery& query) {
  MORTISE_CHECK(query.a != nullptr && query.b != nullptr && query.band_a != nullptr &&
                    query.band_b != nullptr,
                "a query needs two solids and their bands");
  MORTISE_CHECK(valid(query.X_WA) && valid(query.X_WB),
                "poses must be finite and their quaternions unit");
  MORTISE_CHECK(query.accuracy_mm >= 0.0 && query.accuracy_mm <= kLargestCoordinate_mm,
                "an accuracy must be a length");
}

// What OverlapRegion promises.
void check(const OverlapQuery& query, const OverlapResult& result) {
  const std::size_t triangles_a = query.a->mesh().triangles.size();
  const std::size_t triangles_b = query.b->mesh().triangles.size();
  double deepest_mm = std::numeric_limits<double>::infinity();
  for (const OverlapRegion& region : result.regions) {
    MORTISE_CHECK(
        region.delta_mm.ordered() && region.certain_mm.ordered() && region.possible_mm.ordered(),
        "a bracket has its lower end first");
    MORTISE_CHECK(region.delta_mm.lo <= deepest_mm, "the deepest region comes first");
    MORTISE_CHECK(
        region.point_W.allFinite() && region.normal_W.allFinite() && region.witness_W.allFinite(),
        "places of a region are finite");
    MORTISE_CHECK(region.triangle_a < triangles_a && region.deciding_triangle_a < triangles_a &&
                      region.triangle_b < triangles_b && region.deciding_triangle_b < triangles_b,
                  "triangles of a region are those of the parts");
    deepest_mm = region.delta_mm.lo;
  }
}

}  // namespace

OverlapResult find_overlap(const OverlapQuery& query, CcdScratch&) {
  check(query);
  OverlapResult result =
      b_comes_first(query) ? mirrored(Overlap(mirrored(query)).run()) : Overlap(query).run();
  leave_out_rounding(query, result);
  check(query, result);
  return result;
}

SaidByCovers said_by_covers(const OverlapQuery& query, Named named, std::uint64_t& evaluations) {
  check(query);
  if (b_comes_first(query)) {
    SaidByCovers said = said_by_covers(mirrored(query), named, evaluations);
    if (said.place) said.place->role = 1 - said.place->role;
    return said;
  }
  const PairFrame pair(query);
  PairCovers covers(pair, query.use_covers, evaluations);
  const Layer layer = named == Named::kLargest ? Layer::kUpper : Layer::kLower;
  SaidByCovers said;
  said.apart = covers.apart(layer);
  const bool here = named == Named::kLeastHere;
  std::optional<Sample> deepest = here ? covers.on_mesh(layer) : covers.deepest(layer);
  said.touches = covers.touches(layer);
  // Where the wall ends at that place, nothing is deep there, however far the part goes.
  if (here && !deepest) deepest = covers.deepest(layer);
  if (named == Named::kLeast && !deepest) deepest = covers.farther_in(layer);
  if (deepest && (layer == Layer::kUpper || find_witness(pair, *deepest, evaluations)))
    said.place = {deepest->role, deepest->triangle,
                  pair.X_KS[1 - deepest->role] * deepest->point_K};
  return said;
}

bool is_certain_at(const OverlapQuery& query, const CertainPlace& place,
                   std::uint64_t& evaluations) {
  check(query);
  MORTISE_CHECK(place.role == 0 || place.role == 1, "a place is of one of the parts");
  const PairFrame pair(query);
  Sample sample;
  sample.role = place.role;
  sample.triangle = place.triangle;
  sample.point_K = pair.X_KS[place.role] * place.point_S;
  sample.at = nearest_surface(*pair.k(place.role).solid, sample.point_K);
  ++evaluations;
  sample.depth_mm = pair.k(place.role).depth_in(sample.point_K, sample.at, Layer::kLower);
  return sample.depth_mm > pair.touch_mm && find_witness(pair, sample, evaluations).has_value();
}

}  // namespace mortise
