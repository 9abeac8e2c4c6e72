#include "common/depth/gpd/starts.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/geometry/signed_distance.h"

namespace mortise::gpd {
namespace {

// Lengths tried beyond what the region needs, since other regions of the pair may need more.
constexpr double kLengthsTried[] = {1.0, 1.02, 1.1, 1.3, 2.0, 4.0};
// Steps of the fit of a small motion to the contact points; each is linear least squares.
constexpr int kFitSteps = 3;
// Contact points that are looked at, and regions whose normals and axes are tried.
constexpr std::size_t kMostContacts = 32, kMostRegions = 6, kMostAxisRegions = 2;
// Share of the largest below which no normal has a part along a direction.
constexpr double kSlides = 1e-3;

// The pair as the part that is moved sees it: part 0 is moved, part 1 stays.
class Pair {
 public:
  Pair(const GpdQuery& query, const TwistFrame& frame, std::uint64_t& evaluations)
      : query_(query), frame_(frame), evaluations_(evaluations) {
    for (const OverlapRegion& region : query.regions)
      for (const Vec3& x : region.points_W) contacts_.push_back({x, true});
    // Some of many say as much.
    while (contacts_.size() > kMostContacts) {
      for (std::size_t i = 0; 2 * i < contacts_.size(); ++i) contacts_[i] = contacts_[2 * i];
      contacts_.resize((contacts_.size() + 1) / 2);
    }
    for (Contact& contact : contacts_)
      contact.on_mover = distance(0, contact.x_W) <= distance(1, contact.x_W);
  }

  void add_normal(std::vector<Vec6>& twists) const {
    const OverlapRegion& region = query_.regions.front();
    // A unit vector, or zero where the region has none.
    if (!(region.normal_W.norm() > 0.5)) return;
    const double lo = std::max(region.delta_mm.lo, 0.0);
    // A bracket that was not refined says little: start from what is known to be needed.
    const double needed = lo + std::clamp(region.delta_mm.hi - lo, 0.0, std::max(0.01 * lo, 2e-4));
    for (const double times : kLengthsTried)
      twists.push_back(translation_twist(times * (needed + 1e-6) * outward(region)));
  }

  // Least squares twist that moves every contact point out along the normal there.
  void add_fitted(std::vector<Vec6>& twists) const {
    if (contacts_.size() < 3) return;
    Vec6 xi = Vec6::Zero();
    for (int step = 0; step < kFitSteps; ++step) {
      const Pose X = frame_.pose_of(xi);
      const Vec3 center = X * frame_.center_W;
      Eigen::Matrix<double, 6, 6> ata = Eigen::Matrix<double, 6, 6>::Zero();
      Vec6 atb = Vec6::Zero();
      for (const Contact& contact : contacts_) {
        const Push push = push_of(contact, X);
        Vec6 row;
        row << push.out_W, (push.x_W - center).cross(push.out_W) / frame_.radius_mm;
        ata += row * row.transpose();
        atb += row * std::max(0.0, push.depth_mm);
      }
      ata.diagonal().array() += 1e-6 * std::max(1.0, ata.trace());
      xi += ata.ldlt().solve(atb);
    }
    for (const double times : kLengthsTried) twists.push_back(times * xi);
  }

  void add_directions(Starts& starts) const {
    std::size_t count = 0;
    for (const OverlapRegion& region : query_.regions) {
      if (count++ == kMostRegions) break;
      starts.normals.push_back(region.normal_W);
      // What is convex comes free of what is convex along the normal. A round face in a bore, a key
      // in a slot are only left along the direction in which their surfaces go on.
      if (count > kMostAxisRegions ||
          (region.shape_a == FaceShape::kConvex && region.shape_b == FaceShape::kConvex))
        continue;
      for (const Vec3& along : sliding_directions(region)) starts.axes.push_back(along);
    }
  }

 private:
  // A point of the surface of one part that lies in the other; fixed to the one whose it is.
  struct Contact {
    Vec3 x_W;
    bool on_mover;
  };
  // With the mover displaced: where the contact is, how deep, and along what the mover leaves.
  struct Push {
    Vec3 x_W, out_W;
    double depth_mm;
  };

