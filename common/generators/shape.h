#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/generators/generators.h"
#include "common/generators/triangulate.h"

namespace mortise {

/// A closed polyline in space, counter-clockwise seen from +z, as point numbers.
using Ring = std::vector<std::uint32_t>;

/// Builds a part from walls and caps. Points at exactly the same place are one point, and triangles
/// with two equal corners are left out, so that pieces that share corners form a closed mesh.
class Shape {
 public:
  static constexpr int kNoFace = -1;

  /// Declares a face and returns its number, which is passed to its pieces.
  int plane(const std::string& name, const Vec3& point, const Vec3& outward);
  int cylinder(const std::string& name, const Vec3& on_axis, double radius_mm, bool inward);
  int cone(const std::string& name, const Vec3& apex, const Vec3& axis, double half_angle_rad,
           bool inward);

  std::uint32_t point(const Vec3& p);
  const Vec3& at(std::uint32_t i) const { return part_.mesh.points_mm[i]; }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, int face = kNoFace);
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, int face = kNoFace);

  Ring ring(const Loop& loop, double z_mm);
  /// Wall between two rings of the same size; its outside is tangent x (from -> to): outward when
  /// `to` is above `from`, inward when below. A ring of one point is a tip.
  void strip(const Ring& from, const Ring& to, int face = kNoFace);
  /// One facet of it: from corner i to i + 1.
  void facet(const Ring& from, const Ring& to, std::size_t i, int face = kNoFace);
  /// Flat cap: outline and holes are counter-clockwise rings at one height.
  void cap(const Ring& outline, const std::vector<Ring>& holes, bool up, int face = kNoFace);

  /// The part; an error when a cap could not be cut.
  Result<GeneratedPart> finish() &&;

 private:
  int declare(Feature feature);
  GeneratedPart part_;
  std::map<std::array<double, 3>, std::uint32_t> number_;
  std::string trouble_;
};

/// Corners of a circle: whole number of facets, first corner at phase_rad. Every corner lies on the
/// circle to rounding.
Loop circle(const Vec2& center, double radius_mm, int facets, double phase_rad);
Loop rectangle(const Vec2& lo, const Vec2& hi);

/// A circle cut by a slot along +x from the centre: |y| <= width / 2 up to (cut inward) or from
/// (cut outward) the circle to x = floor_x. slot_begin..+3: corners of the slot, in order: lower
/// edge on the circle, lower floor, upper floor, upper edge on the circle.
struct SlottedCircle {
  Loop loop;
  std::size_t slot_begin = 0;
  Loop
      arc;  ///< the piece of the circle that the slot took, from lower to upper edge, both included
};
SlottedCircle slotted_circle(double radius_mm, int facets, double phase_rad, double slot_width_mm,
                             double floor_x_mm);
/// The same circle without its slot: corners of the slot's edges are there, so that both fit.
Loop unslotted(const SlottedCircle& slotted);

}  // namespace mortise
