#include "tests/bench/approaches_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/math/interval.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kSame = 1e-9;

struct Plane {
  Vec3 n = Vec3::UnitZ();
  double c = 0.0;  // n · x <= c
};

// No two of one direction: the tighter one counts.
void add_plane(std::vector<Plane>& planes, const Vec3& n, double c) {
  for (Plane& plane : planes)
    if ((plane.n - n).squaredNorm() < kSame * kSame) {
      plane.c = std::min(plane.c, c);
      return;
    }
  planes.push_back({n, c});
}

void add_planes(std::vector<Plane>& planes, const TriangleMesh& mesh) {
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 p = mesh.corner(t, 0);
    const Vec3 n = (mesh.corner(t, 1) - p).cross(mesh.corner(t, 2) - p).normalized();
    add_plane(planes, n, n.dot(p));
  }
}

// What is left of a polygon below a plane.
void clip(std::vector<Vec3>& polygon, const Plane& plane) {
  std::vector<Vec3> left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = plane.n.dot(p) - plane.c, at_q = plane.n.dot(q) - plane.c;
    if (at_p <= 0.0) left.push_back(p);
    if ((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0))
      left.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  polygon.swap(left);
}

// The cone of each face over the origin.
double volume_within(const std::vector<Plane>& planes, double far) {
  double six = 0.0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const Vec3 u = planes[i].n.unitOrthogonal(), v = planes[i].n.cross(u);
    const Vec3 o = planes[i].c * planes[i].n;
    std::vector<Vec3> face = {o + far * (u + v), o + far * (v - u), o - far * (u + v),
                              o + far * (u - v)};
    for (std::size_t k = 0; k < planes.size() && face.size() > 2; ++k)
      if (k != i) clip(face, planes[k]);
    for (std::size_t k = 2; k < face.size(); ++k) six += face[0].dot(face[k - 1].cross(face[k]));
  }
  return std::max(0.0, six / 6.0);
}

Interval along(const TriangleMesh& mesh, const Vec3& n) {
  Interval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Vec3& x : mesh.points_mm)
    all = {std::min(all.lo, n.dot(x)), std::max(all.hi, n.dot(x))};
  return all;
}

std::vector<std::pair<Vec3, Vec3>> edges_of(const TriangleMesh& mesh) {
  std::vector<std::pair<Vec3, Vec3>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] < t[(k + 1) % 3])
        edges.emplace_back(mesh.points_mm[t[k]], mesh.points_mm[t[(k + 1) % 3]]);
  return edges;
}

// {b - a}: A moved by t overlaps B where t is inside. Its faces are faces of either, or spanned by
// an edge of each that reach farthest along the normal.
std::vector<Plane> difference(const TriangleMesh& a, const TriangleMesh& b) {
  std::vector<Plane> of_a, of_b, faces;
  add_planes(of_a, a);
  add_planes(of_b, b);
  const auto reach = [&](const Vec3& n) { return along(b, n).hi - along(a, n).lo; };
  for (const Plane& plane : of_b) add_plane(faces, plane.n, reach(plane.n));
  for (const Plane& plane : of_a) add_plane(faces, -plane.n, reach(-plane.n));
  const auto edges_a = edges_of(a), edges_b = edges_of(b);
  for (const auto& [p, q] : edges_a)
    for (const auto& [r, s] : edges_b) {
      const Vec3 across = (q - p).cross(s - r);
      if (across.norm() < 1e-9 * (q - p).norm() * (s - r).norm()) continue;
      for (const double sign : {1.0, -1.0}) {
        const Vec3 n = sign * across.normalized();
        if (n.dot(p) < along(a, n).lo + kSame && n.dot(r) > along(b, n).hi - kSame)
          add_plane(faces, n, reach(n));
      }
    }
  return faces;
}

// The point nearest to the origin outside of all bodies.
class Nearest {
 public:
  Nearest(std::vector<std::vector<Plane>> bodies, long long most_nodes)
      : bodies_(std::move(bodies)), nodes_(most_nodes) {}

  std::optional<double> run() {
    descend(Vec3::Zero());
    if (nodes_ <= 0) return std::nullopt;
    return best_;
  }

