#include "common/depth/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/depth/candidates.h"
#include "common/depth/cells/plane_pair.h"
#include "common/depth/crack_regions.h"
#include "common/depth/inner_overlap.h"
#include "common/depth/pair_order.h"
#include "common/depth/region_report.h"
#include "common/depth/regions.h"

namespace mortise {
namespace {

// Triangles of a known pair of faces that are asked how far the meshes overlap.
constexpr std::size_t kKnownQuestions = 24, kKnownQuestionsLazily = 24;

// Where a witness of a closed form is looked for: shares of the way to the middle of the face.
constexpr double kWitnessShares[] = {0.0, 0.002, 0.02, 0.1, 0.4, 1.0};

// The same of parts that lie deep in each other; where they end, the depth is told as "at least".
constexpr std::uint64_t kInnerQuestions = 8'000, kInnerQuestionsLazily = 800;

// Evaluations of a search that only has to find points, not to prove that there are none.
constexpr std::uint64_t kGlance = 400, kGlancePerRoot = 2;
// Evaluations of the overlap of the meshes, where the sharp bodies decide.
constexpr std::uint64_t kMeshAlone = 1000;

// Corners, middles of edges, centre.
std::array<Vec3, 7> probe_points(const TriangleMesh& mesh, std::uint32_t t) {
  const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
  return {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0};
}

double smaller_radius(const PairFrame& pair) {
  return std::min(pair.bodies[0].solid->sphere().radius_mm,
                  pair.bodies[1].solid->sphere().radius_mm);
}

void set_shapes(const PairFrame& pair, OverlapRegion& region) {
  region.shape_a =
      face_shape(pair.bodies[0], region.triangle_a, pair.X_W[0].inverse() * region.point_W);
  region.shape_b =
      face_shape(pair.bodies[1], region.triangle_b, pair.X_W[1].inverse() * region.point_W);
}

// Identical parts in one place: no surface lies inside the other, and yet the parts are one.
OverlapRegion region_of(const PairFrame& pair, const SharedInside& shared) {
  OverlapRegion region;
  region.delta_mm = {shared.depth_mm, 2.0 * smaller_radius(pair)};
  region.certain_mm = {shared.depth_mm - pair.reach_mm(Layer::kLower), region.delta_mm.hi};
  region.possible_mm = {shared.depth_mm - pair.reach_mm(Layer::kUpper),
                        region.delta_mm.hi + pair.reach_mm(Layer::kUpper)};
  region.point_W = region.witness_W = shared.point_W;
  region.has_witness = region.certain_mm.lo > 0.0;
  region.triangle_a = region.deciding_triangle_a = shared.triangle[0];
  region.triangle_b = region.deciding_triangle_b = shared.triangle[1];
  region.normal_W = -(pair.X_W[0].q * pair.bodies[0].normal(region.triangle_a));
  set_shapes(pair, region);
  region.points_W = {region.point_W};
  return region;
}

// Without an inside there is no depth: the crossing itself, or that the parts are near, is the
// finding.
OverlapRegion region_without_depth(const PairFrame& pair, const Candidates& candidates) {
  OverlapRegion region;
  const double depth = 2.0 * smaller_radius(pair);
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
  region.deciding_triangle_a = region.triangle_a;
  region.deciding_triangle_b = region.triangle_b;
  region.normal_W = pair.X_W[1].q * pair.bodies[1].normal(region.triangle_b);
  set_shapes(pair, region);
  region.points_W = {region.point_W};
  return region;
}

Bracket moved(Bracket bracket, double by_mm) {
  bracket.best.depth_mm += by_mm;
  bracket.hi_mm += by_mm;
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

class Overlap {
 public:
  explicit Overlap(const OverlapQuery& query) : query_(query), pair_(query), planes_(pair_) {}

  OverlapResult run() {
    result_.no_inside = !pair_.bodies[0].has_inside || !pair_.bodies[1].has_inside;
    CandidateQuery near{&pair_, pair_.near_mm, result_.no_inside};
    near.want_meetings = pair_.trivial && !result_.no_inside;
    Candidates candidates = find_candidate_triangles(near);
    known_ = known_overlaps(pair_, candidates);
    for (const KnownFacePair& known : candidates.known)
      if (!told_by_another(known, candidates) && !add_known(known))
        leave_to_search(known, candidates, known_);
    regions_ = find_regions({&pair_, &candidates, &known_, query_.work_cap / 2,
                             query_.refinement == Refinement::kDecided},
                            scratch_, result_.evaluations);
    if (regions_.count > 0) {
      if (query_.only_certain)
        search_certain();
      else
        search_regions();
    }
    // Regions that were left out because nothing is certain in them are told apart from none.
    if (result_.regions.empty() && !(query_.only_certain && regions_.count > 0))
      if (const auto shared = find_shared_inside(pair_, candidates))
        result_.regions.push_back(region_of(pair_, *shared));
    if (result_.no_inside) add_without_depth(candidates);
    planes_.tell(query_.only_certain, result_.regions);
    mark_cracks(pair_, !query_.only_certain, result_);
    for (const OverlapRegion& region : result_.regions)
      result_.meshes_cross |= region.delta_mm.lo > pair_.touch_mm;
    result_.contained = result_.meshes_cross && candidates.triangles[0].empty() &&
                        candidates.triangles[1].empty() && candidates.known.empty();
    if (candidates.cross) result_.meshes_cross = true;
    std::stable_sort(result_.regions.begin(), result_.regions.end(),
                     [](const OverlapRegion& a, const OverlapRegion& b) {
                       return a.delta_mm.lo > b.delta_mm.lo;
                     });
    measure_inside();
    return std::move(result_);
  }

 private:
  // One region whose brackets in both layers are those of the sharp bodies.
  bool told_by_planes() const { return regions_.count == 1 && planes_.has_brackets(); }

  std::uint64_t work_left() const {
    return query_.work_cap - std::min(query_.work_cap, result_.evaluations);
  }

  // Lazily a glance is enough where the class does not hang on a proof.
  std::uint64_t glance() const { return kGlance + kGlancePerRoot * regions_.roots.size(); }

  std::vector<Bracket> search(Layer layer, bool sign_only, std::uint64_t work_cap,
                              double ignore_below_mm = -std::numeric_limits<double>::infinity()) {
    SearchQuery search;
    search.pair = &pair_;
    search.layer = layer;
    search.known = &known_;
    search.roots = &regions_.roots;
    search.regions = regions_.count;
    search.region_of_triangle = &regions_.region_of_triangle;
    search.primary = regions_.primary;
    search.accuracy_mm = std::max(query_.accuracy_mm, pair_.rounding_mm);
    search.ignore_below_mm = ignore_below_mm;
    search.sign_only = sign_only;
    search.work_cap = std::max<std::uint64_t>(work_cap, regions_.roots.size());
    std::vector<Bracket> brackets = search_depth(search, scratch_, result_.evaluations);
    // Triangles that the flood did not come to may lie deeper than any that it did.
    if (regions_.capped)
      for (Bracket& bracket : brackets)
        bracket.hi_mm = std::max(bracket.hi_mm, pair_.deepest_mm(layer));
    return brackets;
  }

  void search_regions() {
    const bool lazy = query_.refinement == Refinement::kDecided;
    const bool shape_only = lazy && !pair_.trivial;
    // Where no layer has to be searched, the meshes may cost more.
    std::vector<Bracket> mesh =
        lazy && told_by_planes()
            ? search(Layer::kMesh, false, std::min(kMeshAlone, work_left()))
            : search(Layer::kMesh, lazy,
                     shape_only ? std::min(glance(), work_left()) : work_left());
    // The sign of the depth is not enough where rounding may cover it.
    const auto in_rounding = [&](const Bracket& d) {
      return d.best.depth_mm > 0.0 && d.best.depth_mm <= pair_.reach_mm(Layer::kLower) &&
             d.hi_mm > pair_.reach_mm(Layer::kLower);
    };
    if (lazy && pair_.trivial && std::any_of(mesh.begin(), mesh.end(), in_rounding))
      mesh = search(Layer::kMesh, false, work_left());
    std::vector<Bracket> upper, lower, lower_lazily;
    bool any_open = false;
    for (const bool open : regions_.may_interfere) any_open |= open;
    if (told_by_planes()) {
      upper = {planes_.told(mesh.front(), Layer::kUpper)};
      lower = {planes_.told(mesh.front(), Layer::kLower)};
    } else if (!pair_.trivial && (any_open || !lazy)) {
      upper = search(Layer::kUpper, true, work_left());
      if (!lazy) upper = better_of(search(Layer::kUpper, false, work_left()), upper);
      bool may_be_certain = false;
      for (const Bracket& p : upper) may_be_certain |= p.hi_mm > pair_.touch_mm;
      // What is not seen to be certain is potential: that none of it is needs no proof.
      if (may_be_certain || !lazy)
        lower = lower_lazily =
            search(Layer::kLower, true,
                   query_.prove_not_certain ? work_left() : std::min(glance(), work_left()));
      if (!lazy) lower = better_of(search(Layer::kLower, false, work_left()), lower_lazily);
    }
    for (std::size_t i = 0; i < regions_.count; ++i) {
      const Bracket& d = mesh[i];
      const Bracket p = pair_.trivial   ? moved(d, pair_.reach_mm(Layer::kUpper))
                        : upper.empty() ? proven_apart(d, Layer::kUpper)
                                        : upper[i];
      const Bracket c = pair_.trivial   ? moved(d, -pair_.reach_mm(Layer::kLower))
                        : lower.empty() ? proven_apart(d, Layer::kLower)
                                        : lower[i];
      // Rounding alone makes no collision of parts that only touch.
      if (d.best.depth_mm <= pair_.touch_mm && (pair_.trivial ? d : p).hi_mm <= pair_.touch_mm)
        continue;
      OverlapRegion region;
      region.delta_mm = bracket_of(d);
      region.possible_mm = bracket_of(p);
      region.certain_mm = bracket_of(c);
      region.certain_mm.hi = std::min(region.certain_mm.hi, region.possible_mm.hi);
      region.certain_mm.lo = std::min(region.certain_mm.lo, region.certain_mm.hi);
      region.area_mm2 = d.area_mm2;
      region.capped = regions_.capped || p.undecided || (!lazy && (d.undecided || c.undecided));
      const Sample& deciding = region.possible_mm.lo > 0.0 ? c.best : p.best;
      describe(pair_, d.best, deciding, region);
      for (const Sample& sample : d.samples)
        region.points_W.push_back(pair_.in_world(sample.role, sample.point_K));
      region.points_W.push_back(region.point_W);
      if (region.certain_mm.lo > 0.0 && !told_by_planes()) {
        try_witness(c.best, region);
        if (!lower_lazily.empty()) try_witness(lower_lazily[i].best, region);
        for (const Sample& sample : c.samples) try_witness(sample, region);
      }
      set_grade(pair_, regions_, i, {&deciding, &c.best}, region);
      result_.regions.push_back(std::move(region));
    }
  }

  void search_certain() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const Layer layer = pair_.trivial ? Layer::kMesh : Layer::kLower;
    const bool lazy = query_.refinement == Refinement::kDecided;
    for (const Bracket& found : search(layer, lazy, work_left(), query_.ignore_below_mm)) {
      const Bracket c = pair_.trivial ? moved(found, -pair_.reach_mm(Layer::kLower)) : found;
      if (c.hi_mm <= pair_.touch_mm + query_.certain_from_mm) continue;
      OverlapRegion region;
      region.certain_mm = bracket_of(c);
      region.possible_mm = {region.certain_mm.lo, kInfinity};
      region.delta_mm = {-kInfinity, kInfinity};
      region.capped = regions_.capped || c.undecided;
      describe(pair_, c.best, c.best, region);
      result_.regions.push_back(std::move(region));
    }
  }

  // Parts that lie deep in each other are deeper inside than at their surfaces: the deepest region
  // tells the depth of the parts.
  void measure_inside() {
    if (result_.no_inside || !query_.want_delta || query_.only_certain || result_.regions.empty())
      return;
    OverlapRegion& region = result_.regions.front();
    if (region.at_crack || region.delta_mm.lo < -pair_.touch_mm) return;  // not known, or apart
    const bool full = query_.refinement == Refinement::kFull;
    const std::vector<Vec3> deepest = {region.point_W};
    const auto inner = find_inner_overlap(
        pair_, {full ? region.points_W : deepest, std::max(0.0, region.delta_mm.lo), full},
        full ? kInnerQuestions : std::min(kInnerQuestionsLazily, work_left()), result_.evaluations);
    if (!inner) return;
    const Interval& delta = inner->depth_mm;
    // The surfaces say the same, and closer.
    if (delta.lo <= region.delta_mm.hi && region.delta_mm.width() <= delta.width()) return;
    region.delta_mm = delta;
    region.point_W = inner->point_W;
    const auto widened = [&](const Interval& known, Layer layer) {
      const double reach_mm = pair_.reach_mm(layer);
      const double by_mm = layer == Layer::kLower ? -reach_mm : reach_mm;
      if (pair_.trivial) return Interval{delta.lo + by_mm, delta.hi + by_mm};
      return Interval{std::max(known.lo, delta.lo - reach_mm), delta.hi + reach_mm};
    };
    region.certain_mm = widened(region.certain_mm, Layer::kLower);
    region.possible_mm = widened(region.possible_mm, Layer::kUpper);
    if (region.has_witness || inner->in_either_mm <= pair_.reach_mm(Layer::kLower)) return;
    region.has_witness = true;
    region.witness_W = inner->point_W;
  }

  // No admissible surfaces of the region interfere; how far from it at the deepest point of the
  // mesh.
  Bracket proven_apart(const Bracket& mesh, Layer layer) const {
    Bracket apart;
    apart.hi_mm = 0.0;
    apart.best = mesh.best;
    if (std::isfinite(mesh.best.depth_mm))
      apart.best = sample_at(pair_, layer, mesh.best.role, mesh.best.triangle,
                             pair_.X_KS[1 - mesh.best.role] * mesh.best.point_K);
    apart.best.depth_mm = std::min(apart.best.depth_mm, 0.0);
    return apart;
  }

  Interval bracket_of(const Bracket& bracket) const {
    return without_touch({bracket.best.depth_mm, bracket.hi_mm}, pair_.touch_mm);
  }

  // From another point of the least surface, where there is no witness yet.
  void try_witness(const Sample& from, OverlapRegion& region) {
    if (region.has_witness || !(from.depth_mm > pair_.touch_mm)) return;
    set_witness(find_witness(pair_, from, result_.evaluations, &region.witnesses_refused), from,
                region);
  }

  void set_witness(const std::optional<Vec3>& witness_W, const Sample& from,
                   OverlapRegion& region) const {
    region.has_witness = witness_W.has_value();
    if (!witness_W) return;
    region.witness_W = *witness_W;
    region.certain_place = {from.role, from.triangle, pair_.X_KS[1 - from.role] * from.point_K};
  }

  // A pair of declared faces whose overlap has a closed form: only the overlap of the meshes is
  // searched. False: it is certain by its closed form only, which knows no neighbour that cuts a
  // face short.
  bool add_known(const KnownFacePair& known) {
    const SurfaceBand::Face& face_a = pair_.bodies[0].band->faces[known.face[0]];
    const SurfaceBand::Face& face_b = pair_.bodies[1].band->faces[known.face[1]];
    const auto offsets = [&](Layer layer) {
      return Body::offset_of(face_a, layer) + Body::offset_of(face_b, layer);
    };
    const double lower = offsets(Layer::kLower), upper = offsets(Layer::kUpper);
    OverlapRegion region;
    const auto [at_least, at_most] = known.overlap.of_layer_mm;
    region.possible_mm = without_touch({at_most.lo + upper, at_most.hi + upper}, pair_.touch_mm);
    region.certain_mm = without_touch({at_least.lo + lower, at_least.hi + lower}, pair_.touch_mm);
    region.grade = std::max(face_a.grade, face_b.grade);
    for (const SurfaceBand::Face* face : {&face_a, &face_b})
      region.estimated |= face->grade == DeviationGrade::kEstimated;
    if (region.certain_mm.lo > 0.0) {
      Sample least;
      const auto witness_W = known_witness(known, least, region.witnesses_refused);
      if (!witness_W && query_.only_certain) return false;
      set_witness(witness_W, least, region);
    }
    Bracket mesh = mesh_overlap_of(known);
    // The meshes stand out of the true surfaces by no more than this.
    const double excess =
        std::max(0.0, -face_a.deviation_mm.lo) + std::max(0.0, -face_b.deviation_mm.lo);
    mesh.hi_mm = std::max(mesh.best.depth_mm, std::min(mesh.hi_mm, known.overlap.hi_mm + excess));
    if (mesh.best.depth_mm <= pair_.touch_mm && region.possible_mm.hi <= 0.0 && query_.want_delta)
      return true;
    region.delta_mm = bracket_of(mesh);
    if (std::isfinite(mesh.best.depth_mm)) {
      describe(pair_, mesh.best, mesh.best, region);
    } else {
      region.point_W = pair_.X_W[1] * known.overlap.point_B;
      region.normal_W = pair_.X_W[1].q * known.overlap.normal_B;
    }
    region.area_mm2 = mesh.area_mm2;
    for (const Sample& sample : mesh.samples)
      region.points_W.push_back(pair_.in_world(sample.role, sample.point_K));
    region.points_W.push_back(region.point_W);
    result_.regions.push_back(std::move(region));
    return true;
  }

  // From the point that the closed form names, and from others farther from the end of its face.
  std::optional<Vec3> known_witness(const KnownFacePair& known, Sample& least,
                                    std::uint64_t& refused) {
    const int role = pair_.bodies[0].band->faces[known.face[0]].surface->inward ? 1 : 0;
    const SurfaceBand::Face& convex = pair_.s(role).band->faces[known.face[role]];
    const SurfaceBand::Face& hollow = pair_.k(role).band->faces[known.face[1 - role]];
    const Surface& surface = *convex.surface;
    const Vec3 named_S =
        role == 0 ? Vec3(pair_.X_KS[1] * known.overlap.point_B) : known.overlap.point_B;
    const double z = (named_S - surface.point).dot(surface.axis);
    const double to_middle = pair_.s(role).extent_of(known.face[role]).middle() - z;
    for (const double share : kWitnessShares) {
      Vec3 x = named_S + share * to_middle * surface.axis;
      const Vec3 n = surface.outward_normal(x);
      x += (Body::offset_of(convex, Layer::kLower) - surface.signed_distance_mm(x)) * n;
      least.role = role;
      least.point_K = pair_.X_KS[role] * x;
      least.depth_mm = Body::offset_of(hollow, Layer::kLower) -
                       hollow.surface->signed_distance_mm(least.point_K);
      if (!(least.depth_mm > 0.0)) continue;
      least.at = nearest_surface(*pair_.k(role).solid, least.point_K);
      least.triangle = nearest_point(*pair_.s(role).solid, x).triangle;
      if (const auto witness = find_witness(pair_, least, result_.evaluations, &refused))
        return witness;
    }
    return std::nullopt;
  }

  Bracket mesh_overlap_of(const KnownFacePair& known) {
    Bracket found;
    found.hi_mm = std::numeric_limits<double>::infinity();
    if (!query_.want_delta) return found;
    const std::size_t questions =
        query_.refinement == Refinement::kFull ? kKnownQuestions : kKnownQuestionsLazily;
    for (int role = 0; role < 2; ++role) {
      if (!pair_.k(role).has_inside) continue;
      const std::vector<std::uint32_t>& triangles = known.triangles[role];
      const double step =
          std::max(1.0, static_cast<double>(triangles.size()) / static_cast<double>(questions));
      for (double i = 0.0; i < static_cast<double>(triangles.size()); i += step) {
        const std::uint32_t t = triangles[static_cast<std::size_t>(i)];
        for (const Vec3& x : probe_points(*pair_.s(role).mesh, t)) {
          ++result_.evaluations;
          const Sample sample = sample_at(pair_, Layer::kMesh, role, t, x);
          if (sample.depth_mm > found.best.depth_mm) found.best = sample;
          if (sample.depth_mm > pair_.touch_mm && found.samples.size() < kKnownQuestions)
            found.samples.push_back(sample);
        }
      }
    }
    if (query_.refinement != Refinement::kFull) return found;
    std::vector<Root> roots;
    for (int role = 0; role < 2; ++role)
      for (const std::uint32_t t : known.triangles[role])
        if (pair_.k(role).has_inside) roots.push_back({role, t, 0});
    SearchQuery search;
    search.pair = &pair_;
    search.roots = &roots;
    search.accuracy_mm = std::max(query_.accuracy_mm, pair_.rounding_mm);
    search.work_cap = work_left() / 2;
    Bracket full = search_depth(search, scratch_, result_.evaluations).front();
    if (full.best.depth_mm < found.best.depth_mm) full.best = found.best;
    return full;
  }

  void add_without_depth(const Candidates& candidates) {
    const bool near = !pair_.trivial && !candidates.triangles[0].empty();
    if (!candidates.cross && !near) return;
    for (const OverlapRegion& region : result_.regions)
      if (region.delta_mm.lo > 0.0) return;  // the closed part of the two found it already
    if (!result_.regions.empty() && !candidates.cross) return;
    result_.regions.push_back(region_without_depth(pair_, candidates));
  }

  const OverlapQuery& query_;
  const PairFrame pair_;
  const PlanePair planes_;
  SearchScratch scratch_;
  KnownOverlaps known_;
  Regions regions_;
  OverlapResult result_;
};

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
  const OverlapResult result =
      b_comes_first(query) ? mirrored(Overlap(mirrored(query)).run()) : Overlap(query).run();
  check(query, result);
  return result;
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
