#include "tests/bench/rss_twin.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace mortise::bench {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double clamp01(double x) { return std::clamp(x, 0.0, 1.0); }

// A flat convex polygon, corners in order: a triangle or a rectangle.
template <int kCount>
struct Polygon {
  std::array<Vec3, kCount> x, edge;
  std::array<double, kCount> length2;

  explicit Polygon(const std::array<Vec3, kCount>& corners) : x(corners) {
    for (int k = 0; k < kCount; ++k) {
      edge[k] = x[(k + 1) % kCount] - x[k];
      length2[k] = edge[k].squaredNorm();
    }
  }
  Vec3 normal() const { return edge[0].cross(edge[1]); }
  bool behind(const Vec3& v, const Vec3& foot) const {
    return std::all_of(x.begin(), x.end(), [&](const Vec3& p) { return v.dot(p - foot) <= 0.0; });
  }
  bool over(const Vec3& n, const Vec3& p) const {
    for (int k = 0; k < kCount; ++k)
      if (n.cross(edge[k]).dot(p - x[k]) < 0.0) return false;
    return true;
  }
};

// Of the corners of `points` over the inside of `face`.
template <int kFace, int kPoints>
double over_face2(const Polygon<kFace>& face, const Polygon<kPoints>& points) {
  const Vec3 n = face.normal();
  const double nn = n.squaredNorm();
  double best2 = kFar;
  if (!(nn > 0.0)) return best2;
  for (const Vec3& p : points.x) {
    const double h = n.dot(p - face.x[0]);
    if (h * h < best2 * nn && face.over(n, p)) best2 = h * h / nn;
  }
  return best2;
}

template <int kFace, int kEdges>
bool pierced(const Polygon<kFace>& face, const Polygon<kEdges>& edges) {
  const Vec3 n = face.normal();
  for (int k = 0; k < kEdges; ++k) {
    const double h0 = n.dot(edges.x[k] - face.x[0]);
    const double h1 = n.dot(edges.x[(k + 1) % kEdges] - face.x[0]);
    if ((h0 > 0.0) != (h1 > 0.0) && face.over(n, edges.x[k] + edges.edge[k] * (h0 / (h0 - h1))))
      return true;
  }
  return false;
}

// Edges first: where both polygons lie behind the feet, nothing is nearer.
template <int kA, int kB>
double polygon_distance2(const Polygon<kA>& a, const Polygon<kB>& b) {
  double best2 = kFar;
  for (int i = 0; i < kA; ++i)
    for (int j = 0; j < kB; ++j) {
      const Vec3 r = b.x[j] - a.x[i];
      const double ab = a.edge[i].dot(b.edge[j]), ar = a.edge[i].dot(r), br = b.edge[j].dot(r);
      const double aa = a.length2[i], bb = b.length2[j], sine2 = aa * bb - ab * ab;
      double s = sine2 > 1e-14 * aa * bb ? clamp01((ar * bb - ab * br) / sine2) : 0.0;
      const double t = bb > 0.0 ? clamp01((ab * s - br) / bb) : 0.0;
      s = aa > 0.0 ? clamp01((ab * t + ar) / aa) : 0.0;
      const Vec3 p = a.x[i] + s * a.edge[i], q = b.x[j] + t * b.edge[j], v = q - p;
      const double d2 = v.squaredNorm();
      if (d2 >= best2) continue;
      best2 = d2;
      if (a.behind(v, p) && b.behind(-v, q)) return best2;
    }
  best2 = std::min({best2, over_face2(a, b), over_face2(b, a)});
  return pierced(a, b) || pierced(b, a) ? 0.0 : best2;
}

Vec3 moved(const Mat3& R, const Vec3& p, const Vec3& x) { return R * x + p; }

}  // namespace

RssTwin::RssTwin(const TriangleMesh& mesh) {
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    triangles_.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
  nodes_.reserve(2 * triangles_.size());
  build(0, triangles_.size());
}

int RssTwin::build(std::size_t begin, std::size_t end) {
  const auto at = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.begin = begin;
  node.end = end;
  Vec3 longest;
  fit(node, longest);
  if (end - begin > 1) {
    const auto along = [&](const Corners& t) { return longest.dot(t[0] + t[1] + t[2]); };
    double mean = 0.0;
    for (std::size_t i = begin; i < end; ++i) mean += along(triangles_[i]);
    mean /= static_cast<double>(end - begin);
    const auto first = triangles_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = triangles_.begin() + static_cast<std::ptrdiff_t>(end);
    auto middle = std::partition(first, last, [&](const Corners& t) { return along(t) <= mean; });
    if (middle == first || middle == last) middle = first + (last - first) / 2;
    const auto split = static_cast<std::size_t>(middle - triangles_.begin());
    node.left = build(begin, split);
    node.right = build(split, end);
  }
  nodes_[at] = node;
  return at;
}