 private:
  void descend(const Vec3& t) {
    if (--nodes_ <= 0) return;
    double deepest = kSame;
    const std::vector<Plane>* in = nullptr;
    for (const auto& body : bodies_) {
      double depth = std::numeric_limits<double>::infinity();
      for (const Plane& face : body) depth = std::min(depth, face.c - face.n.dot(t));
      if (depth > deepest) {
        deepest = depth;
        in = &body;
      }
    }
    if (in == nullptr) {
      best_ = std::min(best_, t.norm());
      return;
    }
    std::vector<std::pair<double, Plane>> ways;
    for (const Plane& face : *in)
      if (face.c < best_) ways.emplace_back(face.c - face.n.dot(t), face);
    std::sort(ways.begin(), ways.end(),
              [](const auto& x, const auto& y) { return x.first < y.first; });
    for (const auto& [lack, face] : ways) {
      outside_.push_back(face);
      const std::optional<Vec3> next = nearest();
      if (next && next->norm() < best_ - kSame) descend(*next);
      outside_.pop_back();
    }
  }

  bool beyond_all(const Vec3& t) const {
    return std::all_of(outside_.begin(), outside_.end(),
                       [&](const Plane& face) { return face.n.dot(t) >= face.c - 1e-10; });
  }

  // Nearest to the origin beyond all planes chosen. The last one is active: the point before it was
  // not beyond it.
  std::optional<Vec3> nearest() const {
    const Plane& last = outside_.back();
    if (const Vec3 t = last.c * last.n; beyond_all(t)) return t;
    std::optional<Vec3> best;
    const auto take = [&](const Vec3& t) {
      if (t.allFinite() && beyond_all(t) && (!best || t.norm() < best->norm())) best = t;
    };
    const std::size_t others = outside_.size() - 1;
    for (std::size_t i = 0; i < others; ++i) {
      const Plane& p = outside_[i];
      const double dot = p.n.dot(last.n), det = 1.0 - dot * dot;
      if (det < 1e-12) continue;
      take(((last.c - dot * p.c) * last.n + (p.c - dot * last.c) * p.n) / det);
      for (std::size_t j = 0; j < i; ++j) {
        Mat3 m;
        m << last.n.transpose(), p.n.transpose(), outside_[j].n.transpose();
        if (std::fabs(m.determinant()) > 1e-9) take(m.inverse() * Vec3(last.c, p.c, outside_[j].c));
      }
    }
    return best;
  }

  const std::vector<std::vector<Plane>> bodies_;
  std::vector<Plane> outside_;
  long long nodes_;
  double best_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Pieces placed(const Pieces& pieces, const Pose& X) {
  Pieces moved = pieces;
  for (TriangleMesh& piece : moved)
    for (Vec3& x : piece.points_mm) x = X * x;
  return moved;
}

double common_volume_mm3(const Pieces& a, const Pieces& b) {
  double sum = 0.0;
  for (const TriangleMesh& in_a : a)
    for (const TriangleMesh& in_b : b) {
      std::vector<Plane> planes;
      add_planes(planes, in_a);
      add_planes(planes, in_b);
      double far = 0.0;
      for (const Vec3& x : in_a.points_mm) far = std::max(far, 4.0 * x.norm());
      sum += volume_within(planes, far);
    }
  return sum;
}

std::optional<double> translational_depth_mm(const Pieces& a, const Pieces& b,
                                             long long most_nodes) {
  std::vector<std::vector<Plane>> bodies;
  for (const TriangleMesh& in_a : a)
    for (const TriangleMesh& in_b : b) bodies.push_back(difference(in_a, in_b));
  return Nearest(std::move(bodies), most_nodes).run();
}

Pieces ring_pieces(double hole_mm, double outer_mm, double z0_mm, double z1_mm, int n,
                   double phase_rad) {
  Pieces pieces;
  for (int i = 0; i < n; ++i) {
    std::vector<std::array<double, 2>> corners;
    for (const auto& [radius, k] :
         {std::pair{hole_mm, i}, {outer_mm, i}, {outer_mm, i + 1}, {hole_mm, i + 1}}) {
      const double angle = 2.0 * std::numbers::pi * k / n + phase_rad;
      corners.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    pieces.push_back(shapes::prism(corners, {{0, 1, 2}, {0, 2, 3}}, z0_mm, z1_mm));
  }
  return pieces;
}

Pieces slot_pieces(double w_mm, double s_mm, double h_mm, double floor_mm, double z0_mm,
                   double z1_mm) {
  const double z = 0.5 * (z0_mm + z1_mm), half_z = 0.5 * (z1_mm - z0_mm);
  const double wall = 0.5 * (w_mm - s_mm), middle = 0.5 * (w_mm + s_mm);
  const Vec3 half(wall, 0.5 * h_mm, half_z);
  return {shapes::box({w_mm, 0.5 * floor_mm, half_z}, {0, -0.5 * floor_mm, z}),
          shapes::box(half, {middle, 0.5 * h_mm, z}), shapes::box(half, {-middle, 0.5 * h_mm, z})};
}

}  // namespace mortise::bench
