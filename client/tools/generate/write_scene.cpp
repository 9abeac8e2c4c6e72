#include "client/tools/generate/write_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mortise {
namespace {

// Hues that differ from part to part: the golden angle never comes back to itself.
Vec3 colour_of(std::size_t part, bool moving) {
  if (!moving) return {0.62, 0.64, 0.67};
  const double hue = std::fmod(static_cast<double>(part) * 2.399963, 2.0 * std::numbers::pi);
  const auto channel = [&](double turn) { return 0.55 + 0.33 * std::cos(hue - turn); };
  return {channel(0.0), channel(2.0944), channel(4.1888)};
}

}  // namespace

void write_scene_obj(const World& world, const std::string& material_file, std::ostream& out,
                     std::ostream& materials) {
  out << "# mortise, unit mm\nmtllib " << material_file << '\n';
  std::size_t first_point = 1;
  for (std::size_t i = 0; i < world.parts.size(); ++i) {
    const Part& part = world.parts[i];
    const Vec3 colour = colour_of(i, part.moving);
    materials << fmt::format("newmtl {}\nKd {:.3f} {:.3f} {:.3f}\n", part.name, colour.x(),
                             colour.y(), colour.z());
    out << fmt::format("o {}\nusemtl {}\n", part.name, part.name);
    const TriangleMesh& mesh = part.solid->mesh();
    for (const Vec3& point : mesh.points_mm) {
      const Vec3 p_W = part.X_WP * point;
      out << fmt::format("v {:.7g} {:.7g} {:.7g}\n", p_W.x(), p_W.y(), p_W.z());
    }
    for (const auto& t : mesh.triangles)
      out << fmt::format("f {} {} {}\n", first_point + t[0], first_point + t[1],
                         first_point + t[2]);
    first_point += mesh.points_mm.size();
  }
}

}  // namespace mortise
