// The door for what constraints can name.
#include <numbers>

#include "idl/convert.h"
#include "idl/door.h"

namespace mortise {

wire::Feature to_wire(const FeatureInfo& feature) {
  wire::Feature out;
  out.origin(static_cast<std::uint8_t>(feature.origin));
  out.kind(static_cast<std::uint8_t>(feature.kind));
  out.inward(feature.inward);
  out.point_mm(triple(feature.point_P));
  out.axis(triple(feature.axis_P));
  out.radius_mm(feature.radius_mm);
  out.tube_radius_mm(feature.tube_radius_mm);
  out.half_angle_rad(feature.half_angle_rad);
  out.along_lo_mm(feature.along_mm.lo);
  out.along_hi_mm(feature.along_mm.hi);
  out.middle_mm(triple(feature.middle_P));
  out.name(clip(feature.name, kMaxName_bytes));
  return out;
}

Result<FeatureInfo> from_wire(const wire::Feature& in) {
  Door door("feature");
  door.need(in.origin() != 0 && in.origin() < kFeatureOriginCount, "origin");
  door.need(in.kind() != 0 && in.kind() < kSurfaceKindCount, "kind");
  door.position(in.point_mm(), "point_mm");
  door.need(std::abs(vec3(in.axis()).norm() - 1.0) <= kUnitNormAllowance, "axis");
  for (const double radius_mm : {in.radius_mm(), in.tube_radius_mm()})
    door.need(radius_mm >= 0.0 && radius_mm <= kMaxCoordinate_mm, "radius_mm");
  door.need(in.half_angle_rad() >= 0.0 && in.half_angle_rad() <= 0.5 * std::numbers::pi,
            "half_angle_rad");
  for (const double along_mm : {in.along_lo_mm(), in.along_hi_mm()})
    door.need(std::abs(along_mm) <= kMaxCoordinate_mm, "along_mm");
  door.interval(in.along_lo_mm(), in.along_hi_mm(), "along_mm");
  door.position(in.middle_mm(), "middle_mm");
  door.need(!in.name().empty(), "name");
  door.name(in.name(), "name");
  if (!door.open()) return door.refusal();
  FeatureInfo feature;
  feature.name = in.name();
  feature.origin = static_cast<FeatureOrigin>(in.origin());
  feature.kind = static_cast<SurfaceKind>(in.kind());
  feature.inward = in.inward();
  feature.point_P = vec3(in.point_mm());
  feature.axis_P = vec3(in.axis());
  feature.radius_mm = in.radius_mm();
  feature.tube_radius_mm = in.tube_radius_mm();
  feature.half_angle_rad = in.half_angle_rad();
  feature.along_mm = {in.along_lo_mm(), in.along_hi_mm()};
  feature.middle_P = vec3(in.middle_mm());
  return feature;
}

Result<FeatureSet> from_wire(const wire::FeatureSet& in) {
  Door door("feature set");
  door.sequence(in.parts(), "parts");
  for (const std::uint32_t part : in.parts()) door.need(part != 0, "parts");
  if (!door.open()) return door.refusal();
  FeatureSet set;
  for (const std::uint32_t part : in.parts()) set.parts.push_back(PartId{part});
  if (Status read = read_all(in.features(), set.features); !read) return read.error();
  return set;
}

Result<FeatureTable> from_wire(const wire::Features& in) {
  FeatureTable table;
  table.meshes_waiting = in.meshes_waiting();
  table.meshes_too_large = in.meshes_too_large();
  table.left_out = in.left_out();
  if (Status read = read_all(in.sets(), table.sets); !read) return read.error();
  return table;
}

}  // namespace mortise
