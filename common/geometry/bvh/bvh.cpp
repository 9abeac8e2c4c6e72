#include "common/geometry/bvh/bvh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <thread>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "common/geometry/bvh/bvh_orient.h"
#include "common/geometry/bvh/bvh_split.h"
#include "common/geometry/bvh/bvh_threads.h"

namespace mortise {
namespace {

using bvh::BoxedTriangle;
using bvh::for_each;
using bvh::Range;

// From this depth on sets are halved, whatever their boxes: see Bvh::kMostLevels.
constexpr int kDeepestByArea = 32;

// A set of this size is built by one thread. The same at any number of threads: it decides the
// order of the nodes.
constexpr std::uint32_t kPiece = 8192;

// Below this a thread costs more than it saves.
constexpr std::size_t kWorthThreads = 50'000;

float next_up(float f) {
  if (f == 0.0F) return std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(f);
  return std::bit_cast<float>(f > 0.0F ? bits + 1 : bits - 1);
}
float rounded_up(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) < x ? next_up(f) : f;
}
float rounded_down(double x) { return -rounded_up(-x); }

class Builder {
 public:
  Builder(const TriangleMesh& mesh, Bvh& bvh, int threads)
      : mesh_(mesh), bvh_(bvh), threads_(threads), triangles_(mesh.triangles.size()) {
    measure();
    rounding_ = kRoundingFactor * kUnitRoundoff * bvh.extent_mm;
    each_block([&](std::size_t t) {
      Box box;
      for (int k = 0; k < 3; ++k) box.add(mesh.corner(static_cast<std::uint32_t>(t), k));
      BoxedTriangle& boxed = triangles_[t];
      for (int c = 0; c < 3; ++c) {
        boxed.lo[c] = rounded_down(box.lo[c] - bvh.origin[c]);
        boxed.hi[c] = rounded_up(box.hi[c] - bvh.origin[c]);
      }
      boxed.id = static_cast<std::uint32_t>(t);
      boxed.unused = 0;
    });
  }

