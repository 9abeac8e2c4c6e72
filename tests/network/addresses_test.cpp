// Where mortise-web says the addresses that let people in, and where it must not. No server is
// needed for that.
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

#include "tests/network/domain.h"
#include "tests/network/program.h"

namespace mortise::test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Addresses : testing::Test {
  Addresses() { folder.write("index.html", "<!doctype html>"); }

  std::vector<std::string> words(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {
        "--domain", std::to_string(own_domain()), "--http-port", "0", "--page", folder.path()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Until `done`, then told to end; what it said on both ways.
  template <class Done>
  std::string said_until(const std::vector<std::string>& more, Done done) {
    Program web(folder.path(), "mortise-web", words(more));
    using clock = std::chrono::steady_clock;
    const auto end = clock::now() + std::chrono::duration<double>(kPatience_s);
    while (web.running() && !done(web) && clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_TRUE(done(web)) << web.out() << web.errors();
    web.signal(SIGTERM);
    EXPECT_EQ(web.wait(kPatience_s), 0) << web.errors();
    return web.out() + web.errors();
  }

  TestFolder folder;
  const std::string people =
      "designer anna 0123456789abcdef0123\nobserver otto fedcba98765432100\n";
};

TEST_F(Addresses, WithoutATerminalNoTokenIsSaid) {
  const std::string tokens = folder.write("tokens", people);
  const std::string said = said_until({"--tokens", tokens}, [](const Program& web) {
    return web.out().find("\n") != std::string::npos;
  });
  EXPECT_NE(said.find("open http://127.0.0.1:"), std::string::npos) << said;
  EXPECT_NE(said.find("#token=TOKEN with a token of " + tokens), std::string::npos) << said;
  EXPECT_EQ(said.find("0123456789abcdef0123"), std::string::npos) << said;
  EXPECT_EQ(said.find("fedcba98765432100"), std::string::npos) << said;
}

TEST_F(Addresses, AFileIsForItsOwnerOnly) {
  const std::string tokens = folder.write("tokens", people),
                    file = folder.write("addresses", "old");
  fs::permissions(file, fs::perms(0644));
  const std::string said = said_until({"--tokens", tokens, "--addresses", file},
                                      [&](const Program&) { return text_of(file) != "old"; });
  EXPECT_EQ(said.find("0123456789abcdef0123"), std::string::npos) << said;
  const std::string lines = text_of(file);
  EXPECT_EQ(lines.find("designer anna http://127.0.0.1:"), 0u) << lines;
  EXPECT_NE(lines.find("#token=0123456789abcdef0123\nobserver otto http://"), std::string::npos)
      << lines;
  EXPECT_EQ(fs::status(file).permissions(), fs::perms(0600));
}

TEST_F(Addresses, StdoutWhenItIsAskedFor) {
  const std::string said = said_until({"--addresses", "-"}, [](const Program& web) {
    return web.out().find("\nobserver http://") != std::string::npos;
  });
  EXPECT_EQ(said.find("designer http://127.0.0.1:"), 0u) << said;
}

TEST_F(Addresses, TokensThatNobodyWouldLearnAreNoUse) {
  Program web(folder.path(), "mortise-web", words({}));
  EXPECT_EQ(web.wait(kPatience_s), 2);
  EXPECT_NE(web.errors().find("--addresses FILE"), std::string::npos) << web.errors();
  EXPECT_EQ(web.out(), "");
}

TEST_F(Addresses, WhatIsNoFileIsNotReplaced) {
  Program web(folder.path(), "mortise-web", words({"--addresses", folder.path()}));
  EXPECT_EQ(web.wait(kPatience_s), 3);
  EXPECT_NE(web.errors().find("exists and is not a file"), std::string::npos) << web.errors();
}

TEST_F(Addresses, ATerminalIsToldThem) {
  const std::string program = program_path("mortise-web").string();
  const std::vector<std::string> arguments = words({"--quiet"});
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& word : arguments) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  int terminal = -1;
  const pid_t pid = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (pid == 0) {
    execv(argv[0], argv.data());
    _exit(127);
  }
  ASSERT_GT(pid, 0);
  std::string said;
  char part[512];
  for (ssize_t got = 0; said.find("observer http://") == std::string::npos;
       said.append(part, static_cast<std::size_t>(got)))
    if ((got = read(terminal, part, sizeof part)) <= 0) break;
  EXPECT_NE(said.find("designer http://127.0.0.1:"), std::string::npos) << said;
  EXPECT_NE(said.find("observer http://127.0.0.1:"), std::string::npos) << said;
  kill(pid, SIGTERM);
  waitpid(pid, nullptr, 0);
  close(terminal);
}

}  // namespace
}  // namespace mortise::test
