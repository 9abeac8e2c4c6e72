#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "common/geometry/recognition/recognition.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/mesh/obj_exact.h"
#include "tests/support/test_data.h"

namespace mortise {
namespace {

using test::data_folder;

struct StatedRound {
  const char* file;
  double diameter_mm;
  bool bore;
};

// What the publisher states of the meshes (in metres), or what they measure where it states
// nothing.
constexpr StatedRound kRounds[] = {
    {"insertion/factory_round_hole_8mm_subdiv_3x.obj", 8.1, true},
    {"insertion/factory_round_peg_8mm_tight.obj", 7.995, false},
    {"insertion/factory_round_peg_8mm_loose.obj", 7.986, false},
    {"insertion/factory_round_hole_16mm_subdiv_3x.obj", 16.5, true},
    {"insertion/factory_round_peg_16mm_tight.obj", 15.994, false},
    {"insertion/factory_round_peg_16mm_loose.obj", 15.983, false},
    {"gears/factory_gear_small_space_5e-4.obj", 10.0, true},
    {"gears/factory_gear_base_tight_space_5e-4_subdiv_4x.obj", 10.0, false},
    {"gears/factory_gear_base_loose_space_5e-4_subdiv_4x.obj", 9.972, false}};

TEST(RealRecognition, PublishedPegsAndBoresHaveTheirStatedDiameter) {
  const auto folder = data_folder() / "fits";
  MORTISE_NEEDS_DATA(folder);
  for (const StatedRound& stated : kRounds) {
    const auto mesh = read_obj_exact(folder / stated.file, 1000.0);
    ASSERT_TRUE(mesh) << mesh.error().text;
    const Recognition found = recognize_features(Solid(mesh->mesh));
    double best = 1e9, residual = 0.0;
    for (std::size_t i = 0; i < found.features.size(); ++i) {
      const Feature& f = found.features[i];
      if (f.surface.kind != SurfaceKind::kCylinder || f.surface.inward != stated.bore ||
          found.measures[i].arc_rad < 6.2)
        continue;
      const double off = std::fabs(2.0 * f.surface.radius_mm - stated.diameter_mm);
      if (off < best) best = off, residual = f.residual_mm;
    }
    EXPECT_LE(best, 3e-3) << stated.file;
    std::printf("%-58s off by %.2f um, residual %.2f um\n", stated.file, best * 1e3,
                residual * 1e3);
  }
}

// The part's cylinders as its STEP file states them: radius, a point of the axis, its direction.
struct StatedCylinder {
  double radius_mm;
  Vec3 point, axis;
};

std::vector<StatedCylinder> stated_cylinders(const std::filesystem::path& file) {
  std::vector<StatedCylinder> all;
  const auto json = nlohmann::json::parse(std::ifstream(file));
  const auto vec = [](const nlohmann::json& j) {
    return Vec3(j[0].get<double>(), j[1].get<double>(), j[2].get<double>());
  };
  for (const auto& dimension : json["dimensions"])
    for (const auto& face : dimension["faces"]) {
      if (!face.contains("cyl_r")) continue;
      const StatedCylinder c{face["cyl_r"].get<double>(), vec(face["axis_p"]), vec(face["axis_d"])};
      const bool known = std::any_of(all.begin(), all.end(), [&](const StatedCylinder& o) {
        return std::fabs(o.radius_mm - c.radius_mm) < 1e-6 &&
               (o.point - c.point).cross(o.axis).norm() < 1e-6 &&
               o.axis.cross(c.axis).norm() < 1e-6;
      });
      if (!known) all.push_back(c);
    }
  return all;
}

bool same(const StatedCylinder& stated, const Surface& s) {
  return s.kind == SurfaceKind::kCylinder &&
         std::fabs(s.radius_mm - stated.radius_mm) <= 4e-4 * stated.radius_mm + 1e-4 &&
         s.axis.cross(stated.axis).norm() < 2e-3 &&
         (s.point - stated.point).cross(stated.axis).norm() < 2e-3 * stated.radius_mm + 1e-3;
}

TEST(RealRecognition, OnePartAtThreeChordErrorsShowsTheSameCylinders) {
  const auto folder = data_folder();
  const auto statement = folder / "step/nist_ftc_10_tolerances_occt763.json";
  MORTISE_NEEDS_DATA(statement);
  MORTISE_NEEDS_DATA(folder / "multires");
  const std::vector<StatedCylinder> stated = stated_cylinders(statement);
  ASSERT_GE(stated.size(), 20U);
  std::set<std::size_t> first;
  for (const char* mesh : {"0.02mm", "0.1mm", "0.5mm"}) {
    const auto imported =
        import_mesh(folder / "multires" / (std::string("nist_ftc_10_defl_") + mesh + ".stl"), 1.0);
    ASSERT_TRUE(imported) << imported.error().text;
    const Recognition found =
        recognize_features(Solid(imported->mesh), {.quantum_mm = imported->report.quantum_mm});
    std::set<std::size_t> seen;
    for (std::size_t i = 0; i < stated.size(); ++i) {
      if (std::any_of(found.features.begin(), found.features.end(),
                      [&](const Feature& f) { return same(stated[i], f.surface); }))
        seen.insert(i);
      else
        std::printf("  not found at %s: R %.3f at (%.2f, %.2f, %.2f)\n", mesh, stated[i].radius_mm,
                    stated[i].point.x(), stated[i].point.y(), stated[i].point.z());
    }
    std::printf("%s: %zu of %zu stated cylinders\n", mesh, seen.size(), stated.size());
    if (first.empty()) first = seen;
    EXPECT_EQ(seen, first) << mesh;
    EXPECT_GE(seen.size(), 0.9 * static_cast<double>(stated.size())) << mesh;
  }
}

}  // namespace
}  // namespace mortise
