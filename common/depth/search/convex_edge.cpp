#include "common/depth/search/convex_edge.h"

#include <algorithm>
#include <cmath>

#include "common/depth/triangles_in.h"

namespace mortise {
namespace {

// The edge of two moved faces is so many times farther from the old one than they are offset, at
// most; faces that meet at a smaller angle go over into each other.
constexpr double kMostTravel = 20.0;

// Face of a triangle as the least part has it.
class LeastFace {
 public:
  LeastFace(const Body& body, std::uint32_t triangle)
      : body_(body),
        triangle_(triangle),
        surface_(Body::surface_of(body.face(triangle), Layer::kLower)) {}

  Vec3 outward(const Vec3& x) const {
    return surface_ != nullptr ? surface_->outward_normal(x) : body_.normal(triangle_);
  }
  double offset_mm(const Vec3& x) const {
    return surface_ != nullptr ? Body::offset_of(body_.face(triangle_), Layer::kLower)
                               : body_.offset_at(triangle_, x, Layer::kLower);
  }
  double above_mm(const Vec3& x) const {
    const double from_mm = surface_ != nullptr
                               ? surface_->signed_distance_mm(x)
                               : outward(x).dot(x - body_.mesh->corner(triangle_, 0));
    return from_mm - offset_mm(x);
  }

 private:
  const Body& body_;
  std::uint32_t triangle_;
  const Surface* surface_;
};

double distance_to_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double share = std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (x - a - share * d).norm();
}

// Calls visit(height above the higher of both moved faces) for the edges that x may be past.
template <class Visit>
void for_each_edge_near(const Body& body, const Vec3& x, double rounding_mm, Visit&& visit) {
  const Topology& topology = body.solid->topology();
  const double reach_mm =
      2.0 * kMostTravel * body.largest_offset_mm[static_cast<int>(Layer::kLower)];
  for_each_triangle_in(
      body.solid->bvh(), Box{x.array() - reach_mm, x.array() + reach_mm},
      [&](std::uint32_t t, const std::array<Vec3, 3>& c) {
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t other = topology.neighbor[t][k];
          if (topology.edge_kind[t][k] != EdgeKind::kConvex || other < t ||
              body.face_index(other) == body.face_index(t))
            continue;
          const LeastFace one(body, t), two(body, other);
          const Vec3 &from = c[k], &to = c[(k + 1) % 3], middle = 0.5 * (from + to);
          const double sine = one.outward(middle).cross(two.outward(middle)).norm();
          const double travel_mm = std::fabs(one.offset_mm(x)) + std::fabs(two.offset_mm(x));
          if (sine * kMostTravel < 1.0 ||
              distance_to_segment(x, from, to) * sine > travel_mm + rounding_mm)
            continue;
          visit(std::max(one.above_mm(x), two.above_mm(x)));
        }
      });
}

}  // namespace

bool is_past_convex_edge(const Body& body, const Vec3& x, double rounding_mm) {
  if (body.band->trivial) return false;
  bool past = false;
  for_each_edge_near(body, x, rounding_mm,
                     [&](double above_mm) { past |= above_mm > rounding_mm; });
  return past;
}

double depth_below_convex_edges(const Body& body, const Vec3& x) {
  double depth_mm = body.depth_in(x, nearest_surface(*body.solid, x), Layer::kLower);
  if (!body.band->trivial)
    for_each_edge_near(body, x, 0.0,
                       [&](double above_mm) { depth_mm = std::min(depth_mm, -above_mm); });
  return depth_mm;
}

}  // namespace mortise
