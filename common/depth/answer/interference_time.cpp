#include "common/depth/depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/depth/answer/region_report.h"
#include "common/depth/answer/regions.h"
#include "common/depth/cells/cover_pair.h"
#include "common/depth/pair_path.h"
#include "common/depth/search/candidates.h"
#include "common/depth/search/search.h"

namespace mortise {
namespace {

// How far the search goes into detail, and when it has done enough.

// Items are cut down to this share of the accuracy.
constexpr double kSmallestShare = 0.25;

// Paths longer than this many widths are cut in time without asking.
constexpr double kLongPath = 4.0;

// After so many evaluations, and again whenever they have doubled, the search looks this many times
// the accuracy of the path ahead whether the parts interfere: a part that the last tick stopped
// stands a little before the contact.
constexpr std::uint64_t kFirstLook = 400, kLookWorkCap = 2'000;
constexpr double kSoonShare = 4.0;

// After this share of the work cap the proven time may stay this far, mm of path, before a time at
// which the parts interfere: two rims that just meet take ten times the work for the rest. And as
// much farther as the fourth power of the work beyond that: teeth that lie along a wall take all
// there is.
constexpr std::uint64_t kEnoughOfCap = 8, kEnoughLeast = 1'000;
constexpr double kCloseEnough_mm = 0.02;

// Steps back, doubling from the accuracy, from a time at which the overlap is already certain; and
// the work of these steps and the search, in work caps, after which the start of the tick is used.
constexpr std::uint64_t kBackOff = 12, kBackOffCaps = 2;

// Branch and bound over (piece of surface) x (interval of time), earliest first, in the layer of
// the least surfaces (of the largest, where it is asked what is possible):
//   1. triangles of either part that the path may bring near the other part: the first items;
//   2. an item that is proven outside for its whole interval is dropped;
//   3. an item whose centre is inside at an end of its interval gives a time at which the overlap
//      is certain: nothing later matters any more;
//   4. else it is halved, in time when it stands clear at its start, else in space;
//   5. the first item that is as brief as the accuracy and ends in a certain overlap is the answer.

struct SpanItem {
  Span span;
  Piece piece;
  int role = 0;
  std::uint64_t order = 0;
  std::uint32_t near = Topology::kNone;  // see nearest_surface()
};

bool later(const SpanItem& a, const SpanItem& b) {
  if (a.span.t0 != b.span.t0) return a.span.t0 > b.span.t0;
  return a.order > b.order;
}

// A region in which the surfaces of the layer interfere; null: there is none.
const OverlapRegion* interfering_region(const OverlapResult& result, Layer layer) {
  for (const OverlapRegion& region : result.regions)
    if (layer == Layer::kUpper ? region.possible_mm.lo > 0.0
                               : region.certain_mm.lo > 0.0 && region.has_witness)
      return &region;
  return nullptr;
}

Named named_of(Layer layer) { return layer == Layer::kLower ? Named::kLeastHere : Named::kLargest; }

// By the search at fixed poses, whose word is what a verdict rests on, or by covers.
std::optional<CertainPlace> interferes_at(const OverlapQuery& query, Layer layer,
                                          std::uint64_t& evaluations) {
  const SaidByCovers said = said_by_covers(query, named_of(layer), evaluations);
  if (said.apart || said.place) return said.place;
  CcdScratch scratch;
  const OverlapResult result = find_overlap(query, scratch);
  evaluations += result.evaluations;
  const OverlapRegion* region = interfering_region(result, layer);
  if (region == nullptr) return std::nullopt;
  return region->certain_place;
}

double longest_edge(const Piece& piece) {
  double longest = 0.0;
  for (int c = 0; c < 3; ++c)
    longest = std::max(longest, (piece.corners[(c + 1) % 3] - piece.corners[c]).norm());
  return longest;
}

// Of the corners between two poses.
double longest_way(const Piece& piece, const Pose& X0, const Pose& X1) {
  double longest = 0.0;
  for (const Vec3& corner : piece.corners)
    longest = std::max(longest, (X1 * corner - X0 * corner).norm());
  return longest;
}

class InterferenceSearch {
 public:
  InterferenceSearch(const SweptQuery& query, Layer layer)
      : query_(query),
        at_(query.at_target),
        bodies_{Body(*at_.a, *at_.band_a), Body(*at_.b, *at_.band_b)},
        path_(query.motion_a, *at_.a, query.motion_b, *at_.b) {
    trivial_ = at_.band_a->trivial && at_.band_b->trivial;
    layer_ = trivial_ ? Layer::kMesh : layer;
    at_.X_WA = path_.motions[0].pose_at(0.0);
    at_.X_WB = path_.motions[1].pose_at(0.0);
  }

