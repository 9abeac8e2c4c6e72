// What a command line names: files that are read and written, and numbers. The same rules hold for
// all programs.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/network/program.h"
#include "tests/support/programs.h"

namespace mortise::test {
namespace {

namespace fs = std::filesystem;

constexpr double kLong_s = 30.0;  // for a program that ends at once

class NamedFiles : public InFolder {
 protected:
  void SetUp() override {
    InFolder::SetUp();
    for (const char* name : {"a", "b"})
      ASSERT_EQ(
          run("mortise-generate", "block --out " + std::string(name) + ".obj", folder_).exit_code,
          0);
    file("s.yaml",
         "name: s\nunits: mm\nparts:\n  - {name: a, mesh: {file: a.obj, unit: mm}}\n"
         "  - {name: b, mesh: {file: b.obj, unit: mm}, moving: true}\n");
    file("m.csv",
         "id,path,ref_x,ref_y,ref_z,start_x,start_y,start_z,start_qw,start_qx,start_qy,start_qz,"
         "end_x,end_y,end_z,end_qw,end_qx,end_qy,end_qz\nm,linear,0,0,0,99,0,0,1,0,0,0,0,0,0,1,0,"
         "0,0\n");
    fs::create_symlink("a.obj", folder_ / "link.obj");
    ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  }
  std::string text(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  // The exit code; -1: it did not end.
  int run_in_time(const std::string& program, std::vector<std::string> arguments,
                  std::string* errors = nullptr) const {
    for (std::string& word : arguments)
      if (fs::exists(fs::symlink_status(folder_ / word)) && word != ".")
        word = (folder_ / word).string();
    Program one(folder_, program, arguments);
    const int code = one.wait(kLong_s);
    if (errors != nullptr) *errors = one.errors();
    return code;
  }
};

TEST_F(NamedFiles, NoOutputOverwritesAnInput) {
  const std::string contact = "--moving a.obj --static b.obj --motions m.csv --out ";
  const struct {
    std::string program, arguments, kept;
  } cases[] = {
      {"mortise-check", "s.yaml --csv s.yaml", "s.yaml"},
      {"mortise-check", "s.yaml --html ./s.yaml", "s.yaml"},
      {"mortise-check", "a.obj b.obj --junit link.obj", "a.obj"},
      {"mortise-check", "s.yaml --baseline m.csv --csv m.csv", "m.csv"},
      {"mortise-check", "s.yaml --csv a.obj", "a.obj"},  // named by the scenario alone
      {"mortise-check", "s.yaml --csv link.obj", "a.obj"},
      {"mortise-generate", "--scene s.yaml --out b.obj", "b.obj"},
      {"mortise-first-contact", contact + "a.obj", "a.obj"},
      {"mortise-first-contact", contact + "m.csv", "m.csv"},
      {"mortise-server", "s.yaml --no-log --duration 0.1 --stats s.yaml", "s.yaml"},
      {"mortise-server", "s.yaml --no-log --duration 0.1 --stats b.obj", "b.obj"},
      {"mortise-web", "--replay m.csv --addresses m.csv", "m.csv"},
      {"mortise-web", "--read-log m.csv --addresses m.csv", "m.csv"},
      {"mortise-web", "--tokens s.yaml --addresses s.yaml", "s.yaml"},
      {"mortise-web", "--certificate s.yaml --key m.csv --addresses s.yaml", "s.yaml"},
      {"mortise-web", "--certificate s.yaml --key m.csv --addresses m.csv", "m.csv"},
  };
  for (const auto& c : cases) {
    const std::string before = text(c.kept);
    const Outcome refused = run(c.program, c.arguments, folder_);
    EXPECT_NE(refused.exit_code, 0) << c.program << " " << c.arguments;
    EXPECT_NE(refused.err.find("would overwrite the input"), std::string::npos) << refused.err;
    EXPECT_EQ(text(c.kept), before) << c.program << " " << c.arguments;
  }
}

TEST_F(NamedFiles, NoTwoOutputsAreOneFile) {
  const std::string here = folder_.string();
  for (const std::string& other : {std::string("x.csv"), here + "/x.csv"}) {
    const Outcome refused = run("mortise-check", "s.yaml --csv x.csv --html " + other, folder_);
    EXPECT_EQ(refused.exit_code, 2) << other;
    EXPECT_NE(refused.err.find("--csv writes this one too"), std::string::npos) << refused.err;
    EXPECT_FALSE(fs::exists(folder_ / "x.csv"));
  }
  // What goes nowhere overwrites nothing, and a file of an earlier run is written again.
  for (int again = 0; again < 2; ++again)
    EXPECT_EQ(run("mortise-check", "s.yaml --csv x.csv --html /dev/null --junit /dev/null", folder_)
                  .exit_code,
              0);
}

TEST_F(NamedFiles, NoPipeAndNoDeviceIsRead) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
      {"mortise-lint", {"pipe"}},
      {"mortise-judge", {"pipe"}},
      {"mortise-check", {"s.yaml", "--baseline", "pipe"}},
      {"mortise-check", {"s.yaml", "--baseline", "/dev/zero"}},
      {"mortise-replay", {"info", "pipe"}},
      {"mortise-replay", {"verify", "pipe"}},
      {"mortise-replay", {"merge", "pipe"}},
      {"mortise-replay", {"merge", "/dev/zero"}},
      {"mortise-first-contact",
       {"--moving", "pipe", "--static", "a.obj", "--motions", "m.csv", "--json"}},
      {"mortise-first-contact",
       {"--moving", "a.obj", "--static", "a.obj", "--motions", "/dev/zero", "--json"}},
      {"mortise-bot", {"--behaviour", "script", "--play", "/dev/zero"}},
      {"mortise-server", {"pipe"}},
  };
  for (const auto& [program, arguments] : commands) {
    std::string errors;
    EXPECT_EQ(run_in_time(program, arguments, &errors), 3) << program << " " << arguments.back();
    EXPECT_NE(errors.find("is a pipe or a device"), std::string::npos) << program << errors;
  }
}

TEST_F(NamedFiles, AFolderIsNoFile) {
  for (const auto& [program, arguments] : {std::pair{"mortise-replay", "merge ."},
                                           std::pair{"mortise-check", "s.yaml --baseline ."}}) {
    const Outcome refused = run(program, arguments, folder_);
    EXPECT_EQ(refused.exit_code, 3) << program;
    EXPECT_NE(refused.err.find(".: is a folder; name a file"), std::string::npos) << refused.err;
  }
}

TEST_F(NamedFiles, AFullDiskIsAnErrorOfWhoWritesToIt) {
  for (const auto& [program, arguments] :
       {std::pair{"mortise-lint", "s.yaml"}, std::pair{"mortise-lint", "s.yaml --json"},
        std::pair{"mortise-judge", "s.yaml --json"}, std::pair{"mortise-check", "s.yaml"},
        std::pair{"mortise-inspect", "a.obj"}, std::pair{"mortise-generate", "--list"},
        std::pair{"mortise-first-contact",
                  "--moving a.obj --static b.obj --motions m.csv --json"}}) {
    const Outcome full = run(program, arguments + std::string(" >/dev/full"), folder_);
    EXPECT_EQ(full.exit_code, 1) << program << " " << arguments;
    EXPECT_NE(full.err.find("stdout cannot be written"), std::string::npos) << full.err;
  }
}

TEST_F(NamedFiles, AFileThatMayNotGrowIsAnErrorToo) {
  for (const auto& [program, arguments] : {std::pair{"mortise-generate", "gear --out gear.obj"},
                                           std::pair{"mortise-judge", "s.yaml --picture p.svg"},
                                           std::pair{"mortise-check", "s.yaml --html p.html"}}) {
    const std::string command = "cd '" + folder_.string() + "' && ulimit -f 8 && " +
                                MORTISE_BIN_DIR + "/" + program + " " + arguments +
                                " >/dev/null 2>&1";
    const int status = std::system(command.c_str());
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1) << program << " " << status;
  }
}

