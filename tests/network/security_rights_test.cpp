// What those may do who were let in, and what a stranger can do with what was said on the wire:
// sessions under DDS-Security.
#include "common/messages/names.h"
#include "tests/network/security_fixture.h"
#include "tests/network/unruly.h"
#include "tests/network/wiretap.h"

namespace mortise::test {
namespace {

/// What arrives of the increments that a participant with these keys sends past its own rights.
std::uint64_t increments_of_unruly(Site& site, const DdsOptions& options, const std::string& name,
                                   const std::string& role, std::vector<std::string>& said) {
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
  const auto turn = [&] {
    (*channel)->join(1, name, role);
    joined = joined || site.loop->inbox().users_present() == 1;
    (*channel)->send(batch_of(Increment{UserId{1}, PartId{1}, ++seq, {1, 0, 0}, Vec3::Zero()}, 0));
    (*channel)->take();
    site.loop->tick();
    for (const std::string& text : site.loop->last_intake().turned_away) said.push_back(text);
    sleep_s(0.01);
  };
  until(
      kPatience_s, [&] { return joined; }, turn);
  until(
      kRefused_s, [&] { return site.loop->inbox().counters().increments > 20; }, turn);
  EXPECT_TRUE(joined) << "its requests must come through, or nothing is shown";
  return site.loop->inbox().counters().increments;
}

TEST_F(Security, AnObserversIncrementsDoNotArrive) {
  open_site();
  EXPECT_EQ(increments_of_unruly(*site, options((*site_keys)["otto"]), "otto", "observer", said),
            0u);
  // Who has an end of bad will is told nothing: it is not heard. The server says so.
  EXPECT_TRUE(was_said("'otto' (observer) does not let its owner send increments: none is heard"));
}

TEST_F(Security, AnObserverIsToldThatItMovesNothing) {  // by its own end, in the server's words
  open_site();
  Person otto;
  otto.enter(options((*site_keys)["otto"]), "otto", "observer");
  ASSERT_TRUE(until_in(otto, kPatience_s));
  const std::uint64_t seq = otto.client->send(0, otto.client->find_part("red"), {1, 0, 0});
  ASSERT_TRUE(until(
      kPatience_s, [&] { return !otto.refused.empty(); }, [&] { turn(otto); }));
  EXPECT_EQ(otto.refused[0].seq, seq);
  EXPECT_EQ(otto.refused[0].reason, Refusal::kObserver);
  EXPECT_EQ(name_of(otto.refused[0].reason), "observers look only");
  // Once: it is answered, and not sent again.
  EXPECT_FALSE(until(
      kRefused_s, [&] { return otto.refused.size() > 1; }, [&] { turn(otto); }));
  EXPECT_EQ(otto.client->statistics().joins_sent, 1u) << "nothing is in doubt";
  EXPECT_EQ(site->loop->inbox().counters().increments, 0u);
}

TEST_F(Security, ADesignersIncrementsArrive) {  // the same with the right to
  open_site();
  EXPECT_GT(increments_of_unruly(*site, options((*site_keys)["anna"]), "anna", "designer", said),
            20u);
  EXPECT_EQ(said, std::vector<std::string>{});
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
  // The bot is told, of increments and of a command.
  const auto told = [&] {
    return std::count_if(bot.refused.begin(), bot.refused.end(), [](const RefusedIncrement& one) {
      return one.reason == Refusal::kRateTooHigh;
    });
  };
  ASSERT_TRUE(until(
      kPatience_s, [&] { return told() > 0; }, [&] { turn(bot); }));
  EXPECT_EQ(name_of(Refusal::kRateTooHigh), "rate above the limit");
  std::vector<std::uint64_t> commands;
  EXPECT_TRUE(until(
      kPatience_s,
      [&] {
        return std::any_of(commands.begin(), commands.end(), [&](std::uint64_t seq) {
          const Reply* reply = bot.answer(seq);
          return reply != nullptr && reply->refusal == Refusal::kRateTooHigh &&
                 reply->text ==
                     "more messages a second than the session accepts from one user, or from all";
        });
      },
      [&] {
        for (int i = 0; i < 100; ++i) bot.client->send(0, red, {0.001, 0, 0});
        commands.push_back(bot.client->grab(0, red));
        turn(bot);
      }));
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
  if (!tap.works()) GTEST_SKIP() << "not root: nobody else may listen on lo";
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
  EXPECT_EQ(site->channel->counters().guard_dropped, 0u) << "nothing comes twice by itself";
  play(*anna);
  EXPECT_GE(site->channel->counters().guard_dropped, 3 * 50u) << "all of it is counted";
  ASSERT_TRUE(until(
      kPatience_s, [&] { return was_said("encrypted datagrams came a second time"); },
      [&] { turn(*anna); }));
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
  if (!tap.works()) GTEST_SKIP() << "not root: nobody else may listen on lo";
  site = std::make_unique<Site>(options(""), blocks_yaml(kBlocks));
  Person anna;
  anna.enter(options(""), "anna");
  works(anna);
  EXPECT_GT(naming_the_session(tap.take()), 0);
}

}  // namespace
}  // namespace mortise::test
