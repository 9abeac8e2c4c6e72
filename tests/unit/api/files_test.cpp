// Files: parts, assemblies, checks, logs.
#include <mortise/io.h>

#include "tests/support/programs.h"
#include "tests/unit/api/scene.h"

namespace mortise::test {
namespace {

const std::string kScenarios = MORTISE_SOURCE_DIR "/scenarios/";
const std::string kLog = MORTISE_SOURCE_DIR "/tests/golden/thin_wall.mcap";

#define MORTISE_NEEDS_STEP()                                            \
  if (!std::filesystem::exists(MORTISE_BIN_DIR "/mortise-import-step")) \
  GTEST_SKIP() << "program absent: OpenCASCADE (packages-step.txt)"

struct Files : InFolder {};

TEST_F(Files, APartIsReadInItsUnit) {
  ASSERT_TRUE(save_stl(cube(10, "cube"), (folder_ / "cube.stl").string()));
  const std::string file = (folder_ / "cube.stl").string();
  EXPECT_NEAR(made(load(file)).volume_mm3(), 1e3, 1e-3);
  EXPECT_NEAR(made(load(file, cm)).volume_mm3(), 1e6, 1.0);
  EXPECT_EQ(made(load(file)).name(), "cube");
  const auto none = load((folder_ / "none.stl").string());
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Code::kNotFound);
  EXPECT_FALSE(load(file, {0.0}));
  EXPECT_FALSE(load(kScenarios + "gearbox.yaml"));
  EXPECT_FALSE(load_assembly(file));
  EXPECT_FALSE(save_stl(cube(10, "cube"), "/nowhere/cube.stl"));
}

TEST_F(Files, AnAssemblyHasPartsWithPlaces) {
  MORTISE_NEEDS_STEP();
  const auto parts = load_assembly(kScenarios + "tensioner.step");
  ASSERT_TRUE(parts) << why(parts.error());
  EXPECT_EQ(parts->size(), 19u);
  const auto cover = std::find_if(parts->begin(), parts->end(),
                                  [](const PlacedPart& p) { return p.part.name() == "cover"; });
  ASSERT_NE(cover, parts->end());
  EXPECT_FALSE(cover->part.features().empty());
  const auto many = load(kScenarios + "tensioner.step");
  ASSERT_FALSE(many);
  EXPECT_NE(many.error().text.find("has 19 parts"), std::string::npos);
}

TEST_F(Files, ACheckIsThatOfTheProgram) {
  MORTISE_NEEDS_STEP();
  const Outcome program =
      run("mortise-check", kScenarios + "tensioner.step --json --min-gap 0.3", folder_);
  ASSERT_EQ(program.exit_code, 0) << program.err;
  const auto report = check(kScenarios + "tensioner.step", {.min_gap_mm = 0.3});
  ASSERT_TRUE(report) << why(report.error());
  EXPECT_EQ(report->json, program.out);
  EXPECT_EQ(report->counts.at("unexplained_real"), 1u);
  EXPECT_EQ(report->counts.at("explained_real"), 7u);
  EXPECT_EQ(report->near.size(), report->counts.at("near"));
  const CheckedPair& worst = report->pairs.front();
  EXPECT_TRUE(worst.is_clash());
  EXPECT_EQ(worst.part_a, "cover");
  EXPECT_EQ(worst.part_b, "bracket");
  ASSERT_TRUE(worst.common_mm3);
  EXPECT_NEAR(*worst.common_mm3, 138.973, 1e-3);
  ASSERT_FALSE(worst.places.empty());
  ASSERT_TRUE(worst.places.front().way_out);
  EXPECT_EQ(std::count_if(report->pairs.begin(), report->pairs.end(),
                          [](const CheckedPair& p) { return p.is_clash(); }),
            1);
  EXPECT_TRUE(report->html.empty());
}

TEST_F(Files, ABaselineTellsWhatIsNew) {
  MORTISE_NEEDS_STEP();
  const auto before = check(kScenarios + "tensioner.step");
  ASSERT_TRUE(before);
  auto old = nlohmann::json::parse(before->json);
  old["pairs"].erase(0);
  const auto now = check(kScenarios + "tensioner.step",
                         {.baseline = file("old.json", old.dump()), .html = true});
  ASSERT_TRUE(now) << why(now.error());
  EXPECT_NE(now->text.find("1 new, 0 gone"), std::string::npos) << now->text;
  EXPECT_NE(now->html.find("<svg"), std::string::npos);
}

TEST_F(Files, WhatIsWrongWithACheckIsSaid) {
  const auto said = [](const auto& report) { return report ? "" : report.error().text; };
  EXPECT_NE(said(check("none.step")).find("no such file"), std::string::npos);
  EXPECT_NE(said(check_meshes({})), "");
  EXPECT_NE(said(check_meshes({"a.yaml", "b.yaml"})).find("not a.yaml and b.yaml"),
            std::string::npos);
  EXPECT_NE(said(check("a.yaml", {.fit = "H7/g6"})), "");
  EXPECT_NE(said(check("a.yaml", {.general = "ISO 2768-m"})), "");
  EXPECT_NE(said(check("a.yaml", {.threads = 0})), "");
  EXPECT_NE(said(check("a.yaml", {.no_explain = {"glue"}})).find("glue"), std::string::npos);
  EXPECT_NE(said(check_meshes({"a.stl", "b.stl"}, {.unit = {3.0}})), "");
}

TEST(Logs, AreTables) {
  const auto log = read_log(kLog);
  ASSERT_TRUE(log) << why(log.error());
  EXPECT_TRUE(log->complete);
  const auto clashes = std::find_if(log->tables.begin(), log->tables.end(),
                                    [](const Table& table) { return table.name == "clashes"; });
  ASSERT_NE(clashes, log->tables.end());
  for (const Column& column : clashes->columns)
    EXPECT_EQ(column.is_text ? column.texts.size() : column.numbers.size(), 1u) << column.name;
  const auto verified = verify_log(kLog);
  ASSERT_TRUE(verified) << why(verified.error());
  EXPECT_EQ(*verified, 68u);
  EXPECT_FALSE(read_log(kScenarios + "gearbox.yaml"));
  EXPECT_FALSE(verify_log(kLog, 0));
}

}  // namespace
}  // namespace mortise::test
