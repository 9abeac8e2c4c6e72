#include "common/depth/gpd/separation_search.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/ccd/distance.h"
#include "common/ccd/start_state.h"
#include "common/depth/gpd/contact_rows.h"
#include "common/math/rotation.h"

namespace mortise::gpd {
namespace {

// What the search finds is a local optimum, whatever its steps are. Values without a reason of
// their own are chosen. With half or twice each one but the reaches of a push and what concerns
// large meshes, which were not tried, no way out of 400 random pairs (gpd_pairs in tests/bench) is
// told that is longer or shorter by a percent; only the work differs.

// Gap that a row of a contact place asks for, mm; and where that does not part them, as a share of
// the reach, and how that grows.
constexpr double kMargin_mm = 1e-6, kSettled = 0.2, kWider = 0.005, kMarginGrowth = 3.0;
// A sweep ends in touch: so much farther it is apart, mm.
constexpr double kBeyondTouch_mm = 1e-7;
constexpr double kSweepAccuracy_mm = kAccuracyDefault_mm;
// A hundredth of what a query of first contact may cost: there are some tens of sweeps.
constexpr std::uint64_t kSweepCap = kCcdWorkCap / 100;
// Push: reach of the contact places as multiples of the depth, programs, and how far one may step.
constexpr double kPushReach[] = {1.5, 4.0};
constexpr int kPushPrograms = 10;
constexpr double kStepOverReach = 4.0;
// Descent: programs, repairs of a step that collides, and how the reach changes.
constexpr int kShortDescent = 20, kLongDescent = 40, kRepairs = 3;
constexpr double kFirstReach = 0.2, kShrink = 0.35, kGrow = 1.5, kMostReach = 0.5;
constexpr double kLeastReachShare = 1e-3, kLeastReachThorough = 1e-5, kLeastReach_mm = 1e-8;
// A step must gain the first share; two steps in a row below the second end the descent.
constexpr double kGain = 1e-7, kIdleGain = 1e-4;
constexpr int kIdleSteps = 2;
// Starts no worse than this times the best are descended from, so many whose directions differ.
constexpr double kWorthDescent = 2.5, kAlike = 0.05;
constexpr std::size_t kDescents = 3, kThoroughDescents = 8;
// No more of a turn is looked at, rad.
constexpr double kMostTurn_rad = 3.0;
// Lengths tried along a twist grow by this factor.
constexpr double kScanGrowth = 1.7;
// A motion this many times as long as the overlap is deep is doubted: turns are tried.
constexpr double kFar = 20.0;
constexpr int kRandomTwists = 24, kDisturbed = 16;
// Work of one question, about evaluations of the overlap search.
constexpr std::uint64_t kFreeWork = 4, kFreeWorkOfMany = 100, kProgramWork = 10;
constexpr std::uint64_t kTestsAWorkUnit = 8;
// In meshes of so many triangles together a question of all of them takes once as long again.
constexpr std::uint64_t kLargeMesh = 8'192, kManyUnits = 2;

// Uniform numbers from a fixed seed (Knuth's 64-bit linear congruence).
class Random {
 public:
  double next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11U) * 0x1p-53;
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 x(2.0 * next() - 1.0, 2.0 * next() - 1.0, 2.0 * next() - 1.0);
      // In the ball, so that all ways are as likely; not at its middle, where the quotient says
      // little.
      if (const double n = x.squaredNorm(); n > 1e-4 && n <= 1.0) return x / std::sqrt(n);
    }
  }

 private:
  std::uint64_t state_ = 7;
};

class Search {
 public:
  Search(const SeparationQuery& query, CcdScratch& scratch)
      : query_(query),
        scratch_(scratch),
        frame_(*query.a, query.X_WA),
        program_(frame_, corners_W()),
        size_mm_(2.0 * (query.a->sphere().radius_mm + query.b->sphere().radius_mm)),
        scale_mm_(std::max({query.least_mm, 1e-6 * size_mm_, 1e-6})),
        unit_(1 +
              (query.a->mesh().triangles.size() + query.b->mesh().triangles.size()) / kLargeMesh),
        rows_(*query.a, query.X_WA, *query.b, query.X_WB, frame_, scratch) {}

