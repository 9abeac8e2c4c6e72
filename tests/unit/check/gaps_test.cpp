#include <gtest/gtest.h>

#include <fstream>

#include "client/tools/check/check.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

// Three blocks in a row, 0.2 mm and 0.4 mm apart.
CheckReport report_of(const std::string& gaps) {
  const test::TestFolder folder;
  const std::filesystem::path file = folder.path() / "row.yaml";
  std::ofstream(file) << "name: row\nunits: mm\nparts:\n"
                         "  - {name: a, generator: {kind: block}}\n"
                         "  - {name: b, generator: {kind: block}, moving: true, "
                         "pose: {position: [20.2, 0, 0]}}\n"
                         "  - {name: c, generator: {kind: block}, moving: true, "
                         "pose: {position: [40.6, 0, 0]}}\n"
                      << gaps;
  auto opened = open_scene(file);
  EXPECT_TRUE(opened && opened->usable());
  return check_scene(*opened, {});
}

std::vector<double> required(const CheckReport& report) {
  std::vector<double> all;
  for (const NearPair& pair : report.near) all.push_back(pair.required_mm);
  return all;
}

TEST(Gaps, OnesOfPairsStandInsteadOfThatOfAll) {
  EXPECT_FALSE(report_of("").asks_gaps);
  EXPECT_EQ(required(report_of("min_gap: 0.5\n")), (std::vector{0.5, 0.5}));
  const CheckReport own =
      report_of("min_gap: 0.5\nmin_gaps:\n  - {between: [a, b], min_gap: 0.1}\n");
  ASSERT_EQ(required(own), std::vector{0.5});
  EXPECT_NEAR(own.near[0].gap_mm.lo, 0.4, 1e-6);
  EXPECT_EQ(required(report_of("min_gaps:\n  - {between: [\"*\", c], min_gap: 0.5}\n"
                               "  - {between: [b, c], min_gap: 0.6}\n")),
            std::vector{0.6});
}

}  // namespace
}  // namespace mortise