  InterferenceTime run() {
    if (!bodies_[0].has_inside && !bodies_[1].has_inside) return answer_;
    const PairFrame start(at_);
    rounding_mm_ = start.rounding_mm;
    touch_mm_ = start.touch_mm;
    add_roots(start);
    std::make_heap(heap_.begin(), heap_.end(), later);
    std::uint64_t next_look = answer_.evaluations + kFirstLook;
    const std::uint64_t enough =
        std::min(std::max(kEnoughLeast, at_.work_cap / kEnoughOfCap), at_.work_cap / 2);
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end(), later);
      const SpanItem item = std::move(heap_.back());
      heap_.pop_back();
      if (item.span.t0 >= std::min(t_real_, free_until_)) break;
      if (answer_.evaluations >= at_.work_cap) {
        answer_.capped = true;
        free_until_ = std::min(free_until_, item.span.t0);
        break;
      }
      const double effort = static_cast<double>(answer_.evaluations) / static_cast<double>(enough);
      const double more = query_.slides ? 1.0 : effort * effort * effort * effort;
      if (effort >= 1.0 &&
          (t_real_ - item.span.t0) * path_.speed_upper_bound() <= kCloseEnough_mm * more) {
        free_until_ = std::min(free_until_, item.span.t0);
        break;
      }
      if (answer_.evaluations >= next_look) {
        if (answer_.evaluations >= enough && real_within(item.span.t0, kCloseEnough_mm)) break;
        if (item.span.t0 <= 0.0 && real_within(item.span.t0, kSoonShare * query_.accuracy_mm))
          break;
        next_look = 2 * answer_.evaluations;
      }
      treat(item);
    }
    return finish();
  }

 private:
  // Everything before t is proven free. Is it real when no point has gone farther than path_mm from
  // there? A part that rests against another and is pushed on is real at once: then nothing is
  // gained by parting the surfaces that touch.
  bool real_within(double t, double path_mm) {
    const double soon = t + path_mm / std::max(path_.speed_upper_bound(), 1e-300);
    const std::uint64_t left = at_.work_cap - std::min(at_.work_cap, answer_.evaluations);
    if (soon > std::min(1.0, t_real_) || !is_real_at(soon, std::min(left, kLookWorkCap)))
      return false;
    t_real_ = soon;
    free_until_ = std::min(free_until_, t);
    return true;
  }

  bool is_real_at(double t, std::uint64_t work_cap) {
    OverlapQuery query = query_.at_target;
    query.work_cap = work_cap;
    query.X_WA = path_.motions[0].pose_at(t);
    query.X_WB = path_.motions[1].pose_at(t);
    query.refinement = Refinement::kDecided;
    query.prove_not_certain = true;
    const auto place = interferes_at(query, layer_, answer_.evaluations);
    if (place) answer_.certain_place = *place;
    return place.has_value();
  }

