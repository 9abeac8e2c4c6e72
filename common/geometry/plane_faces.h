#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"
#include "common/math/interval.h"

namespace mortise {

/// A plane face of a part: {x : n · x = c}, material where n · x < c, and where the real face may
/// lie, outward of it. Part frame, mm.
struct PlaneFace {
  Vec3 n = Vec3::UnitZ();
  double c = 0.0;
  Interval offset_mm;
  std::uint32_t triangle = 0;  ///< its largest facet
};

/// How far what faces have in common moves when each is offset by its own band, in the worst layer,
/// and when all are offset by 1 mm. Infinity: faces that are nearly parallel have different
/// offsets.
struct Travel {
  double by_band_mm = 0.0;
  double per_mm = 1.0;
  double outward_mm = 0.0;  ///< how far from the mesh the largest body comes there
  double by_mm(double depth_mm) const { return by_band_mm + depth_mm * per_mm; }
  void take(const Travel& other) {
    by_band_mm = std::max(by_band_mm, other.by_band_mm);
    per_mm = std::max(per_mm, other.per_mm);
    outward_mm = std::max(outward_mm, other.outward_mm);
  }
};

/// The plane faces of a part: coplanar facets that touch and have the same band are one.
struct PlaneFaces {
  static constexpr std::uint32_t kNone = 0xffffffffU;       ///< round, or its band is a mesh error
  static constexpr std::uint32_t kWithoutArea = kNone - 1;  ///< a facet that bounds nothing

  std::vector<PlaneFace> faces;
  std::vector<std::uint32_t> face_of_triangle;
  std::vector<Travel> travel_of;  ///< by point of the mesh: of the corner there and its edges
  Travel most_travel;             ///< of all corners; of each at most kMostTravel times its faces
  double noise_mm = 0.0;          ///< corners lie within this of the planes of their facets

  /// Corners that may travel more than kUsualTravel times as far as any face.
  std::vector<std::uint32_t> sharp_points;
  static constexpr double kUsualTravel = 2.0;  ///< an edge of 60 degrees: 1 / sin 30
  /// An edge or corner counts that travels at most so many times as far as the faces of it: an edge
  /// of 6 degrees. Nobody makes a tip beyond that.
  static constexpr double kMostTravel = 20.0;
};

/// Is the band of a face that of a plane: no surface of its own, and no error of a mesh but the
/// rounding of its file?
bool is_plane_band(const SurfaceBand& band, const SurfaceBand::Face& face);

/// O(n log n), once a part and band.
PlaneFaces find_plane_faces(const Solid& solid, const SurfaceBand& band);

/// Of the edge of two faces: for one offset o and the angle t between them o / sin(t/2).
Travel edge_travel(const PlaneFace& a, const PlaneFace& b);

}  // namespace mortise
