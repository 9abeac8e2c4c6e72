// Sessions side by side on one host, with the same names of users and parts: no word crosses.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/network/domain.h"
#include "tests/network/site.h"
#include "tests/network/small_server.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

const PartId kRed{2}, kBlue{3};

/// Two sessions of the same scenario; in each an Anna and a Ben.
struct Isolation : testing::Test {
  std::unique_ptr<Site> here, there;
  Person anna_here, ben_here, anna_there, ben_there;

  void open(const DdsOptions& first, const DdsOptions& second) {
    here = std::make_unique<Site>(first, blocks_yaml());
    there = std::make_unique<Site>(second, blocks_yaml());
    for (auto [site, anna, ben] : {std::tuple(here.get(), &anna_here, &ben_here),
                                   std::tuple(there.get(), &anna_there, &ben_there)}) {
      anna->enter(site->options, "anna");
      ben->enter(site->options, "ben");
    }
    ASSERT_TRUE(wait([&] {
      for (const Person* person : everybody())
        if (!person->is_in() || person->client->users().size() != 2) return false;
      return true;
    }));
  }
  std::vector<Person*> everybody() { return {&anna_here, &ben_here, &anna_there, &ben_there}; }
  bool wait(const std::function<bool()>& done, double limit_s = 10.0) {
    return until(limit_s, done, [&] {
      here->loop->tick();
      there->loop->tick();
      for (Person* person : everybody()) person->listen();
    });
  }
  static Vec3 at(const Person& person, PartId part) {
    return person.client->parts().at(part).info.X_WP.p;
  }

  // The same words in both, with other numbers: who heard the other one would know.
  void play() {
    // Ids are given in the order of joining: where Anna came first here and last there, they
    // differ.
    anna_here.client->grab(0, kRed);
    ben_there.client->grab(0, kRed);
    ASSERT_TRUE(wait([&] {
      return anna_here.client->parts().at(kRed).info.holder &&
             ben_there.client->parts().at(kRed).info.holder;
    }));
    // Here 2 mm into the base and out again, five times; there once, 1 mm, and it stays.
    for (int i = 0; i < 5; ++i) {
      anna_here.client->send(0, kRed, Vec3(0, 0, -12));
      ASSERT_TRUE(wait([&] { return at(ben_here, kRed).z() == 8.0; }));
      anna_here.client->send(0, kRed, Vec3(0, 0, 12));
      ASSERT_TRUE(wait([&] { return at(ben_here, kRed).z() == 20.0; }));
    }
    ben_there.client->send(0, kRed, Vec3(0, 0, -11));
    ASSERT_TRUE(wait([&] {
      return at(anna_there, kRed).z() == 9.0 && anna_there.client->open_clashes().size() == 1;
    }));
    anna_here.client->set_policy(0, "stop");
    ASSERT_TRUE(wait([&] { return ben_here.client->policy() == "stop"; }));
    wait([] { return false; }, 0.5);  // whatever crosses has time to do so
  }

  void expect_nothing_crossed() {
    EXPECT_EQ(at(anna_here, kRed).z(), 20.0);
    EXPECT_EQ(at(anna_there, kRed).z(), 9.0);
    EXPECT_TRUE(ben_here.client->open_clashes().empty());
    EXPECT_EQ(ben_there.client->policy(), "report");
    EXPECT_TRUE(ben_there.client->standing().empty());
    EXPECT_FALSE(anna_there.client->parts().at(kBlue).info.holder);
    // Each event stream is its own: 1, 2, 3 ... of its own session's clashes, for both alike.
    for (auto [one, other, least, most] : {std::tuple(&anna_here, &ben_here, 10U, 20U),
                                           std::tuple(&anna_there, &ben_there, 1U, 2U)}) {
      ASSERT_EQ(one->events.size(), other->events.size());
      EXPECT_GE(one->events.size(), least);
      EXPECT_LE(one->events.size(), most);
      for (std::size_t i = 0; i < one->events.size(); ++i) {
        EXPECT_EQ(one->events[i].seq, i + 1);
        EXPECT_EQ(one->events[i].seq, other->events[i].seq);
        EXPECT_EQ(one->events[i].verdict.delta_mm, other->events[i].verdict.delta_mm);
      }
    }
    EXPECT_NEAR(anna_here.events.front().verdict.delta_mm.hi, 2.0, 1e-3);
    EXPECT_NEAR(anna_there.events.front().verdict.delta_mm.hi, 1.0, 1e-3);
    for (auto [site, increments, commands] :
         {std::tuple(here.get(), 10U, 2U), std::tuple(there.get(), 1U, 1U)}) {
      const InboxCounters& counters = site->loop->inbox().counters();
      EXPECT_EQ(counters.accepted, increments);
      EXPECT_EQ(counters.commands, commands);
      EXPECT_GE(counters.joins, 2U);  // asked for again where the answer is late
      EXPECT_EQ(counters.refused_in_all() + counters.foreign + counters.joins_refused, 0U);
      EXPECT_EQ(site->channel->counters().malformed + site->channel->counters().foreign, 0U);
    }
    for (Person* person : everybody()) EXPECT_EQ(person->client->statistics().server_losses, 0U);
  }
};