  // Triangles that the path may bring near the other part, and shells that start inside it.
  void add_roots(const PairFrame& start) {
    CandidateQuery query;
    query.pair = &start;
    query.margin_mm = path_.speed_upper_bound();
    for (const Body& body : bodies_)
      query.margin_mm += body.largest_offset_mm[static_cast<int>(layer_)];
    query.closed_forms = false;
    const Candidates candidates = find_candidate_triangles(query);
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

  void treat(const SpanItem& item) {
    ++answer_.evaluations;
    Span span = item.span;
    const Body& s = bodies_[item.role];
    const Body& k = bodies_[1 - item.role];
    span.t1 = std::min({span.t1, t_real_, free_until_});
    const Pose X0 = path_.pose(item.role, span.t0), X1 = path_.pose(item.role, span.t1);
    const PieceShape shape = shape_of(s, layer_, item.piece);
    if (shape.empty()) return;
    const Patch swept =
        make_swept_patch(shape, X0, X1, path_.spread(item.role, span), path_.turn(span));
    const Sample center = look(item, swept.center, item.near);
    if (is_certain(center, span.t0)) {
      t_real_ = std::min(t_real_, span.t0);
      free_until_ = std::min(free_until_, span.t0);
      return;
    }
    const double reach = swept.radius_mm + k.largest_offset_mm[static_cast<int>(layer_)];
    if (center.at.depth_mm + reach <= touch_mm_) return;
    if (stays_out(item, swept, center, touch_mm_)) return;
    ++answer_.evaluations;
    if (is_certain(look(item, X1 * shape.center, center.at.triangle), span.t1))
      t_real_ = std::min(t_real_, span.t1);
    cut(item, span, X0, X1, shape, swept, center);
  }

  Sample look(const SpanItem& item, const Vec3& x_K, std::uint32_t near) const {
    const Body& k = bodies_[1 - item.role];
    const SurfacePoint at = nearest_surface(*k.solid, x_K, near);
    return {k.depth_in(x_K, at, layer_), item.role, item.piece.triangle, x_K, at};
  }

  bool stays_out(const SpanItem& item, const Patch& patch, const Sample& center, double limit_mm) {
    DepthProof proof;
    proof.k = &bodies_[1 - item.role];
    proof.layer = layer_;
    proof.role = item.role;
    proof.s = &bodies_[item.role];
    proof.triangle_s = item.piece.triangle;
    proof.limit_mm = limit_mm;
    proof.at_center = center.at;
    proof.center_depth_mm = center.depth_mm;
    proof.rounding_mm = rounding_mm_;
    return depth_at_most(proof, patch, scratch_.proof);
  }

  // The overlap is certain only with a point in both parts; it is possible where a point of the
  // largest surface of one lies within that of the other.
  bool is_certain(const Sample& sample, double t) {
    if (sample.depth_mm <= touch_mm_) return false;
    if (layer_ == Layer::kUpper) return true;
    at_.X_WA = path_.motions[0].pose_at(t);
    at_.X_WB = path_.motions[1].pose_at(t);
    const PairFrame there(at_);
    if (!find_witness(there, sample, answer_.evaluations)) return false;
    answer_.certain_place = {sample.role, sample.triangle,
                             there.X_KS[1 - sample.role] * sample.point_K};
    return true;
  }

  // In time when the piece stands clear at the start, else in space. What is small in time and not
  // deeper than the accuracy, or small in both, is free within the accuracy.
  void cut(const SpanItem& item, const Span& span, const Pose& X0, const Pose& X1,
           const PieceShape& shape, const Patch& swept, const Sample& center) {
    const double path = path_.spread(item.role, span) + longest_way(item.piece, X0, X1);
    const double width = longest_edge(item.piece);
    const double smallest = kSmallestShare * query_.accuracy_mm;
    const double middle = 0.5 * (span.t0 + span.t1);
    const bool brief = path <= smallest || !(middle > span.t0) || !(middle < span.t1);
    if (brief) {
      if (t_real_ <= span.t1) {
        free_until_ = std::min(free_until_, span.t0);
        return;
      }
      if (width <= smallest || stays_out(item, swept, center, touch_mm_ + query_.accuracy_mm))
        return;
    }
    if (!brief && (width <= smallest || path > kLongPath * width ||
                   stays_out(item, make_patch(shape, X0), center, touch_mm_))) {
      push({{span.t0, middle}, item.piece, item.role, order_++, center.at.triangle});
      push({{middle, span.t1}, item.piece, item.role, order_++, center.at.triangle});
      return;
    }
    for (const Piece& half : split(bodies_[item.role], layer_, item.piece))
      push({span, half, item.role, order_++, center.at.triangle});
  }

  void push(SpanItem item) {
    heap_.push_back(std::move(item));
    std::push_heap(heap_.begin(), heap_.end(), later);
  }

  InterferenceTime finish() {
    answer_.becomes_real = t_real_ <= 1.0;
    answer_.t_real = answer_.becomes_real ? t_real_ : 1.0;
    answer_.t_free = std::min({1.0, free_until_, answer_.t_real});
    // Within the accuracy something may be certain already: back off until nothing is.
    double step = query_.accuracy_mm / std::max(path_.speed_upper_bound(), 1e-300);
    for (std::uint64_t i = 0; i < kBackOff && answer_.becomes_real && answer_.t_free > 0.0; ++i) {
      if (!is_real_at(answer_.t_free, std::max(at_.work_cap, kLookWorkCap))) break;
      answer_.t_real = std::min(answer_.t_real, answer_.t_free);
      const bool last = i + 1 >= kBackOff || answer_.evaluations >= kBackOffCaps * at_.work_cap;
      answer_.t_free = last ? 0.0 : std::max(0.0, answer_.t_free - step);
      step *= 2.0;
    }
    answer_.real_at_start = answer_.becomes_real && answer_.t_real <= 0.0;
    return answer_;
  }

  const SweptQuery& query_;
  OverlapQuery at_;
  Body bodies_[2];
  const PairPath path_;
  bool trivial_ = true;
  Layer layer_ = Layer::kMesh;
  double rounding_mm_ = 0.0, touch_mm_ = 0.0;
  SearchScratch scratch_;
  std::vector<SpanItem> heap_;
  std::uint64_t order_ = 0;
  double t_real_ = std::numeric_limits<double>::infinity();
  double free_until_ = std::numeric_limits<double>::infinity();
  InterferenceTime answer_;
};

// Looks ahead from the time up to which nothing is possible, doubling from the accuracy, before
// anything is searched.
constexpr int kLooks = 3;
// Covers cost a hundredth: they look ahead as far as a search would end, or as long as both only
// touch: who slides along a wall becomes deeper long after that. Then so often between the last two
// looks. Where they name no place, a search at a pose of 2,000 evaluations found none, either.
constexpr int kCoverHalvings = 6;
// Where a look finds no witness it costs some 200 evaluations, and the next ones mostly find none.
constexpr std::uint64_t kCoverLooksWorkCap = 400;

// Work of one look; at the brink of interfering it is not worth more.
constexpr std::uint64_t kPossibleLookWorkCap = 600;

// What first contact may do before the search, for each evaluation of that: a test is the cheaper.
constexpr std::uint64_t kTestsPerEvaluation = 8;

// A path cut anywhere is a path of its kind.
Motion rest_of(const Motion& motion, double t) {
  if (!motion.moves()) return motion;
  const Pose X_Wt = motion.pose_at(t);
  return motion.kind == PathKind::kScrew ? screw_motion(X_Wt, motion.X_W1, motion.reference_P)
                                         : linear_motion(X_Wt, motion.X_W1, motion.reference_P);
}

// Upper bound of how far the largest surface lies outside of a triangle.
double reach_mm(const SurfaceBand& band, std::uint32_t triangle) {
  return Body::offset_range_of(band.face_of(triangle), Layer::kUpper).hi;
}

bool is_possible_at(const SweptQuery& query, double t, std::uint64_t& evaluations,
                    CcdScratch& scratch) {
  OverlapQuery at = query.at_target;
  at.X_WA = query.motion_a.pose_at(t);
  at.X_WB = query.motion_b.pose_at(t);
  at.refinement = Refinement::kDecided;
  at.want_delta = false;
  at.work_cap = std::min(at.work_cap, kPossibleLookWorkCap);
  const OverlapResult result = find_overlap(at, scratch);
  evaluations += result.evaluations;
  return std::any_of(result.regions.begin(), result.regions.end(),
                     [](const OverlapRegion& region) { return region.possible_mm.lo > 0.0; });
}

void check(const SweptQuery& query) {
  MORTISE_CHECK(valid(query.motion_a) && valid(query.motion_b),
                "poses must be finite and unit, rotations at most half a turn");
  MORTISE_CHECK(query.accuracy_mm > 0.0, "how closely a time is known must be a length");
}

// First time at which the least (kLower) or the largest (kUpper) surfaces interfere. "Real" reads
// "interferes in that layer".
InterferenceTime first_interference(const SweptQuery& query, Layer layer) {
  const InterferenceTime answer = InterferenceSearch(query, layer).run();
  MORTISE_CHECK(0.0 <= answer.t_free && answer.t_free <= answer.t_real && answer.t_real <= 1.0,
                "times of a tick are ordered");
  return answer;
}

// The rest of both paths after t.
SweptQuery rest_of(const SweptQuery& query, double t) {
  SweptQuery rest = query;
  rest.motion_a = rest_of(query.motion_a, t);
  rest.motion_b = rest_of(query.motion_b, t);
  rest.certain_free.reset();
  return rest;
}

// A time of the path that is left after t0, in the whole one.
double in_whole(double t0, double t) { return t >= 1.0 ? 1.0 : t0 + (1.0 - t0) * t; }

// A path ends where its covers are this deep in each other: who goes on from there is, rounded,
// still no deeper than touching.
constexpr double kPathEnds_mm = 0.5 * kAccuracyDefault_mm;
// Paths that a search has ended are this deep at most, in accuracies: that of the depth, that of
// the time, and by how much covers hold more than the parts. Looked for in steps of kCoarser.
constexpr double kSearchEnds = 4.0, kCoarser = 4.0;

struct FreeByCovers {
  FreeUntil until;
  std::uint64_t work = 0;  // evaluations
};

// Both covers of a layer along the path; what is no deeper than touching is not in both.
class CoverPath {
 public:
  CoverPath(const SweptQuery& query, Layer layer) : query_(query), layer_(layer) {
    const OverlapQuery& at = query.at_target;
    if (!at.use_covers || (at.band_a->trivial && at.band_b->trivial)) return;
    const Body a(*at.a, *at.band_a), b(*at.b, *at.band_b);
    if (!cover_of(a).found() || !cover_of(b).found()) return;
    const bool least = layer == Layer::kLower;
    pair_.emplace(cover_of(a).of(least), cover_of(b).of(least));
    path_.emplace(query.motion_a, *at.a, query.motion_b, *at.b);
  }

