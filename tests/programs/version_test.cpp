#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "common/io/build_info.h"
#include "tests/network/program.h"

namespace mortise::test {
namespace {

std::vector<std::string> commands() {
  std::vector<std::string> all;
  for (const auto& entry : std::filesystem::directory_iterator(MORTISE_BIN_DIR)) {
    const std::string program = entry.path().filename();
    if (program.starts_with("mortise-") && !program.starts_with("mortise-import"))
      all.push_back(program);
  }
  return all;
}

std::string said_to(const std::string& program, const std::string& option) {
  const TestFolder folder;
  Program one(folder.path(), program, {option});
  EXPECT_EQ(one.wait(60.0), 0) << program << ": " << one.errors();
  return one.out();
}

TEST(Version, EachProgramSaysWhichBuildItIs) {
  EXPECT_GE(commands().size(), 12u);
  for (const std::string& program : commands())
    EXPECT_EQ(said_to(program, "--version"), version_line(program) + "\n");
  EXPECT_NE(version_line("x").find(engine_version()), std::string::npos);
  EXPECT_NE(version_line("x").find(build_fingerprint().substr(0, 12)), std::string::npos);
}

// One word, one meaning: --log says where a log is written, which the server alone does.
TEST(Options, OnlyTheServerHasALogToWrite) {
  for (const std::string& program : commands()) {
    const bool has_log = said_to(program, "--help").find("  --log ") != std::string::npos;
    EXPECT_EQ(has_log, program == "mortise-server") << program;
  }
}

TEST(Options, TheGatewayTakesTheOldNameOfTheLogThatItReads) {
  const TestFolder folder;
  Program web(folder.path(), "mortise-web",
              {"--log", "none.mcap", "--page", "nowhere", "--addresses", "-"});
  web.wait(60.0);
  EXPECT_EQ(web.errors().find("mortise-web: --log is called --read-log now\n"), 0u) << web.errors();
  EXPECT_EQ(web.errors().find("no such option"), std::string::npos) << web.errors();
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
