#include "common/depth/depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "common/base/check.h"
#include "common/depth/gpd/holds.h"
#include "common/depth/gpd/hull_depth.h"
#include "common/depth/gpd/inner_piece.h"
#include "common/depth/gpd/separation_search.h"
#include "common/depth/gpd/starts.h"
#include "common/math/rotation.h"

namespace mortise {
namespace {

using gpd::TwistFrame;
using gpd::Vec6;

// Gap beyond touch at the end of a motion that parts two hulls, mm, and as a share of the
// coordinates; tried again ten times as large where rounding leaves them in touch, up to 0.01 mm.
constexpr double kGap_mm = 1e-7, kGapShare = 1e-13;
constexpr int kGapsTried = 6;
// Accuracy of the depth of hulls, mm; where they only give a start, as a share of the size.
constexpr double kHullAccuracy_mm = 1e-8, kStartAccuracyShare = 1e-3;
constexpr int kStartSupports = 60;
// A bracket this close is closed: no more is looked for. kFull: as far as rounding allows.
constexpr double kCloseShare = 1.002, kCloseFullShare = 1.0001, kClose_mm = 2e-6;
// What part of the work is kept for the holds; lines of them. Chosen: half or twice of it moves no
// bracket of 400 random pairs (gpd_pairs in tests/bench) by a percent.
constexpr std::uint64_t kHoldsShare = 4;
// Holds cost up to about so many evaluations, whatever is left; with less they are left out.
constexpr std::uint64_t kHoldWork = 1'500;
constexpr std::size_t kHoldLines = 32, kHoldLinesFull = 96;
// So many times what the holds ask for is tried as a motion.
constexpr double kHeldTimes[] = {1.0, 1.02, 1.1, 1.3, 1.6, 2.0, 3.0};
// Places at which pieces of the parts are asked, and planes of one. With half as many planes 18 of
// the same 400 pairs have a lower end that is lower by a percent, with twice as many none a higher.
constexpr std::size_t kPiecePoints = 2, kPiecePointsFull = 6;
constexpr std::size_t kPiecePlanes = 16, kPiecePlanesFull = 40;
// Two directions are one when they differ by no more (cosine), two motions by their longest path.
constexpr double kAlong = 1.0 - 1e-8, kAlike = 1e-3;
// A turn whose path is this share of the whole is rounding.
constexpr double kNoTurn = 1e-6;

class PairDepth {
 public:
  PairDepth(const GpdQuery& query, CcdScratch& scratch)
      : query_(query),
        scratch_(scratch),
        full_(query.overlap.refinement == Refinement::kFull),
        mover_(query.b_moves ? *query.overlap.b : *query.overlap.a),
        other_(query.b_moves ? *query.overlap.a : *query.overlap.b),
        X_mover_(query.b_moves ? query.overlap.X_WB : query.overlap.X_WA),
        X_other_(query.b_moves ? query.overlap.X_WA : query.overlap.X_WB),
        frame_(mover_, X_mover_) {}

  GeneralizedDepth run() {
    for (const OverlapRegion& region : query_.regions)
      if (!region.at_crack) delta_mm_ = std::max(delta_mm_, region.delta_mm.lo);
    lo_mm_ = delta_mm_;
    // What the surfaces left open: they are apart as they are.
    if (!(delta_mm_ > 0.0) && gpd::is_apart(mover_, X_mover_, other_, X_other_, scratch_))
      return {};
    const Vec6 apart = part_hulls();
    if (!closed()) search_near(apart);
    if (!closed()) hold_by_pieces();
    if (!closed()) hold_by_balls();
    if (!closed()) search_far();
    straighten();
    GeneralizedDepth depth;
    depth.gpd_mm = {std::min(lo_mm_, hi_mm_), hi_mm_};
    depth.motion = motion_of(xi_);
    depth.way = way_of(xi_);
    depth.evaluations = evaluations_;
    return depth;
  }

 private:
  bool closed() const {
    return hi_mm_ <= (full_ ? kCloseFullShare : kCloseShare) * lo_mm_ + kClose_mm;
  }
  double length(const Vec6& xi) const { return gpd::longest_path_mm(mover_, X_mover_, frame_, xi); }
  void offer(const Vec6& xi, double length_mm) {
    if (!(length_mm < hi_mm_)) return;
    hi_mm_ = length_mm;
    xi_ = xi;
  }

