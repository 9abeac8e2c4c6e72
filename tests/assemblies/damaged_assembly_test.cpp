// An assembly of which one entity is missing, misspelt or not understood: the library leaves out
// what hangs on it, or puts it at the origin, and says nothing. The importer says so.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>

#include "tests/assemblies/support.h"

namespace mortise {
namespace {

std::string tensioner_text(const test::TestFolder& folder) {
  const std::string file = folder.path() / "whole.step";
  test::step_maker("tensioner '" + file + "'");
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Result<StepAssembly> imported(const test::TestFolder& folder, const std::string& text) {
  test::use_built_importer();
  const std::filesystem::path file = folder.path() / "damaged.step";
  std::ofstream(file, std::ios::binary) << text;
  return import_step(file);
}

// The text with the first match put otherwise.
std::string with(const std::string& text, const std::string& pattern,
                 const std::string& otherwise) {
  const std::string changed = std::regex_replace(text, std::regex(pattern), otherwise,
                                                 std::regex_constants::format_first_only);
  EXPECT_NE(changed, text) << pattern;
  return changed;
}

// The place of the first instance names the second of these.
std::string placement_of(const std::string& text) {
  std::smatch found;
  EXPECT_TRUE(std::regex_search(text, found,
                                std::regex(R"(ITEM_DEFINED_TRANSFORMATION\('','',#\d+,#(\d+)\))")));
  return found[1];
}

struct Damage {
  const char* what;
  std::string text;
  std::vector<std::string> notes;  // a piece of each
};

TEST(DamagedAssembly, WhatIsLeftOutIsTold) {
  const test::TestFolder folder;
  const std::string text = tensioner_text(folder), axes = placement_of(text);
  const auto whole = imported(folder, text);
  ASSERT_TRUE(whole) << whole.error().text;
  EXPECT_TRUE(whole->document.notes.empty());
  const std::string at = "#" + axes + " = AXIS2_PLACEMENT_3D";
  const std::vector<Damage> all = {
      {"a place is gone",
       with(text, R"(#\d+ = CONTEXT_DEPENDENT_SHAPE_REPRESENTATION[^;]*;\n)", ""),
       {"1 of its 18 places in assemblies"}},
      {"its axes are gone",
       with(text, at + R"([^;]*;\n)", ""),
       {"names #" + axes + ", which is not in the file"}},
      {"its axes are misspelt",
       with(text, at, "#" + axes + " = AXIS2_PLACEMNT_3D"),
       {"#" + axes + " AXIS2_PLACEMNT_3D was not read as it stands: its kind is not known"}},
      {"a number is a text",
       with(text, "(" + at + R"([^;]*;\n#\d+ = CARTESIAN_POINT\('',\()([^,]*),)", "$1'$2',"),
       {"CARTESIAN_POINT was not read as it stands: Parameter"}},
  };
  for (const Damage& damage : all) {
    SCOPED_TRACE(damage.what);
    const auto read = imported(folder, damage.text);
    ASSERT_TRUE(read) << read.error().text;
    for (const std::string& note : damage.notes)
      EXPECT_TRUE(std::ranges::any_of(read->document.notes,
                                      [&](auto& n) { return n.find(note) != std::string::npos; }))
          << note << " / " << testing::PrintToString(read->document.notes);
  }
}

TEST(DamagedAssembly, APlaceThatScalesOrMirrorsIsLeftOutAlone) {
  const test::TestFolder folder;
  const std::string text = tensioner_text(folder);
  const auto whole = imported(folder, text);
  ASSERT_TRUE(whole) << whole.error().text;
  for (const auto& [arguments, what] :
       {std::pair{"$$,$$,#99999,2.,$$", "scales a part"},
        std::pair{"#99998,#99996,#99999,1.,#99997", "mirrors a part"}}) {
    const auto read = imported(
        folder, with(text, R"(ITEM_DEFINED_TRANSFORMATION\('','',#\d+,#\d+\))",
                     "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',''," + std::string(arguments) +
                         ");\n#99999 = CARTESIAN_POINT('',(0.,0.,0.));\n"
                         "#99998 = DIRECTION('',(1.,0.,0.));\n#99997 = DIRECTION('',(0.,0.,1.));\n"
                         "#99996 = DIRECTION('',(0.,-1.,0.))"));
    ASSERT_TRUE(read) << read.error().text;
    const StepDocument& all = whole->document;
    ASSERT_EQ(read->document.instances.size(), all.instances.size() - 1) << what;
    for (const StepInstance& instance : read->document.instances)
      EXPECT_TRUE(std::ranges::any_of(all.instances, [&](const StepInstance& one) {
        return one.path == instance.path && one.X_WP.p == instance.X_WP.p;
      })) << instance.path;
    ASSERT_EQ(read->document.notes.size(), 1U);
    EXPECT_NE(read->document.notes[0].find(" was left out: "), std::string::npos);
    EXPECT_NE(read->document.notes[0].find(what), std::string::npos) << read->document.notes[0];
  }
}

}  // namespace
}  // namespace mortise
