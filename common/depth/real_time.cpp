#include <algorithm>
#include <cmath>
#include <limits>

#include "common/depth/candidates.h"
#include "common/depth/overlap.h"
#include "common/depth/region_report.h"
#include "common/depth/regions.h"
#include "common/depth/search.h"

namespace mortise {
namespace {

// Branch and bound over (piece of surface) x (interval of time), earliest first, in the layer of
// the least surfaces:
//   1. triangles of either part that the path may bring near the other part: the first items;
//   2. an item that is proven outside for its whole interval is dropped;
//   3. an item whose centre is inside at the interval's start gives a time at which the overlap is
//      certain: nothing later matters any more;
//   4. else it is halved, in time while the path is longer than the piece is wide, else in space.
// An item that becomes smaller than the accuracy ends its branch: the time before it is free.

// Thinner overlaps than the accuracy asked for end here as "not proven": pieces are not cut below
// this share of it.
constexpr double kSmallestShare = 0.25;

struct Span {
  double t0 = 0.0, t1 = 1.0;
};

struct Item {
  Span span;
  Piece piece;
  int role = 0;
  std::uint64_t order = 0;
};

bool later(const Item& a, const Item& b) {
  if (a.span.t0 != b.span.t0) return a.span.t0 > b.span.t0;
  return a.order > b.order;
}

class RealTimeSearch {
 public:
  explicit RealTimeSearch(const SweptQuery& query)
      : query_(query),
        at_(query.at_target),
        bodies_{Body(*at_.a, *at_.band_a), Body(*at_.b, *at_.band_b)},
        motions_{query.motion_a, query.motion_b},
        radius_{at_.a->sphere().radius_mm, at_.b->sphere().radius_mm} {
    trivial_ = at_.band_a->trivial && at_.band_b->trivial;
    layer_ = trivial_ ? Layer::kMesh : Layer::kLower;
    at_.X_WA = motions_[0].pose_at(0.0);
    at_.X_WB = motions_[1].pose_at(0.0);
  }

  RealTime run() {
    if (!bodies_[0].has_inside && !bodies_[1].has_inside) return answer_;
    const PairFrame start(at_);
    rounding_mm_ = start.rounding_mm;
    touch_mm_ = start.touch_mm;
    find_known();
    add_roots(start);
    std::make_heap(heap_.begin(), heap_.end(), later);
    double free_until = std::numeric_limits<double>::infinity();
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end(), later);
      const Item item = std::move(heap_.back());
      heap_.pop_back();
      if (item.span.t0 >= t_real_ || item.span.t0 >= free_until) break;
      if (answer_.evaluations >= at_.work_cap) {
        answer_.capped = true;
        free_until = std::min(free_until, item.span.t0);
        break;
      }
      if (!treat(item)) free_until = std::min(free_until, item.span.t0);
    }
    return finish(free_until);
  }

 private:
  // Relative pose X_KS at t.
  Pose pose(int role, double t) const {
    return motions_[1 - role].pose_at(t).inverse() * motions_[role].pose_at(t);
  }

  double speed_upper_bound() const {
    return motions_[0].travel_upper_bound_mm(radius_[0], 0.0, 1.0) +
           motions_[1].travel_upper_bound_mm(radius_[0] + radius_[1] + gap_upper_bound(), 0.0, 1.0);
  }

  // Distance of the parts' reference points is at most this when they are near each other.
  double gap_upper_bound() const { return radius_[0] + radius_[1]; }

  // A point of S seen from K: |x''| <= |x_S''| + 2 |w_K| |v| + |w_K|^2 d, all points within both
  // spheres of each other.
  double acceleration_upper_bound(int role) const {
    const Motion &s = motions_[role], &k = motions_[1 - role];
    const double ws = s.w_W.norm(), wk = k.w_W.norm();
    const double rs = 2.0 * radius_[role] + s.turn_radius_mm();
    const double d = 2.0 * (radius_[0] + radius_[1]) + k.turn_radius_mm();
    const double vs = s.travel_upper_bound_mm(2.0 * radius_[role], 0.0, 1.0);
    const double vk = k.travel_upper_bound_mm(d, 0.0, 1.0);
    if (ws == 0.0 && wk == 0.0) return 0.0;
    return ws * ws * rs + 2.0 * wk * (vs + vk) + wk * wk * d;
  }