  Separation run() {
    // Of several along one line the first that is free says it all.
    bool descended = query_.first_is_descended;
    for (const Vec6& start : query_.starts) {
      if (length(start) < best_.length_mm && (descended || is_free(start))) offer(start, descended);
      descended = false;
    }
    if (query_.looking != Looking::kFar) push_and_descend();
    if (query_.looking != Looking::kNear) look_far();
    best_.work = work_;
    return best_;
  }

 private:
  struct Found {
    double length_mm;
    Vec6 xi;
    bool descended;
  };

  std::vector<Vec3> corners_W() const {
    std::vector<Vec3> corners;
    for (const Vec3& x : query_.a->outline().corners) corners.push_back(query_.X_WA * x);
    return corners;
  }
  bool done() const { return best_.length_mm <= query_.enough_mm || out_of_work(); }
  bool out_of_work() const { return work_ >= query_.work_cap; }

  double length(const Vec6& xi) const {
    return longest_path_mm(*query_.a, query_.X_WA, frame_, xi);
  }
  Pose pose_of(const Vec6& xi) const { return frame_.pose_of(xi) * query_.X_WA; }
  // Where thousands of triangles lie close along whole faces it takes longer to see that they do
  // not cross.
  std::uint64_t free_work() const { return (is_large() ? kFreeWorkOfMany : kFreeWork) * unit_; }
  bool turns_too_far(const Vec6& xi) const { return !(frame_.turn_of(xi).norm() < kMostTurn_rad); }

  bool is_large() const { return unit_ > kManyUnits; }
  // Of large parts some corners are asked first.
  bool seems_free(const Vec6& xi) {
    return !turns_too_far(xi) && !(is_large() && rows_.meet_at_corners(xi, work_));
  }
  bool is_free(const Vec6& xi) {
    if (!seems_free(xi)) return false;
    work_ += free_work();
    return is_apart(*query_.a, pose_of(xi), *query_.b, query_.X_WB, scratch_);
  }

  void offer(const Vec6& xi, bool descended = false) {
    const double l = length(xi);
    found_.push_back({l, xi, descended});
    if (!(l < best_.length_mm)) return;
    best_.found = true;
    best_.length_mm = l;
    best_.xi = xi;
  }

  // Where on the way exp(s xi) the parts last meet, from its free end; below zero: that is not
  // free.
  double last_exit(const Vec6& xi) {
    ContactQuery sweep;
    sweep.a = query_.a;
    sweep.b = query_.b;
    const Pose X_far = pose_of(xi);
    const Vec3& middle = query_.a->sphere().center_mm;
    sweep.motion_a = xi.tail<3>().isZero(0.0) ? linear_motion(X_far, query_.X_WA, middle)
                                              : screw_motion(X_far, query_.X_WA, middle);
    sweep.motion_b = still_motion(query_.X_WB);
    sweep.accuracy_mm = kSweepAccuracy_mm;
    sweep.work_cap = kSweepCap;
    const FirstContact contact = first_contact(sweep, scratch_);
    work_ += free_work() + (contact.work.box_tests + contact.work.leaf_tests) / kTestsAWorkUnit;
    switch (contact.state) {
      case ContactState::kContact:
        return 1.0 - contact.t_contact;
      case ContactState::kTouchingAtStart:
        return 1.0;
      case ContactState::kFree:
        return 0.0;
      case ContactState::kUndecided:
        return 1.0 - contact.t_clear;
      default:
        return -1.0;
    }
  }

  bool solve(const std::vector<Row>& rows, Vec6& to) {
    work_ += kProgramWork + rows.size() / 2;
    return program_.solve(rows, to);
  }

  // On the way to a shorter motion what seems free of large parts is enough; its end is asked.
  bool is_free_on_the_way(const Vec6& xi) { return is_large() ? seems_free(xi) : is_free(xi); }

  // Programs from a pose that overlaps until it is free, as is_free_on_the_way. False: not within
  // the limit.
  bool push(Vec6& xi, double reach_mm, int programs, double limit_mm) {
    double margin_mm = kMargin_mm;
    for (int i = 0; i < programs && !out_of_work(); ++i) {
      const std::vector<Row> rows = rows_.at(xi, reach_mm, margin_mm, work_);
      Vec6 to;
      if (rows.empty() || !solve(rows, to)) return false;
      const double step = length(to - xi), most = kStepOverReach * reach_mm;
      xi = step > most ? Vec6(xi + (to - xi) * (most / step)) : to;
      // A picometre on is no way out: rounding of poses is as large.
      if (length(xi) >= limit_mm || step < 1e-9) return false;
      if (is_free_on_the_way(xi)) return true;
      // The rows ask for no more, and yet they meet, between the places that are seen.
      if (step < kSettled * length(xi))
        margin_mm = std::max(kMarginGrowth * margin_mm, kWider * reach_mm);
    }
    return false;
  }

