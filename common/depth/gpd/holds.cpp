#include "common/depth/gpd/holds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/check.h"
#include "common/ccd/contact_places.h"
#include "common/geometry/signed_distance.h"

namespace mortise::gpd {
namespace {

// How much is looked at here is chosen: half or twice of it moves the lower end of at most one of
// 400 random pairs (gpd_pairs in tests/bench) by a percent.

// Centres tried along a line, from its middle each way: at so much of the radius of the part,
// shorter by a factor each: from 55 to 1.5 %.
constexpr int kCenters = 8;
constexpr double kShorter = 0.55;
// Rounding that is taken from every overlap of balls, mm, and the least overlap that says anything.
constexpr double kRounding_mm = 2e-9, kLeastHold_mm = 1e-9, kLeastDistance_mm = 1e-6;
// Corners, middles of edges and faces looked at in each part; of the deep ones the deepest few and
// then every so many.
constexpr std::size_t kMostSeen = 16'384, kMostLooks = 600, kDeepest = 6, kMostDeep = 20;
// Contact places that are near by this share of the smaller radius, of so many pairs of triangles.
constexpr double kPlacesReach = 0.05;
constexpr std::uint32_t kMostPlacePairs = 256;
// The bound is found to a thousandth of itself: it lies between two numbers of which one is twice
// the other.
constexpr int kBisections = 10;
// Where the search for the bound begins, as a share of the limit, when nothing is known.
constexpr double kLeastShare = 1e-4;

// A ball of A around x + t m and one of B, which overlap by e along m.
struct Hold {
  double t, sum_mm, e_mm;
};
struct Line {
  Vec3 x, m;
  std::vector<Hold> holds;
};

class Holds {
 public:
  Holds(const HoldsQuery& query, CcdScratch& scratch, std::uint64_t& work)
      : query_(query),
        scratch_(scratch),
        work_(work),
        back_A_(query.X_WA.inverse()),
        back_B_(query.X_WB.inverse()),
        frame_(*query.a, query.X_WA),
        corners_(corners_of(query)),
        program_(frame_, corners_) {
    for (const Vec3& x : corners_) arm_mm_ = std::max(arm_mm_, (x - frame_.center_W).norm());
    measure_across();
    for (const Vec3& x : query.points_W) add_both_ways(x);
    collect_from_surface(0);
    collect_from_surface(1);
    collect_from_places();
  }

  HeldBy bound() {
    HeldBy held{query_.known_mm, std::nullopt};
    if (lines_.empty() || !(across_mm_ > 0.0)) return held;
    // Doubled until it is no longer excluded, then halved.
    const double limit = query_.limit_mm * (1.0 - 1e-6);
    double lo = query_.known_mm, hi = std::max(2.0 * lo, kLeastShare * limit);
    while (hi < limit && excludes(hi)) {
      lo = hi;
      hi *= 2.0;
    }
    hi = std::min(hi, limit);
    for (int i = 0; i < kBisections && lo < hi; ++i) {
      const double r = 0.5 * (lo + hi);
      (excludes(r) ? lo : hi) = r;
    }
    held.least_mm = lo;
    if (Vec6 xi; program_.solve(rows_of(lo), xi)) held.twist = xi;
    return held;
  }

 private:
  static std::vector<Vec3> corners_of(const HoldsQuery& query) {
    std::vector<Vec3> corners;
    for (const Vec3& x : query.a->outline().corners) corners.push_back(query.X_WA * x);
    return corners;
  }

  // Two long differences of corners. About any axis one of them is at least across_mm_ wide:
  // angles α, β of the axis to their lines have α + β >= φ, and max(d1 sin α, d2 sin β) is least
  // where both are d1 d2 sin φ / |d1 + d2|.
  void measure_across() {
    Vec3 d1 = Vec3::Zero(), d2 = Vec3::Zero();
    for (const Vec3& x : corners_)
      for (const Vec3& y : corners_)
        if ((x - y).squaredNorm() > d1.squaredNorm()) d1 = x - y;
    double most = 0.0;
    for (const Vec3& x : corners_)
      for (const Vec3& y : corners_)
        if (const double area = d1.cross(x - y).norm(); area > most) {
          most = area;
          d2 = x - y;
        }
    if (d1.dot(d2) < 0.0) d2 = -d2;
    if (most > 0.0) across_mm_ = most / (d1 + d2).norm();
  }

  // Terms of second order of a motion that moves no point by more than r: θ² / 2.
  double second_of(double r) const {
    const double sine = r / across_mm_;
    const double theta = 2.0 * sine / std::sqrt(1.0 - sine * sine);  // above 2 asin
    return 0.5 * theta * theta;
  }

