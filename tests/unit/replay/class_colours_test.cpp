// One table of colours for page, report and pictures, and heat on the scale of the thresholds.
#include "client/picture/class_colours.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "client/picture/heat.h"
#include "client/report/html_page.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

constexpr CollisionClass kClasses[] = {CollisionClass::kReal, CollisionClass::kPotential,
                                       CollisionClass::kFake};

std::string page_file(const char* name) {
  std::ifstream in(std::string(MORTISE_SOURCE_DIR) + "/client/web/page/" + name);
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_FALSE(text.str().empty()) << name;
  return text.str();
}

TEST(ClassColours, ThePageHasTheSameTable) {
  const std::string table = page_file("session/class_colours.js"), style = page_file("style.css");
  for (const CollisionClass c : kClasses) {
    const ClassColours of = class_colours(c);
    const std::string line =
        fmt::format("{}: {{ light: 0x{:06x}, dark: 0x{:06x}, heat: [0x{:06x}, 0x{:06x}] }}",
                    name_of(c), of.light, of.dark, of.heat_light, of.heat_deep);
    EXPECT_NE(table.find(line), std::string::npos) << line;
    for (const std::uint32_t colour : {of.light, of.dark}) {
      const std::string variable = fmt::format("--{}: #{:06x};", name_of(c), colour);
      EXPECT_NE(style.find(variable), std::string::npos) << variable;
      EXPECT_NE(report_style().find(variable), std::string::npos) << variable;
    }
  }
}

ContactMark mark(CollisionClass c, double overlap_mm) {
  ContactMark mark;
  mark.collision_class = c;
  mark.overlap_mm = overlap_mm;
  mark.fake_below_mm = 0.05;
  mark.real_above_mm = 0.07;
  return mark;
}

TEST(Heat, AFakeClashIsNeverRed) {
  for (const double overlap_mm : {0.0, 0.02, 0.05, 5.0}) {
    const Color color = color_of(heat_of(mark(CollisionClass::kFake, overlap_mm)));
    EXPECT_GT(color.blue, color.red) << overlap_mm;
  }
  const Color real = color_of(heat_of(mark(CollisionClass::kReal, 0.071)));
  EXPECT_GT(real.red, real.blue);
}

TEST(Heat, RisesWithTheOverlapAndWithTheClass) {
  const Heat rising[] = {
      heat_of({}),
      heat_of(mark(CollisionClass::kFake, 0.01)),
      heat_of(mark(CollisionClass::kFake, 0.05)),
      heat_of(mark(CollisionClass::kPotential, 0.055)),
      heat_of(mark(CollisionClass::kPotential, 0.07)),
      heat_of(mark(CollisionClass::kReal, 0.075)),
      heat_of(mark(CollisionClass::kReal, 0.5)),
  };
  for (std::size_t i = 1; i < std::size(rising); ++i) {
    EXPECT_LT(rising[i - 1], rising[i]) << i;
    EXPECT_LT(rising[i - 1].share(), rising[i].share()) << i;
  }
  EXPECT_EQ(std::rbegin(rising)->share(), 1.0);
}

}  // namespace
}  // namespace mortise
