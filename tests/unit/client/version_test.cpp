#include <gtest/gtest.h>

#include "common/io/build_info.h"
#include "tests/network/program.h"

namespace mortise::test {
namespace {

TEST(Version, EachProgramSaysWhichBuildItIs) {
  const TestFolder folder;
  for (const char* name : {"server", "web", "bot", "replay", "directory", "judge", "lint",
                           "inspect", "first-contact", "generate", "keys"}) {
    const std::string program = std::string("mortise-") + name;
    if (!std::filesystem::exists(program_path(program))) continue;  // built without its libraries
    Program asked(folder.path(), program, {"--version"});
    EXPECT_EQ(asked.wait(10.0), 0) << asked.errors();
    EXPECT_EQ(asked.out(), version_line(program) + "\n");
  }
  EXPECT_NE(version_line("x").find(engine_version()), std::string::npos);
  EXPECT_NE(version_line("x").find(build_fingerprint().substr(0, 12)), std::string::npos);
}

}  // namespace
}  // namespace mortise::test