  // What each line asks of such a motion.
  std::vector<Row> rows_of(double r) const {
    const double second = second_of(r);
    std::vector<Row> rows(lines_.size());
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Line& line = lines_[i];
      double most = -1e300;
      for (const Hold& hold : line.holds) {
        const double eta = (2.0 * hold.sum_mm * hold.e_mm - hold.e_mm * hold.e_mm - r * r) /
                           (2.0 * (hold.sum_mm - hold.e_mm));
        most = std::max(most, eta - second * (line.x + hold.t * line.m - frame_.center_W).norm());
      }
      rows[i].g << line.m, (line.x - frame_.center_W).cross(line.m) / frame_.radius_mm;
      rows[i].h = most;
    }
    return rows;
  }

  // Does every motion that moves no point by more than r leave an overlap?
  bool excludes(double r) {
    // Beyond, the turn may exceed 90 degrees, and the terms of second order grow without bound.
    if (!(r < 0.7 * across_mm_)) return false;
    work_ += 20;
    const double limit = r + second_of(r) * arm_mm_;
    return program_.lower_bound_mm(rows_of(r), limit) > limit;
  }

  // Points that are asked one after the other lie close together.
  SurfacePoint at(int part, const Vec3& x_W) {
    ++work_;
    const SurfacePoint found = part == 0 ? nearest_surface(*query_.a, back_A_ * x_W, near_[0])
                                         : nearest_surface(*query_.b, back_B_ * x_W, near_[1]);
    near_[part] = found.triangle;
    return found;
  }
  // Outward normal of the face of the part that is nearest.
  Vec3 normal_W(int part, const Vec3& x_W) {
    ++work_;
    const Solid& solid = part == 0 ? *query_.a : *query_.b;
    const std::uint32_t t = nearest_point(solid, (part == 0 ? back_A_ : back_B_) * x_W).triangle;
    return (part == 0 ? query_.X_WA.q : query_.X_WB.q) * normal_of(solid.mesh(), t);
  }

  // Outward; zero where the triangle has no area.
  static Vec3 normal_of(const TriangleMesh& mesh, std::uint32_t t) {
    return (mesh.corner(t, 1) - mesh.corner(t, 0))
        .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
        .stableNormalized();
  }

  // way: out for A. owner: the part whose surface x is on, -1: not known.
  void add(const Vec3& x, const Vec3& way, int owner) {
    // A unit vector, or zero of a triangle without an area.
    if (!(way.norm() > 0.5) || lines_.size() >= query_.most_lines) return;
    Line line{x, way.normalized(), {}};
    double along_a[kCenters], along_b[kCenters], in_a[kCenters], in_b[kCenters];
    double share = 1.0;
    for (int i = 0; i < kCenters; ++i, share *= kShorter) {
      along_a[i] = i == 0 ? 0.0 : query_.a->sphere().radius_mm * share;
      along_b[i] = i == 0 ? 0.0 : query_.b->sphere().radius_mm * share;
      in_a[i] = i == 0 && owner == 0 ? 0.0 : at(0, x + along_a[i] * line.m).depth_mm;
      in_b[i] = i == 0 && owner == 1 ? 0.0 : at(1, x - along_b[i] * line.m).depth_mm;
    }
    for (int i = 0; i < kCenters; ++i)
      for (int j = 0; j < kCenters; ++j) {
        // A ball may be a mere point, but one that belongs to the part.
        if (!(in_a[i] >= 0.0 || (i == 0 && in_a[i] > -kLeastHold_mm)) ||
            !(in_b[j] >= 0.0 || (j == 0 && in_b[j] > -kLeastHold_mm)))
          continue;
        const double sum = std::max(0.0, in_a[i]) + std::max(0.0, in_b[j]);
        const double e = sum - along_a[i] - along_b[j] - kRounding_mm;
        if (e > kLeastHold_mm && sum - e > kLeastDistance_mm)
          line.holds.push_back({along_a[i], sum, e});
      }
    if (!line.holds.empty()) lines_.push_back(std::move(line));
  }

  // Out along the nearest face of either part.
  void add_both_ways(const Vec3& x) {
    add(x, normal_W(1, x), -1);
    add(x, -normal_W(0, x), -1);
  }

  struct Look {
    Vec3 x = Vec3::Zero();
    std::uint32_t triangle = Topology::kNone;  // whose face it is on; none: a corner
    double depth_mm = 0.0;
  };

