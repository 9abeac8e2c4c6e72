// The toleranced holes of the NIST test case 10 against generated pins at and about their limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/io/scenario/scene_load.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"
#include "tests/scenes/first_error.h"
#include "tests/support/effort.h"
#include "tests/support/test_data.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;
using test::data_folder;
using test::first_error;

struct Hole {
  double diameter_mm, plus_mm, minus_mm;
  Vec3 point = Vec3::Zero(), axis = Vec3::UnitZ();
  std::string name;
};

Vec3 vec3_of(const nlohmann::json& json) {
  return Vec3(json[0].get<double>(), json[1].get<double>(), json[2].get<double>());
}

struct StatedHoles {
  std::vector<Hole> lines;              // each axis with its size once
  int faces = 0;                        // that state them
  std::map<std::string, int> left_out;  // other faces of sizes, by reason
};

StatedHoles stated_holes() {
  std::ifstream file(data_folder() / "step" / "nist_ftc_10_tolerances_occt763.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  StatedHoles stated;
  for (const auto& dimension : json.at("dimensions")) {
    if (dimension.at("type") != "Size_Diameter") continue;
    for (const auto& face : dimension.at("faces")) {
      if (!face.value("hole", false)) {
        ++stated.left_out["face of a shaft"];
      } else if (!dimension.contains("plus")) {
        ++stated.left_out["face of a hole without limits"];
      } else if (std::fabs(2.0 * face.at("cyl_r").get<double>() -
                           dimension.at("value").get<double>()) > 1e-9) {
        ++stated.left_out["face whose radius is not half the stated size"];
      } else {
        Hole hole{dimension.at("value"),
                  dimension.at("plus"),
                  dimension.at("minus"),
                  vec3_of(face.at("axis_p")),
                  vec3_of(face.at("axis_d")).normalized(),
                  ""};
        ++stated.faces;
        // Halves of one round, and rounds of one size behind one another, share their line.
        const auto shared = [&](const Hole& other) {
          return other.diameter_mm == hole.diameter_mm && other.plus_mm == hole.plus_mm &&
                 other.minus_mm == hole.minus_mm && hole.axis.cross(other.axis).norm() < 1e-9 &&
                 (hole.point - other.point).cross(other.axis).norm() < 1e-6;
        };
        if (std::any_of(stated.lines.begin(), stated.lines.end(), shared)) continue;
        hole.name = "hole_" + std::to_string(stated.lines.size() + 1);
        stated.lines.push_back(hole);
      }
    }
  }
  return stated;
}

Scenario::FeatureSpec feature_of(const Hole& hole) {
  Scenario::FeatureSpec feature;
  feature.name = hole.name;
  feature.surface.kind = SurfaceKind::kCylinder;
  feature.surface.point = hole.point;
  feature.surface.axis = hole.axis;
  feature.surface.radius_mm = 0.5 * hole.diameter_mm;
  feature.surface.inward = true;
  // A larger hole leaves less material: its surface lies further inside.
  feature.tolerance = {{-0.5 * hole.plus_mm, 0.5 * hole.minus_mm}, "stated size"};
  return feature;
}

Scenario::PartSpec pin_of(const Hole& hole, double diameter_mm, double length_mm,
                          std::size_t number) {
  Scenario::PartSpec pin;
  pin.name = "pin " + std::to_string(number) + " in " + hole.name;
  pin.mesh.generator = "dowel";
  pin.mesh.parameters = {{"diameter_mm", diameter_mm},
                         {"length_mm", length_mm},
                         {"chamfer_mm", 0.05},
                         {"facets", 48.0},
                         {"phase_rad", 0.3}};
  pin.moving = true;
  return pin;
}

struct NistPart {
  SolidPtr solid;
  ImportedMesh imported;
  std::vector<Feature> features;    // of the holes below
  std::vector<Hole> holes;          // those found in the mesh
  std::vector<std::string> missed;  // why the others were not
};

LoadedScene load(const Scenario& scenario, const ImportedMesh& nist) {
  auto scene = load_scene(scenario, [&](const Scenario& s, const Scenario::PartSpec& part) {
    return part.mesh.generator.empty() ? Result<ImportedMesh>(nist) : default_meshes()(s, part);
  });
  EXPECT_TRUE(scene);
  return std::move(scene).value();
}

Scenario nist_scenario(const std::vector<Hole>& holes) {
  Scenario scenario;
  scenario.name = "nist";
  Scenario::PartSpec part;
  part.name = "block";
  part.mesh.file = "nist.stl";
  // How far corners of the mesh may lie off a stated surface and still stand for it: up to 0.4 µm
  // do. Faces without a statement are not what the pins touch.
  part.chord_error_mm = 0.001;
  for (const Hole& hole : holes) part.features.push_back(feature_of(hole));
  scenario.parts.push_back(std::move(part));
  return scenario;
}

NistPart nist_part(const char* file, const std::vector<Hole>& stated) {
  NistPart part;
  auto imported = import_mesh(data_folder() / "multires" / file, 1.0);
  EXPECT_TRUE(imported) << imported.error().text;
  part.imported = std::move(imported).value();
  for (const Hole& hole : stated) {
    const LoadedScene alone = load(nist_scenario({hole}), part.imported);
    if (alone.usable())
      part.holes.push_back(hole);
    else
      part.missed.push_back(first_error(alone));
  }
  const LoadedScene all = load(nist_scenario(part.holes), part.imported);
  EXPECT_TRUE(all.usable()) << first_error(all);
  if (!all.usable()) return part;
  part.features = all.world.parts[0].features;
  part.solid = all.world.parts[0].solid;
  return part;
}

// One bore of the part: a line of stated holes may run through several walls.
struct Bore {
  std::size_t hole;
  Interval along_mm;  // from Hole::point along Hole::axis
};

std::vector<Bore> bores_of(const NistPart& part) {
  std::vector<Bore> bores;
  for (std::size_t i = 0; i < part.holes.size(); ++i) {
    const Hole& hole = part.holes[i];
    std::vector<Interval> runs;
    for (const std::uint32_t t : part.features[i].triangles) {
      Interval run{INFINITY, -INFINITY};
      for (int k = 0; k < 3; ++k) {
        const double s = (part.solid->mesh().corner(t, k) - hole.point).dot(hole.axis);
        run = {std::min(run.lo, s), std::max(run.hi, s)};
      }
      runs.push_back(run);
    }
    std::sort(runs.begin(), runs.end(),
              [](const Interval& x, const Interval& y) { return x.lo < y.lo; });
    for (const Interval& run : runs)
      if (bores.empty() || bores.back().hole != i || run.lo > bores.back().along_mm.hi + 0.1)
        bores.push_back({i, run});
      else
        bores.back().along_mm.hi = std::max(bores.back().along_mm.hi, run.hi);
  }
  return bores;
}

struct Size {
  const char* name;
  double at_limit;   // 0: stated size; -1: at the least hole; 1: at the largest hole
  double beyond_mm;  // of the diameter, on top
  CollisionClass expected;
};
// Against a pin without tolerance of its own, interval arithmetic says: fake as long as the least
// hole takes the pin, real as soon as the largest hole does not. 6 µm of diameter keep clear of
// what corners of the mesh lie off the stated surface.
constexpr Size kSizes[] = {{"stated size", 0.0, 0.0, CollisionClass::kPotential},
                           {"under the least hole", -1.0, -0.006, CollisionClass::kFake},
                           {"over the least hole", -1.0, 0.006, CollisionClass::kPotential},
                           {"under the largest hole", 1.0, -0.006, CollisionClass::kPotential},
                           {"over the largest hole", 1.0, 0.006, CollisionClass::kReal}};

// The pin in each bore, of one size; the interval of overlaps that the limits of the hole leave.
struct Pinned {
  Bore bore;
  double diameter_mm = 0.0;
  Interval overlap_mm;
};

std::vector<Pinned> pins_of(const NistPart& part, const Size& size) {
  std::vector<Pinned> pins;
  for (const Bore& bore : bores_of(part)) {
    const Hole& hole = part.holes[bore.hole];
    const double limit_mm = size.at_limit > 0.0   ? hole.plus_mm
                            : size.at_limit < 0.0 ? -hole.minus_mm
                                                  : 0.0;
    const double over_mm = limit_mm + size.beyond_mm;
    pins.push_back({bore,
                    hole.diameter_mm + over_mm,
                    {0.5 * (over_mm - hole.plus_mm), 0.5 * (over_mm + hole.minus_mm)}});
  }
  return pins;
}

LoadedScene scene_with(const NistPart& part, const std::vector<Pinned>& pins) {
  Scenario scenario = nist_scenario(part.holes);
  for (const Pinned& pin : pins)
    scenario.parts.push_back(pin_of(part.holes[pin.bore.hole], pin.diameter_mm,
                                    0.6 * pin.bore.along_mm.width(), scenario.parts.size()));
  LoadedScene scene = load(scenario, part.imported);
  if (!scene.usable()) return scene;
  for (std::size_t i = 0; i < pins.size(); ++i) {
    const Hole& hole = part.holes[pins[i].bore.hole];
    const Interval along = pins[i].bore.along_mm;
    scene.world.parts[i + 1].X_WP = {
        Quat::FromTwoVectors(Vec3::UnitZ(), hole.axis),
        hole.point + (along.middle() - 0.3 * along.width()) * hole.axis};
  }
  return scene;
}

class RealHoles : public testing::TestWithParam<const char*> {
 protected:
  void expect_verdicts(const NistPart& part, const Size& size, bool full_brackets) {
    const std::vector<Pinned> pins = pins_of(part, size);
    LoadedScene scene = scene_with(part, pins);
    ASSERT_TRUE(scene.usable()) << first_error(scene);
    Scratch scratch;
    const JudgeReport report = judge_world(scene.world, scratch, full_brackets);
    for (std::size_t i = 0; i < pins.size(); ++i, ++judged_) {
      const PartId id = scene.world.parts[i + 1].id;
      const auto pair = std::find_if(report.pairs.begin(), report.pairs.end(),
                                     [&](const PairVerdicts& p) { return p.b == id; });
      const bool none = pair == report.pairs.end() || pair->verdicts.empty();
      const Hole& hole = part.holes[pins[i].bore.hole];
      const std::string about = hole.name + ", pin Ø" + std::to_string(pins[i].diameter_mm) + ", " +
                                size.name + ": " + (none ? "none" : pair->verdicts[0].explanation);
      if (none) {  // the meshes keep apart, and no admissible surfaces meet
        EXPECT_EQ(size.expected, CollisionClass::kFake) << about;
        continue;
      }
      const Verdict& verdict = pair->verdicts[0];
      EXPECT_EQ(verdict.collision_class, size.expected) << about;
      EXPECT_EQ(verdict.face_a, hole.name) << about;
      // The chamfer shares the edge of the journal.
      EXPECT_TRUE(verdict.face_b == "journal" || verdict.face_b.starts_with("chamfer")) << about;
      if (!full_brackets) continue;
      // The thresholds leave the interval of the exact radii, up to what corners of the mesh lie
      // off the stated surface.
      const double off_mm = 2.0 * (part.features[pins[i].bore.hole].residual_mm + 2e-4);
      const Interval overlap_mm{verdict.delta_mm.lo - verdict.real_above_mm,
                                verdict.delta_mm.hi - verdict.fake_below_mm};
      EXPECT_NEAR(overlap_mm.lo, pins[i].overlap_mm.lo, off_mm) << about;
      EXPECT_NEAR(overlap_mm.hi, pins[i].overlap_mm.hi, off_mm) << about;
    }
  }

  int judged_ = 0;
};

TEST_P(RealHoles, PinsAtAndAboutTheLimitsAreJudgedAsIntervalsSay) {
  MORTISE_NEEDS_DATA(data_folder() / "multires");
  const StatedHoles stated = stated_holes();
  const NistPart part = nist_part(GetParam(), stated.lines);
  ASSERT_EQ(part.features.size(), part.holes.size());
  // Full brackets cost more: thresholds are compared on one of the meshes (of all sizes only in a
  // soak), classes on all.
  const bool full_brackets = std::string(GetParam()).find("0.1mm") != std::string::npos;
  for (const Size& size : kSizes)
    expect_verdicts(part, size, full_brackets && (&size == kSizes || test::effort(1) > 1));
  // None is left out in silence: each stated line is found in the mesh, and each of its bores
  // judged.
  EXPECT_EQ(stated.faces, 66);
  EXPECT_EQ(stated.left_out, (std::map<std::string, int>{{"face of a hole without limits", 6},
                                                         {"face of a shaft", 8}}));
  EXPECT_EQ(stated.lines.size(), 29u);
  EXPECT_EQ(part.missed, std::vector<std::string>{});
  EXPECT_EQ(bores_of(part).size(), 33u);
  EXPECT_EQ(judged_, static_cast<int>(std::size(kSizes) * bores_of(part).size()));
}

INSTANTIATE_TEST_SUITE_P(Nist, RealHoles,
                         testing::Values("nist_ftc_10_defl_0.02mm.stl",
                                         "nist_ftc_10_defl_0.1mm.stl",
                                         "nist_ftc_10_defl_0.5mm.stl"),
                         [](const auto& instance) {
                           const std::string name = instance.param;
                           return "chord_" +
                                  std::string(name.find("0.02") != std::string::npos  ? "20um"
                                              : name.find("0.1") != std::string::npos ? "100um"
                                                                                      : "500um");
                         });

}  // namespace
}  // namespace mortise
