#include "common/geometry/bvh/bvh_orient.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/base/constants.h"
#include "common/geometry/bvh/bvh_threads.h"

namespace mortise::bvh {
namespace {

// Larger sets are seldom flat; their boxes stay in the axes of the part.
constexpr std::uint32_t kMostTriangles = 512;
// Axes of their own must save so much of the surface of the boxes: turning costs something.
constexpr double kWorthTurning = 0.8;
// Length of the sum of the normals of a patch, to its area.
constexpr double kLeastFlat = 0.3;
// The axes are a rotation to a few ulp; the boxes grow by more than that is worth.
constexpr double kAxesRounding = 1e-14;

struct Span {
  std::uint32_t begin = 0, end = 0;
};

float rounded_up(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

Vec3 corner(const Bvh& bvh, std::uint32_t i, int k) {
  const auto& c = bvh.corners[i];
  return Vec3(c[3 * k], c[3 * k + 1], c[3 * k + 2]);
}

Span span_of(const Bvh& bvh, std::int32_t child, const std::vector<Span>& spans) {
  if (child >= 0) return spans[child];
  const Bvh::Leaf& leaf = bvh.leaves[~child];
  return {leaf.first, leaf.first + leaf.count};
}

// Children come after their parents.
std::vector<Span> spans_of_nodes(const Bvh& bvh) {
  std::vector<Span> spans(bvh.nodes.size());
  for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
    const Bvh::Node& node = bvh.nodes[i];
    Span span = span_of(bvh, node.child[0], spans);
    for (int k = 1; k < node.count; ++k) {
      const Span child = span_of(bvh, node.child[k], spans);
      span = {std::min(span.begin, child.begin), std::max(span.end, child.end)};
    }
    spans[i] = span;
  }
  return spans;
}

struct Patch {
  Vec3 normal = Vec3::Zero();
  Vec3 along[2] = {Vec3::Zero(), Vec3::Zero()};  // the longest edge, and the longest middle edge
};

// False where the normals cancel: the set is no patch.
bool patch_of(const Bvh& bvh, Span span, Patch& patch) {
  double area = 0.0;
  for (std::uint32_t i = span.begin; i < span.end; ++i) {
    const Vec3 p = corner(bvh, i, 0), q = corner(bvh, i, 1), r = corner(bvh, i, 2);
    const Vec3 n = (q - p).cross(r - p);
    patch.normal += n;
    area += n.norm();
    // Of a halved rectangle the longest edge is the diagonal, the middle one a side.
    Vec3 edges[3] = {q - p, r - q, p - r};
    std::sort(edges, edges + 3,
              [](const Vec3& x, const Vec3& y) { return x.squaredNorm() > y.squaredNorm(); });
    for (int k = 0; k < 2; ++k)
      if (edges[k].squaredNorm() > patch.along[k].squaredNorm()) patch.along[k] = edges[k];
  }
  const double length = patch.normal.norm();
  if (!(length > kLeastFlat * area)) return false;
  patch.normal /= length;
  return true;
}

bool axes_along(const Vec3& normal, const Vec3& along, Mat3& axes) {
  Vec3 x = along - along.dot(normal) * normal;
  x -= x.dot(normal) * normal;  // once more: the first difference may have cancelled
  // Within 1e-3 rad of the normal nothing is left to go by but rounding.
  if (!(x.squaredNorm() > 1e-6 * along.squaredNorm())) return false;
  axes.row(0) = x.normalized();
  axes.row(2) = normal;
  axes.row(1) = normal.cross(Vec3(axes.row(0))).normalized();
  return true;
}

Box box_in(const Bvh& bvh, Span span, const Mat3& axes, const Vec3& origin) {
  Box box;
  for (std::uint32_t i = span.begin; i < span.end; ++i)
    for (int k = 0; k < 3; ++k) box.add(axes * (corner(bvh, i, k) - origin));
  return box;
}

double surface(const Box& box) {
  const Vec3 d = box.hi - box.lo;
  return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
}

void set_boxes(Bvh::Oriented& out, const Box* boxes, int count, double slack) {
  double radius2 = 0.0;
  for (int k = 0; k < Bvh::kWidth; ++k) {
    const Box& box = boxes[k < count ? k : 0];
    Vec3 far;
    for (int c = 0; c < 3; ++c) {
      const float middle = static_cast<float>(0.5 * (box.lo[c] + box.hi[c]));
      const double m = middle;
      out.center[c][k] = middle;
      out.half[c][k] = rounded_up(std::max(box.hi[c] - m, m - box.lo[c]) + slack);
      far[c] = std::fabs(m) + static_cast<double>(out.half[c][k]);
    }
    radius2 = std::max(radius2, far.squaredNorm());
  }
  out.radius_mm = std::sqrt(radius2) * (1.0 + 1e-12);
}

// True where axes of their own are worth having.
bool orient_node(const Bvh& bvh, std::size_t index, const std::vector<Span>& spans,
                 Bvh::Oriented& out) {
  const Bvh::Node& node = bvh.nodes[index];
  const Span span = spans[index];
  if (span.end - span.begin > kMostTriangles) return false;
  Patch patch;
  if (!patch_of(bvh, span, patch)) return false;
  const Vec3 middle = corner(bvh, span.begin, 0);
  const double slack =
      kRoundingFactor * kUnitRoundoff * bvh.extent_mm + kAxesRounding * bvh.radius_mm;
  bool found = false;
  double best = 0.0;
  for (int k = 0; k < node.count; ++k) best += kWorthTurning * surface(bvh.child_box(node, k));
  for (const Vec3& along : patch.along) {
    Mat3 axes;
    if (!axes_along(patch.normal, along, axes)) continue;
    Box boxes[Bvh::kWidth];
    double cost = 0.0;
    for (int k = 0; k < node.count; ++k) {
      boxes[k] = box_in(bvh, span_of(bvh, node.child[k], spans), axes, middle);
      cost += surface(boxes[k]);
    }
    if (cost >= best) continue;
    best = cost;
    found = true;
    out.axes = axes;
    out.from_origin = middle - bvh.origin;
    set_boxes(out, boxes, node.count, slack);
  }
  return found;
}

}  // namespace

void orient(Bvh& bvh, int threads) {
  const std::vector<Span> spans = spans_of_nodes(bvh);
  constexpr std::size_t kBlock = 64;  // nodes: a job of a thread worth handing out
  const std::size_t blocks = (bvh.nodes.size() + kBlock - 1) / kBlock;
  std::vector<std::vector<Bvh::Oriented>> found(blocks);
  for_each(blocks, threads, [&](std::size_t block) {
    Bvh::Oriented oriented;
    for (std::size_t i = block * kBlock; i < std::min(bvh.nodes.size(), (block + 1) * kBlock);
         ++i) {
      if (!orient_node(bvh, i, spans, oriented)) continue;
      bvh.nodes[i].oriented = static_cast<std::int32_t>(found[block].size());
      found[block].push_back(oriented);
    }
  });
  std::size_t count = 0;
  for (const auto& of_block : found) count += of_block.size();
  bvh.oriented.reserve(count);
  for (std::size_t block = 0; block < blocks; ++block) {
    const auto before = static_cast<std::int32_t>(bvh.oriented.size());
    for (std::size_t i = block * kBlock; i < std::min(bvh.nodes.size(), (block + 1) * kBlock); ++i)
      if (bvh.nodes[i].oriented >= 0) bvh.nodes[i].oriented += before;
    bvh.oriented.insert(bvh.oriented.end(), found[block].begin(), found[block].end());
  }
}

}  // namespace mortise::bvh
