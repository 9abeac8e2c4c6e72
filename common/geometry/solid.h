#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/geometry/bvh/bvh.h"
#include "common/geometry/cracks.h"
#include "common/geometry/mesh.h"
#include "common/geometry/outline.h"
#include "common/geometry/shells.h"
#include "common/geometry/topology.h"

namespace mortise {

/// One distinct mesh with all that is derived from it; immutable, shared by every instance. Tree
/// and topology are built when first asked for (thread safe), so that a scene in which nothing
/// moves builds none.
class Solid {
 public:
  /// The mesh must be valid(). One without triangles may be stored but not queried.
  explicit Solid(TriangleMesh mesh);
  Solid(const Solid&) = delete;
  Solid& operator=(const Solid&) = delete;

  const TriangleMesh& mesh() const { return mesh_; }
  const std::string& hash() const { return hash_; }
  const BoundingSphere& sphere() const { return sphere_; }
  const Box& bounds() const { return bounds_; }
  const Bvh& bvh() const;
  const Topology& topology() const;
  /// The lowest triangle of each connected shell, ascending.
  const std::vector<std::uint32_t>& shells() const;
  /// What its convex hull shows.
  const Outline& outline() const;
  /// Where an open mesh is open; nothing for a balanced one.
  const Cracks& cracks() const;
  /// Closed, or open at small cracks only; beside those what is inside is not known. Without an
  /// inside crossing can be found, but no depth.
  bool has_inside() const;
  /// Has an inside, and no crack.
  bool inside_known() const;
  /// Bytes of tree, topology and other derived data built so far, beyond the mesh itself.
  std::size_t derived_bytes() const;

 private:
  TriangleMesh mesh_;
  std::string hash_;
  BoundingSphere sphere_;
  Box bounds_;
  mutable std::once_flag bvh_once_, topology_once_, shells_once_, cracks_once_, outline_once_;
  mutable std::unique_ptr<const Bvh> bvh_;
  mutable std::unique_ptr<const Topology> topology_;
  mutable std::vector<std::uint32_t> shells_;
  mutable Cracks cracks_;
  mutable Outline outline_;
  mutable bool only_cracks_ = false;
  mutable std::atomic<std::size_t> derived_bytes_{0};
};

using SolidPtr = std::shared_ptr<const Solid>;

}  // namespace mortise
