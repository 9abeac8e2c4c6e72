#include "common/geometry/signed_distance.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "common/base/check.h"
#include "common/geometry/kernels/nearest.h"

namespace mortise {
namespace {

// Where on a triangle its nearest point lies: face, edge k (corner k to k + 1), or corner k.
enum class Spot : std::uint8_t { kFace, kEdge0, kEdge1, kEdge2, kCorner0, kCorner1, kCorner2 };

struct Foot {
  Vec3 point = Vec3::Zero();
  Spot spot = Spot::kFace;
};

Spot edge(int k) { return static_cast<Spot>(1 + k); }
Spot corner(int k) { return static_cast<Spot>(4 + k); }

Foot foot_on_edge(const Vec3& x, const Vec3& a, const Vec3& b, int k) {
  const Vec3 ab = b - a;
  const double along = ab.dot(x - a), length2 = ab.squaredNorm();
  if (!(along > 0.0)) return {a, corner(k)};
  if (along >= length2) return {b, corner((k + 1) % 3)};
  return {a + ab * (along / length2), edge(k)};
}

// Ericson 2005, 5.1.5: by the regions of the plane, without square roots.
Foot foot_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, corner(0)};
  const Vec3 bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0.0 && d4 <= d3) return {b, corner(1)};
  const Vec3 cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0.0 && d5 <= d6) return {c, corner(2)};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + ab * (d1 / (d1 - d3)), edge(0)};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + ac * (d2 / (d2 - d6)), edge(2)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), edge(1)};
  const double sum = va + vb + vc;
  if (sum > 0.0) return {a + ab * (vb / sum) + ac * (vc / sum), Spot::kFace};
  // Without area: the nearest of its edges.
  Foot best = foot_on_edge(x, a, b, 0);
  for (const Foot& other : {foot_on_edge(x, b, c, 1), foot_on_edge(x, c, a, 2)})
    if ((other.point - x).squaredNorm() < (best.point - x).squaredNorm()) best = other;
  return best;
}

struct Found {
  double distance2 = std::numeric_limits<double>::infinity();
  Foot foot;
  std::uint32_t triangle = Topology::kNone;

  void offer(const Foot& f, const Vec3& x, std::uint32_t t) {
    const double d2 = (f.point - x).squaredNorm();
    if (d2 > distance2 || (d2 == distance2 && t >= triangle)) return;
    distance2 = d2;
    foot = f;
    triangle = t;
  }
};

Vec3 corner_of(const Bvh& bvh, std::uint32_t i, int k) {
  const std::array<double, 9>& c = bvh.corners[i];
  return {c[3 * k], c[3 * k + 1], c[3 * k + 2]};
}

// Of each term of a squared distance from a box: boxes are discarded by no less than that, so that
// which of two triangles at the same distance is found does not depend on what was asked first.
constexpr double kRounding = 1e-14;

// Rounding of the point and of two differences is below four units in the last place, 2.4e-7, of
// its coordinates and those of the box.
geometry::BoxPoint box_point(const Vec3& local, double radius_mm) {
  return {
      {static_cast<float>(local[0]), static_cast<float>(local[1]), static_cast<float>(local[2])},
      static_cast<float>(4e-7 * (radius_mm + local.norm()))};
}

// A foot is off by less than 1e-14 of the coordinates, s, and its squared distance d^2 by
// 2 d s + s^2 < 1e-6 d^2 + 2e6 s^2, of which the kernel takes off the first.
geometry::TrianglePoint triangle_point(const Vec3& x, double extent_mm) {
  const double s = 1e-14 * (extent_mm + x.norm());
  return {{x[0], x[1], x[2]}, 2e6 * s * s};
}

// The nearest first: it often leaves nothing for the others.
void offer_leaf(const Bvh& bvh, const Bvh::Leaf& leaf, const Vec3& x,
                const geometry::TrianglePoint& exact, Found& found) {
  double lower[Bvh::kLeafSize];
  geometry::best_nearest().triangles(exact, bvh.corners[leaf.first].data(),
                                     static_cast<int>(leaf.count), lower);
  const auto offer = [&](std::uint32_t k) {
    if (lower[k] > found.distance2) return;
    const std::uint32_t i = leaf.first + k;
    found.offer(
        foot_on_triangle(x, corner_of(bvh, i, 0), corner_of(bvh, i, 1), corner_of(bvh, i, 2)), x,
        bvh.triangle_order[i]);
  };
  const auto nearest =
      static_cast<std::uint32_t>(std::min_element(lower, lower + leaf.count) - lower);
  offer(nearest);
  for (std::uint32_t k = 0; k < leaf.count; ++k)
    if (k != nearest) offer(k);
}