  double spread(int role, const Span& span) const {
    const double dt = span.t1 - span.t0;
    return acceleration_upper_bound(role) * dt * dt / 8.0;
  }

  double turn(const Span& span) const {
    return (motions_[0].w_W.norm() + motions_[1].w_W.norm()) * (span.t1 - span.t0);
  }

  // Pairs of declared faces with a closed form: its bound over the tick. The distance of the axes
  // is a convex function of the pose's displacement, so its largest value is at an end of the path,
  // up to the path's own curvature.
  void find_known() {
    if (trivial_) return;
    const double bend = spread(0, {0.0, 1.0}) + spread(1, {0.0, 1.0});
    const Pose X_BA[2] = {pose(0, 0.0), pose(0, 1.0)};
    const double margin = speed_upper_bound();
    for (std::uint16_t i = 0; i < bodies_[0].band->faces.size(); ++i)
      for (std::uint16_t j = 0; j < bodies_[1].band->faces.size(); ++j) {
        const SurfaceBand::Face& fa = bodies_[0].band->faces[i];
        const SurfaceBand::Face& fb = bodies_[1].band->faces[j];
        const Surface* sa = Body::surface_of(fa, layer_);
        const Surface* sb = Body::surface_of(fb, layer_);
        if (sa == nullptr || sb == nullptr || sa->kind != sb->kind || sa->inward == sb->inward)
          continue;
        const FaceExtent ea = extent_of(bodies_[0], i, *sa), eb = extent_of(bodies_[1], j, *sb);
        double worst = -std::numeric_limits<double>::infinity();
        bool known = true;
        for (const Pose& X : X_BA) {
          const auto overlap = face_pair_overlap(*sa, ea, *sb, eb, X, margin);
          known &= overlap.has_value();
          if (overlap) worst = std::max(worst, overlap->hi_mm);
        }
        if (known) known_.rows.push_back({{i, j}, worst + bend});
      }
  }

  // Triangles that the path may bring near the other part, and shells that start inside it.
  void add_roots(const PairFrame& start) {
    KnownOverlaps never;
    for (const KnownOverlaps::Row& row : known_.rows) {
      double most = row.overlap_mm;
      for (int i = 0; i < 2; ++i)
        most += Body::offset_of(bodies_[i].band->faces[row.face[i]], layer_);
      if (most <= touch_mm_) never.rows.push_back(row);
    }
    CandidateQuery query;
    query.pair = &start;
    query.margin_mm = speed_upper_bound();
    for (const Body& body : bodies_)
      query.margin_mm += body.largest_offset_mm[static_cast<int>(layer_)];
    query.skip = &never;
    const Candidates candidates = find_candidates(query);
    for (int role = 0; role < 2; ++role)
      if (bodies_[1 - role].has_inside)
        for (const std::uint32_t t : candidates.triangles[role]) add_root(role, t);
    for (const ContainedShell& shell : contained_shells(start, answer_.evaluations))
      add_root(shell.role, shell.triangle);
  }