  // 1. large sets are opened level by level, all sets of a level at once;
  // 2. what is left is built piece by piece, each into its own arrays;
  // 3. the pieces are put behind the upper nodes, in their order.
  void build() {
    const auto n = static_cast<std::uint32_t>(triangles_.size());
    std::vector<Piece> pieces(1);
    pieces[0].range = {0, n, bvh::box_of(triangles_.data(), n)};
    while (std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.large(); }))
      pieces = open_large(pieces);
    for_each(pieces.size(), threads_, [&](std::size_t i) {
      Piece& p = pieces[i];
      p.root = subtree(p.range, p.depth, p.nodes, p.leaves);
    });
    gather(pieces);
    bvh_.triangle_order.resize(n);
    bvh_.corners.resize(n);
    each_block([&](std::size_t i) {
      bvh_.triangle_order[i] = triangles_[i].id;
      for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c)
          bvh_.corners[i][3 * k + c] = mesh_.corner(triangles_[i].id, k)[c];
    });
  }

 private:
  struct Piece {
    Range range;
    std::int32_t parent = -1;  // among the upper nodes
    int slot = 0, depth = 0;
    std::int32_t root = 0;
    std::vector<Bvh::Node> nodes;
    std::vector<Bvh::Leaf> leaves;
    bool large() const { return range.size() > kPiece; }
  };

  struct Opened {
    int count = 1;
    Range part[Bvh::kWidth];
  };

  template <class Body>
  void each_block(const Body& body) {
    constexpr std::size_t kBlock = 4096;  // triangles: a job of a thread worth handing out
    const std::size_t n = triangles_.size();
    for_each((n + kBlock - 1) / kBlock, threads_, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) body(i);
    });
  }

  void measure() {
    const auto n = static_cast<std::uint32_t>(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < n; ++t)
      for (int k = 0; k < 3; ++k) {
        const Vec3& x = mesh_.corner(t, k);
        MORTISE_CHECK(std::isfinite(x.x()) && std::isfinite(x.y()) && std::isfinite(x.z()),
                      "a tree needs finite coordinates");
        bvh_.bounds.add(x);
      }
    bvh_.origin = bvh_.bounds.center();
    double radius2 = 0.0, extent2 = 0.0;
    for (std::uint32_t t = 0; t < n; ++t)
      for (int k = 0; k < 3; ++k) {
        radius2 = std::max(radius2, (mesh_.corner(t, k) - bvh_.origin).squaredNorm());
        extent2 = std::max(extent2, mesh_.corner(t, k).squaredNorm());
      }
    bvh_.radius_mm = std::sqrt(radius2);
    bvh_.extent_mm = std::sqrt(extent2);
  }

  // The largest part is split until there are eight, or only leaves.
  Opened opened(const Range& range, int depth) {
    Opened out;
    out.part[0] = range;
    while (out.count < Bvh::kWidth) {
      int largest = -1;
      for (int k = 0; k < out.count; ++k)
        if (out.part[k].size() > Bvh::kLeafSize &&
            (largest < 0 || out.part[k].size() > out.part[largest].size()))
          largest = k;
      if (largest < 0) break;
      const Range whole = out.part[largest];
      bvh::split(triangles_.data(), whole, depth >= kDeepestByArea, out.part[largest],
                 out.part[out.count++]);
    }
    return out;
  }

  Bvh::Node node_of(const Range& range, const Opened& children) const {
    Bvh::Node node{};
    node.count = children.count;
    for (int k = 0; k < Bvh::kWidth; ++k) {
      const bvh::FloatBox& box = children.part[k < children.count ? k : 0].box;
      for (int c = 0; c < 3; ++c) {
        const float middle = 0.5F * box.lo[c] + 0.5F * box.hi[c];
        node.local_center[c][k] = middle;
        const double m = middle;
        node.half[c][k] = rounded_up(std::max(box.hi[c] - m, m - box.lo[c]) + rounding_);
      }
    }
    const auto size = range.box.hi - range.box.lo;
    node.size = 0.5F * (size[0] + size[1] + size[2]);
    return node;
  }

  std::vector<Piece> open_large(std::vector<Piece>& pieces) {
    std::vector<Opened> children(pieces.size());
    for_each(pieces.size(), threads_, [&](std::size_t i) {
      if (pieces[i].large()) children[i] = opened(pieces[i].range, pieces[i].depth);
    });
    std::vector<Piece> next;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (!pieces[i].large()) {
        next.push_back(std::move(pieces[i]));
        continue;
      }
      const auto me = static_cast<std::int32_t>(bvh_.nodes.size());
      bvh_.nodes.push_back(node_of(pieces[i].range, children[i]));
      set_child(pieces[i], me);
      for (int k = 0; k < children[i].count; ++k) {
        Piece child;
        child.range = children[i].part[k];
        child.parent = me;
        child.slot = k;
        child.depth = pieces[i].depth + 1;
        next.push_back(std::move(child));
      }
    }
    return next;
  }

  void set_child(const Piece& piece, std::int32_t root) {
    if (piece.parent < 0) {
      bvh_.root = root;
      return;
    }
    Bvh::Node& parent = bvh_.nodes[piece.parent];
    parent.child[piece.slot] = root;
    if (piece.slot == 0)  // unused lanes repeat it
      for (int k = parent.count; k < Bvh::kWidth; ++k) parent.child[k] = root;
  }

  void gather(std::vector<Piece>& pieces) {
    std::size_t nodes = bvh_.nodes.size(), leaves = 0;
    for (const Piece& p : pieces) {
      nodes += p.nodes.size();
      leaves += p.leaves.size();
    }
    bvh_.nodes.reserve(nodes);
    bvh_.leaves.reserve(leaves);
    for (Piece& p : pieces) {
      const auto node_0 = static_cast<std::int32_t>(bvh_.nodes.size());
      const auto leaf_0 = static_cast<std::int32_t>(bvh_.leaves.size());
      const auto moved = [&](std::int32_t child) {
        return child >= 0 ? child + node_0 : ~(~child + leaf_0);
      };
      for (Bvh::Node& node : p.nodes)
        for (std::int32_t& child : node.child) child = moved(child);
      set_child(p, moved(p.root));
      bvh_.nodes.insert(bvh_.nodes.end(), p.nodes.begin(), p.nodes.end());
      bvh_.leaves.insert(bvh_.leaves.end(), p.leaves.begin(), p.leaves.end());
      p.nodes = {};
      p.leaves = {};
    }
  }

  std::int32_t leaf(const Range& range, std::vector<Bvh::Leaf>& leaves) {
    std::sort(triangles_.begin() + range.begin, triangles_.begin() + range.end,
              [](const BoxedTriangle& x, const BoxedTriangle& y) { return x.id < y.id; });
    leaves.push_back({range.begin, range.size()});
    return ~static_cast<std::int32_t>(leaves.size() - 1);
  }

  std::int32_t subtree(const Range& range, int depth, std::vector<Bvh::Node>& nodes,
                       std::vector<Bvh::Leaf>& leaves) {
    if (range.size() <= Bvh::kLeafSize) return leaf(range, leaves);
    MORTISE_CHECK(depth < Bvh::kMostLevels, "a tree is no deeper than those who walk it expect");
    const Opened children = opened(range, depth);
    const auto me = static_cast<std::int32_t>(nodes.size());
    nodes.push_back(node_of(range, children));
    for (int k = 0; k < Bvh::kWidth; ++k) {
      const std::int32_t child = k < children.count
                                     ? subtree(children.part[k], depth + 1, nodes, leaves)
                                     : nodes[me].child[0];
      nodes[me].child[k] = child;
    }
    return me;
  }

  const TriangleMesh& mesh_;
  Bvh& bvh_;
  int threads_;
  std::vector<BoxedTriangle> triangles_;
  double rounding_ = 0.0;
};

template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

Box Bvh::child_box(const Node& node, int k) const {
  Box box;
  for (int c = 0; c < 3; ++c) {
    const double middle = origin[c] + static_cast<double>(node.local_center[c][k]);
    box.lo[c] = middle - static_cast<double>(node.half[c][k]);
    box.hi[c] = middle + static_cast<double>(node.half[c][k]);
  }
  return box;
}

std::size_t Bvh::bytes() const {
  return bytes_of(nodes) + bytes_of(oriented) + bytes_of(leaves) + bytes_of(triangle_order) +
         bytes_of(corners);
}

Bvh build_bvh(const TriangleMesh& mesh, int threads) {
  MORTISE_CHECK(!mesh.triangles.empty(), "a tree needs at least one triangle");
  MORTISE_CHECK(valid(mesh), "a tree needs finite coordinates and indices that name points");
  if (threads <= 0)
    threads = mesh.triangles.size() < kWorthThreads
                  ? 1
                  : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  Bvh bvh;
  Builder(mesh, bvh, threads).build();
  bvh::orient(bvh, threads);
  return bvh;
}

}  // namespace mortise
