#pragma once
#include <algorithm>
#include <limits>

#include "common/base/constants.h"
#include "common/depth/body.h"
#include "common/depth/depth.h"

namespace mortise {

/// Two bodies at fixed poses. Role 0 looks at the surface of A from B, role 1 the other way round:
/// in role r the surface is that of bodies[r] (S) and the material that of bodies[1 - r] (K).
struct PairFrame {
  explicit PairFrame(const OverlapQuery& query)
      : bodies{Body(*query.a, *query.band_a), Body(*query.b, *query.band_b)},
        X_W{query.X_WA, query.X_WB} {
    X_KS[0] = query.X_WB.inverse() * query.X_WA;
    X_KS[1] = X_KS[0].inverse();
    rounding_mm = kRoundingFactor * kUnitRoundoff *
                  (query.a->bvh().extent_mm + query.b->bvh().extent_mm + X_KS[0].p.norm());
    // What first contact calls touching is touching here too.
    touch_mm = std::max(kAccuracyDefault_mm, rounding_mm);
    trivial = query.band_a->trivial && query.band_b->trivial;
    if (!trivial) near_mm = std::max(0.0, near_of(*query.band_a, *query.band_b));
  }

  const Body& s(int role) const { return bodies[role]; }
  const Body& k(int role) const { return bodies[1 - role]; }
  /// No point lies deeper in either part than half its least extent, and the offsets of the layer.
  double deepest_mm(Layer layer) const {
    double deepest = -std::numeric_limits<double>::infinity();
    for (const Body& body : bodies) {
      if (!body.has_inside) continue;
      const Box& box = body.solid->bounds();
      deepest = std::max(deepest, 0.5 * (box.hi - box.lo).minCoeff() +
                                      body.largest_offset_mm[static_cast<int>(layer)]);
    }
    return deepest;
  }
  /// No surface of the layer is farther from its mesh, both parts together. Where nothing is known
  /// but the meshes it is the same everywhere: the rounding of the files.
  double reach_mm(Layer layer) const {
    return bodies[0].largest_offset_mm[static_cast<int>(layer)] +
           bodies[1].largest_offset_mm[static_cast<int>(layer)];
  }
  bool has_insides() const { return bodies[0].has_inside && bodies[1].has_inside; }
  double smaller_radius_mm() const {
    return std::min(bodies[0].solid->sphere().radius_mm, bodies[1].solid->sphere().radius_mm);
  }
  /// Nobody asks how far edges reach of parts without an inside: they count as near by that alone.
  double near_of(const SurfaceBand& a, const SurfaceBand& b) const {
    return has_insides() ? a.largest_offset_mm + b.largest_offset_mm
                         : a.farthest_mm() + b.farthest_mm();
  }
  /// A point of frame K of a role in the world.
  Vec3 in_world(int role, const Vec3& x_K) const { return X_W[1 - role] * x_K; }

  Body bodies[2];
  Pose X_W[2];
  Pose X_KS[2];
  double rounding_mm = 0.0;
  double touch_mm = 0.0;
  double near_mm = 0.0;  ///< pairs of faces farther apart cannot interfere
  bool trivial = true;
};

}  // namespace mortise
