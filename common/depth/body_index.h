#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "common/depth/cells/cover.h"
#include "common/geometry/plane_faces.h"
#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"
#include "common/geometry/tips.h"
#include "common/math/interval.h"

namespace mortise {

/// A range of angles, rad: middle +- half. Of a torus about its axis they are counted from
/// axis.unitOrthogonal() towards axis x that, of the tube from the way off the axis towards the
/// axis.
struct FaceArc {
  double middle_rad = 0.0;
  double half_rad = std::numbers::pi;
  bool whole() const { return half_rad >= std::numbers::pi; }
};

/// Where a face with a surface ends along the axis of that surface, from its point, mm.
struct FaceEnds {
  Interval extent_mm;  ///< of its corners
  /// At the lower and the upper end: a whole circle of corners in one plane that ends the face, so
  /// that the true face goes no farther either. Of a torus: its border runs along and across the
  /// tube.
  bool level[2] = {false, false};
  /// Of a torus: which directions from its axis, and from its centre circle, the face has. Whole
  /// turns where it goes all around.
  FaceArc around_axis = {}, around_tube = {};
};

/// What depth derives from one part and its band, and reuses at every pose. Body fills it in when
/// it is first needed. It depends on the part and the band alone.
struct BodyIndex {
  struct Range {
    std::uint32_t first = Topology::kNone, count = 0;
    std::uint32_t left_out = 0;  ///< more neighbours that meet the triangle sharply, at most
  };
  std::vector<Range> sharp_range;                                    ///< by triangle, into `sharp`
  std::vector<std::uint32_t> sharp;                                  ///< see Body::sharp_neighbours
  std::vector<FaceEnds> ends;                                        ///< by face, see Body::ends_of
  std::vector<std::array<std::int32_t, Bvh::kWidth>> face_of_child;  ///< see Body::face_of_child
  std::unique_ptr<const PlaneFaces> plane_faces;                     ///< see Body::plane_faces
  std::unique_ptr<const std::vector<Tip>> tips;                      ///< see Body::tips
  std::unique_ptr<const Cover> cover;                                ///< see Body::cover
};

/// The index of a part with a band: one that this thread has made of an equal part and band, else a
/// new one. Costs one comparison of the band.
std::shared_ptr<BodyIndex> body_index(const Solid& solid, const SurfaceBand& band);

/// Gives the index that this thread has made of the part to the next thread that asks for an equal
/// one. Nobody may use it here any more.
void lay_out_index(const Solid& solid, const SurfaceBand& band);

}  // namespace mortise
