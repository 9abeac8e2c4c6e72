// What stands in the way of a server is one clear line, and an exit code; never a core, and never a
// server that nobody can reach.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/network/domain.h"
#include "tests/network/program.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

namespace fs = std::filesystem;

struct Started {
  int code = -1;
  std::string said;
  std::size_t lines() const {
    return static_cast<std::size_t>(std::count(said.begin(), said.end(), '\n'));
  }
};

class StartUp : public ::testing::Test {
 protected:
  /// A program below limits of the shell ("ulimit -n 8"), to its end; what it says on stderr.
  Started run(const std::string& limits, const std::string& program, const std::string& arguments) {
    // The shell needs files of its own for what it redirects.
    const std::string command = "exec 2>&1 >/dev/null; cd '" + folder_.path().string() + "'; " +
                                limits + "; exec '" + program_path(program).string() + "' " +
                                arguments;
    Started started;
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 512> text{};
    while (std::fgets(text.data(), static_cast<int>(text.size()), pipe))
      started.said += text.data();
    const int status = pclose(pipe);
    started.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return started;
  }
  Started serve(const std::string& limits, const std::string& more) {
    return run(limits, "mortise-server",
               scenario_ + " --quiet --duration 0.2 --domain " + std::to_string(own_domain()) +
                   " " + more);
  }
  std::size_t logs_in(const std::string& name) const {
    std::size_t logs = 0;
    for (const auto& entry : fs::directory_iterator(folder_.path() / name))
      logs += entry.path().extension() == ".mcap";
    return logs;
  }

  TestFolder folder_;
  const std::string scenario_ = folder_.write("blocks.yaml", blocks_yaml());
};

TEST_F(StartUp, AFolderForLogsIsMade) {
  for (const char* folder : {"new/", "other", "deep/er/", "with.dot"}) {
    const std::string name = folder;
    const Started started = serve("true", "--log " + name);
    EXPECT_EQ(started.code, 0) << started.said;
    ASSERT_TRUE(fs::is_directory(folder_.path() / name)) << name;
    EXPECT_EQ(logs_in(name), 1U) << name;
  }
  EXPECT_EQ(serve("true", "--log new").code, 0);
  EXPECT_EQ(logs_in("new"), 2U);
  EXPECT_EQ(serve("true", "--log one.mcap").code, 0);
  EXPECT_TRUE(fs::is_regular_file(folder_.path() / "one.mcap"));
  const Started again = serve("true", "--log one.mcap");
  EXPECT_EQ(again.code, 1);
  EXPECT_NE(again.said.find("a log is never overwritten"), std::string::npos) << again.said;
}

TEST_F(StartUp, AnEmptyNewestLogIsPassedOverAndSaid) {
  ASSERT_EQ(serve("true", "--log logs").code, 0);
  std::ofstream(folder_.path() / "logs/default-20990101-000000.mcap");
  const Started started = serve("true", "--restore logs --log logs");
  EXPECT_EQ(started.code, 0) << started.said;
  EXPECT_NE(started.said.find("is empty; there is nothing to read; the log before it is taken"),
            std::string::npos)
      << started.said;
}

TEST_F(StartUp, ABrokenNewestLogIsPassedOverAndSaid) {
  ASSERT_EQ(serve("true", "--log logs").code, 0);
  const fs::path good = fs::directory_iterator(folder_.path() / "logs")->path();
  std::ifstream in(good, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  ASSERT_GT(bytes.size(), 1000U);
  const std::string broken[] = {
      std::string(5000, 'x'),                               // of something else
      bytes.substr(0, 60),                                  // cut off in its front
      bytes.substr(0, 8) + std::string(bytes.size(), '\0')  // whose blocks never came to disk
  };
  for (const std::string& text : broken) {
    const fs::path newest = folder_.path() / "logs/default-20990101-000000.mcap";
    std::ofstream(newest, std::ios::binary) << text;
    const Started started = serve("true", "--restore logs --log other");
    EXPECT_EQ(started.code, 0) << started.said;
    EXPECT_NE(started.said.find(newest.filename().string() + ": "), std::string::npos);
    EXPECT_NE(started.said.find("the log before it is taken: logs/" + good.filename().string()),
              std::string::npos)
        << started.said;
    const Started alone = serve("true", "--restore " + newest.string() + " --log other");
    EXPECT_EQ(alone.code, 3) << "by its name there is none before it: " << alone.said;
    EXPECT_EQ(alone.lines(), 1U) << alone.said;
  }
}

TEST_F(StartUp, WithoutFilesThreadsOrMemoryItSaysSoAndEnds) {
  for (const char* program : {"mortise-server", "mortise-bot"}) {
    const std::string arguments = program == std::string("mortise-server")
                                      ? scenario_ + " --no-log --duration 0.2 --quiet"
                                      : "--wait 0.2";
    for (const int files : {8, 12, 20, 30}) {
      const Started started = run("ulimit -n " + std::to_string(files), program, arguments);
      EXPECT_NE(started.code, 0) << program << ", " << files << " files: " << started.said;
      EXPECT_LT(started.code, 128) << program << ", " << files << " files: " << started.said;
      EXPECT_EQ(started.lines(), 1U) << program << ", " << files << " files: " << started.said;
      EXPECT_NE(started.said.find("ulimit -n"), std::string::npos) << started.said;
    }
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  int refused = 0;
  for (int kB = 60'000; kB <= 240'000; kB += 12'000) {
    const Started started = serve("ulimit -v " + std::to_string(kB), "--no-log");
    if (started.code == 127) continue;  // its libraries do not fit
    EXPECT_LT(started.code, 128) << kB << " kB: " << started.said;
    if (started.code == 0) continue;
    ++refused;
    EXPECT_EQ(started.lines(), 1U) << kB << " kB: " << started.said;
    EXPECT_NE(started.said.find("ulimit -v"), std::string::npos) << kB << " kB: " << started.said;
  }
  EXPECT_GT(refused, 0);
#endif
}

}  // namespace
}  // namespace mortise::test