  FreeByCovers free() {
    FreeByCovers found;
    if (!pair_) return found;
    const auto ask = [&](double ends_mm) {
      const CoverFree free = free_until(ends_mm);
      found.until = {free.all ? 1.0 : free.t_free, free.all || free.t_free > 0.0,
                     ends_mm <= kAccuracyDefault_mm};
    };
    ask(kPathEnds_mm);
    // Who stands where a path has ended may leave it again, and no farther than that.
    const double deepest_mm = layer_ == Layer::kLower
                                  ? std::max(kAccuracyDefault_mm, kSearchEnds * query_.accuracy_mm)
                                  : kAccuracyDefault_mm;
    for (double ends_mm = kAccuracyDefault_mm; !found.until.touches; ends_mm *= kCoarser) {
      ask(std::min(ends_mm, deepest_mm));
      if (found.until.t < 1.0) found.until.t = 0.0;
      if (ends_mm >= deepest_mm) break;
    }
    found.work = evaluations_of_bounds(bounds_);
    return found;
  }

  // Who grazes a wall and has left it at the end needs no search: nowhere deeper than the accuracy.
  bool only_grazes(std::uint64_t& evaluations) {
    const bool only = pair_ && pair_->apart(path_->pose(0, 1.0), kPathEnds_mm, bounds_) &&
                      free_until(query_.accuracy_mm).all;
    evaluations += evaluations_of_bounds(bounds_);
    return only;
  }

