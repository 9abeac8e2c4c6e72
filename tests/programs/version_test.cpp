#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "common/io/build_info.h"
#include "tests/network/program.h"

namespace mortise::test {
namespace {

TEST(Version, EachProgramSaysWhichBuildItIs) {
  const TestFolder folder;
  int asked = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MORTISE_BIN_DIR)) {
    const std::string program = entry.path().filename();
    if (!program.starts_with("mortise-") || program.starts_with("mortise-import"))
      continue;  // no command
    Program one(folder.path(), program, {"--version"});
    EXPECT_EQ(one.wait(60.0), 0) << program << ": " << one.errors();
    EXPECT_EQ(one.out(), version_line(program) + "\n");
    ++asked;
  }
  EXPECT_GE(asked, 12);
  EXPECT_NE(version_line("x").find(engine_version()), std::string::npos);
  EXPECT_NE(version_line("x").find(build_fingerprint().substr(0, 12)), std::string::npos);
}

TEST(Version, FilesThatNobodyConfiguresSayTheSame) {
  for (const auto& [file, words] :
       {std::pair{"client/freecad/package.xml", "<version>" + engine_version() + "<"},
        std::pair{"CHANGELOG.md", "\n## [" + engine_version() + "]"}}) {
    std::ostringstream text;
    text << std::ifstream(std::string(MORTISE_SOURCE_DIR "/") + file).rdbuf();
    EXPECT_NE(text.str().find(words), std::string::npos) << file << " does not say " << words;
  }
}

}  // namespace
}  // namespace mortise::test