  std::vector<Look> looks_of(int part) const {
    const TriangleMesh& mesh = (part == 0 ? query_.a : query_.b)->mesh();
    const Pose X = (part == 0 ? back_B_ : back_A_) * (part == 0 ? query_.X_WA : query_.X_WB);
    const Mat3 R = X.rotation();
    const Box& other = (part == 0 ? query_.b : query_.a)->bounds();
    std::vector<Look> looks;
    // Of a large mesh every so many are enough.
    const std::size_t every =
        std::max<std::size_t>(1, (mesh.points_mm.size() + 4 * mesh.triangles.size()) / kMostSeen);
    const auto look = [&](const Vec3& x, std::uint32_t t) {
      const Vec3 y = R * x + X.p;
      if ((y.array() >= other.lo.array()).all() && (y.array() <= other.hi.array()).all())
        looks.push_back({x, t, 0.0});
    };
    for (std::size_t i = 0; i < mesh.points_mm.size(); i += every)
      look(mesh.points_mm[i], Topology::kNone);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); t += static_cast<std::uint32_t>(every)) {
      const Vec3 &p = mesh.corner(t, 0), &q = mesh.corner(t, 1), &r = mesh.corner(t, 2);
      for (const Vec3& x :
           {Vec3((p + q + r) / 3.0), Vec3(0.5 * (p + q)), Vec3(0.5 * (q + r)), Vec3(0.5 * (r + p))})
        look(x, t);
    }
    return looks;
  }

  void collect_from_surface(int part) {
    const TriangleMesh& mesh = (part == 0 ? query_.a : query_.b)->mesh();
    const Pose& X = part == 0 ? query_.X_WA : query_.X_WB;
    std::vector<Look> looks = looks_of(part), deep;
    const std::size_t every = std::max<std::size_t>(1, looks.size() / kMostLooks);
    for (std::size_t i = 0; i < looks.size(); i += every) {
      Look& look = looks[i];
      look.x = X * look.x;
      look.depth_mm = at(1 - part, look.x).depth_mm;
      if (look.depth_mm > kLeastHold_mm) deep.push_back(look);
    }
    std::stable_sort(deep.begin(), deep.end(),
                     [](const Look& x, const Look& y) { return x.depth_mm > y.depth_mm; });
    const std::size_t stride = std::max<std::size_t>(1, deep.size() / kMostDeep);
    for (std::size_t i = 0; i < deep.size(); i += i < kDeepest ? 1 : stride) {
      const Look& look = deep[i];
      const Vec3 theirs = normal_W(1 - part, look.x);
      add(look.x, part == 0 ? theirs : Vec3(-theirs), part);
      if (look.triangle == Topology::kNone) continue;
      const Vec3 own = X.q * normal_of(mesh, look.triangle);
      add(look.x, part == 0 ? Vec3(-own) : own, part);
    }
  }

  void collect_from_places() {
    ContactPlacesQuery query;
    query.a = query_.a;
    query.b = query_.b;
    query.X_WA = query_.X_WA;
    query.X_WB = query_.X_WB;
    query.reach_mm =
        kPlacesReach * std::min(query_.a->sphere().radius_mm, query_.b->sphere().radius_mm);
    query.most_pairs = kMostPlacePairs;
    work_ += 20;
    for (const ContactPlace& p : contact_places(query, scratch_).places)
      if (p.gap_mm < -kLeastHold_mm)
        for (const double share : {0.0, -0.5, 0.5})
          add(p.point_W + share * p.gap_mm * p.normal_W, p.normal_W, -1);
  }

  const HoldsQuery& query_;
  CcdScratch& scratch_;
  std::uint64_t& work_;
  const Pose back_A_, back_B_;
  const TwistFrame frame_;
  const std::vector<Vec3> corners_;
  Minimax program_;
  double arm_mm_ = 0.0, across_mm_ = 0.0;
  std::uint32_t near_[2] = {Topology::kNone, Topology::kNone};  // see nearest_surface()
  std::vector<Line> lines_;
};

}  // namespace

HeldBy held_by_balls(const HoldsQuery& query, CcdScratch& scratch, std::uint64_t& work) {
  MORTISE_CHECK(query.a != nullptr && query.b != nullptr, "a query needs two solids");
  MORTISE_CHECK(valid(query.X_WA) && valid(query.X_WB),
                "poses must be finite and their quaternions unit");
  MORTISE_CHECK(0.0 <= query.known_mm && query.known_mm <= query.limit_mm,
                "what is known is no more than what parts them");
  HeldBy held = Holds(query, scratch, work).bound();
  MORTISE_CHECK(query.known_mm <= held.least_mm && held.least_mm <= query.limit_mm,
                "a lower bound does not fall, nor pass what parts them");
  return held;
}

}  // namespace mortise::gpd