// Nearest first, so that the best found so far (`found`) discards most of the tree.
Found find_nearest(const Bvh& bvh, const Vec3& x, Found found) {
  struct Item {
    float distance2;
    std::int32_t child;
  };
  std::array<Item, Bvh::kMostWaiting> stack;
  int top = 0;
  stack[top++] = {0.0F, bvh.root};
  const Vec3 local = x - bvh.origin;
  const geometry::BoxPoint point = box_point(local, bvh.radius_mm);
  const geometry::TrianglePoint exact = triangle_point(x, bvh.extent_mm);
  const geometry::NearestKernels& kernels = geometry::best_nearest();
  const double size = kRounding * (bvh.radius_mm + local.norm()), tiny = size * size;
  const auto discards = [&found, tiny](float distance2) {
    return static_cast<double>(distance2) * (1.0 - kRounding) > found.distance2 + tiny;
  };
  while (top > 0) {
    const Item item = stack[--top];
    if (discards(item.distance2)) continue;
    if (item.child < 0) {
      offer_leaf(bvh, bvh.leaves[~item.child], x, exact, found);
      continue;
    }
    const Bvh::Node& node = bvh.nodes[item.child];
    float distance2[Bvh::kWidth];
    const double limit2 = (found.distance2 + tiny) * (1.0 + 4.0 * kRounding);
    const float limit = limit2 < 1e38 ? static_cast<float>(limit2) * (1.0F + 0x1p-22F)
                                      : std::numeric_limits<float>::max();
    unsigned near = kernels.boxes(point, node.local_center, node.half, limit, distance2) &
                    ((1U << node.count) - 1U);
    const int begin = top;
    for (; near != 0; near &= near - 1) {
      const int k = std::countr_zero(near);
      int at = top++;
      while (at > begin && stack[at - 1].distance2 < distance2[k]) {
        stack[at] = stack[at - 1];
        --at;
      }
      stack[at] = {distance2[k], node.child[k]};
    }
  }
  return found;
}

// Sum over the triangles around a corner of normal times angle there.
Vec3 corner_pseudonormal(const Solid& solid, std::uint32_t start, int start_corner) {
  const TriangleMesh& mesh = solid.mesh();
  const Topology& topology = solid.topology();
  const std::uint32_t point = mesh.triangles[start][start_corner];
  Vec3 sum = Vec3::Zero();
  std::uint32_t t = start;
  for (std::size_t guard = 0; guard <= mesh.triangles.size(); ++guard) {
    int k = 0;
    while (k < 2 && mesh.triangles[t][k] != point) ++k;
    const Vec3 u = mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k);
    const Vec3 v = mesh.corner(t, (k + 2) % 3) - mesh.corner(t, k);
    sum += std::atan2(u.cross(v).norm(), u.dot(v)) * topology.normal[t];
    t = topology.neighbor[t][k];
    if (t == start || t == Topology::kNone) break;
  }
  return sum;
}

Vec3 pseudonormal(const Solid& solid, std::uint32_t t, Spot spot) {
  const Topology& topology = solid.topology();
  if (spot == Spot::kFace) return topology.normal[t];
  if (spot >= Spot::kCorner0)
    return corner_pseudonormal(solid, t, static_cast<int>(spot) - static_cast<int>(Spot::kCorner0));
  const std::uint32_t other = topology.neighbor[t][static_cast<int>(spot) - 1];
  const Vec3& mine = topology.normal[t];
  return other == Topology::kNone ? mine : Vec3(mine + topology.normal[other]);
}

// Directions without relation to any usual mesh; the next is tried when one grazes an edge.
const std::array<Vec3, 6>& ray_directions() {
  static const std::array<Vec3, 6> directions = {Vec3(0.5370861555, 0.7292384129, 0.4237146328),
                                                 Vec3(-0.3183098862, 0.4342944819, 0.8427007929),
                                                 Vec3(0.6931471806, -0.5772156649, 0.4314159265),
                                                 Vec3(0.2078795764, 0.3678794412, -0.9063416971),
                                                 Vec3(-0.7071170277, -0.6180339887, 0.3436463656),
                                                 Vec3(0.1234567891, -0.9159655942, -0.3819660113)};
  return directions;
}

struct Crossings {
  int winding = 0;
  bool grazed = false;
};

// Signed crossings of the ray from x with one triangle, by the signs of the three volumes that the
// ray spans with its edges.
void cross_triangle(const Vec3& x, const Vec3& d, const Vec3& a, const Vec3& b, const Vec3& c,
                    Crossings& count) {
  const Vec3 pa = a - x, pb = b - x, pc = c - x;
  const double u = d.dot(pb.cross(pc)), v = d.dot(pc.cross(pa)), w = d.dot(pa.cross(pb));
  const double size = std::max({pa.squaredNorm(), pb.squaredNorm(), pc.squaredNorm()});
  const double epsilon = 1e-14 * size;  // rounding of the volumes: a few ulp of their terms
  const bool positive = u > epsilon && v > epsilon && w > epsilon;
  const bool negative = u < -epsilon && v < -epsilon && w < -epsilon;
  if (!positive && !negative) {
    const bool outside = (std::min({u, v, w}) < -epsilon && std::max({u, v, w}) > epsilon);
    if (!outside) count.grazed = true;
    return;
  }
  const Vec3 n = (b - a).cross(c - a);
  const double height = n.dot(pa);  // along n; d points along n when `positive`
  if (positive ? height > 0.0 : height < 0.0) count.winding += positive ? 1 : -1;
}

