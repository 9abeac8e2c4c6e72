// Who leads, who stands by, and nobody: what mortise-directory says of servers that run as
// programs.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "idl/directory.h"
#include "tests/network/domain.h"
#include "tests/network/guest.h"
#include "tests/network/key_ring.h"
#include "tests/network/program.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

class DirectoryOfSessions : public ::testing::Test {
 protected:
  std::unique_ptr<Program> start(int domain, const std::string& session,
                                 std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain), "--log", logs()});
    if (session != "default") arguments.insert(arguments.end(), {"--session", session});
    auto server = std::make_unique<Program>(folder_.path(), "mortise-server", arguments);
    if (arguments.front() == "--standby-of") {
      EXPECT_TRUE(says(*server, "in step")) << server->errors();
    }
    return server;
  }
  std::unique_ptr<Program> lead(int domain, const std::string& session,
                                std::vector<std::string> more = {}) {
    more.insert(more.begin(), folder_.write("blocks.yaml", blocks_yaml()));
    return start(domain, session, more);
  }
  bool says(const Program& server, const std::string& text) {
    for (const double end_s = steady_s() + kPatience_s; steady_s() < end_s;) {
      if (server.errors().find(text) != std::string::npos) return true;
      if (guest_ != nullptr) guest_->listen();  // who is silent meanwhile is gone
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  /// Its answer, and the exit code that was wanted.
  nlohmann::json ask(std::vector<std::string> arguments, int exit_code = 0) {
    arguments.push_back("--json");
    Program directory(folder_.path(), "mortise-directory", arguments);
    // Who is silent meanwhile is gone.
    while (guest_ != nullptr && directory.running()) guest_->until(0.01, [] { return false; });
    EXPECT_EQ(directory.wait(kPatience_s), exit_code) << directory.errors();
    errors_ = directory.errors();
    const auto answer = nlohmann::json::parse(directory.out(), nullptr, false);
    EXPECT_TRUE(answer.contains("servers")) << directory.out();
    return answer.contains("servers") ? answer["servers"] : nlohmann::json::array();
  }
  static nlohmann::json row(const nlohmann::json& servers, const std::string& session,
                            const std::string& place) {
    for (const auto& server : servers)
      if (server["session"] == session && server["place"] == place) return server;
    ADD_FAILURE() << "nobody " << place << " in " << session << ": " << servers.dump();
    return nlohmann::json::object();
  }
  std::string logs() const { return folder_.path().string() + "/logs"; }
  void SetUp() override { std::filesystem::create_directories(logs()); }

  const int domain_ = take_domains(2), other_ = domain_ + 1;
  TestFolder folder_;
  Guest* guest_ = nullptr;
  std::string errors_;
};

TEST_F(DirectoryOfSessions, ListsWhoLeadsAndWhoStandsBy) {
  const auto hall = lead(domain_, "default"), yard = lead(other_, "yard");
  Guest anna(domain_, "anna");
  ASSERT_TRUE(anna.joined());
  guest_ = &anna;
  const auto second = start(domain_, "default", {"--standby-of", "default", "--restore", logs()});
  const auto servers = ask({"--domain", std::to_string(domain_) + "-" + std::to_string(other_)});
  ASSERT_EQ(servers.size(), 3u) << servers.dump();
  const auto of_hall = row(servers, "default", "leads");
  EXPECT_EQ(of_hall["domain"], domain_);
  EXPECT_EQ(of_hall["address"], "127.0.0.1");
  EXPECT_EQ(of_hall["port"], 7402 + 250 * domain_);
  EXPECT_EQ(of_hall["users"], 1);
  EXPECT_EQ(of_hall["parts"], anna.client->parts().size());
  EXPECT_EQ(of_hall["tick_rate_hz"], 60.0);
  EXPECT_GT(of_hall["load"], 0.0);
  EXPECT_GT(of_hall["term_ms"], 1'600'000'000'000u);
  EXPECT_FALSE(of_hall["version"].get<std::string>().empty());
  const auto waits = row(servers, "default", "stands by");
  EXPECT_EQ(waits["port"], 7404 + 250 * domain_);
  EXPECT_EQ(waits["term_ms"], 0);
  EXPECT_EQ(waits["version"], of_hall["version"]);
  EXPECT_TRUE(waits["users"].is_null());
  const auto of_yard = row(servers, "yard", "leads");
  EXPECT_EQ(of_yard["domain"], other_);
  EXPECT_EQ(of_yard["users"], 0) << "a server tells its load with nobody there";

  hall->signal(SIGKILL);
  EXPECT_EQ(hall->wait(kPatience_s), 128 + SIGKILL);
  ASSERT_TRUE(says(*second, "taken over at tick"));
  const auto after = ask({"--domain", std::to_string(domain_)});
  ASSERT_EQ(after.size(), 1u) << after.dump();
  EXPECT_EQ(row(after, "default", "leads")["port"], 7404 + 250 * domain_);
  EXPECT_GT(row(after, "default", "leads")["term_ms"], of_hall["term_ms"]);
}

/// One that is frozen and overtaken is told apart from the one that leads, until it is known to be
/// gone; asked in this process, which listens all the while.
TEST_F(DirectoryOfSessions, TellsTheOvertakenFromTheOneThatLeads) {
  const auto first = lead(domain_, "default");
  DdsOptions options;
  options.domain = domain_;
  options.session = kEverySession;
  const auto directory = open_directory(options);
  ASSERT_TRUE(directory) << directory.error().text;
  const auto port_that = [&](KnownServer::Place place) {
    std::vector<int> ports;
    for (const KnownServer& server : (*directory)->known())
      if (server.place == place) ports.push_back(server.port);
    EXPECT_LE(ports.size(), 1u);
    return ports.empty() ? 0 : ports.front();
  };
  const auto becomes = [&](KnownServer::Place place, int port) {
    for (const double end_s = steady_s() + 5.0; steady_s() < end_s;) {
      if (port_that(place) == port) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  };
  using Place = KnownServer::Place;
  const int first_port = 7402 + 250 * domain_, second_port = first_port + 2;
  ASSERT_TRUE(becomes(Place::kLeads, first_port));
  const auto second = start(domain_, "default", {"--standby-of", "default", "--restore", logs()});
  ASSERT_TRUE(becomes(Place::kStandsBy, second_port));
  first->signal(SIGSTOP);
  EXPECT_TRUE(becomes(Place::kLeads, second_port));
  EXPECT_EQ(port_that(Place::kOvertaken), first_port);
  EXPECT_TRUE(becomes(Place::kOvertaken, 0)) << "known to be gone after its lease";
  first->signal(SIGKILL);

  // And in order: a third stands by, and the second is drained.
  const auto third = start(domain_, "default", {"--standby-of", "default", "--restore", logs()});
  ASSERT_TRUE(becomes(Place::kStandsBy, first_port)) << "the place of the one that is gone";
  second->signal(SIGUSR1);
  EXPECT_TRUE(becomes(Place::kLeads, first_port));
  EXPECT_EQ(second->wait(kPatience_s), 0) << second->errors();
  EXPECT_EQ((*directory)->known().size(), 1u);
}

TEST_F(DirectoryOfSessions, SaysInOneLineThatThereIsNobody) {
  const std::string domain = std::to_string(domain_);
  EXPECT_TRUE(ask({"--domain", domain, "--wait", "0.5"}, 1).empty());
  EXPECT_EQ(errors_, "mortise-directory: no server answered at 127.0.0.1 (domain " + domain +
                         ") within 0.5 s: none runs there, or it asks for keys (--keys)\n");
  const auto yard = lead(domain_, "yard");
  EXPECT_EQ(ask({"--domain", domain, "--session", "yard"}).size(), 1u);
  EXPECT_TRUE(ask({"--domain", domain, "--session", "hall"}, 1).empty());
}

TEST_F(DirectoryOfSessions, WantsKeysWhereTheServerDoes) {
  const std::string domain = std::to_string(domain_);
  KeyRing keys("site");
  keys.issue("hall", "server");
  keys.issue("olga", "observer");
  keys.issue("paul", "observer", {"--session", "default"});
  ASSERT_EQ(keys.trouble(), "");
  const auto hall = lead(domain_, "default", {"--keys", keys["hall"]});
  const auto seen = ask({"--domain", domain, "--keys", keys["olga"]});
  EXPECT_EQ(row(seen, "default", "leads")["users"], 0);
  EXPECT_TRUE(ask({"--domain", domain}, 1).empty()) << "not without";
  const auto of_paul = ask({"--domain", domain, "--keys", keys["paul"], "--session", "default"});
  EXPECT_EQ(row(of_paul, "default", "leads")["users"], 0);
}

TEST_F(DirectoryOfSessions, RefusesWhatIsNoDomain) {
  for (const char* domains : {"233", "5-3", "x", "1-", "0-40", ""}) {
    Program directory(folder_.path(), "mortise-directory", {"--domain", domains});
    EXPECT_EQ(directory.wait(kPatience_s), 2) << domains;
    EXPECT_FALSE(directory.errors().empty()) << domains;
  }
}

}  // namespace
}  // namespace mortise::test