/// A server that is being ended frees the name of its domain before its ports.
TEST(Domain, IsNotTakenWhileASocketHoldsAPortOfIt) {
  const int next = 1 + static_cast<int>(getpid()) % 100;  // what is tried first
  sockaddr_in port{};
  port.sin_family = AF_INET;
  port.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  port.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * next + 249));
  const int handle = socket(AF_INET, SOCK_DGRAM, 0);
  ASSERT_EQ(bind(handle, reinterpret_cast<const sockaddr*>(&port), sizeof port), 0);
  EXPECT_NE(take_domains(1), next);
  close(handle);
}

TEST_F(Isolation, TwoDomains) {
  DdsOptions other = own_options();
  other.domain = take_domains(1);
  open(own_options(), other);
  play();
  expect_nothing_crossed();
}

TEST_F(Isolation, TwoPortsOfOneDomain) {
  DdsOptions other = own_options();
  other.discovery_port = 7400 + 250 * other.domain + 6;
  open(own_options(), other);
  play();
  expect_nothing_crossed();
}

TEST_F(Isolation, TwoSessionsByPartition) {
  DdsOptions other = own_options();
  other.session = "other";
  other.discovery_port = 7400 + 250 * other.domain + 6;
  open(own_options(), other);
  EXPECT_EQ(ben_there.client->session(), "other");
  play();
  expect_nothing_crossed();
  const std::uint64_t joins_here = here->loop->inbox().counters().joins;
  const std::uint64_t joins_there = there->loop->inbox().counters().joins;
  // Who asks the server of one for the session of the other hears nobody.
  DdsOptions lost = own_options();
  lost.session = "other";
  Person eve;
  eve.enter(lost, "anna");
  wait(
      [&] {
        eve.listen();
        return false;
      },
      1.5);
  EXPECT_FALSE(eve.client->server_present());
  EXPECT_EQ(eve.channel->counters().received, 0U);
  EXPECT_EQ(here->loop->inbox().counters().joins, joins_here);
  EXPECT_EQ(there->loop->inbox().counters().joins, joins_there);
}

// Clients look for a server that takes over where another session's is: that one began later, and
// its term is the higher one.
TEST_F(Isolation, AnotherSessionAtTheSecondPlace) {
  DdsOptions other = own_options();
  other.session = "other";
  other.discovery_port = 7400 + 250 * other.domain + 4;
  open(own_options(), other);
  play();
  expect_nothing_crossed();
}

// The end of one is not the end of the other.
TEST_F(Isolation, OneEndsAndTheOtherGoesOn) {
  DdsOptions other = own_options();
  other.session = "other";
  other.discovery_port = 7400 + 250 * other.domain + 6;
  open(own_options(), other);
  there->loop.reset();
  there->channel.reset();
  const auto turn = [&] {
    here->loop->tick();
    for (Person* person : everybody()) person->listen();
  };
  ASSERT_TRUE(until(
      kPatience_s, [&] { return ben_there.client->statistics().server_losses == 1; }, turn));
  anna_here.client->grab(0, kBlue);
  anna_here.client->send(0, kBlue, Vec3(1, 0, 0));
  ASSERT_TRUE(until(
      kPatience_s, [&] { return at(ben_here, kBlue).x() == 31.0; }, turn));
  EXPECT_EQ(ben_here.client->statistics().server_losses, 0U);
}

}  // namespace
}  // namespace mortise::test
