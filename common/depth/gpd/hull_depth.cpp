#include "common/depth/gpd/hull_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/math/unit.h"

namespace mortise::gpd {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
// A facet is no facet when its height is below this share of its longest edge.
constexpr double kSliver = 1e-11;

// b - a for all points of the bodies: A may be moved by t without overlap when t is outside.
class Difference {
 public:
  Difference(const ConvexBody& a, const ConvexBody& b) : a_(a), b_(b) {}

  struct Point {
    Vec3 x;
    double height = 0.0;  // along the direction that was asked
  };
  Point farthest(const Vec3& n_W) {
    ++asked;
    const Vec3 x = b_.farthest(n_W) - a_.farthest(-n_W);
    return {x, n_W.dot(x)};
  }
  std::uint64_t asked = 0;

 private:
  const ConvexBody &a_, &b_;
};

struct Facet {
  std::array<int, 3> corner{};
  std::array<int, 3> across{};  // facet beyond the edge from corner k to k + 1
  Vec3 n = Vec3::Zero();        // outward; zero: a sliver, which stands for no direction
  double height = kNone;        // n . x of its plane
  bool alive = true;
};

// A convex polytope that grows by points. Distances of its facets from the origin are signed:
// negative where the origin is outside.
class Polytope {
 public:
  Polytope(const std::array<Vec3, 4>& corners, double rounding_mm) : rounding_mm_(rounding_mm) {
    points_.assign(corners.begin(), corners.end());
    const bool turned =
        (points_[1] - points_[0]).cross(points_[2] - points_[0]).dot(points_[3] - points_[0]) > 0.0;
    if (turned) std::swap(points_[1], points_[2]);
    for (const std::array<int, 3>& c :
         {std::array<int, 3>{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}})
      add_facet(c);
    facets_[0].across = {1, 2, 3};
    facets_[1].across = {3, 2, 0};
    facets_[2].across = {1, 3, 0};
    facets_[3].across = {2, 1, 0};
  }

  // The facet nearest to the origin; -1: none that has a direction.
  int nearest() const {
    int best = -1;
    for (std::size_t i = 0; i < facets_.size(); ++i)
      if (facets_[i].alive && facets_[i].height < kNone &&
          (best < 0 || facets_[i].height < facets_[static_cast<std::size_t>(best)].height))
        best = static_cast<int>(i);
    return best;
  }
  const Facet& facet(int i) const { return facets_[static_cast<std::size_t>(i)]; }
  bool has(const Vec3& x) const {
    return std::find(points_.begin(), points_.end(), x) != points_.end();
  }

  // x lies above facet `from`. Takes away what x sees and closes the hole with facets around x.
  void grow(const Vec3& x, int from) {
    const int apex = static_cast<int>(points_.size());
    points_.push_back(x);
    horizon_.clear();
    facets_[static_cast<std::size_t>(from)].alive = false;
    see(x, from);
    const int first = static_cast<int>(facets_.size());
    const int count = static_cast<int>(horizon_.size());
    for (const Side& side : horizon_) {
      const Facet& beyond = facets_[static_cast<std::size_t>(side.facet)];
      const int u = beyond.corner[static_cast<std::size_t>(side.edge)],
                v = beyond.corner[static_cast<std::size_t>((side.edge + 1) % 3)];
      const int mine = static_cast<int>(facets_.size());
      add_facet({v, u, apex});
      Facet& fresh = facets_.back();
      fresh.across = {side.facet, -1, -1};
      facets_[static_cast<std::size_t>(side.facet)].across[static_cast<std::size_t>(side.edge)] =
          mine;
    }
    for (int i = first; i < first + count; ++i)
      for (int j = first; j < first + count; ++j)
        if (facets_[static_cast<std::size_t>(i)].corner[1] ==
            facets_[static_cast<std::size_t>(j)].corner[0]) {
          facets_[static_cast<std::size_t>(i)].across[1] = j;
          facets_[static_cast<std::size_t>(j)].across[2] = i;
        }
  }
  // Did every new facet find its neighbours? Else the border of what was seen was no simple ring.
  bool closed() const {
    return std::all_of(facets_.begin(), facets_.end(), [](const Facet& f) {
      return !f.alive ||
             std::all_of(f.across.begin(), f.across.end(), [](int k) { return k >= 0; });
    });
  }

 private:
  struct Side {
    int facet, edge;
  };

  void add_facet(const std::array<int, 3>& corner) {
    Facet facet;
    facet.corner = corner;
    const Vec3 &p = points_[static_cast<std::size_t>(corner[0])],
               &q = points_[static_cast<std::size_t>(corner[1])],
               &r = points_[static_cast<std::size_t>(corner[2])];
    const Vec3 area = (q - p).cross(r - p);
    const double longest2 =
        std::max({(q - p).squaredNorm(), (r - p).squaredNorm(), (r - q).squaredNorm()});
    if (area.norm() > kSliver * longest2) {
      facet.n = area.stableNormalized();
      facet.height = std::min({facet.n.dot(p), facet.n.dot(q), facet.n.dot(r)});
    }
    facets_.push_back(facet);
  }

