#include "common/depth/generalized_depth.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/check.h"
#include "common/depth/region_report.h"
#include "common/math/rotation.h"

namespace mortise {
namespace {

// Lengths tried beyond what the region needs, since other regions of the pair may need more.
constexpr double kLengthsTried[] = {1.0, 1.02, 1.1, 1.3, 2.0, 4.0};

// Steps of the fit of a small motion to the contact points; each is linear least squares.
constexpr int kFitSteps = 3;

// Contact points that are looked at.
constexpr std::size_t kMostContacts = 96;

// Share of the largest below which no normal has a part along a direction.
constexpr double kSlides = 1e-3;

// Work of one proof that a pose is free.
constexpr std::uint64_t kFreeWorkCap = 2'000;

struct Attempt {
  Vec3 translation = Vec3::Zero();  // of A's reference point
  Vec3 rotation = Vec3::Zero();     // about it
};

// Motion of A seen by B over [t, 1], as the displacement of world points fixed to A at the
// target.
Pose relative_from(const GpdQuery& query, double t) {
  const Pose back_b = query.motion_b.X_W1 * query.motion_b.pose_at(t).inverse();
  return back_b * query.motion_a.pose_at(t) * query.motion_a.X_W1.inverse();
}

// Of a point that is fixed to A: exact for a constant speed, else by parts.
double path_length(const GpdQuery& query, const Vec3& x_W1) {
  const double t0 = query.t_contact;
  const Vec3 x_A = query.motion_a.X_W1.inverse() * x_W1;
  const auto relative = [&](double t) -> Vec3 {
    return query.motion_b.X_W1 *
           (query.motion_b.pose_at(t).inverse() * (query.motion_a.pose_at(t) * x_A));
  };
  const double turned = (query.motion_a.w_W.norm() + query.motion_b.w_W.norm()) * (1.0 - t0);
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

class Separation {
 public:
  Separation(const GpdQuery& query, CcdScratch& scratch)
      : query_(query),
        region_(*query.region),
        scratch_(scratch),
        nominal_(nominal_band()),
        center_A_(query.overlap.a->sphere().center_mm),
        radius_mm_(query.overlap.a->sphere().radius_mm) {
    if (query.regions.empty()) add_contacts(region_);
    for (const OverlapRegion& region : query.regions) add_contacts(region);
    // Some of many say as much.
    while (contacts_.size() > kMostContacts) {
      for (std::size_t i = 0; 2 * i < contacts_.size(); ++i) contacts_[i] = contacts_[2 * i];
      contacts_.resize((contacts_.size() + 1) / 2);
    }
  }

  GeneralizedDepth run() {
    best_.gpd_mm = {std::max(0.0, region_.delta_mm.lo), std::numeric_limits<double>::infinity()};
    measure_travel();
    if (region_.delta_mm.hi <= 0.0) {  // only the offsets make them meet: the meshes are free
      best_.gpd_mm = {};
      return best_;
    }
    try_back();
    try_normal();
    try_fitted();
    try_axis();
    best_.evaluations += 2 * contacts_.size();
    return best_;
  }

 private:
  // A point of the surface of one part that lies in the other; fixed to the one whose it is.
  struct Contact {
    Vec3 x_W;
    bool on_a = true;
  };
  void add_contacts(const OverlapRegion& region) {
    for (const Vec3& x : region.points_W) contacts_.push_back({x, in_b(x) >= in_a(x, Pose())});
  }
  SurfacePoint at_b(const Vec3& x_W) const {
    return nearest_surface(*query_.overlap.b, query_.overlap.X_WB.inverse() * x_W);
  }
  SurfacePoint at_a(const Vec3& x_W, const Pose& X) const {
    return nearest_surface(*query_.overlap.a, (X * query_.overlap.X_WA).inverse() * x_W);
  }
  double in_b(const Vec3& x_W) const { return at_b(x_W).depth_mm; }
  double in_a(const Vec3& x_W, const Pose& X) const { return at_a(x_W, X).depth_mm; }

  // With A displaced by X: where the contact is, how deep, and along what A leaves it.
  struct Push {
    Vec3 x_W, out_W;
    double depth_mm = 0.0;
  };
  Push push_of(const Contact& contact, const Pose& X) const {
    if (contact.on_a) {
      const Vec3 x = X * contact.x_W;
      const SurfacePoint at = at_b(x);
      return {x, query_.overlap.X_WB.q * at.outward, at.depth_mm};
    }
    const SurfacePoint at = at_a(contact.x_W, X);
    return {contact.x_W, -((X * query_.overlap.X_WA).q * at.outward), at.depth_mm};
  }

  void measure_travel() {
    if (!query_.motion_a.moves() && !query_.motion_b.moves()) return;
    const double t = query_.t_contact;
    const Pose back = relative_from(query_, t);
    for (const Vec3& x : region_.points_W) {
      best_.travel_mm = std::max(best_.travel_mm, path_length(query_, x));
      best_.normal_travel_mm = std::max(best_.normal_travel_mm, region_.normal_W.dot(back * x - x));
    }
  }

  // Do the meshes stay out of each other with A displaced by X (world)?
  bool is_free(const Pose& X) {
    // Most attempts that fall short are seen to by the contact points themselves.
    for (const Contact& contact : contacts_)
      for (const Vec3& x : {contact.x_W, Vec3(X * contact.x_W)}) {
        if (in_b(x) + in_a(x, X) > query_.overlap.accuracy_mm) return false;
      }
    if (work_ >= query_.work_cap) return false;
    OverlapQuery query = query_.overlap;
    query.band_a = query.band_b = &nominal_;
    query.X_WA = X * query.X_WA;
    query.refinement = Refinement::kDecided;
    query.work_cap = std::min(kFreeWorkCap, query_.work_cap - work_);
    const OverlapResult result = find_overlap(query, scratch_);
    work_ += result.evaluations;
    best_.evaluations += result.evaluations;
    for (const OverlapRegion& region : result.regions)
      if (region.delta_mm.hi > query_.overlap.accuracy_mm) return false;
    return !result.meshes_cross || !result.regions.empty();
  }

  void offer(SeparationWay way, double length_mm, const Attempt& attempt) {
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
    const double arm_mm = radius_mm_ + (query_.overlap.X_WA * center_A_ -
                                        query_.motion_a.X_W1 * query_.motion_a.reference_P)
                                           .norm();
    const double length = query_.motion_a.travel_upper_bound_mm(arm_mm, t, 1.0) +
                          query_.motion_b.travel_upper_bound_mm(
                              radius_mm_ + (query_.overlap.X_WA * center_A_ -
                                            query_.motion_b.X_W1 * query_.motion_b.reference_P)
                                               .norm(),
                              t, 1.0);
    if (length >= best_.gpd_mm.hi) return;
    const Pose back = relative_from(query_, t);
    if (!is_free(back)) return;
    Attempt attempt;
    const Vec3 center = query_.overlap.X_WA * center_A_;
    attempt.translation = back * center - center;
    attempt.rotation = rotation_log(back.q.normalized());
    offer(SeparationWay::kBack, length, attempt);
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
      offer(SeparationWay::kNormal, length_of(attempt), attempt);
      return;
    }
  }

  // Least squares twist that moves every contact point out along the normal of B's surface there.
  void try_fitted() {
    if (contacts_.size() < 3) return;
    Pose X;
    Attempt attempt;
    const Vec3 center = query_.overlap.X_WA * center_A_;
    for (int step = 0; step < kFitSteps; ++step) {
      Eigen::Matrix<double, 6, 6> ata = Eigen::Matrix<double, 6, 6>::Zero();
      Eigen::Matrix<double, 6, 1> atb = Eigen::Matrix<double, 6, 1>::Zero();
      for (const Contact& contact : contacts_)
        add_row(push_of(contact, X), center + attempt.translation, ata, atb);
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
      offer(SeparationWay::kFitted, length_of(longer), longer);
      return;
    }
  }

  // What is convex comes free of what is convex along the normal. A round face in a bore, a key in
  // a slot are only left along the direction in which their surfaces go on: the axis of the bore,
  // else what all normals are perpendicular to. Either way along it, as far as the two faces lie in
  // each other, or as far as both parts do.
  void try_axis() {
    if (region_.shape_a == FaceShape::kConvex && region_.shape_b == FaceShape::kConvex) return;
    std::vector<Vec3> ways;
    for (const Vec3& along : sliding_directions())
      for (const Vec3& d : {along, Vec3(-along)})
        for (const bool faces_only : {true, false}) {
          const double length = reach(1, d, faces_only) + reach(0, -d, faces_only);
          if (length > 0.0) ways.push_back((length + query_.overlap.accuracy_mm) * d);
        }
    std::stable_sort(ways.begin(), ways.end(), [](const Vec3& x, const Vec3& y) {
      return x.squaredNorm() < y.squaredNorm();
    });
    work_ = 0;  // of its own: far apart little is to be proven
    for (const Vec3& way : ways) {
      Attempt attempt;
      attempt.translation = way;
      if (length_of(attempt) >= best_.gpd_mm.hi) return;
      if (!is_free(pose_of(attempt))) continue;
      offer(SeparationWay::kAxis, length_of(attempt), attempt);
      return;
    }
  }

  const Solid& solid(int part) const { return part == 0 ? *query_.overlap.a : *query_.overlap.b; }
  const SurfaceBand& band(int part) const {
    return part == 0 ? *query_.overlap.band_a : *query_.overlap.band_b;
  }
  std::uint32_t deciding(int part) const {
    return part == 0 ? region_.deciding_triangle_a : region_.deciding_triangle_b;
  }

  // Directions along which the surfaces that hold A go on, either sense.
  std::vector<Vec3> sliding_directions() const {
    const Quat q[2] = {query_.overlap.X_WA.q, query_.overlap.X_WB.q};
    for (int part = 0; part < 2; ++part) {
      const auto& surface = band(part).face_of(deciding(part)).surface;
      if (surface &&
          (surface->kind == SurfaceKind::kCylinder || surface->kind == SurfaceKind::kCone))
        return {q[part] * surface->axis};
    }
    Mat3 sum = Mat3::Zero();
    Vec3 mean = Vec3::Zero();
    for (const Contact& contact : contacts_) {
      const Vec3 n = push_of(contact, Pose()).out_W;
      sum += n * n.transpose();
      mean += n / static_cast<double>(contacts_.size());
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(sum);
    const Vec3& sizes = solver.eigenvalues();
    if (sizes[0] > kSlides * sizes[2]) return {};
    if (sizes[1] > kSlides * sizes[2]) return {solver.eigenvectors().col(0)};
    // All normals are along one line. Walls that face each other leave a plane: along their edges.
    std::vector<Vec3> edges;
    if (mean.norm() > 0.9) return edges;
    const TriangleMesh& mesh = solid(1).mesh();
    for (int k = 0; k < 3; ++k)
      edges.push_back(
          q[1] *
          (mesh.corner(deciding(1), (k + 1) % 3) - mesh.corner(deciding(1), k)).stableNormalized());
    return edges;
  }

  // How far a part, or its deciding face, reaches along a world direction.
  double reach(int part, const Vec3& d, bool faces_only) const {
    const TriangleMesh& mesh = solid(part).mesh();
    const Pose& X = part == 0 ? query_.overlap.X_WA : query_.overlap.X_WB;
    const Vec3 d_P = X.q.conjugate() * d;
    const SurfaceBand& its_band = band(part);
    const bool by_face = faces_only && !its_band.face_of_triangle.empty();
    const SurfaceBand::Face* face = &its_band.face_of(deciding(part));
    double most = -std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (!by_face || &its_band.face_of(t) == face)
        for (int k = 0; k < 3; ++k) most = std::max(most, mesh.corner(t, k).dot(d_P));
    return most + X.p.dot(d);
  }

  void add_row(const Push& push, const Vec3& center, Eigen::Matrix<double, 6, 6>& ata,
               Eigen::Matrix<double, 6, 1>& atb) const {
    Eigen::Matrix<double, 6, 1> row;
    row.head<3>() = push.out_W;
    row.tail<3>() = (push.x_W - center).cross(push.out_W) / radius_mm_;
    ata += row * row.transpose();
    atb += row * std::max(0.0, push.depth_mm);
  }

  const GpdQuery& query_;
  const OverlapRegion& region_;
  CcdScratch& scratch_;
  const SurfaceBand nominal_;
  const Vec3 center_A_;
  const double radius_mm_;
  std::vector<Contact> contacts_;  // of all regions: a motion has to free them all
  std::uint64_t work_ = 0;
  GeneralizedDepth best_;
};

}  // namespace

GeneralizedDepth generalized_depth(const GpdQuery& query, CcdScratch& scratch) {
  if (query.region == nullptr) return {};
  MORTISE_CHECK(valid(query.motion_a) && valid(query.motion_b) && query.t_contact >= 0.0 &&
                    query.t_contact <= 1.0,
                "a separation is sought along valid motions from a time of the tick");
  const GeneralizedDepth depth = Separation(query, scratch).run();
  MORTISE_CHECK(depth.gpd_mm.lo >= 0.0 && depth.gpd_mm.ordered(),
                "a depth has its lower end first");
  return depth;
}

}  // namespace mortise
