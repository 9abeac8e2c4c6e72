#include "common/depth/answer/plane_pair.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/ccd/distance.h"
#include "common/depth/answer/region_report.h"
#include "common/depth/cells/sharp_window.h"

namespace mortise {
namespace {

// Depths are told up to so many times what all offsets make together; beyond, so much deeper.
// Of convex parts however deep.
constexpr double kDepths = 2.0, kDeeper = 4.0, kAnyDepth = 2.0;
// Meshes that touch are looked at to a depth of so many times what counts as touching.
constexpr double kTouches = 10.0;
// A place for a later look lies this share of the way from the witness to the face of A.
constexpr double kTowardsFace = 0.9;

// Offsets of both layers and both parts, mm.
double all_offsets_mm(const PairFrame& pair) {
  double sum = 0.0;
  for (const Body& body : pair.bodies)
    for (const Layer layer : {Layer::kLower, Layer::kUpper})
      sum += body.largest_offset_mm[static_cast<int>(layer)];
  return sum;
}

// Of any face, round ones as well: what is within reach must be seen.
double most_offset_mm(const Body& body) {
  return std::max(body.largest_offset_mm[static_cast<int>(Layer::kLower)],
                  body.largest_offset_mm[static_cast<int>(Layer::kUpper)]);
}

bool has_plane_faces(const Body& body) {
  return body.has_inside &&
         std::any_of(body.band->faces.begin(), body.band->faces.end(),
                     [&](const auto& face) { return is_plane_band(*body.band, face); }) &&
         !body.plane_faces().faces.empty();
}

// The depth in all faces is that in the part.
bool is_convex(const Body& body, double nothing_mm) {
  const Outline& outline = body.solid->outline();
  return outline.complete && outline.convex_slack_mm <= nothing_mm;
}

}  // namespace

PlanePair::PlanePair(const PairFrame& pair) : pair_(pair) {
  if (pair.trivial || !has_plane_faces(pair.bodies[0]) || !has_plane_faces(pair.bodies[1])) return;
  const bool convex =
      is_convex(pair.bodies[0], pair.touch_mm) && is_convex(pair.bodies[1], pair.touch_mm);
  look(kDepths * all_offsets_mm(pair));
  // Windows that reach farther may know less of the signs: what is known stays.
  if (!decided_ || has_brackets()) return;
  const SharpDecision near = decision_;
  const double near_mm = depth_mm_;
  const double most_mm = convex ? kAnyDepth * pair.deepest_mm(Layer::kUpper) : 0.0;
  for (const double depth_mm : {kDeeper * near_mm, most_mm}) {
    if (!(depth_mm > near_mm)) continue;
    look(depth_mm, &near);
    if (has_brackets()) return;
  }
  decision_ = near;
  depth_mm_ = near_mm;
  decided_ = true;
}

void PlanePair::look(double depth_mm, const SharpDecision* known) {
  if (!(depth_mm > pair_.touch_mm)) return;
  depth_mm_ = depth_mm;
  SharpQuery query;
  query.a = {pair_.bodies[0].solid, &pair_.bodies[0].plane_faces()};
  query.b = {pair_.bodies[1].solid, &pair_.bodies[1].plane_faces()};
  query.X_BA = pair_.X_KS[0];
  query.depth_mm = depth_mm;
  query.known = known;
  decision_ = decide(query);
  const auto has_sign = [&](const SharpDepth& depth) {
    return depth.margin_mm.hi <= pair_.touch_mm ||
           (depth.has_point && depth.margin_mm.lo > pair_.touch_mm);
  };
  decided_ = decision_.state == SharpDecision::State::kDecided && has_sign(decision_.least) &&
             has_sign(decision_.largest);
}

std::optional<Interval> PlanePair::bracket_mm(Layer layer) const {
  const SharpDepth& depth = depth_of(layer);
  if (!(depth.margin_mm.lo > pair_.touch_mm)) {
    if (!std::isfinite(depth.margin_mm.lo)) return std::nullopt;
    const Interval gap{depth.margin_mm.lo / depth.facing, depth.margin_mm.hi / depth.facing};
    return without_touch(gap, pair_.touch_mm);
  }
  // A deeper point would show with as much.
  if (!(depth.overlap_mm.hi < depth_mm_)) return std::nullopt;
  return depth.overlap_mm;
}

double PlanePair::upper_mm(Layer layer) const {
  if (const auto bracket = bracket_mm(layer)) return bracket->hi;
  return depth_of(layer).margin_mm.hi <= pair_.touch_mm ? 0.0 : kInfinity;
}

OverlapRegion& PlanePair::nearest(std::vector<OverlapRegion>& regions, const Vec3& x_W) const {
  OverlapRegion* found = &regions.front();
  double least = kInfinity;
  for (OverlapRegion& region : regions)
    for (const Vec3& at : region.points_W)
      if (const double d = (at - x_W).squaredNorm(); d < least) {
        least = d;
        found = &region;
      }
  return *found;
}

void PlanePair::name_faces(const SharpDepth& depth, OverlapRegion& region) const {
  region.deciding_triangle_a = pair_.bodies[0].plane_faces().faces[depth.face_a].triangle;
  region.deciding_triangle_b = pair_.bodies[1].plane_faces().faces[depth.face_b].triangle;
  region.shape_a = region.shape_b = FaceShape::kPlanar;
}

void PlanePair::tell_least(OverlapRegion& region) const {
  const SharpDepth& least = decision_.least;
  if (const auto bracket = bracket_mm(Layer::kLower)) region.certain_mm = *bracket;
  if (!certain()) return;
  region.certain_mm.lo = least.overlap_mm.lo;  // by triangles it may be beyond a moved neighbour
  region.certain_mm.hi = std::max(region.certain_mm.lo, region.certain_mm.hi);
  region.possible_mm.hi = std::max(region.possible_mm.hi, region.certain_mm.hi);
  region.possible_mm.lo = std::max(region.possible_mm.lo, region.certain_mm.lo);
  region.has_witness = true;
  region.witness_W = pair_.X_W[1] * least.point_B;
  const PlaneFace& face = pair_.bodies[0].plane_faces().faces[least.face_a];
  region.certain_place = {
      0, face.triangle,
      pair_.X_KS[1] * least.point_B + kTowardsFace * 0.5 * least.margin_mm.lo * face.n};
  name_faces(least, region);
}

void PlanePair::tell_largest(OverlapRegion& region) const {
  if (const auto bracket = bracket_mm(Layer::kUpper)) region.possible_mm = *bracket;
  region.certain_mm.hi = std::min(region.certain_mm.hi, region.possible_mm.hi);
  region.certain_mm.lo = std::min(region.certain_mm.lo, region.certain_mm.hi);
  if (decision_.largest.has_point) name_faces(decision_.largest, region);
}

Bracket PlanePair::told(const Bracket& mesh, Layer layer) const {
  const Interval bracket = *bracket_mm(layer);
  Bracket told = mesh;
  told.best.depth_mm = bracket.lo;
  told.hi_mm = bracket.hi;
  told.undecided = false;
  return told;
}

void PlanePair::tell(bool only_certain, std::vector<OverlapRegion>& regions) const {
  if (!decided_) return;
  if (regions.empty() && (only_certain ? certain() : possible())) regions.push_back(region());
  if (regions.empty()) return;
  const double possible_mm = upper_mm(Layer::kUpper);
  const double certain_mm = std::min(possible_mm, upper_mm(Layer::kLower));
  for (OverlapRegion& region : regions) {
    const auto at_most = [](Interval& bracket, double most) {
      bracket.hi = std::min(bracket.hi, most);
      bracket.lo = std::min(bracket.lo, bracket.hi);
    };
    at_most(region.possible_mm, possible_mm);
    at_most(region.certain_mm, std::min(certain_mm, region.possible_mm.hi));
    if (!certain()) region.has_witness = false;
  }
  const auto place = [&](const SharpDepth& depth) -> OverlapRegion& {
    return depth.has_point ? nearest(regions, pair_.X_W[1] * depth.point_B) : regions.front();
  };
  tell_largest(place(decision_.largest));
  tell_least(place(certain() ? decision_.least : decision_.largest));
  // Where no point of one mesh lies in the other, delta is the gap, found faster than by search.
  Interval& delta_mm = regions.front().delta_mm;
  if (regions.size() == 1 && delta_mm.lo <= 0.0 && delta_mm.width() > pair_.touch_mm)
    if (const double gap = gap_mm(); gap > pair_.touch_mm) delta_mm = {-gap, -gap};
  if (!only_certain) return;
  for (OverlapRegion& region : regions) region.possible_mm = {region.certain_mm.lo, kInfinity};
}

double PlanePair::gap_mm() const {
  CcdScratch scratch;
  return distance(*pair_.bodies[0].solid, pair_.X_W[0], *pair_.bodies[1].solid, pair_.X_W[1],
                  scratch)
      .distance_mm;
}

OverlapRegion PlanePair::region() const {
  const SharpDepth& largest = decision_.largest;
  OverlapRegion region;
  const double gap = gap_mm();
  double inwards_mm = 0.0, outwards_mm = 0.0;
  for (const Body& body : pair_.bodies) {
    inwards_mm += body.plane_faces().most_travel.by_band_mm;
    outwards_mm += body.plane_faces().most_travel.outward_mm;
  }
  region.delta_mm = {-gap, -gap};
  region.possible_mm = {largest.overlap_mm.lo, std::max(largest.overlap_mm.lo, outwards_mm - gap)};
  region.certain_mm = {-gap - inwards_mm, 0.0};
  region.point_W = pair_.X_W[1] * largest.point_B;
  name_faces(largest, region);
  region.triangle_a = region.deciding_triangle_a;
  region.triangle_b = region.deciding_triangle_b;
  region.normal_W = pair_.X_W[1].q * pair_.bodies[1].plane_faces().faces[largest.face_b].n;
  region.points_W = {region.point_W};
  return region;
}

bool meshes_do_not_overlap(const PairFrame& pair) {
  if (!has_plane_faces(pair.bodies[0]) || !has_plane_faces(pair.bodies[1])) return false;
  std::array<PlaneFaces, 2> planes = {pair.bodies[0].plane_faces(), pair.bodies[1].plane_faces()};
  for (PlaneFaces& of_part : planes)
    for (PlaneFace& face : of_part.faces) face.offset_mm = {};
  SharpQuery query;
  query.a = {pair.bodies[0].solid, &planes[0]};
  query.b = {pair.bodies[1].solid, &planes[1]};
  query.X_BA = pair.X_KS[0];
  query.depth_mm = kTouches * pair.touch_mm;
  const SharpDecision decision = decide(query);
  return decision.state == SharpDecision::State::kDecided &&
         decision.largest.margin_mm.hi <= pair.touch_mm + planes[0].noise_mm + planes[1].noise_mm;
}

bool is_outside_of_least_bodies(const PairFrame& pair, const Vec3& x_W) {
  if (pair.trivial) return false;
  for (int i = 0; i < 2; ++i) {
    const Body& body = pair.bodies[i];
    if (!has_plane_faces(body)) continue;
    const PlaneFaces& planes = body.plane_faces();
    Box point;
    point.add(pair.X_W[i].inverse() * x_W);
    const double reach_mm =
        std::max(planes.most_travel.by_band_mm, PlaneFaces::kUsualTravel * most_offset_mm(body));
    SharpWindow window(*body.solid, planes, point, reach_mm + pair.touch_mm, 0.0);
    if (window.state() != SharpWindow::State::kReady) continue;
    FaceSet held = 0;
    for (std::size_t f = 0; f < window.faces().size(); ++f) {
      const PlaneFace& face = planes.faces[window.faces()[f]];
      if (face.n.dot(point.lo) < face.c + face.offset_mm.lo - planes.noise_mm)
        held |= FaceSet{1} << f;
    }
    if (!window.in_least(held)) return true;
  }
  return false;
}

}  // namespace mortise
