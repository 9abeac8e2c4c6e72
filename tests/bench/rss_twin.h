#pragma once
#include <array>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/math/pose.h"

namespace mortise::bench {

/// Distance of two meshes by rectangle swept spheres, after Larsen et al. 1999 (PQP): a binary
/// tree, one triangle a leaf, axes by principal components, the larger node opened first, the
/// nearer child first. It shares the mesh with the engine, and nothing else.
class RssTwin {
 public:
  explicit RssTwin(const TriangleMesh& mesh);

  /// 0 where the surfaces cross. Exact to rounding.
  double distance_mm(const Pose& X_WA, const RssTwin& b, const Pose& X_WB) const;

  /// The largest distance of a corner from the node that holds it, beyond its radius, mm: 0 or
  /// rounding where the tree is sound.
  double worst_overhang_mm() const;

  using Corners = std::array<Vec3, 3>;

 private:
  /// Points within `radius` of the rectangle corner + [0,1] side[0] + [0,1] side[1].
  struct Node {
    Vec3 corner = Vec3::Zero();
    std::array<Vec3, 2> side = {Vec3::Zero(), Vec3::Zero()};
    double radius = 0.0, size = 0.0;
    int left = -1, right = -1;       ///< -1: a leaf
    std::size_t begin = 0, end = 0;  ///< triangles
  };
  struct Search;

  int build(std::size_t begin, std::size_t end);
  void fit(Node& node, Vec3& longest) const;

  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace mortise::bench
