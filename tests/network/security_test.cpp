// Who may not, and how it is said: sessions under DDS-Security, met by those that have no business
// there.
#include <ctime>
#include <thread>

#include "idl/fast_dds_overrides.h"
#include "idl/identity.h"
#include "tests/network/key_ring.h"
#include "tests/network/site.h"
#include "tests/network/small_server.h"
#include "tests/network/unruly.h"
#include "tests/network/wiretap.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

constexpr double kPatience_s = 10.0;  // for what must happen
constexpr double kRefused_s = 3.0;    // for what must not: ten times what a join takes
const Blocks kBlocks{"lease_s: 5\n", "[0, 0, 60]", "[500, 0, 20]"};

class Security : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    site_keys = std::make_unique<KeyRing>("keys");
    site_keys->issue("hall", "server");
    site_keys->issue("anna", "designer");
    site_keys->issue("otto", "observer");
    ASSERT_EQ(site_keys->trouble(), "");
  }
  static void TearDownTestSuite() {
    EXPECT_EQ(site_keys->trouble(), "");
    site_keys.reset();
  }

  DdsOptions options(const std::string& keys) const {
    DdsOptions o = options_for_test(std::string("Security.") +
                                    testing::UnitTest::GetInstance()->current_test_info()->name());
    o.keys = keys;
    return o;
  }
  void open_site() {
    site = std::make_unique<Site>(options((*site_keys)["hall"]), blocks_yaml(kBlocks));
  }
  void turn(Person& person) {
    if (site) {
      site->loop->tick();
      for (const std::string& text : site->loop->last_intake().turned_away) said.push_back(text);
    }
    person.listen();
    sleep_s(0.004);
  }
  bool until_in(Person& person, double limit_s) {
    return until(
        limit_s, [&] { return person.is_in(); }, [&] { turn(person); });
  }
  bool was_said(const std::string& words) const {
    return std::any_of(said.begin(), said.end(),
                       [&](const std::string& s) { return s.find(words) != std::string::npos; });
  }
  /// What is said when keys are looked at before they are used.
  static std::string trouble_with(const std::string& folder) {
    const auto identity = check_keys(folder);
    return identity ? "" : identity.error().text;
  }
  static double x_of(const Person& person, const char* part) {
    return person.client->parts().at(person.client->find_part(part)).info.X_WP.p.x();
  }
  /// Joins, grabs red and moves it by 1 mm.
  void works(Person& person) {
    ASSERT_TRUE(until_in(person, kPatience_s));
    const PartId red = person.client->find_part("red");
    const std::uint64_t seq = person.client->grab(0, red);
    ASSERT_TRUE(until(
        kPatience_s, [&] { return person.answer(seq) != nullptr; }, [&] { turn(person); }));
    ASSERT_EQ(person.answer(seq)->refusal, Refusal::kNone) << person.answer(seq)->text;
    const double before = x_of(person, "red");
    person.client->send(0, red, {1, 0, 0});
    EXPECT_TRUE(until(
        kPatience_s, [&] { return x_of(person, "red") == before + 1.0; }, [&] { turn(person); }));
  }

  static std::unique_ptr<KeyRing> site_keys;
  std::unique_ptr<Site> site;
  std::vector<std::string> said;
};
std::unique_ptr<KeyRing> Security::site_keys;

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
  EXPECT_NE(trouble_with((*site_keys)["nobody"]).find("is not there"), std::string::npos);
  const auto channel = open_client_channel(options((*site_keys)["nobody"]));
  ASSERT_FALSE(channel);
  EXPECT_NE(channel.error().text.find("mortise keys issue"), std::string::npos);
}

TEST_F(Security, AForeignAuthorityIsNotOurs) {
  KeyRing elsewhere("elsewhere");
  elsewhere.issue("anna", "designer");
  open_site();
  Person anna;
  anna.enter(options(elsewhere["anna"]), "anna");
  EXPECT_FALSE(until_in(anna, kRefused_s));
  EXPECT_TRUE(was_said("was not let in")) << said.size();
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
  EXPECT_TRUE(was_said("was not let in"));
}

