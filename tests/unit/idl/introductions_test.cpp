// Who is told of whom by a discovery server, and what one host may cost it.
#include "idl/introductions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "idl/directory.h"
#include "tests/support/effort.h"

namespace mortise {
namespace {

using Outcome = Introductions::Outcome;
using Ports = std::vector<int>;
constexpr std::uint32_t kHost = 0x7f000001, kThere = 0x0a000002;

/// Participants with a place of their own each.
class Introduced : public ::testing::Test {
 protected:
  static Announcement of(int number, bool serves, const std::string& session, int domain = 0,
                         std::uint32_t host = kHost) {
    Announcement told;
    std::memcpy(told.participant.data(), &number, sizeof number);
    told.purpose = Purpose{serves, domain, session};
    told.places = {{host, static_cast<std::uint16_t>(number)}};
    told.inboxes = {{host, static_cast<std::uint16_t>(number)}};
    return told;
  }
  static Announcement goodbye(Announcement told) {
    told.leaves = true;
    return told;
  }
  Introductions::Answer take(const Announcement& told) {
    const std::uint32_t host = told.places.empty() ? kHost : told.places.front().ipv4;
    return take(told, host);
  }
  Introductions::Answer take(const Announcement& told, std::uint32_t from) {
    return introductions_.take(told, from, now_s_);
  }
  static Ports ports(const Introductions::Answer& answer) {
    Ports all;
    for (const UdpPlace& place : answer.to) all.push_back(place.port);
    std::sort(all.begin(), all.end());
    return all;
  }
  Introductions introductions_;
  double now_s_ = 100.0;
};

TEST_F(Introduced, AreServersAndClientsOfOneSession) {
  const auto server = of(1, true, "hall"), second = of(2, true, "hall"),
             other = of(3, true, "yard"), anna = of(11, false, "hall"), ben = of(12, false, "hall"),
             cleo = of(13, false, "yard"), looker = of(20, false, kEverySession),
             far = of(21, true, "hall", 5);
  for (const auto& told : {server, second, other, anna, ben, cleo, looker, far})
    EXPECT_TRUE(take(told).is_new);
  EXPECT_EQ(ports(take(server)), (Ports{2, 11, 12, 20}));
  EXPECT_EQ(ports(take(second)), (Ports{1, 11, 12, 20}));
  EXPECT_EQ(ports(take(other)), (Ports{13, 20}));
  EXPECT_EQ(ports(take(anna)), (Ports{1, 2})) << "and no other client";
  EXPECT_EQ(ports(take(cleo)), (Ports{3}));
  EXPECT_EQ(ports(take(looker)), (Ports{1, 2, 3}));
  EXPECT_EQ(ports(take(far)), Ports{}) << "another domain";
  EXPECT_EQ(introductions_.size(), 8u);
  EXPECT_EQ(introductions_.servers(), 4u);
}

/// Longer than a lease, so that who hears nothing of the other directly takes it for gone.
TEST_F(Introduced, AreToldOftenWhileNewAndThenSeldom) {
  const auto server = of(1, true, "hall"), anna = of(11, false, "hall");
  take(server);
  std::vector<double> told_s;
  for (int i = 0; i < 100; ++i, now_s_ += 0.5) {
    take(server);
    if (!take(anna).to.empty()) told_s.push_back(now_s_);
  }
  ASSERT_GT(told_s.size(), 10u);
  for (std::size_t i = 1; i < told_s.size(); ++i)
    EXPECT_EQ(told_s[i] - told_s[i - 1], i < Introductions::kWhileNew ? 0.5 : 4.0) << i;
  EXPECT_EQ(ports(take(of(2, true, "hall"))), (Ports{1, 11}));
  EXPECT_EQ(ports(take(anna)), (Ports{2})) << "to the new one at once";
}

TEST_F(Introduced, AreForgottenWhenTheyLeaveOrAreSilent) {
  const auto server = of(1, true, "hall"), anna = of(11, false, "hall");
  take(server);
  take(anna);
  now_s_ += 2.0;
  take(anna);
  now_s_ += 2.0;
  const auto gone = introductions_.take_gone(now_s_);
  ASSERT_EQ(gone.size(), 1u);
  EXPECT_TRUE(gone.front().purpose.serves);
  EXPECT_EQ(gone.front().place.port, 1);
  EXPECT_TRUE(take(anna).to.empty());
  EXPECT_EQ(ports(take(server)), (Ports{11})) << "back again";
  take(anna);

  EXPECT_EQ(take(goodbye(anna), kThere).outcome, Outcome::kFromElsewhere) << "said by another";
  EXPECT_EQ(introductions_.size(), 2u);
  const auto left = take(goodbye(anna));
  EXPECT_EQ(left.outcome, Outcome::kTaken);
  EXPECT_EQ(ports(left), (Ports{1})) << "to whom it was made known";
  EXPECT_EQ(take(goodbye(anna)).outcome, Outcome::kUnknown);
  EXPECT_EQ(take(goodbye(of(99, false, "hall"))).outcome, Outcome::kUnknown);
  EXPECT_EQ(introductions_.size(), 1u);
  EXPECT_TRUE(take(server).to.empty());
  take(goodbye(server));
  EXPECT_EQ(introductions_.size(), 0u);
  EXPECT_EQ(introductions_.servers(), 0u);
  EXPECT_EQ(introductions_.sessions(), 0u);
  EXPECT_EQ(introductions_.take_gone(now_s_).size(), 2u);
  EXPECT_TRUE(introductions_.take_gone(now_s_ + 10.0).empty()) << "once";
}

TEST_F(Introduced, AreHeardFromTheirOwnHostOnly) {
  const auto anna = of(11, false, "hall");
  EXPECT_EQ(take(anna, kThere).outcome, Outcome::kFromElsewhere) << "names a host that is not its";
  EXPECT_EQ(introductions_.size(), 0u);
  EXPECT_EQ(take(anna).outcome, Outcome::kTaken);
  EXPECT_EQ(take(of(11, false, "hall", 0, kThere)).outcome, Outcome::kFromElsewhere)
      << "anna's name from elsewhere";
  EXPECT_EQ(take(of(11, true, "hall")).outcome, Outcome::kOtherPurpose) << "she is no server";
  EXPECT_EQ(ports(take(of(1, true, "hall"))), (Ports{11}));

  Announcement odd = of(12, false, "hall");
  odd.inboxes.push_back({kThere, 5});
  EXPECT_EQ(take(odd).outcome, Outcome::kFromElsewhere) << "others would send there";
  odd = of(12, false, "hall");
  odd.places.push_back({kThere, 5});
  EXPECT_EQ(take(odd).outcome, Outcome::kFromElsewhere);
  odd = of(12, false, "hall");
  odd.hears_otherwise = true;
  EXPECT_EQ(take(odd).outcome, Outcome::kFromElsewhere);
  odd = of(12, false, "hall");
  odd.purpose.reset();
  EXPECT_EQ(take(odd).outcome, Outcome::kNoPurpose);
  EXPECT_EQ(take(of(13, true, kEverySession)).outcome, Outcome::kFromElsewhere)
      << "nobody serves all";
  EXPECT_EQ(introductions_.size(), 2u);
}

TEST_F(Introduced, AreBoundInPace) {
  const auto anna = of(11, false, "hall");
  int taken = 0;
  for (int i = 0; i < 1000; ++i) {
    now_s_ += 0.001;
    taken += take(anna).outcome == Outcome::kTaken ? 1 : 0;
  }
  EXPECT_GE(taken, 58);
  EXPECT_LE(taken, 60) << "40 at once and 20 in the second";
  now_s_ += 0.5;
  EXPECT_EQ(take(anna).outcome, Outcome::kTaken);

  const auto ben = of(12, false, "hall");
  taken = 0;
  for (int i = 0; i < 1000; ++i) {
    taken += take(ben).outcome == Outcome::kTaken ? 1 : 0;
    take(goodbye(ben));
  }
  EXPECT_EQ(taken, 40) << "coming and going is no way around it";
}

TEST_F(Introduced, AreBoundInNumber) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(take(of(100 + i, true, "hall")).is_new);
  EXPECT_EQ(take(of(103, true, "hall")).outcome, Outcome::kFull) << "three of one host";
  EXPECT_EQ(take(of(103, true, "yard")).outcome, Outcome::kTaken);
  for (int i = 0; i < 5; ++i)
    EXPECT_TRUE(take(of(110 + i, true, "hall", 0, kThere + static_cast<unsigned>(i))).is_new);
  EXPECT_EQ(take(of(120, true, "hall", 0, kThere + 9)).outcome, Outcome::kFull) << "eight of all";