  // The least translation of the hulls is a motion that parts them, and the least of all where both
  // parts are convex: a turn does not help.
  Vec6 part_hulls() {
    const double slack_mm = mover_.outline().convex_slack_mm + other_.outline().convex_slack_mm;
    const bool convex = std::isfinite(slack_mm);
    const double size_mm = mover_.sphere().radius_mm + other_.sphere().radius_mm;
    const gpd::HullDepth hulls =
        convex ? gpd::hull_depth(mover_, X_mover_, other_, X_other_, kHullAccuracy_mm)
               : gpd::hull_depth(mover_, X_mover_, other_, X_other_, kStartAccuracyShare * size_mm,
                                 kStartSupports);
    evaluations_ += hulls.supports;
    if (convex) lo_mm_ = std::max(lo_mm_, hulls.depth_mm.lo - slack_mm);
    const double scale = X_mover_.p.norm() + X_other_.p.norm() + size_mm;
    double gap_mm = std::max(kGap_mm, kGapShare * scale);
    Vec6 xi = Vec6::Zero();
    for (int i = 0; i < kGapsTried; ++i, gap_mm *= 10.0) {
      xi = gpd::translation_twist((hulls.depth_mm.hi + gap_mm) * hulls.normal_W);
      if (gpd::is_apart(mover_, frame_.pose_of(xi) * X_mover_, other_, X_other_, scratch_)) {
        offer(xi, length(xi));
        break;
      }
    }
    return xi;
  }

  void search_near(const Vec6& apart) {
    starts_ = gpd::starts_of(query_, frame_, evaluations_);
    starts_.twists.push_back(apart);
    if (query_.known != nullptr && query_.known->of_b == query_.b_moves)
      starts_.twists.push_back(frame_.twist_of(query_.known->displacement()));
    // For the lower end.
    const std::uint64_t kept =
        std::max(query_.work_cap / kHoldsShare, std::min(kHoldWork, query_.work_cap / 2));
    search(gpd::Looking::kNear, starts_.twists, query_.work_cap - kept);
  }

  // From afar, and along what all holds ask for.
  void search_far() {
    std::vector<Vec6> starts = {xi_};
    if (held_)
      for (const double times : kHeldTimes) starts.push_back(times * *held_);
    search(gpd::Looking::kFar, starts, query_.work_cap);
  }

  template <class Query>
  Query query_of() const {
    Query query;
    query.a = &mover_;
    query.b = &other_;
    query.X_WA = X_mover_;
    query.X_WB = X_other_;
    return query;
  }

  void search(gpd::Looking looking, const std::vector<Vec6>& starts, std::uint64_t cap) {
    if (evaluations_ >= cap) return;
    auto query = query_of<gpd::SeparationQuery>();
    std::vector<Vec3> directions = starts_.normals;
    directions.insert(directions.end(), starts_.axes.begin(), starts_.axes.end());
    query.directions = directions;
    query.starts = starts;
    query.looking = looking;
    query.first_is_descended = looking == gpd::Looking::kFar;
    query.least_mm = lo_mm_;
    query.enough_mm = (full_ ? kCloseFullShare : kCloseShare) * lo_mm_ + kClose_mm;
    query.thorough = full_;
    query.work_cap = cap - evaluations_;
    const gpd::Separation found = gpd::find_separation(query, scratch_);
    evaluations_ += found.work;
    if (found.found) offer(found.xi, found.length_mm);
  }

  // A turn that is none but for rounding is left away.
  void straighten() {
    if (xi_.tail<3>().isZero(0.0) || xi_.tail<3>().norm() > kNoTurn * hi_mm_) return;
    const Vec6 straight = gpd::translation_twist(xi_.head<3>());
    const double length_mm = straight.head<3>().norm();
    if (length_mm > hi_mm_ ||
        !gpd::is_apart(mover_, frame_.pose_of(straight) * X_mover_, other_, X_other_, scratch_))
      return;
    hi_mm_ = std::max(length_mm, lo_mm_);
    xi_ = straight;
  }

  // In a crack the depth of a point is a guess.
  bool can_hold() const {
    return mover_.inside_known() && other_.inside_known() && std::isfinite(hi_mm_) &&
           evaluations_ + kHoldWork <= query_.work_cap;
  }
  std::vector<Vec3> deepest_points() const {
    std::vector<Vec3> points;
    for (const OverlapRegion& region : query_.regions)
      if (region.delta_mm.hi > 0.0) points.push_back(region.point_W);
    return points;
  }

  void hold_by_pieces() {
    if (!can_hold()) return;
    const std::vector<Vec3> points = deepest_points();
    auto query = query_of<gpd::PiecesQuery>();
    query.points_W = points;
    query.most_points = full_ ? kPiecePointsFull : kPiecePoints;
    query.most_planes = full_ ? kPiecePlanesFull : kPiecePlanes;
    lo_mm_ = std::max(lo_mm_, gpd::lower_bound_by_pieces_mm(query, evaluations_));
  }

  void hold_by_balls() {
    if (!can_hold()) return;
    const std::vector<Vec3> points = deepest_points();
    auto query = query_of<gpd::HoldsQuery>();
    query.points_W = points;
    query.known_mm = std::min(lo_mm_, hi_mm_);
    query.limit_mm = hi_mm_;
    query.most_lines = full_ ? kHoldLinesFull : kHoldLines;
    const gpd::HeldBy held = gpd::held_by_balls(query, scratch_, evaluations_);
    lo_mm_ = std::max(lo_mm_, held.least_mm);
    held_ = held.twist;
  }

  SeparatingMotion motion_of(const Vec6& xi) const {
    SeparatingMotion motion;
    motion.of_b = query_.b_moves;
    motion.about_W = frame_.center_W;
    motion.rotation_rad = frame_.turn_of(xi);
    motion.translation_mm = frame_.pose_of(xi) * frame_.center_W - frame_.center_W;
    return motion;
  }