// The rectangle in the plane of the two larger principal axes, shortened at its ends by what the
// spheres reach; the radius then holds every corner.
void RssTwin::fit(Node& node, Vec3& longest) const {
  const auto corners = std::span(triangles_).subspan(node.begin, node.end - node.begin);
  Vec3 mean = Vec3::Zero();
  for (const Corners& t : corners) mean += (t[0] + t[1] + t[2]) / (3.0 * double(corners.size()));
  Mat3 spread = Mat3::Zero();
  for (const Corners& t : corners)
    for (const Vec3& x : t) spread += (x - mean) * (x - mean).transpose();
  Mat3 axes = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  longest = axes.col(2);
  Vec3 lo = Vec3::Constant(kFar), hi = -lo;
  for (const Corners& t : corners)
    for (const Vec3& x : t) {
      lo = lo.cwiseMin(axes.transpose() * (x - mean));
      hi = hi.cwiseMax(axes.transpose() * (x - mean));
    }
  const double thick = 0.5 * (hi - lo).x(), middle = 0.5 * (hi + lo).x();
  Vec3 from = hi, to = lo;
  for (const Corners& t : corners)
    for (const Vec3& x : t) {
      const Vec3 at = axes.transpose() * (x - mean);
      const double z = at.x() - middle, reach = std::sqrt(std::max(0.0, thick * thick - z * z));
      for (int c = 1; c < 3; ++c) {
        from[c] = std::min(from[c], at[c] + reach);
        to[c] = std::max(to[c], at[c] - reach);
      }
    }
  from.x() = to.x() = middle;
  for (int c = 1; c < 3; ++c)
    if (to[c] < from[c]) from[c] = to[c] = 0.5 * (from[c] + to[c]);
  double radius2 = 0.0;
  for (const Corners& t : corners)
    for (const Vec3& x : t) {
      const Vec3 at = axes.transpose() * (x - mean);
      radius2 = std::max(radius2, (at - at.cwiseMax(from).cwiseMin(to)).squaredNorm());
    }
  node.corner = mean + axes * from;
  node.side = {axes.col(1) * (to.y() - from.y()), axes.col(2) * (to.z() - from.z())};
  node.radius = std::sqrt(radius2) * (1.0 + 1e-12) + 1e-13 * mean.norm();
  node.size = node.side[0].norm() + node.side[1].norm() + 2.0 * node.radius;
}

double RssTwin::worst_overhang_mm() const {
  double worst = -kFar;
  for (const Node& node : nodes_) {
    const Polygon<4> rectangle({node.corner, node.corner + node.side[0],
                                node.corner + node.side[0] + node.side[1],
                                node.corner + node.side[1]});
    for (std::size_t i = node.begin; i < node.end; ++i)
      for (const Vec3& x : triangles_[i])
        worst = std::max(
            worst, std::sqrt(polygon_distance2(rectangle, Polygon<3>({x, x, x}))) - node.radius);
  }
  return worst;
}

struct RssTwin::Search {
  const RssTwin &a, &b;
  Mat3 R;
  Vec3 p;
  double best = kFar;

  Polygon<4> rectangle(const Node& n, bool of_a) const {
    const Vec3 x = of_a ? moved(R, p, n.corner) : n.corner;
    const Vec3 u = of_a ? Vec3(R * n.side[0]) : n.side[0];
    const Vec3 v = of_a ? Vec3(R * n.side[1]) : n.side[1];
    return Polygon<4>({x, x + u, x + u + v, x + v});
  }

  double bound(int i, int j) const {
    const Node &x = a.nodes_[i], &y = b.nodes_[j];
    return std::sqrt(polygon_distance2(rectangle(x, true), rectangle(y, false))) - x.radius -
           y.radius;
  }

  void run(int i, int j) {
    const Node &x = a.nodes_[i], &y = b.nodes_[j];
    if (x.left < 0 && y.left < 0) {
      const Corners& t = a.triangles_[x.begin];
      const Polygon<3> moving({moved(R, p, t[0]), moved(R, p, t[1]), moved(R, p, t[2])});
      best =
          std::min(best, std::sqrt(polygon_distance2(moving, Polygon<3>(b.triangles_[y.begin]))));
      return;
    }
    const bool open_a = y.left < 0 || (x.left >= 0 && x.size > y.size);
    struct Child {
      int i, j;
      double bound;
    };
    Child near{open_a ? x.left : i, open_a ? j : y.left, 0.0};
    Child far{open_a ? x.right : i, open_a ? j : y.right, 0.0};
    near.bound = bound(near.i, near.j);
    far.bound = bound(far.i, far.j);
    if (far.bound < near.bound) std::swap(near, far);
    for (const Child& child : {near, far})
      if (child.bound < best) run(child.i, child.j);
  }
};

double RssTwin::distance_mm(const Pose& X_WA, const RssTwin& b, const Pose& X_WB) const {
  const Pose X_BA = X_WB.inverse() * X_WA;
  Search search{*this, b, X_BA.rotation(), X_BA.p};
  search.run(0, 0);
  return search.best;
}

}  // namespace mortise::bench
