// Files that are almost solids: what is welded, turned and dropped on import, and how far the
// corners may be off.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "common/geometry/topology.h"
#include "common/io/mesh/mesh_clean.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/mesh/mesh_orient.h"
#include "tests/support/shapes.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

using shapes::box;
using shapes::together;

TriangleMesh inside_out(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

std::vector<double> soup_of(const TriangleMesh& mesh) {
  std::vector<double> soup;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      soup.insert(soup.end(), mesh.corner(t, k).data(), mesh.corner(t, k).data() + 3);
  return soup;
}

std::string stl_of(const std::vector<double>& soup) {
  std::string bytes(84, '\0');
  const auto count = static_cast<std::uint32_t>(soup.size() / 9);
  std::memcpy(bytes.data() + 80, &count, sizeof count);
  for (std::size_t t = 0; t < count; ++t) {
    bytes.append(12, '\0');
    for (std::size_t i = 0; i < 9; ++i) {
      const auto x = static_cast<float>(soup[9 * t + i]);
      bytes.append(reinterpret_cast<const char*>(&x), sizeof x);
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

class MeshSolid : public testing::Test {
 protected:
  ImportedMesh imported(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
    auto mesh = import_mesh(folder_.path() / name, 1.0);
    EXPECT_TRUE(mesh) << mesh.error().text;
    return mesh ? std::move(*mesh) : ImportedMesh{};
  }
  static bool says(const ImportedMesh& mesh, const std::string& part) {
    for (const std::string& note : mesh.report.notes)
      if (note.find(part) != std::string::npos) return true;
    return false;
  }
  test::TestFolder folder_;
};

TEST_F(MeshSolid, EveryShellIsTurnedByItself) {
  const TriangleMesh block = box({20, 20, 10}), boss = box({5, 5, 10}, {0, 0, 15});
  const ImportedMesh overlapping =
      imported("o.stl", stl_of(soup_of(together(block, inside_out(boss)))));
  EXPECT_TRUE(overlapping.report.closed);
  EXPECT_FALSE(overlapping.report.flipped);
  EXPECT_NEAR(overlapping.report.volume_mm3, 40.0 * 40 * 20 + 10.0 * 10 * 20, 1e-6);
  EXPECT_TRUE(says(overlapping, "1 of 2 shells faced inwards and was turned"));
  const ImportedMesh all = imported("a.stl", stl_of(soup_of(inside_out(block))));
  EXPECT_TRUE(all.report.flipped);
  EXPECT_TRUE(says(all, "all triangles faced inwards"));
}

TEST(OrientShells, NestingDecides) {
  const TriangleMesh outer = box({20, 20, 20}), hollow = inside_out(box({10, 10, 10})),
                     core = box({5, 5, 5});
  const auto volume = [](TriangleMesh mesh, std::uint32_t turned) {
    const ShellsTurned answer = orient_shells(mesh);
    EXPECT_EQ(answer.turned, turned);
    return signed_volume_mm3(mesh);
  };
  const double all = 64000.0 - 8000.0 + 1000.0;
  EXPECT_NEAR(volume(together(outer, hollow), 0), 64000.0 - 8000.0, 1e-6);  // a hollow stays
  EXPECT_NEAR(volume(together(together(outer, hollow), core), 0), all, 1e-6);
  EXPECT_NEAR(volume(together(together(outer, hollow), inside_out(core)), 1), all, 1e-6);
  EXPECT_NEAR(volume(inside_out(together(together(outer, hollow), core)), 3), all, 1e-6);
  EXPECT_NEAR(volume(inside_out(together(core, together(hollow, outer))), 3), all, 1e-6);
}

TEST(OrientShells, ManyAreTurnedEachByWhatIsAroundIt) {
  // Bodies of all widths in a row and above each other, each with a hollow and a core in it.
  TriangleMesh mesh;
  double volume_mm3 = 0.0;
  std::uint32_t turned = 0;
  for (int i = 0; i < 60; ++i) {
    const double half = 1.0 + i % 7;
    const Vec3 at(9.0 * (i % 20), 20.0 * (i / 20), 0);
    const auto add = [&](double share, bool outward, bool wrong) {
      const TriangleMesh one = box(Vec3(half, half, half) * share, at);
      mesh = together(mesh, outward == wrong ? inside_out(one) : one);
      volume_mm3 += (outward ? 8.0 : -8.0) * std::pow(half * share, 3);
      turned += wrong ? 1 : 0;
    };
    const bool wrong = i % 3 == 0;
    add(0.25, true, wrong || i % 5 == 0);
    add(1.0, true, wrong);
    add(0.5, false, wrong);
  }
  EXPECT_EQ(orient_shells(mesh).turned, turned);
  EXPECT_NEAR(signed_volume_mm3(mesh), volume_mm3, 1e-6);
}

TEST(AlignNeighbours, TheFewerAreTurned) {
  TriangleMesh mesh = box({1, 1, 1}, Vec3::Zero(), 4);
  const TriangleMesh good = mesh;
  for (const std::size_t t : {3U, 17U, 18U, 90U})
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  EXPECT_FALSE(build_topology(mesh).closed());
  EXPECT_EQ(align_neighbours(mesh), 4U);
  EXPECT_EQ(mesh.triangles, good.triangles);
  EXPECT_EQ(align_neighbours(mesh), 0U);
  // A band that is turned once has no way to face.
  TriangleMesh band;
  for (std::uint32_t i = 0; i < 5; ++i) {
    band.points_mm.push_back({static_cast<double>(i * i), static_cast<double>(i), 0});
    band.triangles.push_back({i, (i + 1) % 5, (i + 2) % 5});
  }
  const auto before = band.triangles;
  EXPECT_EQ(align_neighbours(band), 0U);
  EXPECT_EQ(band.triangles, before);
}

TEST(OrientShells, MaterialWithinMaterialIsSaid) {
  TriangleMesh mesh = together(box({20, 20, 20}), box({5, 5, 5}));
  const ShellsTurned answer = orient_shells(mesh);
  EXPECT_EQ(answer.turned, 0U);
  EXPECT_EQ(answer.filled, 1U);
}

TEST(OrientShells, CubesThatTouchAreTwo) {
  // The second faces inwards; both share an edge, and its four triangles balance.
  TriangleMesh mesh = together(box({1, 1, 1}), inside_out(box({1, 1, 1}, {2, 2, 0})));
  mesh = weld(soup_of(mesh), 1.0).mesh;
  const ShellsTurned turned = orient_shells(mesh);
  EXPECT_EQ(turned.shells, 2U);
  EXPECT_EQ(turned.turned, 1U);
  EXPECT_NEAR(signed_volume_mm3(mesh), 16.0, 1e-9);
}

TEST(InnerFaces, GoBetweenBodiesAndStayAsSheets) {
  TriangleMesh two = weld(soup_of(together(box({1, 1, 1}), box({1, 1, 1}, {2, 0, 0}))), 1.0).mesh;
  EXPECT_EQ(take_out_inner_faces(two), 4U);
  const Topology topology = build_topology(two);
  EXPECT_TRUE(topology.manifold());
  EXPECT_NEAR(topology.volume_mm3, 16.0, 1e-12);

  TriangleMesh fin = box({1, 1, 1});
  fin.points_mm.insert(fin.points_mm.end(), {Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(5, 1, 0)});
  fin.triangles.insert(fin.triangles.end(), {{8, 9, 10}, {8, 10, 9}});
  EXPECT_EQ(take_out_inner_faces(fin), 0U);
  EXPECT_EQ(fin.triangles.size(), 14U);
}

TEST_F(MeshSolid, CornersThatRoundingPartedAreWelded) {
  // Every corner of every triangle off by up to one step of its floats.
  TriangleMesh mesh = shapes::ring({400, 1600, 1624, 96, 1, 0}, 420);
  std::vector<double> soup = soup_of(mesh);
  std::mt19937_64 random(61);
  for (double& x : soup) {
    const auto f = static_cast<float>(x);
    if (random() % 3 == 0 && f != 0.0F) x = std::nextafter(f, 1e9F);
  }
  const ImportedMesh welded = imported("parted.stl", stl_of(soup));
  EXPECT_TRUE(welded.report.closed) << welded.report.boundary_edges;
  EXPECT_EQ(welded.report.components, 1U);
  EXPECT_TRUE(says(welded, "apart and were welded"));
  // What was moved is part of how far a corner may be off.
  EXPECT_GT(welded.report.quantum_mm, 0.5 * std::ldexp(1.0, 10 - 23));
  EXPECT_LT(welded.report.quantum_mm, 1e-3);
}

TEST(Weld, ACornerOnAnOpenEdgeCutsIt) {
  // A box of which one face has a corner in the middle of an edge that its neighbour does not have.
  std::vector<double> soup = soup_of(box({1, 1, 1}));
  const auto top = soup_of(box({1, 1, 1}, Vec3::Zero(), 2));
  std::vector<double> mixed;
  const auto take = [&](const std::vector<double>& from, bool upper) {
    for (std::size_t t = 0; t < from.size(); t += 9) {
      const bool is_top = from[t + 2] == 1.0 && from[t + 5] == 1.0 && from[t + 8] == 1.0;
      if (is_top == upper)
        mixed.insert(mixed.end(), from.begin() + static_cast<long>(t),
                     from.begin() + static_cast<long>(t) + 9);
    }
  };
  take(soup, false);
  take(top, true);
  for (double& x : mixed)
    if (x == 0.0) x = 1e-7;  // and not quite on it
  EXPECT_FALSE(build_topology(weld(mixed, 1.0).mesh).closed());
  const CleanMesh clean = weld(mixed, 1.0, 1e-6);
  EXPECT_TRUE(build_topology(clean.mesh).closed());
  EXPECT_EQ(clean.corners_moved, 4U);
  // Nothing is moved where that closes nothing.
  std::vector<double> open(mixed.begin(), mixed.begin() + 18);
  EXPECT_EQ(weld(open, 1.0, 1e-6).corners_moved, 0U);
}

std::string obj_of(const TriangleMesh& mesh, const char* format) {
  std::string text;
  char line[128];
  for (const Vec3& x : mesh.points_mm) {
    std::snprintf(line, sizeof line, format, x.x(), x.y(), x.z());
    text += line;
  }
  for (const auto& t : mesh.triangles) {
    std::snprintf(line, sizeof line, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
    text += line;
  }
  return text;
}

TEST_F(MeshSolid, TextKeepsItsDigits) {
  const Vec3 far(7788450.0, 7736288.0, 20200.0);
  const TriangleMesh mesh = box({7.7, 8.8, 5.5}, far);
  const ImportedMesh exact = imported("far.obj", obj_of(mesh, "v %.17g %.17g %.17g\n"));
  EXPECT_EQ(exact.report.quantum_mm, 0.0);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(bounds_of(exact.mesh).hi[static_cast<int>(i)],
              bounds_of(mesh).hi[static_cast<int>(i)]);
  const ImportedMesh floats = imported("far.stl", stl_of(soup_of(mesh)));
  EXPECT_EQ(floats.report.quantum_mm, 0.25);
}

TEST_F(MeshSolid, TwinsOfWorkedOutDoublesAreWelded) {
  // Every triangle has corners of its own, noughts off by 4e-13.
  const TriangleMesh mesh = box({10, 10, 10}, {10, 10, 10});
  TriangleMesh loose;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      Vec3 x = mesh.corner(t, k);
      for (double& c : x) c = c == 0.0 && (t + static_cast<std::uint32_t>(k)) % 2 == 0 ? 4e-13 : c;
      loose.points_mm.push_back(x);
    }
    loose.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const ImportedMesh welded = imported("twins.obj", obj_of(loose, "v %.17g %.17g %.17g\n"));
  EXPECT_TRUE(welded.report.closed);
  EXPECT_EQ(welded.report.points, 8U);
  EXPECT_LT(welded.report.quantum_mm, 1e-5);
}

TEST_F(MeshSolid, SixDigitsAreSixDigits) {
  const TriangleMesh mesh = shapes::peg({419.7412345, 1600.123456, 1623.987654, 96, 1, 0.1});
  const ImportedMesh six = imported("six.obj", obj_of(mesh, "v %.6g %.6g %.6g\n"));
  EXPECT_DOUBLE_EQ(six.report.quantum_mm, 0.005);
  const TriangleMesh plain = box({10, 20, 30}, {0.5, 0.25, 0}, 8);
  EXPECT_LT(imported("plain.obj", obj_of(plain, "v %.6g %.6g %.6g\n")).report.quantum_mm, 2e-6);
}

TEST_F(MeshSolid, AMirroredNodeIsTurned) {
  // The same tetrahedron as it is and mirrored in one file.
  const std::string gltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0,"translation":[5,0,0]},{"mesh":0,"scale":[-1,1,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},
"indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",
"min":[0,0,0],"max":[1,1,1]},{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,
"byteLength":24}],"buffers":[{"byteLength":72,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAACAAEAAAABAAMAAAADAAIAAQACAAMA"}]})";
  const ImportedMesh mesh = imported("both.gltf", gltf);
  EXPECT_TRUE(mesh.report.closed);
  EXPECT_EQ(mesh.report.components, 2U);
  EXPECT_NEAR(mesh.report.volume_mm3, 2.0 / 6.0, 1e-9);
  EXPECT_FALSE(says(mesh, "turned"));
}

}  // namespace
}  // namespace mortise