  bool is_a(int part) const { return (part == 0) != query_.b_moves; }
  const Solid& solid(int part) const { return is_a(part) ? *query_.overlap.a : *query_.overlap.b; }
  const Pose& pose(int part) const {
    return is_a(part) ? query_.overlap.X_WA : query_.overlap.X_WB;
  }
  Vec3 outward(const OverlapRegion& region) const {
    return query_.b_moves ? Vec3(-region.normal_W) : region.normal_W;
  }

  SurfacePoint at(int part, const Vec3& x_W, const Pose& X) const {
    ++evaluations_;
    const Pose X_WP = part == 0 ? X * pose(0) : pose(1);
    return nearest_surface(solid(part), X_WP.inverse() * x_W);
  }

  double distance(int part, const Vec3& x_W) const {
    ++evaluations_;
    return nearest_point(solid(part), pose(part).inverse() * x_W).distance_mm;
  }

  Push push_of(const Contact& contact, const Pose& X) const {
    if (contact.on_mover) {
      const Vec3 x = X * contact.x_W;
      const SurfacePoint on = at(1, x, X);
      return {x, pose(1).q * on.outward, on.depth_mm};
    }
    const SurfacePoint on = at(0, contact.x_W, X);
    return {contact.x_W, -((X * pose(0)).q * on.outward), on.depth_mm};
  }

  // Directions along which the surfaces that hold the part go on, either sense.
  std::vector<Vec3> sliding_directions(const OverlapRegion& region) const {
    for (int part = 0; part < 2; ++part) {
      const SurfaceBand* band = is_a(part) ? query_.overlap.band_a : query_.overlap.band_b;
      const auto& surface =
          band->face_of(is_a(part) ? region.deciding_triangle_a : region.deciding_triangle_b)
              .surface;
      if (surface &&
          (surface->kind == SurfaceKind::kCylinder || surface->kind == SurfaceKind::kCone))
        return {pose(part).q * surface->axis};
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
    if (!(sizes[0] <= kSlides * sizes[2])) return {};
    if (sizes[1] > kSlides * sizes[2]) return {solver.eigenvectors().col(0)};
    // All normals are along one line. Walls that face each other leave a plane: along their edges.
    std::vector<Vec3> edges;
    // All look the same way: no walls that face each other.
    if (mean.norm() > 0.9) return edges;
    const TriangleMesh& mesh = query_.overlap.b->mesh();
    const std::uint32_t t = region.deciding_triangle_b;
    for (int k = 0; k < 3; ++k)
      edges.push_back(query_.overlap.X_WB.q *
                      (mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k)).stableNormalized());
    return edges;
  }

  const GpdQuery& query_;
  const TwistFrame& frame_;
  std::uint64_t& evaluations_;
  std::vector<Contact> contacts_;  // of all regions: a motion has to free them all
};

}  // namespace

std::optional<Vec6> back_twist(const GpdQuery& query, const TwistFrame& frame) {
  const Motion &a = query.motion_a, &b = query.motion_b;
  if ((!a.moves() && !b.moves()) || query.t_contact >= 1.0) return std::nullopt;
  const Motion &mover = query.b_moves ? b : a, &other = query.b_moves ? a : b;
  const double t = query.t_contact;
  return frame.twist_of(other.X_W1 * other.pose_at(t).inverse() * mover.pose_at(t) *
                        mover.X_W1.inverse());
}

Starts starts_of(const GpdQuery& query, const TwistFrame& frame, std::uint64_t& evaluations) {
  Starts starts;
  if (query.regions.empty()) return starts;
  const Pair pair(query, frame, evaluations);
  if (const auto back = back_twist(query, frame)) starts.twists.push_back(*back);
  pair.add_normal(starts.twists);
  pair.add_fitted(starts.twists);
  pair.add_directions(starts);
  return starts;
}

}  // namespace mortise::gpd