 private:
  // The rest of the accuracy is that of the time.
  CoverFree free_until(double ends_mm) {
    const CoverFree free = pair_->free_until(*path_, ends_mm, kSmallestShare * query_.accuracy_mm);
    bounds_ += free.work;
    return free;
  }

  const SweptQuery& query_;
  const Layer layer_;
  std::optional<CoverPair> pair_;
  std::optional<PairPath> path_;
  std::uint64_t bounds_ = 0;
};

// Up to t the covers of a layer keep both parts apart. Shortly behind that the parts often
// interfere: then no search is needed.
struct SoonAfter {
  bool interferes = false;
  double t = 0.0;
  CertainPlace certain_place;
};

class LookAhead {
 public:
  LookAhead(const SweptQuery& query, double t, Layer layer, std::uint64_t& evaluations)
      : query_(query), t_(t), spent_(evaluations) {
    const PairPath path(query.motion_a, *query.at_target.a, query.motion_b, *query.at_target.b);
    const double speed_mm = std::max(path.speed_upper_bound(), 1e-300);
    step_ = query.accuracy_mm / speed_mm;
    close_ = kCloseEnough_mm / speed_mm;
    const bool certain = layer == Layer::kLower;
    named_ = certain && !query.slides ? Named::kLeast : named_of(layer);
  }

