#include <cmath>
#include <limits>

#include "common/base/constants.h"
#include "common/depth/body.h"

namespace mortise {
namespace {

// A circle of corners is no circle with fewer.
constexpr int kLeastCircle = 3;

// Is an end of a face a circle in a plane across the axis? The mesh is closed there, its corners
// are on the surface, and what ends the face is flat: then the true face ends in that plane as
// well.
class LevelEnd {
 public:
  LevelEnd(const Body& body, std::uint16_t face, bool upper)
      : body_(body),
        face_(face),
        surface_(*body.band->faces[face].surface),
        sign_(upper ? 1.0 : -1.0),
        end_(upper ? body.extent_of(face).hi : -body.extent_of(face).lo),
        off_mm_(std::max(std::fabs(body.band->faces[face].deviation_mm.lo),
                         std::fabs(body.band->faces[face].deviation_mm.hi))),
        flat_mm_(kRoundingFactor * kUnitRoundoff * body.solid->bvh().extent_mm) {}

  bool found() const {
    int circle = 0;
    for (std::uint32_t t = 0; t < body_.mesh->triangles.size(); ++t) {
      if (body_.face_index(t) != face_) continue;
      for (int k = 0; k < 3; ++k) {
        const double a = height(t, k), b = height(t, (k + 1) % 3);
        const bool on_a = is_level(a), on_b = is_level(b);
        const std::uint32_t other = body_.solid->topology().neighbor[t][k];
        const bool border = other == Topology::kNone || body_.face_index(other) != face_;
        if (on_a && on_b) {
          if (!border || other == Topology::kNone || !is_flat(other)) return false;
          ++circle;
        } else if (border && std::max(a, b) > end_ - off_mm_ - flat_mm_) {
          return false;  // between its corners the true border may go higher than the circle
        }
      }
    }
    return circle >= kLeastCircle;
  }

 private:
  double height(std::uint32_t t, int k) const {
    return sign_ * (body_.mesh->corner(t, k) - surface_.point).dot(surface_.axis);
  }
  bool is_level(double height) const { return height >= end_ - flat_mm_; }
  bool is_flat(std::uint32_t t) const {
    for (int k = 0; k < 3; ++k)
      if (std::fabs(height(t, k) - end_) > flat_mm_) return false;
    return true;
  }

  const Body& body_;
  std::uint16_t face_;
  const Surface& surface_;
  double sign_, end_, off_mm_, flat_mm_;
};

}  // namespace

const FaceEnds& Body::ends_of(std::uint16_t face) const {
  std::vector<FaceEnds>& ends = index_->ends;
  if (ends.empty()) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    ends.assign(band->faces.size(), {{kInfinity, -kInfinity}});
    for (std::uint32_t t = 0; t < mesh->triangles.size(); ++t) {
      const std::uint16_t f = face_index(t);
      const auto& surface = band->faces[f].surface;
      if (!surface) continue;
      for (int k = 0; k < 3; ++k) {
        const double z = (mesh->corner(t, k) - surface->point).dot(surface->axis);
        ends[f].extent_mm.lo = std::min(ends[f].extent_mm.lo, z);
        ends[f].extent_mm.hi = std::max(ends[f].extent_mm.hi, z);
      }
    }
    for (std::uint16_t f = 0; f < ends.size(); ++f)
      if (const auto& surface = band->faces[f].surface;
          surface && surface->kind == SurfaceKind::kSphere)
        for (const bool upper : {false, true})
          ends[f].level[upper] = LevelEnd(*this, f, upper).found();
  }
  return ends[face];
}

}  // namespace mortise
