#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/io/mesh/confined_child.h"
#include "tests/support/effort.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

// A dialogue with a shell script in place of an importer.
class Dialogue : public testing::Test {
 protected:
  Result<ConfinedDialogue> started(const std::string& script, double seconds = 20.0) const {
    const std::string file = folder_.path() / "child.sh";
    std::ofstream(file) << script;
    ConfinedChild child;
    child.called = "child";
    child.program = "/bin/sh";
    child.file = file;
    child.arguments = {file};
    child.limits.seconds = seconds;
    child.cpu = {seconds, 0.0};
    return ConfinedDialogue::start(child);
  }
  static std::string text(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  static std::span<const std::byte> bytes(const std::string& text) {
    return std::as_bytes(std::span(text));
  }

  test::TestFolder folder_;
};

constexpr const char* kSaysFive = "printf first; printf '\\005\\0\\0\\0\\0\\0\\0\\0' >&0\n";

TEST_F(Dialogue, AnswersAfterItsFirstWord) {
  auto dialogue = started(std::string(kSaysFive) + "q=$(cat); printf \"second to $q\"\n");
  ASSERT_TRUE(dialogue) << dialogue.error().text;
  EXPECT_EQ(text(dialogue->take_said()), "first");
  const auto answer = dialogue->ask(bytes("this"), 20.0);
  ASSERT_TRUE(answer) << answer.error().text;
  EXPECT_EQ(text(*answer), "second to this");
  EXPECT_FALSE(dialogue->ask(bytes("more"), 20.0));
}

TEST_F(Dialogue, ALongQuestionArrivesWhole) {
  auto dialogue = started(std::string(kSaysFive) + "cat | wc -c\n");
  ASSERT_TRUE(dialogue) << dialogue.error().text;
  const auto answer = dialogue->ask(bytes(std::string(3'000'000, 'x')), 20.0);
  ASSERT_TRUE(answer) << answer.error().text;
  EXPECT_EQ(text(*answer), "3000000\n");
}

TEST_F(Dialogue, EveryEndIsOneLine) {
  for (const auto& [script, said] : {
           std::pair{"exit 3", "ended with code 3"},
           {"kill -SEGV $$", "SIGSEGV"},
           {"printf '\\005\\0\\0\\0\\0\\0\\0\\0' >&0; exec sleep 9", "less than it said"},
           {"printf first; printf '\\005\\0\\0' >&0", "ended with code 0"},
       }) {
    const auto dialogue = started(script);
    ASSERT_FALSE(dialogue) << script;
    EXPECT_NE(dialogue.error().text.find(said), std::string::npos) << dialogue.error().text;
    EXPECT_EQ(dialogue.error().text.find('\n'), std::string::npos);
  }
  auto dies = started(std::string(kSaysFive) + "cat > /dev/null; kill -SEGV $$");
  ASSERT_TRUE(dies) << dies.error().text;
  EXPECT_FALSE(dies->ask(bytes("this"), 20.0));
}

TEST_F(Dialogue, NobodyWaitsLongerThanAllowed) {
  const auto begin = std::chrono::steady_clock::now();
  const auto silent = started("exec sleep 60", 1.0);
  ASSERT_FALSE(silent);
  EXPECT_NE(silent.error().text.find("took longer than 1.0 s"), std::string::npos)
      << silent.error().text;
  EXPECT_FALSE(started("exec sleep 60 <&-", 1.0));  // one that closes its socket as well
  auto deaf = started(std::string(kSaysFive) + "exec sleep 60");
  ASSERT_TRUE(deaf) << deaf.error().text;
  EXPECT_FALSE(deaf->ask(bytes(std::string(3'000'000, 'x')), 1.0));
  {
    const auto left = started(std::string(kSaysFive) + "exec sleep 60");  // ends with its owner
    EXPECT_TRUE(left);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (test::timed()) {
    EXPECT_LT(took.count(), 30.0);
  }
}

}  // namespace
}  // namespace mortise