TEST_F(Security, ARevokedCertificateIsGoodNoMore) {
  site_keys->issue("rita", "designer");
  const std::string kept = site_keys->copy_of("rita", "kept_by_rita");  // with the old list
  site_keys->revoke("rita");
  open_site();
  Person rita;
  rita.enter(options(kept), "rita");
  EXPECT_FALSE(until_in(rita, kRefused_s));
  EXPECT_TRUE(was_said("was not let in"));
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
      5.0, [&] { return was_said("'dora' (designer) has been revoked"); }, [&] { turn(dora); }));
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

/// What arrives of the increments that a participant with these keys sends past its own rights.
std::uint64_t increments_of_unruly(Site& site, const DdsOptions& options, const std::string& name,
                                   const std::string& role) {
  DdsOptions blind = options;
  blind.check_keys = false;  // else it knows that it is an observer's
  const Unruly bad_will;
  auto channel = open_client_channel(blind);
  if (!channel) {
    ADD_FAILURE() << channel.error().text;
    return 0;
  }
  std::uint64_t seq = 0;
  bool joined = false;
  until(
      kRefused_s, [&] { return site.loop->inbox().counters().increments > 20; },
      [&] {
        (*channel)->join(1, name, role);
        joined = joined || site.loop->inbox().users_present() == 1;
        (*channel)->send(
            batch_of(Increment{UserId{1}, PartId{1}, ++seq, {1, 0, 0}, Vec3::Zero()}, 0));
        (*channel)->take();
        site.loop->tick();
        sleep_s(0.01);
      });
  EXPECT_TRUE(joined) << "its requests must come through, or nothing is shown";
  return site.loop->inbox().counters().increments;
}

TEST_F(Security, AnObserversIncrementsDoNotArrive) {
  open_site();
  EXPECT_EQ(increments_of_unruly(*site, options((*site_keys)["otto"]), "otto", "observer"), 0u);
}

TEST_F(Security, ADesignersIncrementsArrive) {  // the same with the right to
  open_site();
  EXPECT_GT(increments_of_unruly(*site, options((*site_keys)["anna"]), "anna", "designer"), 20u);
}

TEST_F(Security, NobodyJoinsAsSomebodyElse) {
  open_site();
  const struct {
    const char *keys, *name, *role, *says;
  } cases[] = {
      {"anna", "ben", "designer", "'anna' does not let its owner join as 'ben'"},
      {"otto", "otto", "designer", "role observer, not of designer"},
      {"anna", "anna", "bot", "role designer, not of bot"},
  };
  for (const auto& [keys, name, role, says] : cases) {
    Person person;
    person.enter(options((*site_keys)[keys]), name, role);
    ASSERT_TRUE(until(
        kPatience_s, [&] { return person.client->join_state(0) == JoinState::kRefused; },
        [&] { turn(person); }));
    EXPECT_NE(person.client->refusal_text(0).find(says), std::string::npos)
        << person.client->refusal_text(0);
  }
}

TEST_F(Security, ABotThatIsTooFastIsRefused) {
  site_keys->issue("mill", "bot");
  open_site();
  Person bot;
  bot.enter(options((*site_keys)["mill"]), "mill-1", "bot");
  ASSERT_TRUE(until_in(bot, kPatience_s));
  const PartId red = bot.client->find_part("red");
  bot.client->grab(0, red);
  const auto refused = [&] {
    return site->loop->inbox().counters().refused[static_cast<int>(Refusal::kRateTooHigh)];
  };
  // 1000 a second are allowed.
  EXPECT_TRUE(until(
      kPatience_s, [&] { return refused() > 0; },
      [&] {
        for (int i = 0; i < 100; ++i) bot.client->send(0, red, {0.001, 0, 0});
        turn(bot);
      }));
  EXPECT_EQ(site->loop->inbox().user_counters()[0].refused, refused());
}

