// A published gear on a shaft of its own size, judged under the fits of ISO 286.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/io/scenario/scene_load.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"
#include "tests/scenes/first_error.h"
#include "tests/support/test_data.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;
using test::data_folder;
using test::first_error;

// Each shaft on the plate is a closed shell of its own: the one of the small gear is judged alone.
void keep_shaft_only(ImportedMesh& base) {
  const auto on_shaft = [](const Vec3& x) {
    return std::hypot(x.x() - 50.5, x.y()) < 5.1 && x.z() > 4.999;
  };
  TriangleMesh& mesh = base.mesh;
  std::map<std::uint32_t, std::uint32_t> kept;
  TriangleMesh shaft;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto corners = mesh.triangles[t];
    if (!std::all_of(corners.begin(), corners.end(),
                     [&](std::uint32_t i) { return on_shaft(mesh.points_mm[i]); }))
      continue;
    for (std::uint32_t& i : corners) {
      const auto [at, fresh] = kept.insert({i, static_cast<std::uint32_t>(shaft.points_mm.size())});
      if (fresh) shaft.points_mm.push_back(mesh.points_mm[i]);
      i = at->second;
    }
    shaft.triangles.push_back(corners);
  }
  mesh = std::move(shaft);
  base.report.closed = true;
}

enum class Base { kWhole, kShaftOnly };

// Bore 10.000 and shaft 10.000, the gear raised off the plate; "" declares the surfaces and no fit.
struct GearJudged {
  Verdict verdict;         // of bore against shaft
  double residual_mm = 0;  // how far corners stand off both declared surfaces, together
};

GearJudged gear_on_shaft(const std::string& code, Base base = Base::kShaftOnly) {
  const fs::path folder = fs::absolute(data_folder() / "fits" / "gears");
  Scenario scenario;
  scenario.name = "gear";
  const auto add_part = [&](const char* name, const char* mesh, const char* feature, bool inward) {
    Scenario::PartSpec part;
    part.name = name;
    part.mesh.file = (folder / mesh).string();
    part.mesh.unit_mm = 1000.0;
    part.X_WP = Pose::translation(Vec3(0, 0, inward ? 0.2 : 0.0));
    part.moving = inward;
    part.chord_error_mm = 0.002;  // corners stand up to 1.5e-4 R off
    Scenario::FeatureSpec round;
    round.name = feature;
    round.surface.kind = SurfaceKind::kCylinder;
    round.surface.point = Vec3(50.5, 0, 0);
    round.surface.radius_mm = 5.0;
    round.surface.inward = inward;
    part.features.push_back(std::move(round));
    scenario.parts.push_back(std::move(part));
  };
  add_part("base", "factory_gear_base_tight_space_5e-4_subdiv_4x.obj", "shaft", false);
  add_part("gear", "factory_gear_small_space_5e-4.obj", "bore", true);
  if (!code.empty()) {
    Scenario::FitSpec fit;
    fit.part_a = "base", fit.feature_a = "shaft", fit.part_b = "gear", fit.feature_b = "bore";
    fit.code = code;
    scenario.fits.push_back(std::move(fit));
  }
  auto scene = load_scene(scenario, [&](const Scenario& s, const Scenario::PartSpec& part) {
    Result<ImportedMesh> mesh = default_meshes()(s, part);
    if (mesh && part.name == "base" && base == Base::kShaftOnly) keep_shaft_only(*mesh);
    return mesh;
  });
  EXPECT_TRUE(scene && scene->usable()) << first_error(*scene);
  Scratch scratch;
  // A bracket that is left open has no probability.
  const JudgeReport report = judge_world(scene->world, scratch, true);
  GearJudged judged;
  for (const Part& part : scene->world.parts) judged.residual_mm += part.features[0].residual_mm;
  for (const PairVerdicts& pair : report.pairs)
    for (const Verdict& verdict : pair.verdicts)  // worst first
      if (judged.verdict.collision_class == CollisionClass::kNone && verdict.face_a == "shaft" &&
          verdict.face_b == "bore")
        judged.verdict = verdict;
  return judged;
}

class RealGear : public testing::Test {
 protected:
  void SetUp() override { MORTISE_NEEDS_DATA(data_folder() / "fits"); }
};

TEST_F(RealGear, WithoutAToleranceItIsPotential) {
  const Verdict verdict = gear_on_shaft("").verdict;
  EXPECT_EQ(verdict.collision_class, CollisionClass::kPotential) << verdict.explanation;
  EXPECT_EQ(verdict.grade, DeviationGrade::kDeclaredFeature);
  EXPECT_GT(verdict.delta_mm.lo, 0.0);  // the polygons cross; the true surfaces touch
}

// The edges at which the file leaves the plate open are closed on import.
TEST_F(RealGear, OnTheWholePlateItIsRealAsWell) {
  const Verdict verdict = gear_on_shaft("H7/s6", Base::kWhole).verdict;
  EXPECT_EQ(verdict.collision_class, CollisionClass::kReal) << verdict.explanation;
  EXPECT_TRUE(verdict.has_witness);
}

// Limits of the standard at 10 mm, diametral µm: H7 0/15, H8 0/22, H6 0/9; f7 -28/-13, g6 -14/-5,
// k6 1/10, n6 10/19, p6 15/24, r6 19/28, s6 23/32. So H7/p6 may just touch here and is no certain
// interference. The corners of the published meshes stand up to 1.4 µm off; the surfaces are
// declared, and a declaration is the truth.
TEST_F(RealGear, EveryFitIsWhatItsLimitsAndTheMeshesLeave) {
  struct Row {
    const char* code;
    double least_um, most_um;  // diametral interference
  };
  constexpr Row kRows[] = {{"H8/f7", -50, -13}, {"H7/f7", -43, -13}, {"H7/g6", -29, -5},
                           {"H7/k6", -14, 10},  {"H7/n6", -5, 19},   {"H7/p6", 0, 24},
                           {"H7/r6", 4, 28},    {"H6/p6", 6, 24},    {"H7/s6", 8, 32}};
  int fake = 0, real = 0;
  for (const Row& row : kRows) {
    const auto [verdict, residual_mm] = gear_on_shaft(row.code);
    EXPECT_LT(residual_mm, 0.0026);
    const CollisionClass expected = 0.5e-3 * row.most_um <= 0.0   ? CollisionClass::kFake
                                    : 0.5e-3 * row.least_um > 0.0 ? CollisionClass::kReal
                                                                  : CollisionClass::kPotential;
    EXPECT_EQ(verdict.collision_class, expected) << row.code << ": " << verdict.explanation;
    EXPECT_EQ(verdict.has_witness, expected == CollisionClass::kReal) << row.code;
    if (row.least_um >= 0.0) {
      EXPECT_GT(verdict.probability, 0.999) << row.code << ": " << verdict.explanation;
    }
    if (row.most_um < 0.0) {
      EXPECT_LT(verdict.probability, 0.001) << row.code;
    }
    fake += verdict.collision_class == CollisionClass::kFake ? 1 : 0;
    real += verdict.collision_class == CollisionClass::kReal ? 1 : 0;
  }
  EXPECT_GE(fake, 2);
  EXPECT_GE(real, 2);
}

}  // namespace
}  // namespace mortise