TEST_F(NamedFiles, NumbersAreFiniteAndWithinARangeThatCanBeRead) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
      {"mortise-check", {"s.yaml", "--min-gap", "nan"}},
      {"mortise-check", {"s.yaml", "--min-gap", "-1"}},
      {"mortise-check", {"s.yaml", "--min-gap", "0"}},
      {"mortise-check", {"s.yaml", "--min-gap", "1e300"}},
      {"mortise-judge", {"s.yaml", "--picture", "p.svg", "--region", "-1"}},
      {"mortise-first-contact",
       {"--moving", "a.obj", "--static", "b.obj", "--motions", "m.csv", "--json", "--accuracy-mm",
        "nan"}},
      {"mortise-first-contact",
       {"--moving", "a.obj", "--static", "b.obj", "--motions", "m.csv", "--json", "--accuracy-mm",
        "1e300"}},
      {"mortise-server", {"s.yaml", "--no-log", "--duration", "nan"}},
      {"mortise-server", {"s.yaml", "--no-log", "--duration", "inf"}},
      {"mortise-server", {"s.yaml", "--log-rotate", "nan"}},
      {"mortise-server", {"s.yaml", "--rate", "nan"}},
      {"mortise-bot", {"--rate", "nan"}},
      {"mortise-replay", {"play", "m.csv", "--wait", "nan"}},
  };
  for (const auto& [program, arguments] : commands) {
    std::string errors;
    const std::string& value = arguments.back();
    EXPECT_EQ(run_in_time(program, arguments, &errors), 2) << program << " " << value;
    EXPECT_LT(errors.size(), 120U) << errors;
  }
}

}  // namespace
}  // namespace mortise::test
