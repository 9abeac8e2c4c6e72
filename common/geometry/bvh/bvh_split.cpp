#include "common/geometry/bvh/bvh_split.h"

#include <algorithm>
#include <cstring>

namespace mortise::bvh {
namespace {

// Of the heuristic; more gain nothing measurable. Small sets need fewer.
constexpr int kBins = 16;
constexpr int kFewBins = 8;
constexpr std::uint32_t kSmall = 32;

// Below this the reciprocal could overflow; such sets are halved.
constexpr float kLeastWidth = 1e-36F;

typedef int IntQuad __attribute__((vector_size(16)));

inline Quad smaller(Quad a, Quad b) { return a < b ? a : b; }
inline Quad larger(Quad a, Quad b) { return a > b ? a : b; }

inline Quad low(const BoxedTriangle& t) {
  IntQuad bits;
  std::memcpy(&bits, t.lo, sizeof bits);
  return (Quad)(bits & IntQuad{-1, -1, -1, 0});
}
inline Quad high(const BoxedTriangle& t) {
  Quad x;
  std::memcpy(&x, t.hi, sizeof x);
  return x;
}
// Twice the centre.
inline Quad middle(const BoxedTriangle& t) { return low(t) + high(t); }

inline void add(FloatBox& box, const FloatBox& other) {
  box.lo = smaller(box.lo, other.lo);
  box.hi = larger(box.hi, other.hi);
}

inline float half_area(const FloatBox& box) {
  const Quad d = box.hi - box.lo;
  return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

// Which bin a triangle falls into, on each axis. The axes along which all centres are one have
// scale 0.
struct Binning {
  Quad base, scale;
  int count;
  IntQuad of(const BoxedTriangle& t) const {
    const IntQuad k = __builtin_convertvector((middle(t) - base) * scale, IntQuad);
    const IntQuad last = IntQuad{} + (count - 1);
    return k < last ? k : last;
  }
};

struct Cut {
  int axis = -1, bin = 0;
  FloatBox left, right;
};

Cut best_cut(const BoxedTriangle* t, std::uint32_t n, const Binning& binning) {
  FloatBox box[3][kBins];
  std::uint32_t filled[3][kBins] = {};
  for (std::uint32_t i = 0; i < n; ++i) {
    const IntQuad k = binning.of(t[i]);
    const FloatBox own{low(t[i]), high(t[i])};
    for (int axis = 0; axis < 3; ++axis) {
      add(box[axis][k[axis]], own);
      ++filled[axis][k[axis]];
    }
  }
  Cut cut;
  float best = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(binning.scale[axis] > 0.0F)) continue;
    float right_cost[kBins];
    FloatBox right;
    std::uint32_t count = 0;
    for (int k = binning.count - 1; k > 0; --k) {
      add(right, box[axis][k]);
      count += filled[axis][k];
      right_cost[k] = count > 0 ? static_cast<float>(count) * half_area(right) : 0.0F;
    }
    FloatBox left;
    count = 0;
    for (int k = 1; k < binning.count; ++k) {
      add(left, box[axis][k - 1]);
      count += filled[axis][k - 1];
      if (count == 0 || count == n) continue;
      const float cost = static_cast<float>(count) * half_area(left) + right_cost[k];
      if (cost < best) {
        best = cost;
        cut.axis = axis;
        cut.bin = k;
        cut.left = left;
      }
    }
  }
  if (cut.axis >= 0)
    for (int k = cut.bin; k < binning.count; ++k) add(cut.right, box[cut.axis][k]);
  return cut;
}

void halve(BoxedTriangle* triangles, const Range& range, int axis, Range& left, Range& right) {
  BoxedTriangle* const begin = triangles + range.begin;
  BoxedTriangle* const end = triangles + range.end;
  BoxedTriangle* const half = begin + range.size() / 2;
  std::nth_element(begin, half, end, [axis](const BoxedTriangle& x, const BoxedTriangle& y) {
    const float mx = x.lo[axis] + x.hi[axis], my = y.lo[axis] + y.hi[axis];
    return mx != my ? mx < my : x.id < y.id;
  });
  const std::uint32_t at = range.begin + range.size() / 2;
  left = {range.begin, at, box_of(begin, range.size() / 2)};
  right = {at, range.end, box_of(half, range.end - at)};
}

}  // namespace

FloatBox box_of(const BoxedTriangle* triangles, std::uint32_t count) {
  FloatBox box;
  for (std::uint32_t i = 0; i < count; ++i) add(box, {low(triangles[i]), high(triangles[i])});
  return box;
}

void split(BoxedTriangle* triangles, const Range& range, bool balanced, Range& left, Range& right) {
  BoxedTriangle* const t = triangles + range.begin;
  const std::uint32_t n = range.size();
  FloatBox centres;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Quad m = middle(t[i]);
    add(centres, {m, m});
  }
  const Quad width = centres.hi - centres.lo;
  int widest = 0;
  for (int c = 1; c < 3; ++c)
    if (width[c] > width[widest]) widest = c;
  Binning binning{centres.lo, Quad{}, n < kSmall ? kFewBins : kBins};
  for (int c = 0; c < 3; ++c)
    if (width[c] > kLeastWidth) binning.scale[c] = static_cast<float>(binning.count) / width[c];
  const Cut cut = balanced ? Cut{} : best_cut(t, n, binning);
  if (cut.axis < 0) {
    halve(triangles, range, widest, left, right);
    return;
  }
  const BoxedTriangle* const middle_of = std::partition(
      t, t + n, [&](const BoxedTriangle& x) { return binning.of(x)[cut.axis] < cut.bin; });
  const auto at = range.begin + static_cast<std::uint32_t>(middle_of - t);
  left = {range.begin, at, cut.left};
  right = {at, range.end, cut.right};
}

}  // namespace mortise::bvh