  void look_far() {
    if (!done()) sweep_back();
    if (!done() && (query_.thorough || best_.length_mm > kFar * scale_mm_)) try_turns();
    if (!done()) descend_from_best();
  }

  void push_and_descend() {
    for (const double times : kPushReach) {
      Vec6 xi = Vec6::Zero();
      if (push(xi, times * scale_mm_ + 1e-5, kPushPrograms, kWorthDescent * best_.length_mm)) {
        if (!is_large()) offer(xi);
        if (is_large() || !done())
          descend_from(xi, kShortDescent);  // what only seems free is asked
      }
      if (done()) return;
    }
  }

  // Offers the end; of large parts, where that is not free, the start.
  void descend_from(const Vec6& start, int programs) {
    const Vec6 end = descend(start, programs);
    if (!is_large() || is_free(end))
      offer(end, true);
    else if (is_free(start))
      offer(start, true);
  }

  // From a twist that is free on the way to a shorter one, within a trust region that is the reach
  // of the places.
  Vec6 descend(Vec6 xi, int programs) {
    double best = length(xi), reach_mm = kFirstReach * best;
    const double least_share = query_.thorough ? kLeastReachThorough : kLeastReachShare;
    int idle = 0;
    for (int i = 0; i < programs && idle < kIdleSteps && !out_of_work(); ++i) {
      if (!(reach_mm > least_share * best + kLeastReach_mm)) break;
      Vec6 to;
      if (!solve(rows_.at(xi, reach_mm, kMargin_mm, work_), to)) {
        reach_mm *= kShrink;
        continue;
      }
      const double step = length(to - xi), enough = best * (1.0 - kGain);
      if (step > reach_mm) to = xi + (to - xi) * (reach_mm / step);
      const bool shorter = length(to) < enough;
      if (shorter && (is_free_on_the_way(to) || push(to, reach_mm, kRepairs, enough))) {
        const double now = length(to);
        idle = best - now < kIdleGain * best ? idle + 1 : 0;
        xi = to;
        best = now;
        reach_mm = std::min(kMostReach * best, kGrow * reach_mm);
      } else {
        reach_mm *= kShrink;
      }
    }
    return xi;
  }

  std::vector<Vec3> lines() const {
    std::vector<Vec3> lines;
    const auto add = [&](const Vec3& d) {
      // A unit vector, or zero of a triangle without an area.
      if (!(d.norm() > 0.5)) return;
      for (const Vec3& other : lines)
        if (std::fabs(other.dot(d)) > 0.9995 * d.norm()) return;  // within two degrees
      lines.push_back(d.normalized());
    };
    for (const Vec3& d : query_.directions) add(d);
    for (const Vec3& n : query_.a->outline().main_normals) add(query_.X_WA.q * n);
    for (const Vec3& n : query_.b->outline().main_normals) add(query_.X_WB.q * n);
    for (int i = 0; i < 3; ++i) add(Vec3::Unit(i));
    return lines;
  }

  double reach(const Solid& part, const Pose& X_W, const Vec3& d) const {
    return d.dot(X_W * farthest_corner(part.bvh(), part.outline(), X_W.q.conjugate() * d));
  }

  // Translations: from where it would pay at most, back to the first contact.
  void sweep_back() {
    std::vector<Vec3> all = lines();
    for (int i = 0; i < 13; ++i) {
      const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
      all.push_back(Vec3(x, y, z).normalized());
    }
    for (const Vec3& line : all)
      for (const double sign : {1.0, -1.0}) {
        if (out_of_work()) return;
        const Vec3 d = sign * line;
        double far = reach(*query_.b, query_.X_WB, d) + reach(*query_.a, query_.X_WA, -d);
        if (!(far > 0.0)) continue;
        far = std::min(far + 1e-3 * size_mm_, kWorthDescent * best_.length_mm);
        const double s = last_exit(translation_twist(far * d));
        if (s < 0.0) continue;
        const Vec6 xi = translation_twist((std::min(1.0, s) * far + kBeyondTouch_mm) * d);
        if (is_free(xi)) offer(xi);
      }
  }

