#include "common/depth/generalized_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/depth/region_report.h"
#include "common/math/rotation.h"

namespace mortise {
namespace {

// Lengths tried beyond what the region needs, since other regions of the pair may need more.
constexpr double kLengthsTried[] = {1.0, 1.02, 1.1, 1.3, 2.0, 4.0};

// Steps of the fit of a small motion to the contact points; each is linear least squares.
constexpr int kFitSteps = 3;

// Work of one proof that a pose is free, and of all of them together.
constexpr std::uint64_t kFreeWorkCap = 2'000, kAllFreeWorkCap = 4'000;

struct Attempt {
  Vec3 translation = Vec3::Zero();  // of A's reference point
  Vec3 rotation = Vec3::Zero();     // about it
};

class Separation {
 public:
  Separation(const GpdQuery& query, CcdScratch& scratch)
      : query_(query),
        region_(*query.region),
        scratch_(scratch),
        nominal_(nominal_band()),
        center_A_(query.overlap.a->sphere().center_mm),
        radius_mm_(query.overlap.a->sphere().radius_mm) {}

  GeneralizedDepth run() {
    best_.gpd_mm = {std::max(0.0, region_.delta_mm.lo), std::numeric_limits<double>::infinity()};
    measure_travel();
    try_back();
    try_normal();
    try_fitted();
    return best_;
  }

 private:
  using Way = GeneralizedDepth::Way;

  // Motion of A seen by B over [t, 1], as the displacement of world points fixed to A at the
  // target.
  Pose relative_from(double t) const {
    const Pose back_b = query_.motion_b.X_W1 * query_.motion_b.pose_at(t).inverse();
    return back_b * query_.motion_a.pose_at(t) * query_.motion_a.X_W1.inverse();
  }

  void measure_travel() {
    if (!query_.motion_a.moves() && !query_.motion_b.moves()) return;
    const double t = query_.t_contact;
    const Pose back = relative_from(t);
    for (const Vec3& x : region_.points_W) {
      best_.travel_mm = std::max(best_.travel_mm, path_length(x));
      best_.normal_travel_mm = std::max(best_.normal_travel_mm, region_.normal_W.dot(back * x - x));
    }
  }

