#include "common/geometry/bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"
#include "common/base/constants.h"

namespace mortise {
namespace {

constexpr int kBins = 16;  // of the surface area heuristic; more gain nothing measurable

double half_area(const Box& box) {
  if (box.empty()) return 0.0;
  const Vec3 d = box.hi - box.lo;
  return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
}

float rounded_up(double x) {
  const float f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

// The set of triangles on either side of a split depends on coordinates and ids only, never on the
// order that a library's partition leaves behind: trees are the same on every build.
class Builder {
 public:
  Builder(const TriangleMesh& mesh, Bvh& bvh) : mesh_(mesh), bvh_(bvh) {
    const std::size_t n = mesh.triangles.size();
    order_.resize(n);
    boxes_.resize(n);
    for (std::uint32_t t = 0; t < n; ++t) {
      order_[t] = t;
      for (int k = 0; k < 3; ++k) boxes_[t].add(mesh.corner(t, k));
      bvh.bounds.add(boxes_[t]);
    }
    bvh.origin = bvh.bounds.center();
    for (std::uint32_t t = 0; t < n; ++t)
      for (int k = 0; k < 3; ++k) {
        bvh.radius_mm = std::max(bvh.radius_mm, (mesh.corner(t, k) - bvh.origin).norm());
        bvh.extent_mm = std::max(bvh.extent_mm, mesh.corner(t, k).norm());
      }
    rounding_ = kRoundingFactor * kUnitRoundoff * bvh.extent_mm;
  }

  void build() {
    bvh_.nodes.reserve(order_.size() / 8 + 1);
    bvh_.leaves.reserve(order_.size() / 2 + 1);
    bvh_.root = subtree({0, static_cast<std::uint32_t>(order_.size())});
    bvh_.triangle_order = order_;
    bvh_.corners.resize(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i)
      for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) bvh_.corners[i][3 * k + c] = mesh_.corner(order_[i], k)[c];
    bvh_.nodes.shrink_to_fit();
    bvh_.leaves.shrink_to_fit();
  }

 private:
  struct Range {
    std::uint32_t begin, end;
    std::uint32_t size() const { return end - begin; }
  };

  Vec3 center(std::uint32_t t) const { return boxes_[t].center(); }

  Box box_of(Range range) const {
    Box box;
    for (std::uint32_t i = range.begin; i < range.end; ++i) box.add(boxes_[order_[i]]);
    return box;
  }

  std::uint32_t split(Range range) {
    Box centers;
    for (std::uint32_t i = range.begin; i < range.end; ++i) centers.add(center(order_[i]));
    const Vec3 width = centers.hi - centers.lo;
    const auto bin_of = [&](std::uint32_t t, int axis) {
      const double x = (center(t)[axis] - centers.lo[axis]) / width[axis] * kBins;
      return std::clamp(static_cast<int>(x), 0, kBins - 1);
    };
    int best_axis = -1, best_bin = 0;
    double best_cost = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (!(width[axis] > 0.0)) continue;
      Box bin_box[kBins];
      std::uint32_t bin_count[kBins] = {};
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        const int k = bin_of(order_[i], axis);
        bin_box[k].add(boxes_[order_[i]]);
        ++bin_count[k];
      }
      double right_cost[kBins] = {};
      Box box;
      std::uint32_t count = 0;
      for (int k = kBins - 1; k > 0; --k) {
        box.add(bin_box[k]);
        count += bin_count[k];
        right_cost[k] = count * half_area(box);
      }
      box = Box{};
      count = 0;
      for (int k = 1; k < kBins; ++k) {
        box.add(bin_box[k - 1]);
        count += bin_count[k - 1];
        if (count == 0 || count == range.size()) continue;
        const double cost = count * half_area(box) + right_cost[k];
        if (cost < best_cost) {
          best_cost = cost;
          best_axis = axis;
          best_bin = k;
        }
      }
    }
    const auto begin = order_.begin() + range.begin, end = order_.begin() + range.end;
    if (best_axis >= 0) {
      const auto middle = std::partition(
          begin, end, [&](std::uint32_t t) { return bin_of(t, best_axis) < best_bin; });
      const auto index = static_cast<std::uint32_t>(middle - order_.begin());
      if (index > range.begin && index < range.end) return index;
    }
    // All centres in one place: halve by id.
    std::sort(begin, end);
    return range.begin + range.size() / 2;
  }

  std::int32_t leaf(Range range) {
    std::sort(order_.begin() + range.begin, order_.begin() + range.end);
    bvh_.leaves.push_back({range.begin, range.size()});
    return ~static_cast<std::int32_t>(bvh_.leaves.size() - 1);
  }

  std::int32_t subtree(Range range) {
    if (range.size() <= Bvh::kLeafSize) return leaf(range);
    Range parts[Bvh::kWidth] = {range};
    int count = 1;
    while (count < Bvh::kWidth) {
      int largest = -1;
      for (int k = 0; k < count; ++k)
        if (parts[k].size() > Bvh::kLeafSize &&
            (largest < 0 || parts[k].size() > parts[largest].size()))
          largest = k;
      if (largest < 0) break;
      const std::uint32_t middle = split(parts[largest]);
      parts[count++] = {middle, parts[largest].end};
      parts[largest].end = middle;
    }
    const auto me = static_cast<std::int32_t>(bvh_.nodes.size());
    bvh_.nodes.emplace_back();
    Bvh::Node node{};
    node.count = count;
    Box whole;
    for (int k = 0; k < Bvh::kWidth; ++k) {
      const int source = k < count ? k : 0;
      const Box box = box_of(parts[source]);
      if (k < count) whole.add(box);
      for (int c = 0; c < 3; ++c) {
        const double lo = box.lo[c] - bvh_.origin[c], hi = box.hi[c] - bvh_.origin[c];
        const float middle = static_cast<float>(0.5 * (lo + hi));
        node.local_center[c][k] = middle;
        node.half[c][k] = rounded_up(std::max(hi - middle, middle - lo) + rounding_);
      }
    }
    for (int k = 0; k < Bvh::kWidth; ++k)
      node.child[k] = k < count ? subtree(parts[k]) : node.child[0];
    node.size = static_cast<float>(whole.half().sum());
    bvh_.nodes[me] = node;
    return me;
  }

  const TriangleMesh& mesh_;
  Bvh& bvh_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> boxes_;
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
  return bytes_of(nodes) + bytes_of(leaves) + bytes_of(triangle_order) + bytes_of(corners);
}

Bvh build_bvh(const TriangleMesh& mesh) {
  MORTISE_CHECK(!mesh.triangles.empty(), "a tree needs at least one triangle");
  Bvh bvh;
  Builder(mesh, bvh).build();
  return bvh;
}

}  // namespace mortise