  // First free length along a twist, then back along it.
  void scan(const Vec6& twist) {
    const double unit = length(twist);
    if (!(unit > 0.0)) return;
    for (double l = 1.05 * scale_mm_; l < best_.length_mm && !out_of_work(); l *= kScanGrowth) {
      const Vec6 xi = twist * (l / unit);
      if (turns_too_far(xi)) return;
      if (!is_free(xi)) continue;
      const double s = last_exit(xi);
      const Vec6 nearer = xi * (std::clamp(s, 0.0, 1.0) * (1.0 + 1e-7));
      offer(s > 0.0 && is_free(nearer) ? nearer : xi);
      return;
    }
  }

  void try_turns() {
    const Vec3 center_b = query_.X_WB * query_.b->sphere().center_mm;
    for (const Vec3& axis : lines())
      for (const Vec3& about :
           {frame_.center_W, center_b, Vec3(0.5 * (frame_.center_W + center_b))})
        for (const double sign : {1.0, -1.0}) {
          Vec6 twist;
          twist << sign * axis.cross(frame_.center_W - about), sign * frame_.radius_mm * axis;
          scan(twist);
        }
    Random random;
    const auto any = [&] {
      Vec6 twist;
      const double share = 4.0 * random.next();
      twist << share * random.direction(), random.direction();
      return twist;
    };
    for (int i = 0; i < kRandomTwists; ++i) scan(any());
    for (int i = 0; i < kDisturbed; ++i) {
      const Vec6 twist = any();
      const double l = std::ldexp(scale_mm_, 1 + i % 5);
      if (l > best_.length_mm) continue;
      Vec6 xi = twist * (l / length(twist));
      if (is_free(xi) ||
          (push(xi, 1.5 * l, 8, 1.5 * best_.length_mm) && (!is_large() || is_free(xi))))
        offer(xi);
    }
  }

  void descend_from_best() {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Found& x, const Found& y) { return x.length_mm < y.length_mm; });
    std::vector<Found> starts;
    for (const Found& found : found_) {
      if (found.length_mm > kWorthDescent * best_.length_mm) break;
      if (!found.descended && std::none_of(starts.begin(), starts.end(), [&](const Found& other) {
            const Vec6 as_long = other.xi * (found.length_mm / other.length_mm);
            return length(found.xi - as_long) < kAlike * found.length_mm;
          }))
        starts.push_back(found);
      if (starts.size() == (query_.thorough ? kThoroughDescents : kDescents)) break;
    }
    for (const Found& start : starts)
      if (!done()) descend_from(start.xi, kLongDescent);
  }

  const SeparationQuery& query_;
  CcdScratch& scratch_;
  const TwistFrame frame_;
  Minimax program_;
  const double size_mm_, scale_mm_;
  const std::uint64_t unit_;
  ContactRows rows_;
  std::vector<Found> found_;
  Separation best_;
  std::uint64_t work_ = 0;
};

}  // namespace

bool is_apart(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
              CcdScratch& scratch) {
  return !surfaces_cross(a, X_WA, b, X_WB, scratch) && !contained(a, X_WA, b, X_WB, 0.0);
}

Separation find_separation(const SeparationQuery& query, CcdScratch& scratch) {
  MORTISE_CHECK(query.a != nullptr && query.b != nullptr, "a query needs two solids");
  MORTISE_CHECK(valid(query.X_WA) && valid(query.X_WB),
                "poses must be finite and their quaternions unit");
  MORTISE_CHECK(query.least_mm >= 0.0 && query.enough_mm >= 0.0, "lengths are not negative");
  for (const Vec3& n : query.directions)
    MORTISE_CHECK(n.allFinite(), "a direction to try is finite");
  const Separation separation = Search(query, scratch).run();
  MORTISE_CHECK(separation.found == std::isfinite(separation.length_mm) &&
                    separation.length_mm >= 0.0 && separation.xi.allFinite(),
                "a way that is found has a length");
  return separation;
}

}  // namespace mortise::gpd
