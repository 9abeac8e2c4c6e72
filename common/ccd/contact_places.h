#pragma once
#include <cstdint>
#include <vector>

#include "common/ccd/first_contact.h"

namespace mortise {

/// Where two parts touch or nearly touch.
struct ContactPlace {
  Vec3 point_W = Vec3::Zero();
  Vec3 normal_W = Vec3::UnitZ();  ///< from B to A
  double gap_mm = 0.0;            ///< along the normal; negative: so deep
};

struct ContactPlaces {
  std::vector<ContactPlace> places;
  bool all = true;  ///< false: more pairs are near than were looked at
};

struct ContactPlacesQuery {
  const Solid* a = nullptr;
  const Solid* b = nullptr;
  Pose X_WA, X_WB;
  double reach_mm = 0.0;            ///< farther places do not count
  std::uint32_t most_pairs = 4096;  ///< triangle pairs looked at; the rest is left out
  bool all_or_none = false;         ///< no places where there are more
};

/// The places at which parts that do not overlap by more than reach_mm are within reach_mm of each
/// other: of every such pair of triangles the corners of the patch in which they face each other
/// along the normal that parts them best (triangle_separation_outside). A pair of which one
/// triangle stands upright on the other is left out, its neighbours show the contact: that spares
/// the false normals at edges between coplanar triangles. Of one direction only the outermost
/// places are kept, up to eight. Order and bits depend on the meshes and poses alone.
ContactPlaces contact_places(const ContactPlacesQuery& query, CcdScratch& scratch);

}  // namespace mortise