/// Announcements of topics and requests to join have it, when they can be read.
std::ptrdiff_t naming_the_session(const std::vector<Wiretap::Heard>& heard) {
  const std::string name = "session/test";
  return std::count_if(heard.begin(), heard.end(), [&](const Wiretap::Heard& one) {
    return std::search(one.bytes.begin(), one.bytes.end(), name.begin(), name.end()) !=
           one.bytes.end();
  });
}

TEST_F(Security, ARecordingSentAgainMovesNothing) {
  Wiretap tap(7402 + 250 * options("").domain);
  if (!tap.works()) GTEST_SKIP() << "listening on lo needs root";
  open_site();
  auto anna = std::make_unique<Person>();
  anna->enter(options((*site_keys)["anna"]), "anna");
  works(*anna);
  const PartId red = anna->client->find_part("red");
  for (int i = 0; i < 50; ++i) {
    anna->client->send(0, red, {1, 0, 0});
    turn(*anna);
  }
  EXPECT_TRUE(until(
      kPatience_s, [&] { return x_of(*anna, "red") == 51.0; }, [&] { turn(*anna); }));
  const std::vector<Wiretap::Heard> heard = tap.take();
  ASSERT_GT(heard.size(), 50u);
  EXPECT_EQ(naming_the_session(heard), 0) << "what is said is there to read";

  // While she is there, after she has gone, and to another server: nothing is heard of it.
  const auto& counters = site->loop->inbox().counters();
  std::uint64_t taken = counters.increments + counters.repeats;
  const auto play = [&](Person& listener) {
    for (int i = 0; i < 3; ++i) send_again(heard);
    for (int i = 0; i < 100; ++i) turn(listener);
  };
  play(*anna);
  EXPECT_EQ(counters.increments + counters.repeats, taken);
  EXPECT_EQ(x_of(*anna, "red"), 51.0);
  anna.reset();
  Person otto;
  otto.enter(options((*site_keys)["otto"]), "otto", "observer");
  ASSERT_TRUE(until_in(otto, kPatience_s));
  play(otto);
  EXPECT_EQ(counters.increments + counters.repeats, taken);
  EXPECT_EQ(site->loop->inbox().users_present(), 1u) << "only he is there";
  EXPECT_EQ(x_of(otto, "red"), 51.0);
  site.reset();
  open_site();
  // He may not have noticed yet that the server is another: it is asked, not he.
  ASSERT_TRUE(until(
      kPatience_s, [&] { return site->loop->inbox().users_present() == 1; }, [&] { turn(otto); }));
  play(otto);
  const InboxCounters& after = site->loop->inbox().counters();
  // His own: a machine that lets him be silent for the lease has him join anew.
  EXPECT_EQ(after.joins, 1u + after.liveliness_lost) << "somebody else has joined";
  EXPECT_EQ(site->loop->inbox().users_present(), 1u) << "only he is there";
  EXPECT_EQ(after.increments, 0u);
}

TEST_F(Security, WithoutKeysAllIsThereToRead) {
  Wiretap tap(7402 + 250 * options("").domain);
  if (!tap.works()) GTEST_SKIP() << "listening on lo needs root";
  site = std::make_unique<Site>(options(""), blocks_yaml(kBlocks));
  Person anna;
  anna.enter(options(""), "anna");
  works(anna);
  EXPECT_GT(naming_the_session(tap.take()), 0);
}

TEST(OpenToOthers, NeedsKeys) {
  TestFolder folder;
  const std::string scenario = folder.write("blocks.yaml", blocks_yaml(kBlocks));
  Program server(folder.path(), "mortise-server", {scenario, "--interface", "10.1.2.3"});
  EXPECT_EQ(server.wait(10), 2);
  EXPECT_NE(server.errors().find("--interface 10.1.2.3 opens the session to other hosts"),
            std::string::npos)
      << server.errors();
}

}  // namespace
}  // namespace mortise::test
