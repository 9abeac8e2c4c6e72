#include "common/geometry/solid.h"

#include <utility>

#include "common/base/check.h"

namespace mortise {

Solid::Solid(TriangleMesh mesh)
    : mesh_(std::move(mesh)),
      hash_(mesh_hash(mesh_)),
      sphere_(bounding_sphere(mesh_)),
      bounds_(bounds_of(mesh_)) {
  MORTISE_CHECK(valid(mesh_), "indices must name points, coordinates must be finite");
}

const Bvh& Solid::bvh() const {
  std::call_once(bvh_once_, [this] {
    bvh_ = std::make_unique<const Bvh>(build_bvh(mesh_));
    derived_bytes_ += bvh_->bytes();
  });
  return *bvh_;
}

const Topology& Solid::topology() const {
  std::call_once(topology_once_, [this] {
    topology_ = std::make_unique<const Topology>(build_topology(mesh_));
    derived_bytes_ += topology_->neighbor.capacity() * sizeof(topology_->neighbor[0]) +
                      topology_->edge_kind.capacity() * sizeof(topology_->edge_kind[0]) +
                      topology_->edge_sharp.capacity() * sizeof(topology_->edge_sharp[0]) +
                      topology_->normal.capacity() * sizeof(topology_->normal[0]);
  });
  return *topology_;
}

const std::vector<std::uint32_t>& Solid::shells() const {
  std::call_once(shells_once_, [this] {
    shells_ = first_triangle_of_each_shell(mesh_);
    derived_bytes_ += shells_.capacity() * sizeof(shells_[0]);
  });
  return shells_;
}

const Cracks& Solid::cracks() const {
  std::call_once(cracks_once_, [this] {
    if (topology().balanced()) return;
    cracks_ = find_cracks(mesh_);
    TriangleMesh whole = mesh_;
    for (const Lid& lid : cracks_.lids) {
      const auto first = static_cast<std::uint32_t>(whole.points_mm.size());
      whole.points_mm.insert(whole.points_mm.end(), lid.corners.begin(), lid.corners.end());
      whole.triangles.push_back({first, first + 1, first + 2});
    }
    only_cracks_ = small(cracks_, sphere_.radius_mm) && signed_volume_mm3(whole) > 0.0;
    derived_bytes_ += cracks_.lids.capacity() * sizeof(cracks_.lids[0]);
  });
  return cracks_;
}

const Outline& Solid::outline() const {
  std::call_once(outline_once_, [this] {
    outline_ = outline_of(mesh_, bvh(), topology());
    derived_bytes_ += (outline_.corners.capacity() + outline_.main_normals.capacity()) *
                      sizeof(outline_.corners[0]);
  });
  return outline_;
}

bool Solid::has_inside() const {
  if (topology().balanced()) return topology().closed();
  cracks();
  return only_cracks_;
}

bool Solid::inside_known() const { return has_inside() && cracks().count == 0; }

std::size_t Solid::derived_bytes() const { return derived_bytes_; }

}  // namespace mortise
