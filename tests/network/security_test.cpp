// Who may not, and how it is said: sessions under DDS-Security, met by those that have no business
// there.
#include <ctime>
#include <thread>

#include "idl/fast_dds_overrides.h"
#include "tests/network/security_fixture.h"
#include "tests/network/unruly.h"

namespace mortise::test {
namespace {

TEST_F(Security, ThoseOfOneSiteMeetAndWork) {
  open_site();
  Person anna, otto;
  anna.enter(options((*site_keys)["anna"]), "anna");
  works(anna);
  otto.enter(options((*site_keys)["otto"]), "otto", "observer");
  ASSERT_TRUE(until_in(otto, kPatience_s));
  EXPECT_TRUE(until(  // the scene comes first, poses of now with the next tick
      kPatience_s, [&] { return x_of(otto, "red") == x_of(anna, "red"); }, [&] { turn(otto); }));
  // What takes the place of the library's functions does so where the library itself calls them.
  const OverrideUses uses = override_uses();
  EXPECT_GT(uses.encodings, 0u);
  EXPECT_GT(uses.session_keys, 0u);
}

TEST_F(Security, WithoutACertificateNobodyComesIn) {
  open_site();
  Person stranger;
  stranger.enter(options(""), "anna");
  EXPECT_FALSE(until_in(stranger, kRefused_s));
  EXPECT_EQ(site->loop->inbox().counters().joins, 0u);
  EXPECT_TRUE(was_said("was not let in: without keys"));
  EXPECT_FALSE(was_said("another site") || was_said("expired") || was_said("revoked"));
  EXPECT_NE(trouble_with((*site_keys)["nobody"]).find("is not there"), std::string::npos);
  const auto channel = open_client_channel(options((*site_keys)["nobody"]));
  ASSERT_FALSE(channel);
  EXPECT_NE(channel.error().text.find("mortise keys issue"), std::string::npos);
}

TEST_F(Security, AForeignAuthorityIsNotOurs) {
  KeyRing elsewhere("elsewhere", "strangers");
  elsewhere.issue("anna", "designer");
  open_site();
  Person anna;
  anna.enter(options(elsewhere["anna"]), "anna");
  EXPECT_FALSE(until_in(anna, kRefused_s));
  EXPECT_TRUE(was_said("was not let in")) << said.size();
  EXPECT_TRUE(was_said("'anna' (designer) was not let in: of another site (/O=strangers/CN="));
  EXPECT_FALSE(was_said("without keys") || was_said("expired") || was_said("revoked"));
  EXPECT_GT(site->channel->counters().turned_away, 0u);
  std::filesystem::copy_file((*site_keys)["anna"] + "/ca.crt", elsewhere["anna"] + "/ca.crt",
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::copy_file((*site_keys)["anna"] + "/crl.pem", elsewhere["anna"] + "/crl.pem",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(trouble_with(elsewhere["anna"]).find("belongs to another site"), std::string::npos)
      << trouble_with(elsewhere["anna"]);
}

TEST_F(Security, AnExpiredCertificateIsGoodNoMore) {
  // It begins good and ends while its owner waits for the server: no end of ours would send it.
  const std::time_t end = std::time(nullptr) + 6;
  std::tm utc{};
  gmtime_r(&end, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%d%H%M%SZ", &utc);
  site_keys->issue("eva", "designer", {"--until", text});
  Person eva;
  eva.enter(options((*site_keys)["eva"]), "eva");
  std::this_thread::sleep_until(std::chrono::system_clock::from_time_t(end + 1));
  EXPECT_NE(trouble_with((*site_keys)["eva"]).find("'eva' expired on"), std::string::npos);
  open_site();
  EXPECT_FALSE(until_in(eva, kRefused_s));
  EXPECT_TRUE(was_said("'eva' (designer) was not let in: expired, not valid yet, or signed by no"));
  EXPECT_FALSE(was_said("without keys") || was_said("another site") || was_said("revoked"));
}

TEST_F(Security, ARevokedCertificateIsGoodNoMore) {
  site_keys->issue("rita", "designer");
  const std::string kept = site_keys->copy_of("rita", "kept_by_rita");  // with the old list
  site_keys->revoke("rita");
  open_site();
  Person rita;
  rita.enter(options(kept), "rita");
  EXPECT_FALSE(until_in(rita, kRefused_s));
  EXPECT_TRUE(was_said("'rita' (designer) was not let in: it has been revoked"));
  EXPECT_FALSE(was_said("without keys") || was_said("another site") || was_said("expired"));
  EXPECT_EQ(said.size(), 1u) << "once";
  std::filesystem::copy_file((*site_keys)["anna"] + "/crl.pem", kept + "/crl.pem",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_NE(trouble_with(kept).find("has been revoked"), std::string::npos) << trouble_with(kept);
}

TEST_F(Security, WhoIsRevokedWhileThereHasToGo) {
  site_keys->issue("dora", "designer");
  const std::string kept = site_keys->copy_of("dora", "kept_by_dora");
  open_site();
  Person dora;
  dora.enter(options(kept), "dora");
  works(dora);
  site_keys->revoke("dora");
  EXPECT_TRUE(until(
      kPatience_s, [&] { return was_said("'dora' (designer) has been revoked"); },
      [&] { turn(dora); }));
  EXPECT_EQ(site->loop->inbox().users_present(), 0u);
  EXPECT_FALSE(site->scene.world.parts[1].holder || site->scene.world.parts[0].holder);
  const std::uint64_t accepted = site->loop->inbox().counters().accepted;
  for (int i = 0; i < 200; ++i) {
    dora.client->send(0, dora.client->find_part("red"), {1, 0, 0});
    turn(dora);
  }
  EXPECT_EQ(site->loop->inbox().counters().accepted, accepted);
  EXPECT_EQ(site->loop->inbox().users_present(), 0u) << "she must not come in again";
}

/// Of somebody with these keys who joins under any name that is free and moves any part.
void send_all_there_is(ClientChannel& channel, std::uint64_t seq) {
  channel.send(batch_of(Increment{UserId{1}, PartId{2}, seq, {1, 0, 0}, Vec3::Zero()}, 0));
  Command command;
  command.kind = CommandKind::kGrab;
  command.user = UserId{1};
  command.part = PartId{2};
  command.seq = seq;
  channel.send(command);
  channel.heartbeat(UserId{1});
  channel.take();
}

TEST_F(Security, WhoIsRevokedWhileAwayDoesNotComeBack) {
  site_keys->issue("nora", "designer");
  const std::string kept = site_keys->copy_of("nora", "kept_by_nora");
  open_site();
  auto nora = std::make_unique<Person>();
  nora->enter(options(kept), "nora");
  works(*nora);
  nora.reset();
  Person anna;
  anna.enter(options((*site_keys)["anna"]), "anna");
  ASSERT_TRUE(until_in(anna, kPatience_s));
  ASSERT_TRUE(until(
      kPatience_s, [&] { return site->loop->inbox().users_present() == 1; }, [&] { turn(anna); }));
  site_keys->revoke("nora");
  until(
      1.5, [] { return false; }, [&] { turn(anna); });  // the list is looked at each second
  const InboxCounters before = site->loop->inbox().counters();

  // As a new participant, which the transport lets in: it read the list when the server began.
  Person again;
  again.enter(options(kept), "nora");
  EXPECT_TRUE(until(
      kPatience_s, [&] { return again.client->join_state(0) == JoinState::kRefused; },
      [&] { turn(again); }));
  EXPECT_NE(again.client->refusal_text(0).find("'nora' (designer) has been revoked; ask for a new"),
            std::string::npos)
      << again.client->refusal_text(0);
  EXPECT_TRUE(was_said("'nora' (designer) was not let in: it has been revoked"));
  const InboxCounters& inbox = site->loop->inbox().counters();
  const std::uint64_t heard = inbox.increments + inbox.repeats + inbox.commands;
  const std::uint64_t foreign = site->channel->counters().foreign;
  for (std::uint64_t seq = 1; seq <= 100; ++seq) {
    send_all_there_is(*again.channel, seq);
    turn(anna);
  }
  EXPECT_EQ(inbox.increments + inbox.repeats + inbox.commands, heard);
  EXPECT_GT(site->channel->counters().foreign, foreign + 200) << "dropped, and counted";
  // Anna's own: a machine that lets her be silent for the lease has her join anew.
  EXPECT_EQ(inbox.joins - before.joins, inbox.liveliness_lost - before.liveliness_lost);
  EXPECT_LE(site->loop->inbox().users_present(), 1u);
  works(anna);
}

TEST_F(Security, ADesignersKeysAreNotAServers) {
  const auto refused = open_server_channel(options((*site_keys)["anna"]));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text.find("keys of an ordinary designer, 'anna'"), std::string::npos)
      << refused.error().text;
  // One who does not look at the own keys, with an end that is of good will:
  DdsOptions blind = options((*site_keys)["anna"]);
  blind.check_keys = false;
  const auto forbidden = open_server_channel(blind);
  ASSERT_FALSE(forbidden);
  EXPECT_NE(forbidden.error().text.find("refused the writer of topic mortise_answers"),
            std::string::npos);
  // And with one of bad will: the others do not listen.
  const auto bad_will = std::make_unique<Unruly>();
  Site imposter(blind, blocks_yaml(kBlocks));
  Person otto;
  otto.enter(options((*site_keys)["otto"]), "otto", "observer");
  EXPECT_FALSE(until(
      kRefused_s, [&] { return otto.client->server_present() || otto.is_in(); },
      [&] {
        imposter.loop->tick();
        turn(otto);
      }));
  EXPECT_TRUE(otto.client->parts().empty()) << "it was told a scene by somebody who is no server";
}

TEST(OpenToOthers, NeedsKeys) {
  TestFolder folder;
  const std::string scenario = folder.write("blocks.yaml", blocks_yaml(kBlocks));
  Program server(folder.path(), "mortise-server", {scenario, "--interface", "10.1.2.3"});
  EXPECT_EQ(server.wait(kPatience_s), 2);
  EXPECT_NE(server.errors().find("--interface 10.1.2.3 opens the session to other hosts"),
            std::string::npos)
      << server.errors();
}

}  // namespace
}  // namespace mortise::test
