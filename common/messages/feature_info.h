#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/ids.h"
#include "common/math/interval.h"
#include "common/math/types.h"

namespace mortise {

/// Goes over the wire, so numbers never change.
enum class SurfaceKind : std::uint8_t {
  kUnknown = 0,
  kPlane = 1,
  kCylinder = 2,
  kCone = 3,
  kSphere = 4,
  kTorus = 5,
};
inline constexpr std::uint8_t kSurfaceKindCount = 6;

/// Where a feature of a mesh comes from. Goes over the wire, so numbers never change.
enum class FeatureOrigin : std::uint8_t {
  kUnknown = 0,
  kDeclared = 1,    ///< named in the scenario
  kGenerated = 2,   ///< declared by the generator of the mesh
  kRecognized = 3,  ///< found in the mesh
};
inline constexpr std::uint8_t kFeatureOriginCount = 4;

/// A feature that a constraint can name, as a participant is told of it. Part frame, mm.
struct FeatureInfo {
  std::string name;  ///< unique in its part
  FeatureOrigin origin = FeatureOrigin::kUnknown;
  SurfaceKind kind = SurfaceKind::kUnknown;
  bool inward = false;           ///< bore, countersink, socket: material lies outside of the radius
  Vec3 point_P = Vec3::Zero();   ///< on the plane / on the axis / apex of the cone / centre
  Vec3 axis_P = Vec3::UnitZ();   ///< unit: outward normal of the plane; axis, of a cone to its wide
                                 ///< side; unused for a sphere
  double radius_mm = 0.0;        ///< cylinder, sphere; torus: of the centre circle
  double tube_radius_mm = 0.0;   ///< torus
  double half_angle_rad = 0.0;   ///< cone
  Interval along_mm{0.0, 0.0};   ///< where its facets lie along axis_P, from point_P
  Vec3 middle_P = Vec3::Zero();  ///< centroid of its facets
};

/// Parts that have the same mesh and the same features.
struct FeatureSet {
  std::vector<PartId> parts;
  std::vector<FeatureInfo> features;
};

/// All features of a session. A part may be in several sets and has the features of all of them.
struct FeatureTable {
  std::vector<FeatureSet> sets;
  std::uint32_t meshes_waiting = 0;    ///< not yet searched for features; a new table will follow
  std::uint32_t meshes_too_large = 0;  ///< never searched; their declared features are in the table
  std::uint32_t left_out = 0;          ///< features that did not fit into the table
};

}  // namespace mortise