  SeparationWay way_of(const Vec6& xi) const {
    if (!std::isfinite(hi_mm_)) return SeparationWay::kNone;
    if (const auto back = gpd::back_twist(query_, frame_);
        back && length(xi - *back) < kAlike * hi_mm_)
      return SeparationWay::kBack;
    if (!xi.tail<3>().isZero(0.0)) return SeparationWay::kFitted;
    const Vec3 d = xi.head<3>().normalized();
    for (const OverlapRegion& region : query_.regions)
      if (std::fabs(d.dot(region.normal_W)) > kAlong) return SeparationWay::kNormal;
    for (const Vec3& axis : starts_.axes)
      if (std::fabs(d.dot(axis)) > kAlong) return SeparationWay::kAxis;
    return SeparationWay::kStraight;
  }

  const GpdQuery& query_;
  CcdScratch& scratch_;
  const bool full_;
  const Solid &mover_, &other_;
  const Pose &X_mover_, &X_other_;
  const TwistFrame frame_;
  double delta_mm_ = 0.0, lo_mm_ = 0.0, hi_mm_ = std::numeric_limits<double>::infinity();
  Vec6 xi_ = Vec6::Zero();
  gpd::Starts starts_;
  std::optional<Vec6> held_;
  std::uint64_t evaluations_ = 0;
};

// Of a point that is fixed to A, seen from B: exact for a constant speed, else by parts.
double path_length(const Motion& a, const Motion& b, double t0, const Vec3& x_W1) {
  const Vec3 x_A = a.X_W1.inverse() * x_W1;
  const auto relative = [&](double t) -> Vec3 {
    return b.X_W1 * (b.pose_at(t).inverse() * (a.pose_at(t) * x_A));
  };
  const double turned = (a.w_W.norm() + b.w_W.norm()) * (1.0 - t0);
  const int parts = turned > 0.0 ? 32 : 1;
  double sum = 0.0;
  Vec3 from = relative(t0);
  for (int i = 1; i <= parts; ++i) {
    const Vec3 to = relative(t0 + (1.0 - t0) * i / parts);
    const double chord = (to - from).norm();
    const double half_angle = 0.5 * turned / parts;
    // Arc over chord of a turn about one axis.
    sum += half_angle > 1e-4 ? chord * half_angle / std::sin(half_angle) : chord;
    from = to;
  }
  return sum;
}

}  // namespace

Pose SeparatingMotion::displacement() const {
  const Quat turn = rotation_exp(rotation_rad);
  return {turn, about_W + translation_mm - turn * about_W};
}

namespace {

Motion screw(const Pose& X_from, const Pose& X_to, const Solid& part, bool turns) {
  const Vec3& middle = part.sphere().center_mm;
  return turns ? screw_motion(X_from, X_to, middle) : linear_motion(X_from, X_to, middle);
}

}  // namespace

Motion SeparatingMotion::path(const Pose& X_W, const Solid& part) const {
  return screw(X_W, displacement() * X_W, part, !rotation_rad.isZero(0.0));
}

Motion SeparatingMotion::backward(const Pose& X_W, const Solid& part) const {
  return screw(displacement() * X_W, X_W, part, !rotation_rad.isZero(0.0));
}

double longest_path_mm(const Solid& part, const Pose& X_W, const SeparatingMotion& motion) {
  const TwistFrame frame(part, X_W);
  return gpd::longest_path_mm(part, X_W, frame, frame.twist_of(motion.displacement()));
}

GeneralizedDepth generalized_depth(const GpdQuery& query, CcdScratch& scratch) {
  MORTISE_CHECK(valid(query.motion_a) && valid(query.motion_b) && query.t_contact >= 0.0 &&
                    query.t_contact <= 1.0,
                "a separation is sought along valid motions from a time of the tick");
  // Only the offsets make them meet: the meshes are free as they are.
  if (std::none_of(query.regions.begin(), query.regions.end(),
                   [](const OverlapRegion& region) { return region.delta_mm.hi > 0.0; }))
    return {};
  const GeneralizedDepth depth = PairDepth(query, scratch).run();
  MORTISE_CHECK(depth.gpd_mm.lo >= 0.0 && depth.gpd_mm.ordered(),
                "a depth has its lower end first");
  return depth;
}

TravelSinceContact travel_since_contact(const OverlapRegion& region, const Motion& a,
                                        const Motion& b, double t_contact) {
  TravelSinceContact travel;
  if (!a.moves() && !b.moves()) return travel;
  const Pose back_b = b.X_W1 * b.pose_at(t_contact).inverse();
  const Pose back = back_b * a.pose_at(t_contact) * a.X_W1.inverse();
  for (const Vec3& x : region.points_W) {
    travel.path_mm = std::max(travel.path_mm, path_length(a, b, t_contact, x));
    travel.normal_mm = std::max(travel.normal_mm, region.normal_W.dot(back * x - x));
  }
  return travel;
}

}  // namespace mortise
