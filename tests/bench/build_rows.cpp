// Time to build a tree beside FCL's OBBRSS tree, and its bytes.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "common/geometry/bvh/bvh.h"
#include "common/geometry/topology.h"
#include "tests/bench/scenes.h"
#include "tests/bench/sections.h"
#include "tests/bench/statistics.h"
#include "tests/oracle/fcl_model.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::bench {
namespace {

struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};

std::vector<NamedMesh> all_meshes(bool quick) {
  std::vector<NamedMesh> meshes;
  for (const int thousands : {1, 10, 100, 500}) {
    if (quick && thousands > 100) break;
    const int around = static_cast<int>(std::sqrt(1000.0 * thousands));
    meshes.push_back({"sphere " + std::to_string(thousands) + "k",
                      testing::sphere_mesh(10.0, around, around / 2 + 1)});
  }
  meshes.push_back({"gear", gear_solid(40, 64, 0.0)->mesh()});
  meshes.push_back({"peg", testing::prism_mesh(10.0, 512, -12.5, 12.5)});
  meshes.push_back({"bore", testing::tube_mesh(10.0, 20.0, 512, -40.0, 40.0)});
  for (const char* name : {"sphere10k", "peg_c0.50", "peg_c0.10", "gears", "wall"}) {
    const MotionSet set = measured_set(name, 1);
    if (set.items.empty()) continue;
    meshes.push_back({set.name + ", moving", set.moving->mesh()});
    meshes.push_back({set.name + ", static", set.fixed->mesh()});
  }
  return meshes;
}

// The lists that FCL wants are made before the clock runs.
double fcl_time_s(const TriangleMesh& mesh) {
  const std::vector<fcl::Vector3d> points(mesh.points_mm.begin(), mesh.points_mm.end());
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  return least_time_s(
      [&] {
        fcl::BVHModel<fcl::OBBRSSd> model;
        model.beginModel();
        model.addSubModel(points, triangles);
        model.endModel();
      },
      5, 0.3);
}

std::size_t topology_bytes(const TriangleMesh& mesh) {
  const Solid solid(mesh);
  solid.topology();
  solid.shells();
  return solid.derived_bytes();
}

}  // namespace

void section_build(Report& report, const Options& options) {
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  report.table("Building a tree: CPU time of one thread; bytes a triangle, alone and with topology",
               {"mesh", "triangles", "mortise ms", "FCL OBBRSS ms", "ratio", "ns a triangle",
                "bytes", "with topology"});
  std::vector<double> ratios;
  double most_bytes = 0.0;
  for (const NamedMesh& named : all_meshes(options.quick)) {
    const auto count = static_cast<double>(named.mesh.triangles.size());
    std::size_t bytes = 0;
    const double ours_s = least_time_s([&] { bytes = build_bvh(named.mesh, 1).bytes(); }, 20, 0.2);
    const double fcl_s = fcl_time_s(named.mesh);
    const double bytes_each = static_cast<double>(bytes) / count;
    const double with_topology = static_cast<double>(bytes + topology_bytes(named.mesh)) / count;
    // Of a small part nobody counts the bytes.
    if (count > 50'000) most_bytes = std::max(most_bytes, with_topology);
    ratios.push_back(fcl_s / ours_s);
    report.row({named.name, static_cast<long long>(named.mesh.triangles.size()), 1e3 * ours_s,
                1e3 * fcl_s, ratios.back(), 1e9 * ours_s / count, bytes_each, with_topology});
  }
  report.bar("tree: FCL's build time / ours, least of all meshes",
             *std::min_element(ratios.begin(), ratios.end()), 5.0, BoundKind::kAtLeast);
  report.bar("tree: bytes a triangle with topology, meshes above 50k", most_bytes, 160.0,
             BoundKind::kAtMost);

  // The calling thread takes part in everything: where the cores are free, its time is what passes.
  report.table("Building a tree on several threads: CPU time of the calling thread, and elapsed",
               {"mesh", "threads", "calling thread ms", "speed-up", "elapsed ms", "same tree"});
  const TriangleMesh large = testing::sphere_mesh(10.0, options.quick ? 300 : 700, 351);
  const Bvh one = build_bvh(large, 1);
  double one_s = 0.0;
  for (const int threads : {1, 2, 4}) {
    if (threads > 1 && static_cast<unsigned>(threads) > cores) break;
    double least_s = 0.0, elapsed_least_s = 0.0;
    bool same = true;
    for (int i = 0; i < 5; ++i) {
      const auto start = std::chrono::steady_clock::now();
      const Stopwatch watch;
      const Bvh bvh = build_bvh(large, threads);
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      const double caller_s = watch.elapsed_s();
      least_s = i == 0 ? caller_s : std::min(least_s, caller_s);
      elapsed_least_s = i == 0 ? elapsed.count() : std::min(elapsed_least_s, elapsed.count());
      same = same && bvh.triangle_order == one.triangle_order && bvh.root == one.root &&
             bvh.nodes.size() == one.nodes.size();
    }
    if (threads == 1) one_s = least_s;
    report.row({"sphere " + std::to_string(large.triangles.size()), static_cast<long long>(threads),
                1e3 * least_s, one_s / least_s, 1e3 * elapsed_least_s,
                std::string(same ? "yes" : "NO")});
  }
}

}  // namespace mortise::bench
