#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "client/tools/check/check.h"
#include "common/io/step/step_import.h"
#include "tests/support/test_data.h"

namespace mortise {
namespace {

struct Checked {
  OpenedScene opened;
  CheckReport report;
  std::vector<StepCommon> commons;  // of all pairs of parts whose boxes meet
  std::vector<std::pair<PartId, PartId>> pairs;
};

Box box_of(const Part& part) {
  Box box;
  for (const Vec3& x : part.solid->mesh().points_mm) box.add(part.X_WP * x);
  return box;
}

Checked checked(const std::filesystem::path& file, bool with_oracle) {
  setenv("MORTISE_STEP_IMPORTER", MORTISE_BIN_DIR "/mortise-import-step", 1);
  auto opened = open_assembly(file);
  EXPECT_TRUE(opened) << opened.error().text;
  Checked c{std::move(*opened), {}, {}, {}};
  EXPECT_TRUE(c.opened.usable());
  c.report = check_scene(c.opened, file, {});
  if (!with_oracle) return c;
  const World& world = c.opened.scene.world;
  std::vector<StepCommonQuery> queries;
  for (std::size_t i = 0; i < world.parts.size(); ++i)
    for (std::size_t j = i + 1; j < world.parts.size(); ++j) {
      const Part &a = world.parts[i], &b = world.parts[j];
      if (!box_of(a).overlaps(box_of(b))) continue;
      c.pairs.emplace_back(a.id, b.id);
      queries.push_back({c.opened.scenario.parts[i].mesh.given_number,
                         c.opened.scenario.parts[j].mesh.given_number, a.X_WP.inverse() * b.X_WP});
    }
  const auto commons = step_commons(file, queries);
  EXPECT_TRUE(commons) << commons.error().text;
  c.commons = *commons;
  return c;
}

// Exact Booleans of all candidates: nothing that is empty is real, nothing thick is passed over.
void agrees_with_exact_solids(const Checked& c) {
  std::map<std::pair<PartId, PartId>, const CheckedPair*> said;
  for (const CheckedPair& pair : c.report.pairs)
    for (const auto& ids : pair.all) said[ids] = &pair;
  for (std::size_t i = 0; i < c.pairs.size(); ++i) {
    const StepCommon& common = c.commons[i];
    if (common.volume_mm3 < 0.0) continue;
    const auto found = said.find(c.pairs[i]);
    const CollisionClass klass =
        found == said.end() ? CollisionClass::kNone : found->second->collision_class;
    const std::string pair = c.opened.scene.world.find(c.pairs[i].first)->name + " x " +
                             c.opened.scene.world.find(c.pairs[i].second)->name;
    const double thick_mm = common.area_mm2 > 0.0 ? 2.0 * common.volume_mm3 / common.area_mm2 : 0.0;
    if (common.volume_mm3 < 1e-9) {
      EXPECT_NE(klass, CollisionClass::kReal) << pair;
    }
    if (thick_mm > 0.02) {
      EXPECT_EQ(klass, CollisionClass::kReal) << pair << " " << thick_mm;
    }
    if (found != said.end() && found->second->explained) {
      EXPECT_LE(common.volume_mm3, 1.1 * found->second->mating.explained_mm3 + 1e-3) << pair;
    }
  }
}

struct Expected {
  const char* file;
  std::size_t unexplained, explained;
};
class Assemblies : public testing::TestWithParam<Expected> {};

TEST_P(Assemblies, AsTheExactSolidsSay) {
  const auto file = test::data_folder() / "assemblies" / GetParam().file;
  MORTISE_NEEDS_DATA(file);
  const Checked c = checked(file, true);
  EXPECT_EQ(c.report.counts.unexplained_real, GetParam().unexplained);
  EXPECT_EQ(c.report.counts.explained_real, GetParam().explained);
  EXPECT_EQ(c.report.counts.potential, 0U);
  agrees_with_exact_solids(c);
}

INSTANTIATE_TEST_SUITE_P(Open, Assemblies,
                         testing::Values(Expected{"framework_threadedinsert.stp", 0, 2},
                                         Expected{"framework_selftapping.stp", 0, 2},
                                         Expected{"framework_hinge_r.stp", 0, 0},
                                         Expected{"aero_assembly.step", 2, 0}));

// Meshes are closed, enclose what the exact solids do, and freeform faces say what they reach;
// what is not so is named.
TEST(StepImport, MeshesAreWhatTheFilesSay) {
  setenv("MORTISE_STEP_IMPORTER", MORTISE_BIN_DIR "/mortise-import-step", 1);
  const auto folder = test::data_folder() / "assemblies";
  MORTISE_NEEDS_DATA(folder);
  std::size_t parts = 0, open = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!is_step_name(entry.path()) || entry.path().filename().string().starts_with("hostile"))
      continue;
    const auto assembly = import_step(entry.path());
    ASSERT_TRUE(assembly) << assembly.error().text;
    for (const StepPart& part : assembly->document.parts) {
      ++parts;
      open += part.open_edges > 0;
      const double volume = signed_volume_mm3(part.mesh);
      EXPECT_NEAR(volume / part.volume_mm3, 1.0, 0.05) << entry.path() << " " << part.name;
      for (const StepFace& face : part.faces)
        if (face.grade == StepFaceGrade::kExact) {
          EXPECT_LT(face.residual_mm, 0.02) << entry.path() << " " << part.name;
        }
    }
  }
  EXPECT_GE(parts, 25U);
  EXPECT_LE(open, 1U);
}

TEST(StepImport, HostileFilesAreOneLine) {
  setenv("MORTISE_STEP_IMPORTER", MORTISE_BIN_DIR "/mortise-import-step", 1);
  for (const char* name : {"hostile_bad_bytes_framework_threadedinsert.stp_0.stp",
                           "hostile_bad_refs_framework_threadedinsert.stp_0.stp"}) {
    const auto file = test::data_folder() / "assemblies" / name;
    MORTISE_NEEDS_DATA(file);
    const auto assembly = import_step(file);
    ASSERT_FALSE(assembly);
    EXPECT_EQ(assembly.error().text.find('\n'), std::string::npos);
    EXPECT_NE(assembly.error().text.find("export it again"), std::string::npos)
        << assembly.error().text;
  }
  EXPECT_FALSE(import_step("/nowhere.step"));
  EXPECT_FALSE(import_step("/"));
}

// k6 below must not read as js, and g6, whose limits are both below, must not read as a range.
TEST(StepImport, SignsOfTolerancesAreThoseOfTheFile) {
  setenv("MORTISE_STEP_IMPORTER", MORTISE_BIN_DIR "/mortise-import-step", 1);
  const auto file = test::data_folder() / "assemblies" / "derived_ftc10_signs.stp";
  MORTISE_NEEDS_DATA(file);
  const auto assembly = import_step(file);
  ASSERT_TRUE(assembly) << assembly.error().text;
  bool both_above = false, both_below = false, fit_in_pieces = false;
  for (const StepStatement& s : assembly->document.statements) {
    both_above |= std::fabs(s.upper - 0.015) < 1e-9 && std::fabs(s.lower - 0.002) < 1e-9;
    both_below |= std::fabs(s.upper + 0.007) < 1e-9 && std::fabs(s.lower + 0.02) < 1e-9;
    fit_in_pieces |= s.code == "G6";
  }
  EXPECT_TRUE(both_above);
  EXPECT_TRUE(both_below);
  EXPECT_TRUE(fit_in_pieces);
}

}  // namespace
}  // namespace mortise