  // Covers may be larger than the parts, and then their time is too early: so a place counts that
  // is no farther behind than a search ends. Where the parts themselves touch, the time is the
  // parts' own, and a place anywhere behind counts.
  SoonAfter run() {
    const std::uint64_t enough = spent_ + kCoverLooksWorkCap;
    double before = t_;
    bool parts_touch = false;
    for (double step = step_; before < 1.0 && spent_ < enough; step *= 2.0) {
      const double t = std::min(t_ + step, 1.0);
      const SaidByCovers said = said_by_covers(at(t), named_, spent_);
      if (said.place) return between(before, {true, t, *said.place});
      parts_touch |= said.touches;
      if (!said.apart && !parts_touch && step > close_) break;
      before = t;
    }
    return {};
  }

 private:
  OverlapQuery at(double t) const {
    OverlapQuery at = query_.at_target;
    at.X_WA = query_.motion_a.pose_at(t);
    at.X_WB = query_.motion_b.pose_at(t);
    at.refinement = Refinement::kDecided;
    at.want_delta = false;
    return at;
  }

  SoonAfter between(double before, SoonAfter found) {
    if (before == t_) return found;
    for (int i = 0; i < kCoverHalvings; ++i) {
      const double middle = 0.5 * (before + found.t);
      if (const auto place = said_by_covers(at(middle), named_, spent_).place)
        found = {true, middle, *place};
      else
        before = middle;
    }
    return found;
  }

  const SweptQuery& query_;
  const double t_;
  std::uint64_t& spent_;
  double step_ = 0.0, close_ = 0.0;  // the first one, and what is close enough
  Named named_ = Named::kLeast;
};

SoonAfter look_soon_after(const SweptQuery& query, double t, Layer layer,
                          std::uint64_t& evaluations) {
  return LookAhead(query, t, layer, evaluations).run();
}

}  // namespace

FreeUntil certain_free_until(const SweptQuery& query, std::uint64_t& evaluations) {
  check(query);
  const FreeByCovers free = CoverPath(query, Layer::kLower).free();
  evaluations += free.work;
  return free.until;
}

