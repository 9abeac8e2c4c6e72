// Another DDS implementation takes part: Cyclone DDS, in C, from the same IDL, against the real
// server, beside a client of ours. Both must see the same.
#include <gtest/gtest.h>

#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "client/client.h"
#include "idl/dds_channel.h"
#include "tests/network/domain.h"
#include "tests/network/program.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

/// What the peer said on a line that begins with `what`, by the name before the number.
double said(const std::string& text, const std::string& what, const std::string& name) {
  const std::size_t line = text.find(what + " ");
  if (line == std::string::npos) return -1.0;
  const std::size_t at = text.find(" " + name + " ", line);
  return at == std::string::npos ? -1.0 : std::atof(text.c_str() + at + name.size() + 2);
}

/// A session of the peer, which must see what a client of ours sees.
void plays_a_session(const char* program) {
#ifndef MORTISE_HAS_CYCLONE
  GTEST_SKIP() << "program absent: Cyclone DDS (cyclonedds-dev, cyclonedds-tools)";
#endif
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  Program server(folder.path(), "mortise-server",
                 {folder.write("blocks.yaml", blocks_yaml({.blue = ""})), "--domain", domain,
                  "--no-log", "--json", "--duration", "40"});
  DdsOptions options;
  options.domain = own_domain();
  auto channel = open_client_channel(options);
  ASSERT_TRUE(channel) << channel.error().text;
  Client witness(**channel);
  witness.add_user("witness", "observer");
  std::vector<ClashEvent> events;
  const auto listen = [&] {
    for (const ClashEvent& event : witness.poll().events) events.push_back(event);
    usleep(4000);
  };
  for (int i = 0; i < 2000 && !witness.synced(); ++i) listen();
  ASSERT_TRUE(witness.synced()) << server.errors();

  // Down through the base's face at z = 10 mm (from 20 by 60 steps of 0.2) and 2 mm into it.
  Program peer(folder.path(), program, {domain, "default", "red", "60", "-0.2"});
  while (peer.running()) listen();
  for (int i = 0; i < 50; ++i) listen();
  const std::string out = peer.out();
  std::printf("%s", out.c_str());
  ASSERT_EQ(peer.wait(1), 0) << out << peer.errors();
  EXPECT_EQ(peer.errors(), "");
  EXPECT_EQ(said(out, "moved", "acknowledged"), 60.0);
  const Pose& X_WP = witness.parts().at(witness.find_part("red")).info.X_WP;
  EXPECT_NEAR(X_WP.p.z(), 8.0, 1e-9);
  EXPECT_EQ(said(out, "moved", "z_mm"), X_WP.p.z()) << "the same pose, to the last bit";
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(said(out, "events", "count"), static_cast<double>(events.size()));
  EXPECT_EQ(said(out, "events", "first"), static_cast<double>(events.front().seq));
  EXPECT_EQ(said(out, "events", "last"), static_cast<double>(events.back().seq));
  EXPECT_EQ(said(out, "events", "missed"), 0.0);
  EXPECT_EQ(said(out, "events", "class"),
            static_cast<double>(events.back().verdict.collision_class));
  EXPECT_EQ(said(out, "events", "open"), 1.0);
  server.signal(SIGTERM);
  ASSERT_EQ(server.wait(kPatience_s), 0) << server.errors();
  EXPECT_NE(server.out().find("\"accepted\": 60"), std::string::npos) << server.out();
  EXPECT_NE(server.errors().find("cyclone left"), std::string::npos) << server.errors();
}

TEST(Cyclone, JoinsGrabsMovesAndSeesPosesAndClashes) { plays_a_session("cyclone_peer"); }
/// What it writes lacks members that this build reads, and it reads what has more than it knows.
TEST(Cyclone, OneOfBeforeDoesSoWithoutTheNewestMembers) {
  plays_a_session("cyclone_peer_of_before");
}

/// By what idl/README.md says and nothing else: it keeps its user and its part where another server
/// leads.
TEST(Cyclone, GoesOnWhereAnotherServerTakesOver) {
#ifndef MORTISE_HAS_CYCLONE
  GTEST_SKIP() << "program absent: Cyclone DDS (cyclonedds-dev, cyclonedds-tools)";
#endif
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  const std::string logs = folder.path().string() + "/logs";
  Program first(folder.path(), "mortise-server",
                {folder.write("blocks.yaml", blocks_yaml({.blue = ""})), "--domain", domain,
                 "--log", logs, "--json"});
  Program peer(folder.path(), "cyclone_peer", {domain, "default", "red", "20", "-0.2", "takeover"});
  const auto until = [](const auto& done) {
    for (int i = 0; i < 5000 && !done(); ++i) usleep(10'000);
    return done();
  };
  ASSERT_TRUE(until([&] { return peer.out().find("waits") != std::string::npos; }))
      << peer.out() << peer.errors() << first.errors();
  Program second(
      folder.path(), "mortise-server",
      {"--standby-of", "default", "--restore", logs, "--log", logs, "--domain", domain, "--json"});
  ASSERT_TRUE(until([&] { return second.errors().find("in step") != std::string::npos; }))
      << second.errors();
  first.signal(SIGKILL);
  EXPECT_EQ(peer.wait(kPatience_s), 0) << peer.out() << peer.errors();
  const std::string out = peer.out();
  std::printf("%s", out.c_str());
  EXPECT_EQ(said(out, "rejoined", "same_user"), 1.0);
  EXPECT_EQ(said(out, "rejoined", "higher_term"), 1.0);
  EXPECT_EQ(said(out, "moved", "acknowledged"), 40.0);
  EXPECT_NEAR(said(out, "moved", "z_mm"), 20.0 - 40 * 0.2, 1e-9);
  EXPECT_EQ(said(out, "events", "missed"), 0.0);
  second.signal(SIGTERM);
  ASSERT_EQ(second.wait(kPatience_s), 0) << second.errors();
}

TEST(Cyclone, OneAbsurdTickEndsNobody) {
#ifndef MORTISE_HAS_CYCLONE
  GTEST_SKIP() << "program absent: Cyclone DDS (cyclonedds-dev, cyclonedds-tools)";
#endif
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  Program server(folder.path(), "mortise-server",
                 {folder.write("blocks.yaml", blocks_yaml({.blue = ""})), "--domain", domain,
                  "--no-log", "--json"});
  Program rogue(folder.path(), "cyclone_peer", {domain, "default", "red", "0", "0", "absurd"});
  ASSERT_EQ(rogue.wait(kPatience_s), 0) << rogue.out() << rogue.errors() << server.errors();
  EXPECT_TRUE(server.running()) << server.errors();
  Program peer(folder.path(), "cyclone_peer", {domain, "default", "red", "10", "-0.2"});
  EXPECT_EQ(peer.wait(kPatience_s), 0) << peer.out() << peer.errors();
  server.signal(SIGTERM);
  EXPECT_EQ(server.wait(kPatience_s), 0) << server.errors();
}

}  // namespace
}  // namespace mortise::test