  void add_root(int role, std::uint32_t t) {
    const TriangleMesh& mesh = *bodies_[role].mesh;
    heap_.push_back({{0.0, 1.0},
                     {{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, t},
                     role,
                     order_++});
  }

  // False: the item cannot be decided at the accuracy asked for.
  bool treat(const Item& item) {
    ++answer_.evaluations;
    Span span = item.span;
    const Body& s = bodies_[item.role];
    const Body& k = bodies_[1 - item.role];
    span.t1 = std::min(span.t1, t_real_);
    const Pose X0 = pose(item.role, span.t0), X1 = pose(item.role, span.t1);
    const Patch patch =
        make_swept_patch(s, layer_, item.piece, X0, X1, spread(item.role, span), turn(span));
    if (patch.count == 0) return true;
    const SurfacePoint at = nearest_surface(*k.solid, patch.center);
    if (k.depth_in(patch.center, at, layer_) > touch_mm_ && is_certain(item, at, patch.center)) {
      if (span.t0 < t_real_) t_real_ = span.t0;
      return true;
    }
    if (at.depth_mm + patch.radius_mm + k.largest_offset_mm[static_cast<int>(layer_)] <= touch_mm_)
      return true;
    DepthProof proof;
    proof.k = &k;
    proof.layer = layer_;
    proof.known = trivial_ ? nullptr : &known_;
    proof.role = item.role;
    proof.s = &s;
    proof.triangle_s = item.piece.triangle;
    proof.limit_mm = touch_mm_;
    proof.at_center = at;
    proof.rounding_mm = rounding_mm_;
    if (depth_at_most(proof, patch, scratch_.proof)) return true;
    return cut(item, span, X0, X1);
  }

  // The overlap is certain only with a point in both parts.
  bool is_certain(const Item& item, const SurfacePoint& at, const Vec3& point_K) {
    at_.X_WA = motions_[0].pose_at(item.span.t0);
    at_.X_WB = motions_[1].pose_at(item.span.t0);
    const PairFrame pair(at_);
    Sample sample;
    sample.role = item.role;
    sample.triangle = item.piece.triangle;
    sample.point_K = point_K;
    sample.at = at;
    sample.depth_mm = bodies_[1 - item.role].depth_in(point_K, at, layer_);
    return find_witness(pair, sample).has_value();
  }

  bool cut(const Item& item, const Span& span, const Pose& X0, const Pose& X1) {
    double path = 0.0, width = 0.0;
    for (int c = 0; c < 3; ++c) {
      path = std::max(path, (X1 * item.piece.corners[c] - X0 * item.piece.corners[c]).norm());
      width = std::max(width, (item.piece.corners[(c + 1) % 3] - item.piece.corners[c]).norm());
    }
    path += spread(item.role, span);
    const double smallest = kSmallestShare * query_.accuracy_mm;
    if (path <= smallest && width <= smallest) return false;
    if (path > width || width <= smallest) {
      const double middle = 0.5 * (span.t0 + span.t1);
      if (!(middle > span.t0) || !(middle < span.t1)) return false;
      push({{span.t0, middle}, item.piece, item.role, order_++});
      push({{middle, span.t1}, item.piece, item.role, order_++});
      return true;
    }
    for (const Piece& half : split(bodies_[item.role], layer_, item.piece))
      push({span, half, item.role, order_++});
    return true;
  }

  void push(Item item) {
    heap_.push_back(std::move(item));
    std::push_heap(heap_.begin(), heap_.end(), later);
  }

  RealTime finish(double free_until) {
    answer_.becomes_real = t_real_ <= 1.0;
    answer_.t_real = answer_.becomes_real ? t_real_ : 1.0;
    answer_.real_at_start = answer_.becomes_real && t_real_ <= 0.0;
    answer_.t_free = std::min({1.0, free_until, answer_.becomes_real ? t_real_ : 1.0});
    return answer_;
  }

  const SweptQuery& query_;
  OverlapQuery at_;
  Body bodies_[2];
  Motion motions_[2];
  double radius_[2];
  bool trivial_ = true;
  Layer layer_ = Layer::kMesh;
  double rounding_mm_ = 0.0, touch_mm_ = 0.0;
  KnownOverlaps known_;
  SearchScratch scratch_;
  std::vector<Item> heap_;
  std::uint64_t order_ = 0;
  double t_real_ = std::numeric_limits<double>::infinity();
  RealTime answer_;
};

}  // namespace

RealTime find_real_time(const SweptQuery& query, CcdScratch&) {
  return RealTimeSearch(query).run();
}

}  // namespace mortise