  int number = 1000, last = 0;
  for (std::uint32_t host = kThere + 100; last == 0; ++host)
    for (std::size_t i = 0; i <= Introductions::kMostOfHost && last == 0; ++i) {
      const auto outcome = take(of(number++, false, "crowd", 0, host)).outcome;
      if (outcome == Outcome::kTaken) continue;
      ASSERT_EQ(outcome, Outcome::kFull);
      if (introductions_.size() == Introductions::kMost)
        last = number;
      else
        ASSERT_EQ(i, Introductions::kMostOfHost) << "one host has not all the room";
    }
  EXPECT_EQ(take(of(999, false, "hall")).outcome, Outcome::kFull);
  EXPECT_EQ(take(of(100, true, "hall")).outcome, Outcome::kTaken) << "who is here stays";
}

/// What one datagram makes of others, in sum.
TEST_F(Introduced, AreBoundInWhatIsPassedOnForOneHost) {
  constexpr int kClients = 3000;
  for (int i = 0; i < kClients; ++i)
    ASSERT_EQ(take(of(1000 + i, false, "hall", 0, kThere)).outcome, Outcome::kTaken);
  std::size_t passed = 0;
  bool was_too_often = false;
  for (int n = 0; n < 100; ++n) {  // as many as it likes, of names of its own
    const auto forged = of(10'000 + n, true, "hall");
    const auto answer = take(forged);
    passed += answer.to.size();
    was_too_often = was_too_often || answer.outcome == Outcome::kTooOften;
    take(goodbye(forged));
  }
  EXPECT_TRUE(was_too_often);
  EXPECT_GT(passed, 10'000u);
  EXPECT_LE(passed, 20'000u);
  now_s_ += 0.2;
  EXPECT_EQ(take(of(20'000, true, "hall")).to.size(), kClients) << "and is given time";
}

/// Against the rule, asked of every pair.
TEST_F(Introduced, AgreeWithTheRuleInEveryCrowd) {
  struct One {
    Announcement told;
    double heard_s = -100.0;
    bool here = false;
  };
  struct Pair {
    int times = 0;
    double last_s = 0.0;
  };
  std::mt19937 random(5);
  std::size_t introduced = 0, again = 0, full = 0;
  for (int round = 0; round < 50 * test::effort(1); ++round) {
    Introductions introductions;
    std::vector<One> all;
    std::map<std::pair<std::size_t, std::size_t>, Pair> pairs;
    double now_s = 0.0;
    for (int step = 0; step < 400; ++step) {
      now_s += 0.05;
      const bool is_new = all.empty() || (all.size() < 40 && random() % 4 == 0);
      if (is_new) {
        const bool serves = random() % 5 == 0;
        const char* const sessions[] = {"a", "b", "c", kEverySession};
        all.push_back({of(static_cast<int>(all.size()) + 1, serves,
                          sessions[random() % (serves ? 3 : 4)], static_cast<int>(random() % 2))});
      }
      const std::size_t me = is_new ? all.size() - 1 : random() % all.size();
      introductions.take_gone(now_s);
      for (std::size_t i = 0; i < all.size(); ++i)
        if (now_s - all[i].heard_s > Introductions::kSilence_s) {
          all[i].here = false;
          std::erase_if(pairs, [i](const auto& pair) {
            return pair.first.first == i || pair.first.second == i;
          });
        }
      if (all[me].here && random() % 8 == 0) {
        EXPECT_EQ(introductions.take(goodbye(all[me].told), kHost, now_s).outcome, Outcome::kTaken);
        all[me].here = false;
        std::erase_if(pairs, [me](const auto& pair) { return pair.first.first == me; });
        continue;
      }
      const auto answer = introductions.take(all[me].told, kHost, now_s);
      if (answer.outcome == Outcome::kFull) {
        ++full;
        continue;
      }
      ASSERT_EQ(answer.outcome, Outcome::kTaken);
      ASSERT_EQ(answer.is_new, !all[me].here);
      all[me].heard_s = now_s;
      all[me].here = true;
      std::vector<UdpPlace> expected;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const Purpose &a = *all[me].told.purpose, &b = *all[i].told.purpose;
        const bool same =
            a.session == b.session || a.session == kEverySession || b.session == kEverySession;
        if (i == me || !all[i].here || a.domain != b.domain || !same || !(a.serves || b.serves))
          continue;
        Pair& pair = pairs[{me, i}];
        if (pair.times >= 4 && now_s - pair.last_s < 4.0) continue;
        again += pair.times >= 4 ? 1 : 0;
        pair = {pair.times + 1, now_s};
        expected.push_back(all[i].told.places.front());
      }
      auto told = answer.to;
      std::sort(told.begin(), told.end());
      std::sort(expected.begin(), expected.end());
      ASSERT_EQ(told, expected);
      introduced += told.size();
    }
  }
  EXPECT_GT(introduced, 5'000u);
  EXPECT_GT(again, 20u);
  EXPECT_GT(full, 0u);
}

}  // namespace
}  // namespace mortise
