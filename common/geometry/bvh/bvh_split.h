#pragma once
#include <cstdint>
#include <limits>

#include "common/geometry/bvh/bvh.h"

// Where a set of triangles is cut in two: binned surface area heuristic. Used by bvh.cpp alone.
namespace mortise::bvh {

/// Box of a triangle relative to the origin of the tree, single precision, rounded outward.
struct alignas(16) BoxedTriangle {
  float lo[3];
  std::uint32_t id;
  float hi[3];
  std::uint32_t unused;  ///< zero: the lane goes through float arithmetic
};

/// Four floats, x y z and a lane of zero (GCC vector extension).
typedef float Quad __attribute__((vector_size(16)));

struct FloatBox {
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Quad lo = {kInfinity, kInfinity, kInfinity, 0.0F};
  Quad hi = {-kInfinity, -kInfinity, -kInfinity, 0.0F};
};

struct Range {
  std::uint32_t begin = 0, end = 0;
  FloatBox box;  ///< of the triangles
  std::uint32_t size() const { return end - begin; }
};

FloatBox box_of(const BoxedTriangle* triangles, std::uint32_t count);

/// Cuts `range` (of the array `triangles`, at least two of them) into two parts that are not empty,
/// and orders the array accordingly. The cut depends on coordinates and ids only, never on the
/// order of the array, so that trees are the same on every build. `balanced`: cuts in the middle
/// whatever the boxes, which bounds the depth.
void split(BoxedTriangle* triangles, const Range& range, bool balanced, Range& left, Range& right);

}  // namespace mortise::bvh
