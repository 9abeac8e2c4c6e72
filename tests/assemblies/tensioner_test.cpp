#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "client/tools/check/check_files.h"
#include "client/tools/check/check_tables.h"
#include "client/tools/check/check_text.h"
#include "common/session/tick/step.h"
#include "tests/assemblies/support.h"

// scenarios/tensioner.step, the assembly that the README shows, and its kept report. To keep a new
// one: MORTISE_KEEP=1, then read the difference.
namespace mortise {
namespace {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string report_of(test::Checked& c) {
  c.opened.scenario.file = "tensioner.step";
  return check_text(c.opened, c.report, {false, true});
}

TEST(Tensioner, ReportIsTheKeptOne) {
  const std::filesystem::path root = MORTISE_SOURCE_DIR,
                              kept = root / "tests/assemblies/tensioner.txt";
  test::Checked c = test::checked(root / "scenarios/tensioner.step");
  const std::string report = report_of(c);
  if (std::getenv("MORTISE_KEEP") != nullptr) std::ofstream(kept) << report;
  EXPECT_EQ(report, text_of(kept));
}

TEST(Tensioner, EveryRelationOccurs) {
  const test::Checked c =
      test::checked(std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/tensioner.step");
  EXPECT_GE(c.report.parts, 12U);
  std::set<MatingKind> relations;
  for (const CheckedPair& pair : c.report.pairs) relations.insert(pair.mating.relation);
  EXPECT_EQ(relations.size(), kMatingKindCount);  // of the clash it is not known
  EXPECT_EQ(c.report.counts.unexplained_real, 1U);
  EXPECT_EQ(c.report.counts.explained_real, 7U);
}

TEST(Tensioner, ReportsAreTheSameWhereverTheThreadsRun) {
  const auto file = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/tensioner.step";
  CheckOptions one, four;
  one.threads = 1;
  four.threads = 4;
  test::Checked a = test::checked(file, one), b = test::checked(file, four);
  EXPECT_EQ(report_of(a), report_of(b));
}

// A session of it begins with what the check found: what is explained is approved, the clash is
// new, and a part that was named stays where it is.
TEST(Tensioner, ASessionBeginsWithTheResult) {
  const test::TestFolder folder;
  CheckCommand command;
  command.files = {std::string(MORTISE_SOURCE_DIR) + "/scenarios/tensioner.step"};
  command.session = folder.path() / "session.yaml";
  command.fixed = {"base"};
  test::Checked c = test::checked(command.files.front());
  ASSERT_TRUE(write_check_files(c.opened, c.report, command));
  auto session = open_scene(command.session);
  ASSERT_TRUE(session && session->usable()) << (session ? "" : session.error().text);
  World& world = session->scene.world;
  for (const Part& part : world.parts) EXPECT_EQ(part.moving, part.name != "base") << part.name;
  Scratch scratch(1);
  std::map<std::string, std::size_t> reals;
  for (int i = 0; i < 10; ++i)
    for (const ClashEvent& event : step(world, {}, scratch).events)
      if (event.verdict.collision_class == CollisionClass::kReal)
        ++reals[event.review.comment.substr(0, event.review.comment.find(':'))];
  EXPECT_EQ(reals[""], 1U);
  reals.erase("");
  std::size_t approved = 0;
  for (const auto& [why, count] : reals) approved += count;
  EXPECT_EQ(approved, c.report.counts.explained_real);
}

TEST(Tensioner, TreeHasNamesAndColours) {
  const test::Checked c =
      test::checked(std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/tensioner.step");
  const Json json = check_json(c.opened, c.report);
  EXPECT_EQ(json.begin().key(), "counts");
  ASSERT_EQ(json.at("tree").size(), c.report.parts);
  std::map<std::string, std::string> colours;
  for (const Json& row : json.at("tree")) colours[row.at("part")] = row.at("colour");
  EXPECT_EQ(colours["bracket"], "#cc4444");
  EXPECT_EQ(colours["roller_2/wheel"], "#336699");
  const std::string page = check_page(c.opened, c.report);
  EXPECT_NE(page.find("roller_2</summary>"), std::string::npos);
  EXPECT_NE(page.find("color:#cc4444"), std::string::npos);
}

TEST(Tensioner, IssuesAreOfWhatNothingExplains) {
  const test::Checked c =
      test::checked(std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios/tensioner.step");
  const BcfProject project = check_bcf(c.opened, c.report, "2026-01-01T00:00:00Z");
  ASSERT_EQ(project.topics.size(), 1U);
  EXPECT_EQ(project.topics[0].parts[1], "bracket");
  EXPECT_EQ(project.topics[0].label, "real");
  EXPECT_FALSE(project.topics[0].png.empty());
  const test::TestFolder folder;
  EXPECT_TRUE(write_bcf(project, folder.path() / "a.bcf"));
  EXPECT_FALSE(write_bcf(project, folder.path() / "a.bcf"));
}

}  // namespace
}  // namespace mortise
