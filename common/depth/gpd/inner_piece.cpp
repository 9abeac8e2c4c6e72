#include "common/depth/gpd/inner_piece.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/check.h"
#include "common/depth/gpd/hull_depth.h"
#include "common/geometry/signed_distance.h"
#include "common/math/unit.h"

namespace mortise::gpd {
namespace {

// What a piece stays below its planes, as a share of the coordinates: more than rounding.
constexpr double kSlackShare = 1e-9;
// The plane of a triangle is taken where it is not much nearer than the triangle itself; else the
// plane across the way to it, which leaves more.
constexpr double kOwnPlane = 0.7;
// Steps of the climb to a point that is deep in both parts. With half as many 20 of 400 random
// pairs (gpd_pairs in tests/bench) have a lower end that is lower by a percent, with twice as many
// 2 a higher one.
constexpr int kClimbs = 14;
// Larger meshes are not cut into pieces, triangles; a unit of work for so many.
constexpr std::size_t kMostTriangles = 4096, kTrianglesAWorkUnit = 32;
// The depth of two pieces is a lower end in any case: how closely it is found, as a share of their
// radius, and the steps after which what is found has to do.
constexpr double kAccuracyShare = 1e-4;
constexpr int kMostSupports = 200;

struct Near {
  double distance_mm;
  Vec3 point;
  std::uint32_t triangle;
};

double lowest(const Vec3& n, const TriangleMesh& mesh, std::uint32_t t) {
  return std::min({n.dot(mesh.corner(t, 0)), n.dot(mesh.corner(t, 1)), n.dot(mesh.corner(t, 2))});
}

// The plane that keeps a triangle out. Its distance from x is that of the triangle, or of its
// plane.
Vec3 normal_of(const TriangleMesh& mesh, const Near& near, const Vec3& x) {
  const Vec3 p = mesh.corner(near.triangle, 0);
  const Vec3 own = (mesh.corner(near.triangle, 1) - p)
                       .cross(mesh.corner(near.triangle, 2) - p)
                       .stableNormalized();
  return own.dot(p - x) >= kOwnPlane * near.distance_mm ? own
                                                        : Vec3((near.point - x) / near.distance_mm);
}

class Pieces {
 public:
  Pieces(const PiecesQuery& query, std::uint64_t& work)
      : query_(query), work_(work), back_A_(query.X_WA.inverse()), back_B_(query.X_WB.inverse()) {}

  double bound_mm() {
    double most = 0.0;
    const std::size_t count = std::min(query_.points_W.size(), query_.most_points);
    for (std::size_t i = 0; i < count; ++i)
      if (Vec3 x = query_.points_W[i]; climb(x)) most = std::max(most, bound_at(x));
    return most;
  }

 private:
  struct Depth {
    double least_mm;
    Vec3 away_W;  // from the surface that is nearer
  };
  Depth depth_at(const Vec3& x_W) {
    work_ += 2;
    const SurfacePoint a = nearest_surface(*query_.a, back_A_ * x_W),
                       b = nearest_surface(*query_.b, back_B_ * x_W);
    return a.depth_mm < b.depth_mm ? Depth{a.depth_mm, -(query_.X_WA.q * a.outward)}
                                   : Depth{b.depth_mm, -(query_.X_WB.q * b.outward)};
  }

  // Deeper in the part in which the point is less deep.
  bool climb(Vec3& x_W) {
    Depth now = depth_at(x_W);
    double step = 0.25 * std::min(query_.a->sphere().radius_mm, query_.b->sphere().radius_mm);
    for (int i = 0; i < kClimbs; ++i) {
      const Vec3 to = x_W + step * now.away_W;
      const Depth there = depth_at(to);
      if (there.least_mm > now.least_mm) {
        x_W = to;
        now = there;
      } else {
        step *= 0.5;
      }
    }
    return now.least_mm > 0.0;
  }

  // What is convex is one piece: with the whole of it.
  std::optional<ConvexBody> piece_of(const Solid& part, const Pose& X_W, const Vec3& x,
                                     ConvexCell& cell, double& slack_mm) {
    if (part.outline().nearly_convex()) {
      slack_mm += part.outline().convex_slack_mm;
      return hull_of(part, X_W);
    }
    if (part.mesh().triangles.size() > kMostTriangles) return std::nullopt;
    work_ += part.mesh().triangles.size() / kTrianglesAWorkUnit;
    auto piece = inner_piece(part, x, query_.most_planes);
    if (!piece) return std::nullopt;
    cell = std::move(*piece);
    return hull_of(cell, X_W);
  }

  double bound_at(const Vec3& x_W) {
    ConvexCell cell_a, cell_b;
    double slack_mm = 0.0;
    const auto a = piece_of(*query_.a, query_.X_WA, back_A_ * x_W, cell_a, slack_mm);
    if (!a) return 0.0;
    const auto b = piece_of(*query_.b, query_.X_WB, back_B_ * x_W, cell_b, slack_mm);
    if (!b) return 0.0;
    const HullDepth depth =
        hull_depth(*a, *b, kAccuracyShare * std::min(a->radius_mm, b->radius_mm), kMostSupports);
    work_ += depth.supports;
    return depth.depth_mm.lo - slack_mm;
  }

  const PiecesQuery& query_;
  std::uint64_t& work_;
  const Pose back_A_, back_B_;
};

}  // namespace

std::optional<ConvexCell> inner_piece(const Solid& part, const Vec3& x, std::size_t most_planes) {
  MORTISE_CHECK(x.allFinite(), "a piece is sought around a point");
  const TriangleMesh& mesh = part.mesh();
  const double slack_mm = kSlackShare * (part.bvh().extent_mm + x.norm());
  std::vector<Near> all(mesh.triangles.size());
  for (std::uint32_t t = 0; t < all.size(); ++t) {
    const Vec3 p = nearest_on_triangle(x, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    all[t] = {(p - x).norm(), p, t};
  }
  std::sort(all.begin(), all.end(), [](const Near& p, const Near& q) {
    return p.distance_mm != q.distance_mm ? p.distance_mm < q.distance_mm : p.triangle < q.triangle;
  });
  // Each triangle lies above some plane, the nearest ones first.
  std::vector<HalfSpace> planes;
  for (const Near& near : all) {
    const bool outside = std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
      return lowest(plane.n, mesh, near.triangle) >= plane.c_mm + slack_mm;
    });
    if (outside) continue;
    if (planes.size() == most_planes || !(near.distance_mm > 0.0)) return std::nullopt;
    const Vec3 n = normal_of(mesh, near, x);
    const double c = lowest(n, mesh, near.triangle) - 2.0 * slack_mm;
    if (!(c - n.dot(x) > slack_mm)) return std::nullopt;
    planes.push_back({n, c});
  }
  for (const HalfSpace& plane : planes)
    MORTISE_CHECK(is_unit(plane.n) && plane.n.dot(x) < plane.c_mm, "the point lies in its piece");
  std::optional<ConvexCell> cell = polytope_cell(planes);
  if (!cell) return std::nullopt;
  for (const HalfSpace& plane : planes)
    if (cell->support_mm(plane.n) > plane.c_mm + 0.5 * slack_mm) return std::nullopt;
  if (!(nearest_surface(part, cell->middle).depth_mm > 0.0)) return std::nullopt;
  return cell;
}

double lower_bound_by_pieces_mm(const PiecesQuery& query, std::uint64_t& work) {
  return Pieces(query, work).bound_mm();
}

}  // namespace mortise::gpd