Crossings cross_all(const Bvh& bvh, const Vec3& x, const Vec3& d) {
  std::array<std::int32_t, Bvh::kMostWaiting> stack;
  int top = 0;
  stack[top++] = bvh.root;
  const Vec3 local = x - bvh.origin;
  const double slack = 1e-12 * (bvh.radius_mm + local.norm());
  Crossings count;
  while (top > 0 && !count.grazed) {
    const std::int32_t child = stack[--top];
    if (child < 0) {
      const Bvh::Leaf& leaf = bvh.leaves[~child];
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
        cross_triangle(x, d, corner_of(bvh, i, 0), corner_of(bvh, i, 1), corner_of(bvh, i, 2),
                       count);
      continue;
    }
    const Bvh::Node& node = bvh.nodes[child];
    for (int k = 0; k < node.count; ++k) {
      double enter = 0.0, leave = std::numeric_limits<double>::infinity();
      for (int c = 0; c < 3; ++c) {
        const double middle = static_cast<double>(node.local_center[c][k]) - local[c];
        const double half = static_cast<double>(node.half[c][k]) + slack;
        const double s0 = (middle - half) / d[c], s1 = (middle + half) / d[c];
        enter = std::max(enter, std::min(s0, s1));
        leave = std::min(leave, std::max(s0, s1));
      }
      if (enter <= leave) stack[top++] = node.child[k];
    }
  }
  return count;
}

}  // namespace

Vec3 nearest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  return foot_on_triangle(x, a, b, c).point;
}

NearestPoint nearest_point(const Solid& solid, const Vec3& x, double limit_mm) {
  MORTISE_CHECK(x.allFinite() && !std::isnan(limit_mm), "a point and a limit must be numbers");
  Found limit;
  limit.distance2 = limit_mm < 1e150 ? limit_mm * limit_mm : limit_mm;
  const Found found = find_nearest(solid.bvh(), x, limit);
  if (found.triangle == Topology::kNone) return {limit_mm, x, Topology::kNone};
  return {std::sqrt(found.distance2), found.foot.point, found.triangle};
}

SurfacePoint nearest_surface(const Solid& solid, const Vec3& x, std::uint32_t near) {
  MORTISE_CHECK(x.allFinite(), "a point must be finite");
  Found first;
  if (near != Topology::kNone) {
    const TriangleMesh& mesh = solid.mesh();
    first.offer(
        foot_on_triangle(x, mesh.corner(near, 0), mesh.corner(near, 1), mesh.corner(near, 2)), x,
        near);
  }
  const Found found = find_nearest(solid.bvh(), x, first);
  SurfacePoint at;
  at.triangle = found.triangle;
  at.point = found.foot.point;
  at.face_normal = solid.topology().normal[found.triangle];
  const double distance = std::sqrt(found.distance2);
  Vec3 outward = pseudonormal(solid, found.triangle, found.foot.spot);
  const double length = outward.norm();
  at.outward = length > 0.0 ? Vec3(outward / length) : at.face_normal;
  // Elsewhere the normals around a point do not tell the side: it is that of another shell, or of
  // another fan of triangles.
  const bool one_shell = solid.topology().manifold() && solid.shells().size() == 1;
  const bool is_inside =
      one_shell && length > 0.0 ? at.outward.dot(x - at.point) < 0.0 : inside(solid, x);
  at.depth_mm = is_inside ? distance : -distance;
  return at;
}

int winding_number(const Solid& solid, const Vec3& x) {
  MORTISE_CHECK(x.allFinite(), "a point must be finite");
  const auto& lids = solid.cracks().lids;
  for (const Vec3& d : ray_directions()) {
    Crossings count = cross_all(solid.bvh(), x, d);
    for (std::size_t i = 0; i < lids.size() && !count.grazed; ++i)
      cross_triangle(x, d, lids[i].corners[0], lids[i].corners[1], lids[i].corners[2], count);
    if (!count.grazed) return count.winding;
  }
  return static_cast<int>(std::lround(winding_number_brute_force(solid.mesh(), x)));
}

bool inside(const Solid& solid, const Vec3& x) {
  MORTISE_CHECK(x.allFinite(), "a point must be finite");
  if (!solid.has_inside()) return winding_number_brute_force(solid.mesh(), x) > 0.5;
  const Box& box = solid.bounds();
  if ((x.array() < box.lo.array()).any() || (x.array() > box.hi.array()).any()) return false;
  return winding_number(solid, x) > 0;
}

double signed_distance_mm(const Solid& solid, const Vec3& x) {
  return -nearest_surface(solid, x).depth_mm;
}

NearestPoint nearest_point_brute_force(const TriangleMesh& mesh, const Vec3& x) {
  Found found;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    found.offer(foot_on_triangle(x, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)), x, t);
  return {std::sqrt(found.distance2), found.foot.point, found.triangle};
}

// Van Oosterom and Strackee 1983.
double winding_number_brute_force(const TriangleMesh& mesh, const Vec3& x) {
  double sum = 0.0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 a = mesh.corner(t, 0) - x, b = mesh.corner(t, 1) - x, c = mesh.corner(t, 2) - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2.0 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4.0 * std::numbers::pi);
}

}  // namespace mortise
