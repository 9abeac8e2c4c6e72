#include "client/tools/generate/write_mesh.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

namespace mortise {

void write_obj(const TriangleMesh& mesh, const std::vector<Feature>& features, std::ostream& out) {
  out << "# mortise, unit mm\n";
  for (const Vec3& p : mesh.points_mm) {
    char line[96];
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", p.x(), p.y(), p.z());
    out << line;
  }
  std::vector<std::uint32_t> group_of(mesh.triangles.size(), 0);
  for (std::size_t f = 0; f < features.size(); ++f)
    for (const std::uint32_t t : features[f].triangles)
      group_of[t] = static_cast<std::uint32_t>(f) + 1;
  for (std::uint32_t group = 0; group <= features.size(); ++group) {
    bool named = false;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (group_of[t] != group) continue;
      if (!named)
        out << "g " << (group == 0 ? std::string("rest") : features[group - 1].name) << '\n';
      named = true;
      out << "f " << mesh.triangles[t][0] + 1 << ' ' << mesh.triangles[t][1] + 1 << ' '
          << mesh.triangles[t][2] + 1 << '\n';
    }
  }
}

void write_stl(const TriangleMesh& mesh, std::ostream& out) {
  std::array<char, 80> header{};
  std::strncpy(header.data(), "mortise, unit mm", header.size() - 1);
  out.write(header.data(), header.size());
  const auto put = [&out](auto value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.write(bytes, sizeof value);
  };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 normal = (mesh.corner(t, 1) - mesh.corner(t, 0))
                            .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                            .normalized();
    for (const Vec3& v : {normal, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)})
      for (int k = 0; k < 3; ++k) put(static_cast<float>(v[k]));
    put(std::uint16_t{0});
  }
}

}  // namespace mortise