  // Of a point that is fixed to A: exact for a constant speed, else by parts.
  double path_length(const Vec3& x_W1) const {
    const double t0 = query_.t_contact;
    const Vec3 x_A = query_.motion_a.X_W1.inverse() * x_W1;
    const auto relative = [&](double t) -> Vec3 {
      return query_.motion_b.X_W1 *
             (query_.motion_b.pose_at(t).inverse() * (query_.motion_a.pose_at(t) * x_A));
    };
    const double turned = (query_.motion_a.w_W.norm() + query_.motion_b.w_W.norm()) * (1.0 - t0);
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

  // Do the meshes stay out of each other with A displaced by X (world)?
  bool is_free(const Pose& X) {
    // Most attempts that fall short are seen to by the contact points themselves.
    const Pose X_BW = query_.overlap.X_WB.inverse();
    for (const Vec3& x : region_.points_W) {
      const Vec3 x_A = query_.overlap.X_WA.inverse() * x;
      const double in_b = nearest_surface(*query_.overlap.b, X_BW * (X * x)).depth_mm;
      if (in_b > query_.overlap.accuracy_mm &&
          in_b + nearest_surface(*query_.overlap.a, x_A).depth_mm > query_.overlap.accuracy_mm)
        return false;
    }
    if (work_ >= kAllFreeWorkCap) return false;
    OverlapQuery query = query_.overlap;
    query.band_a = query.band_b = &nominal_;
    query.X_WA = X * query.X_WA;
    query.refinement = Refinement::kDecided;
    query.work_cap = std::min(kFreeWorkCap, kAllFreeWorkCap - work_);
    const OverlapResult result = find_overlap(query, scratch_);
    work_ += result.evaluations;
    for (const OverlapRegion& region : result.regions)
      if (region.delta_mm.hi > query_.overlap.accuracy_mm) return false;
    return !result.meshes_cross || !result.regions.empty();
  }

  void offer(Way way, double length_mm, const Attempt& attempt) {
    if (!(length_mm < best_.gpd_mm.hi)) return;
    best_.gpd_mm.hi = std::max(length_mm, best_.gpd_mm.lo);
    best_.way = way;
    best_.translation_mm = attempt.translation;
    best_.rotation_rad = attempt.rotation;
  }

  Pose pose_of(const Attempt& attempt) const {
    const Vec3 center = query_.overlap.X_WA * center_A_;
    const Quat turn = rotation_exp(attempt.rotation);
    return {turn, center + attempt.translation - turn * center};
  }

  // Largest path of any point of A along the motion: all points are within the sphere.
  double length_of(const Attempt& attempt) const {
    return attempt.translation.norm() + attempt.rotation.norm() * radius_mm_;
  }

  // Back along the tick: free at the contact by the word of first contact, up to its accuracy.
  void try_back() {
    if ((!query_.motion_a.moves() && !query_.motion_b.moves()) || query_.t_contact >= 1.0) return;
    const double t = query_.t_contact;
    const double length = query_.motion_a.travel_upper_bound_mm(radius_mm_, t, 1.0) +
                          query_.motion_b.travel_upper_bound_mm(
                              radius_mm_ + (query_.overlap.X_WA * center_A_ -
                                            query_.motion_b.X_W1 * query_.motion_b.reference_P)
                                               .norm(),
                              t, 1.0);
    if (length >= best_.gpd_mm.hi) return;
    const Pose back = relative_from(t);
    if (!is_free(back)) return;
    Attempt attempt;
    const Vec3 center = query_.overlap.X_WA * center_A_;
    attempt.translation = back * center - center;
    attempt.rotation = rotation_log(back.q.normalized());
    offer(Way::kBack, length, attempt);
  }

  double needed_mm() const {
    const double hi = region_.delta_mm.hi, lo = region_.delta_mm.lo;
    // A bracket that was not refined says little: start from what is known to be needed.
    return std::max(lo, 0.0) + std::min(std::max(hi - lo, 0.0), std::max(0.01 * lo, 2e-4)) + 1e-6;
  }

  void try_normal() {
    const Vec3 n = region_.normal_W;
    if (!(n.norm() > 0.5)) return;
    for (const double times : kLengthsTried) {
      Attempt attempt;
      attempt.translation = times * needed_mm() * n;
      if (length_of(attempt) >= best_.gpd_mm.hi) return;
      if (!is_free(pose_of(attempt))) continue;
      offer(Way::kNormal, length_of(attempt), attempt);
      return;
    }
  }

  // Least squares twist that moves every contact point out along the normal of B's surface there.
  void try_fitted() {
    if (region_.points_W.size() < 3) return;
    Pose X;
    Attempt attempt;
    const Vec3 center = query_.overlap.X_WA * center_A_;
    for (int step = 0; step < kFitSteps; ++step) {
      Eigen::Matrix<double, 6, 6> ata = Eigen::Matrix<double, 6, 6>::Zero();
      Eigen::Matrix<double, 6, 1> atb = Eigen::Matrix<double, 6, 1>::Zero();
      for (const Vec3& x0 : region_.points_W)
        add_row(X * x0, center + attempt.translation, ata, atb);
      // Rotations are measured by the path that they give the farthest point.
      const double weight = 1e-6 * std::max(1.0, ata.trace());
      ata.diagonal().array() += weight;
      const Eigen::Matrix<double, 6, 1> twist = ata.ldlt().solve(atb);
      attempt.translation += twist.head<3>();
      attempt.rotation += twist.tail<3>() / radius_mm_;
      X = pose_of(attempt);
    }
    for (const double times : kLengthsTried) {
      const Attempt longer{times * attempt.translation, times * attempt.rotation};
      if (length_of(longer) >= best_.gpd_mm.hi) return;
      if (!is_free(pose_of(longer))) continue;
      offer(Way::kFitted, length_of(longer), longer);
      return;
    }
  }

  void add_row(const Vec3& x, const Vec3& center, Eigen::Matrix<double, 6, 6>& ata,
               Eigen::Matrix<double, 6, 1>& atb) const {
    const Pose X_BW = query_.overlap.X_WB.inverse();
    const SurfacePoint at = nearest_surface(*query_.overlap.b, X_BW * x);
    const Vec3 n = query_.overlap.X_WB.q * at.outward;
    Eigen::Matrix<double, 6, 1> row;
    row.head<3>() = n;
    row.tail<3>() = (x - center).cross(n) / radius_mm_;
    ata += row * row.transpose();
    atb += row * std::max(0.0, at.depth_mm);
  }

  const GpdQuery& query_;
  const OverlapRegion& region_;
  CcdScratch& scratch_;
  const SurfaceBand nominal_;
  const Vec3 center_A_;
  const double radius_mm_;
  std::uint64_t work_ = 0;
  GeneralizedDepth best_;
};

}  // namespace

GeneralizedDepth generalized_depth(const GpdQuery& query, CcdScratch& scratch) {
  if (query.region == nullptr) return {};
  return Separation(query, scratch).run();
}

}  // namespace mortise