bool is_free_of_possible(const SweptQuery& query, std::uint64_t& evaluations) {
  check(query);
  const FreeByCovers free = CoverPath(query, Layer::kUpper).free();
  evaluations += free.work;
  return free.until.t >= 1.0;
}

namespace {

// What covers say of a layer where the path begins.
SaidByCovers said_of_start(const SweptQuery& query, Layer layer, std::uint64_t& evaluations) {
  OverlapQuery at = query.at_target;
  at.X_WA = query.motion_a.pose_at(0.0);
  at.X_WB = query.motion_b.pose_at(0.0);
  return said_by_covers(at, named_of(layer), evaluations);
}

}  // namespace

// 1. As long as the covers of both least parts are apart nothing is certain.
// 2. Often something is certain shortly behind that, or where the path begins.
// 3. Else the rest of the path is searched; all of it where they are not even apart at its start.
InterferenceTime find_interference_time(const SweptQuery& query, CcdScratch&) {
  check(query);
  InterferenceTime answer;
  FreeUntil free;
  if (query.certain_free)
    free = *query.certain_free;
  else
    free = certain_free_until(query, answer.evaluations);
  if (free.t >= 1.0) return answer;
  SaidByCovers start;
  if (free.t <= 0.0) start = said_of_start(query, Layer::kLower, answer.evaluations);
  // Who slides goes by the place that the search finds.
  const bool free_at_start = start.apart || (query.slides ? free.t > 0.0 : free.touches);
  SoonAfter soon;
  if (start.place)
    soon = {true, 0.0, *start.place};
  else if (free_at_start)
    soon = look_soon_after(query, free.t, Layer::kLower, answer.evaluations);
  if (!soon.interferes && CoverPath(query, Layer::kLower).only_grazes(answer.evaluations))
    return answer;
  const std::uint64_t looked = answer.evaluations;
  if (soon.interferes) {
    answer.becomes_real = true;
    answer.real_at_start = start.place.has_value();
    answer.t_free = free.t;
    answer.t_real = soon.t;
    answer.certain_place = soon.certain_place;
  } else {
    answer = first_interference(rest_of(query, free.t), Layer::kLower);
    answer.t_free = in_whole(free.t, answer.t_free);
    answer.t_real = in_whole(free.t, answer.t_real);
    answer.real_at_start &= !free_at_start;
  }
  answer.evaluations = looked + (soon.interferes ? 0 : answer.evaluations);
  return answer;
}