  // Depth first over what x sees; its border in `horizon_`, as sides of the facets beyond.
  void see(const Vec3& x, int from) {
    waiting_.assign(1, from);
    while (!waiting_.empty()) {
      const Facet seen = facets_[static_cast<std::size_t>(waiting_.back())];
      waiting_.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        Facet& beyond = facets_[static_cast<std::size_t>(seen.across[k])];
        if (!beyond.alive) continue;
        const int v = seen.corner[(k + 1) % 3];
        if (beyond.height < kNone && beyond.n.dot(x) > beyond.height + rounding_mm_) {
          beyond.alive = false;
          waiting_.push_back(seen.across[k]);
        } else {
          for (int e = 0; e < 3; ++e)
            if (beyond.corner[static_cast<std::size_t>(e)] == v &&
                beyond.corner[static_cast<std::size_t>((e + 1) % 3)] == seen.corner[k])
              horizon_.push_back({seen.across[k], e});
        }
      }
    }
    // A facet that was passed as border before it was seen from elsewhere is no border.
    std::erase_if(horizon_, [&](const Side& side) {
      return !facets_[static_cast<std::size_t>(side.facet)].alive;
    });
  }

  const double rounding_mm_;
  std::vector<Vec3> points_;
  std::vector<Facet> facets_;
  std::vector<Side> horizon_;
  std::vector<int> waiting_;
};

// Four points that span a volume; false: the difference is flat.
bool spanning(Difference& difference, double least_mm, std::array<Vec3, 4>& corner) {
  corner[0] = difference.farthest(Vec3::UnitX()).x;
  corner[1] = difference.farthest(-Vec3::UnitX()).x;
  const Vec3 along = corner[1] - corner[0];
  if (!(along.norm() > least_mm)) return false;
  const Vec3 side = along.unitOrthogonal();
  const auto out_of = [&](const Vec3& n, Vec3& x) {
    const double at = n.dot(corner[0]);
    const auto up = difference.farthest(n), down = difference.farthest(-n);
    x = up.height - at >= down.height + at ? up.x : down.x;
    return std::fabs(n.dot(x) - at) > least_mm;
  };
  if (!out_of(side, corner[2]) && !out_of(along.cross(side).normalized(), corner[2])) return false;
  return out_of(along.cross(corner[2] - corner[0]).normalized(), corner[3]);
}

}  // namespace

ConvexBody hull_of(const Solid& part, const Pose& X_W) {
  return {[&part, &X_W](const Vec3& n_W) -> Vec3 {
            return X_W * farthest_corner(part.bvh(), part.outline(), X_W.q.conjugate() * n_W);
          },
          X_W* part.sphere().center_mm, part.sphere().radius_mm,
          X_W.p.norm() + part.bvh().extent_mm};
}

ConvexBody hull_of(const ConvexCell& cell, const Pose& X_W) {
  double radius_mm = 0.0;
  for (const Vec3& x : cell.corners.all())
    radius_mm = std::max(radius_mm, (x - cell.middle).norm());
  return {[&cell, &X_W](const Vec3& n_W) -> Vec3 {
            return X_W * cell.farthest(X_W.q.conjugate() * n_W);
          },
          X_W* cell.middle, radius_mm, X_W.p.norm() + cell.middle.norm() + radius_mm};
}

HullDepth hull_depth(const ConvexBody& a, const ConvexBody& b, double accuracy_mm,
                     int most_supports) {
  MORTISE_CHECK(accuracy_mm >= 0.0, "an accuracy must be a length");
  MORTISE_CHECK(
      a.middle_W.allFinite() && b.middle_W.allFinite() && a.radius_mm >= 0.0 && b.radius_mm >= 0.0,
      "a body has a middle and a radius");
  const Vec3 apart = a.middle_W - b.middle_W;
  const double rounding_mm = kRoundingFactor * kUnitRoundoff *
                             (2.0 * (a.radius_mm + b.radius_mm) + a.scale_mm + b.scale_mm);
  Difference difference(a, b);
  HullDepth result;
  result.normal_W = apart.norm() > 0.0 ? Vec3(apart.normalized()) : Vec3(Vec3::UnitZ());
  result.depth_mm = {0.0, std::max(0.0, difference.farthest(result.normal_W).height)};
  std::array<Vec3, 4> corners;
  if (result.depth_mm.hi > 0.0 && spanning(difference, 64.0 * rounding_mm, corners)) {
    Polytope polytope(corners, rounding_mm);
    while (static_cast<int>(difference.asked) < most_supports && result.depth_mm.hi > 0.0) {
      const int at = polytope.nearest();
      if (at < 0 || !polytope.closed()) break;
      const Facet facet = polytope.facet(at);
      result.depth_mm.lo = std::clamp(facet.height - rounding_mm, 0.0, result.depth_mm.hi);
      const Difference::Point far = difference.farthest(facet.n);
      if (far.height < result.depth_mm.hi) {
        result.depth_mm.hi = std::max(0.0, far.height);
        result.normal_W = facet.n;
      }
      result.depth_mm.lo = std::min(result.depth_mm.lo, result.depth_mm.hi);
      if (result.depth_mm.hi - facet.height <= accuracy_mm + 2.0 * rounding_mm ||
          far.height - facet.height <= 2.0 * rounding_mm || polytope.has(far.x))
        break;
      polytope.grow(far.x, at);
    }
  }
  result.supports = difference.asked;
  MORTISE_CHECK(0.0 <= result.depth_mm.lo && result.depth_mm.ordered(),
                "a depth has its lower end first");
  MORTISE_CHECK(is_unit(result.normal_W), "a way out goes along a unit direction");
  return result;
}

}  // namespace mortise::gpd
