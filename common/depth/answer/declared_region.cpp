#include "common/depth/answer/declared_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/depth/answer/region_report.h"
#include "common/math/rotation.h"

namespace mortise {
namespace {

// Triangles of a face that are asked how far the meshes overlap: those nearest to where the closed
// form is reached, and some all over it; more of these where the class hangs on whether the meshes
// overlap at all.
constexpr std::size_t kNearest = 4, kAllOver = 4, kAllOverMore = 24;
// Contact points kept for the fitted separating motion, which looks at 32 of all regions.
constexpr std::size_t kMostContactPoints = 24;
// Where a witness is looked for: shares of the way to the middle of the face.
constexpr double kMiddleShares[] = {0.0, 0.002, 0.02, 0.1, 0.4, 1.0};

// Of a torus along its tube, to so far.
constexpr double kWitnessTurn_rad = 0.5;

// Corners, middles of edges, centre.
std::array<Vec3, 7> probe_points(const TriangleMesh& mesh, std::uint32_t t) {
  const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
  return {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0};
}

class DeclaredSearch {
 public:
  DeclaredSearch(const PairFrame& pair, const OverlapQuery& query, std::uint64_t mesh_work,
                 SearchScratch& scratch, std::uint64_t& evaluations)
      : pair_(pair),
        query_(query),
        mesh_work_(mesh_work),
        scratch_(scratch),
        evaluations_(evaluations) {}

  DeclaredRegion find(const KnownFacePair& known) {
    const SurfaceBand::Face& face_a = pair_.bodies[0].band->faces[known.face[0]];
    const SurfaceBand::Face& face_b = pair_.bodies[1].band->faces[known.face[1]];
    const auto offsets = [&](Layer layer) {
      return Body::offset_of(face_a, layer) + Body::offset_of(face_b, layer);
    };
    const double lower = offsets(Layer::kLower), upper = offsets(Layer::kUpper);
    OverlapRegion region;
    region.closed_form = true;
    const auto [at_least, at_most] = known.overlap.of_layer_mm;
    region.possible_mm = without_touch({at_most.lo + upper, at_most.hi + upper}, pair_.touch_mm);
    region.certain_mm = without_touch({at_least.lo + lower, at_least.hi + lower}, pair_.touch_mm);
    region.grade = std::max(face_a.grade, face_b.grade);
    for (const SurfaceBand::Face* face : {&face_a, &face_b})
      region.estimated |= face->grade == DeviationGrade::kEstimated;
    if (region.certain_mm.lo > 0.0) {
      Sample least;
      const auto witness_W = known_witness(known, least, region.witnesses_refused);
      if (!witness_W && query_.only_certain) return {.left_to_search = true, .region = {}};
      set_witness(pair_, witness_W, least, region);
    }
    Bracket mesh = mesh_overlap_of(known, region.possible_mm.hi > 0.0);
    // The meshes stand out of the true surfaces by no more than this.
    const double excess =
        std::max(0.0, -face_a.deviation_mm.lo) + std::max(0.0, -face_b.deviation_mm.lo);
    const double most_mm = known.overlap.hi_mm + excess;
    mesh.hi_mm = std::max(mesh.best.depth_mm, std::min(mesh.hi_mm, most_mm));
    if (mesh.best.depth_mm <= pair_.touch_mm && region.possible_mm.hi <= 0.0 && query_.want_delta)
      return {};
    region.delta_mm = without_touch({mesh.best.depth_mm, mesh.hi_mm}, pair_.touch_mm);
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
    return {false, std::move(region), most_mm};
  }

 private:
  std::uint64_t work_left() const {
    return query_.work_cap - std::min(query_.work_cap, evaluations_);
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
    for (const double share : kMiddleShares) {
      // Along a shaft, or along a tube.
      Vec3 x = named_S + share * to_middle * surface.axis;
      if (surface.kind == SurfaceKind::kTorus)
        x = surface.point +
            rotation_exp(share * kWitnessTurn_rad * surface.axis) * (named_S - surface.point);
      const Vec3 n = surface.outward_normal(x);
      x += (Body::offset_of(convex, Layer::kLower) - surface.signed_distance_mm(x)) * n;
      least.role = role;
      least.point_K = pair_.X_KS[role] * x;
      least.depth_mm = Body::offset_of(hollow, Layer::kLower) -
                       hollow.surface->signed_distance_mm(least.point_K);
      if (!(least.depth_mm > 0.0)) continue;
      least.at = nearest_surface(*pair_.k(role).solid, least.point_K);
      least.triangle = nearest_point(*pair_.s(role).solid, x).triangle;
      if (const auto witness = find_witness(pair_, least, evaluations_, &refused)) return witness;
    }
    return std::nullopt;
  }