namespace {

// When the meshes come that near.
FirstContact first_nearer(const SweptQuery& query, double separation_mm, CcdScratch& scratch) {
  const OverlapQuery& at = query.at_target;
  ContactQuery near;
  near.a = at.a;
  near.b = at.b;
  near.motion_a = query.motion_a;
  near.motion_b = query.motion_b;
  near.separation_mm = separation_mm;
  near.work_cap = std::min(kCcdWorkCap, kTestsPerEvaluation * std::min(kCcdWorkCap, at.work_cap));
  return first_contact(near, scratch);
}

// 1. Nothing is possible before the meshes are as near as the largest offsets of both faces reach:
//    first contact says when that is.
// 2. Where all faces have the same zone that is the time itself: looked at shortly behind it.
// 3. Else the surfaces that do meet there have narrower zones: the rest of the path is searched.
PossibleTime find_faces_time(const SweptQuery& query, CcdScratch& scratch) {
  PossibleTime answer;
  const OverlapQuery& at = query.at_target;
  const double separation_mm =
      std::max(0.0, at.band_a->largest_offset_mm) + std::max(0.0, at.band_b->largest_offset_mm);
  const FirstContact first = first_nearer(query, separation_mm, scratch);
  if (first.state == ContactState::kFree) return answer;
  if (first.state == ContactState::kUndecided) {
    answer.t_clear = first.t_clear;
    answer.capped = true;
    return answer;
  }
  const bool begins = first.state == ContactState::kContact;
  const double t0 = begins ? first.t_clear : 0.0;
  const PairPath path(query.motion_a, *at.a, query.motion_b, *at.b);
  double step = query.accuracy_mm / std::max(path.speed_upper_bound(), 1e-300);
  const bool widest_meet =
      reach_mm(*at.band_a, first.triangle_a) + reach_mm(*at.band_b, first.triangle_b) >=
      separation_mm - query.accuracy_mm;
  for (int i = 0; i < kLooks && (widest_meet || !begins); ++i, step *= 2.0) {
    const double t = begins ? t0 + step : 0.0;
    if (t > 1.0) break;
    if (is_possible_at(query, t, answer.evaluations, scratch)) {
      answer.becomes_possible = true;
      answer.t_clear = t0;
      answer.t_possible = t;
      return answer;
    }
    if (!begins) break;
  }

  const InterferenceTime found = first_interference(rest_of(query, t0), Layer::kUpper);
  answer.becomes_possible = found.becomes_real;
  answer.t_clear = in_whole(t0, found.t_free);
  answer.t_possible = in_whole(t0, found.t_real);
  answer.capped = found.capped;
  answer.evaluations += found.evaluations;
  return answer;
}

// How often the time at which an edge meets something is halved.
constexpr int kEdgeHalvings = 12;

// Edges and corners that travel farther than faces may meet earlier than these. No later than
// `answer` says, and not before the meshes are as near as edges travel.
void look_at_edges(const SweptQuery& query, PossibleTime& answer, CcdScratch& scratch) {
  const OverlapQuery& at = query.at_target;
  const FirstContact first =
      first_nearer(query, at.band_a->farthest_mm() + at.band_b->farthest_mm(), scratch);
  double known = answer.becomes_possible ? answer.t_clear : 1.0;
  if (first.state == ContactState::kFree || first.t_clear >= known ||
      !is_possible_at(query, known, answer.evaluations, scratch))
    return;
  double clear = answer.t_clear = first.t_clear;
  for (int i = 0; i < kEdgeHalvings; ++i) {
    const double middle = 0.5 * (clear + known);
    (is_possible_at(query, middle, answer.evaluations, scratch) ? known : clear) = middle;
  }
  answer.becomes_possible = true;
  answer.t_possible = known;
}

PossibleTime search_possible_time(const SweptQuery& query, CcdScratch& scratch) {
  PossibleTime answer = find_faces_time(query, scratch);
  const auto has_edges = [](const SurfaceBand& band) {
    return band.farthest_mm() > std::max(0.0, band.largest_offset_mm);
  };
  if (has_edges(*query.at_target.band_a) || has_edges(*query.at_target.band_b))
    look_at_edges(query, answer, scratch);
  return answer;
}

}  // namespace

PossibleTime find_possible_time(const SweptQuery& query, CcdScratch& scratch) {
  check(query);
  const auto [free, work] = CoverPath(query, Layer::kUpper).free();
  PossibleTime answer;
  if (free.t < 1.0) {
    SaidByCovers start;
    if (free.t <= 0.0) start = said_of_start(query, Layer::kUpper, answer.evaluations);
    SoonAfter soon;
    if (start.place)
      soon.interferes = true;
    else if (free.t > 0.0 || start.apart)
      soon = look_soon_after(query, free.t, Layer::kUpper, answer.evaluations);
    if (soon.interferes) {
      answer.becomes_possible = true;
      answer.t_clear = free.t;
      answer.t_possible = soon.t;
    } else if (!CoverPath(query, Layer::kUpper).only_grazes(answer.evaluations)) {
      const std::uint64_t looked = answer.evaluations;
      answer = search_possible_time(rest_of(query, free.t), scratch);
      answer.t_clear = in_whole(free.t, answer.t_clear);
      answer.t_possible = in_whole(free.t, answer.t_possible);
      answer.evaluations += looked;
    }
  }
  answer.evaluations += work;
  return answer;
}

}  // namespace mortise
