#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/mesh.h"

namespace mortise {

/// Flat tree with up to eight children a node. Boxes are single precision, rounded outward;
/// triangles stay double. Boxes may only discard; every number that leaves a query comes from the
/// double triangles. Built once per distinct mesh (binned SAH), shared by all instances.
struct Bvh {
  static constexpr int kWidth = 8;     ///< boxes tested at once: one AVX register of floats
  static constexpr int kLeafSize = 4;  ///< two leaves are sixteen pairs of triangles (ccd/kernels)
  /// No leaf is below more nodes than this: after 32 levels sets are halved, three times a level,
  /// which leaves eleven levels of 2^32 triangles.
  static constexpr int kMostLevels = 32 + 11;
  /// Children that wait at most while a tree is walked depth first: each level leaves all but one.
  static constexpr int kMostWaiting = kMostLevels * (kWidth - 1) + 1;

  struct alignas(32) Node {
    /// Box centres *relative to Bvh::origin* (axes of the part), mm; unused lanes repeat lane 0.
    /// Use child_box() for a box in the part frame.
    float local_center[3][kWidth];
    /// Half extents, rounded outward: the box contains its triangles exactly.
    float half[3][kWidth];
    std::int32_t child[kWidth];  ///< >= 0: node; < 0: ~leaf
    std::int32_t count = 0;      ///< used lanes
    std::int32_t oriented = -1;  ///< index in Bvh::oriented; -1: the axes of the part fit best
    float size = 0.0F;           ///< sum of the half extents of the node's own box
  };
  /// The boxes of the children of a node again, in axes that fit the patch of surface below it (its
  /// mean normal and its edges). A point x of the part (from Bvh::origin) is at
  /// axes (x - from_origin).
  struct alignas(32) Oriented {
    float center[3][kWidth];
    float half[3][kWidth];  ///< rounded outward
    Mat3 axes;              ///< by row
    Vec3 from_origin;
    double radius_mm = 0.0;  ///< no point of a box is farther from from_origin
  };
  struct Leaf {
    std::uint32_t first = 0;  ///< into triangle_order
    std::uint32_t count = 0;  ///< 1..kLeafSize
  };

  std::vector<Node> nodes;
  std::vector<Oriented> oriented;  ///< of the nodes that have one
  std::vector<Leaf> leaves;
  std::vector<std::uint32_t> triangle_order;  ///< triangle ids in leaf order
  std::vector<std::array<double, 9>>
      corners;             ///< corners of triangle_order[i], x y z of each corner
  Box bounds;              ///< part frame
  Vec3 origin;             ///< centre of `bounds`: keeps the boxes fine when a mesh lies far away
  double radius_mm = 0.0;  ///< no point is farther from `origin`
  double extent_mm = 0.0;  ///< no point is farther from the part's own origin: scale of rounding
  std::int32_t root = 0;   ///< >= 0 node, < 0 ~leaf

  /// Box of child k of a node, part frame; contains its triangles.
  Box child_box(const Node& node, int k) const;

  std::size_t bytes() const;
};

/// Deterministic: the same tree to the last bit at any number of threads. The mesh must have at
/// least one triangle and finite coordinates below 1e12 mm. O(n log n). threads 0: one for small
/// meshes, all of the machine for large ones.
Bvh build_bvh(const TriangleMesh& mesh, int threads = 0);

}  // namespace mortise