  void ask(int role, std::uint32_t triangle, std::uint32_t& near, Bracket& found) {
    for (const Vec3& x : probe_points(*pair_.s(role).mesh, triangle)) {
      ++evaluations_;
      const Sample sample = sample_at(pair_, Layer::kMesh, role, triangle, x, near);
      near = sample.at.triangle;
      if (sample.depth_mm > found.best.depth_mm) found.best = sample;
      if (sample.depth_mm > pair_.touch_mm && found.samples.size() < kMostContactPoints)
        found.samples.push_back(sample);
    }
  }

  void ask_nearest(const KnownFacePair& known, Bracket& found) {
    for (const int role : {0, 1}) {
      if (!pair_.k(role).has_inside) continue;
      const Vec3 named_S =
          role == 0 ? Vec3(pair_.X_KS[1] * known.overlap.point_B) : known.overlap.point_B;
      const TriangleMesh& mesh = *pair_.s(role).mesh;
      std::vector<std::pair<double, std::uint32_t>> by_distance;
      for (const std::uint32_t t : known.triangles[role]) {
        const Vec3 middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
        by_distance.emplace_back((middle - named_S).squaredNorm(), t);
      }
      const std::size_t count = std::min(kNearest, by_distance.size());
      std::partial_sort(by_distance.begin(),
                        by_distance.begin() + static_cast<std::ptrdiff_t>(count),
                        by_distance.end());
      std::uint32_t near = Topology::kNone;  // of the point before
      for (std::size_t i = 0; i < count; ++i) ask(role, by_distance[i].second, near, found);
    }
  }

  void ask_all_over(const KnownFacePair& known, std::size_t most, Bracket& found) {
    for (const int role : {0, 1}) {
      if (!pair_.k(role).has_inside) continue;
      const std::vector<std::uint32_t>& triangles = known.triangles[role];
      const double count = static_cast<double>(triangles.size());
      const double step = std::max(1.0, count / static_cast<double>(most));
      std::uint32_t near = Topology::kNone;
      for (double i = 0.0; i < count; i += step)
        ask(role, triangles[static_cast<std::size_t>(i)], near, found);
    }
  }

  Bracket mesh_overlap_of(const KnownFacePair& known, bool is_possible) {
    Bracket found;
    found.hi_mm = std::numeric_limits<double>::infinity();
    if (!query_.want_delta) return found;
    ask_nearest(known, found);
    const bool decides = !is_possible && found.best.depth_mm <= pair_.touch_mm;
    ask_all_over(known, decides ? kAllOverMore : kAllOver, found);
    if (mesh_work_ == 0) return found;
    std::vector<Root> roots;
    for (int role = 0; role < 2; ++role)
      for (const std::uint32_t t : known.triangles[role])
        if (pair_.k(role).has_inside) roots.push_back({role, t, 0});
    SearchQuery search;
    search.pair = &pair_;
    search.roots = &roots;
    search.accuracy_mm = std::max(query_.accuracy_mm, pair_.rounding_mm);
    search.sign_only = query_.refinement != Refinement::kFull;
    search.work_cap = std::min(work_left() / 2, mesh_work_);
    Bracket full = search_depth(search, scratch_, evaluations_).front();
    if (full.best.depth_mm < found.best.depth_mm) full.best = found.best;
    return full;
  }

  const PairFrame& pair_;
  const OverlapQuery& query_;
  const std::uint64_t mesh_work_;
  SearchScratch& scratch_;
  std::uint64_t& evaluations_;
};

}  // namespace

DeclaredRegion find_declared_region(const PairFrame& pair, const OverlapQuery& query,
                                    const KnownFacePair& known, std::uint64_t mesh_work,
                                    SearchScratch& scratch, std::uint64_t& evaluations) {
  return DeclaredSearch(pair, query, mesh_work, scratch, evaluations).find(known);
}

}  // namespace mortise
