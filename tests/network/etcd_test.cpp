// Two servers and an etcd of three nodes, while nets are cut, nodes and servers killed, and leaders
// paused: nothing that was acknowledged is lost, and nobody ever sees a count go back.
#include "tests/network/etcd_site.h"

#include <random>

#include "tests/support/effort.h"

namespace mortise::test {
namespace {

/// Faults at random: two, of which the second comes while the first lasts; then all is whole again.
class FaultSchedules : public EtcdSite {
 protected:
  enum class First { kAny, kUserComesAnew };
  void play(int count, std::uint64_t seed, First first = First::kAny) {
    random_.seed(seed);
    for (int i = 0; i < count && !HasFailure(); ++i) {
      said_.clear();
      const int led = leader();
      std::string what = first == First::kAny ? fault(true) : user_comes_anew();
      sleep_s(between(0.1, 3.0));
      what += ", " + fault(false);
      sleep_s(between(1.0, 7.0));
      heal();
      EXPECT_TRUE(whole_again()) << "schedule " << i << ": " << what << "\n" << errors();
      changes_ += leader() != led;
      EXPECT_EQ(what_is_wrong(), "") << "schedule " << i << ": " << what << "\n" << errors();
    }
    const auto counted = counts();
    EXPECT_EQ(lost(), 0U);
    EXPECT_EQ(what_is_wrong(), "");
    for (const std::uint64_t known : counted) EXPECT_GT(known, 10U);
    std::printf(
        "%d schedules; %d changes of leader; %d users came anew; acknowledged %zu, %zu, %zu\n",
        count, changes_, came_anew(), counted[0], counted[1], counted[2]);
  }

 private:
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

  /// A user's host is cut off for longer than a seat is kept; there the program is started again,
  /// which meets what the first has left when the net is whole: its name, its part, its numbers.
  std::string user_comes_anew() {
    const int side = below(kSides);
    link_->cut({side});
    const double cut_s = between(kSeatKept_s + 0.5, kSeatKept_s + 3.0);
    const double anew_s = between(0.0, cut_s);
    sleep_s(anew_s);
    come_anew(side);
    sleep_s(cut_s - anew_s);
    if (below(2) == 0) link_->cut({});
    return "user of " + std::to_string(side) + " cut off, and come anew";
  }

  // A server dies as the first thing alone: one that went on alone and dies takes with it what only
  // its log has, and the last second of that.
  std::string fault(bool is_first) {
    const int leading = std::max(0, leader());
    switch (below(is_first ? 7 : 5)) {
      case 0:
      case 1: {
        std::set<int> apart{below(kSides)};
        if (below(3) == 0) apart.insert(below(kSides));
        link_->cut(apart);
        return "cut of " + std::to_string(*apart.begin()) +
               (apart.size() > 1 ? " and " + std::to_string(*apart.rbegin()) : std::string());
      }
      case 2: {
        const int node = below(kSides);
        etcds_[at(node)]->signal(SIGKILL);
        return "node " + std::to_string(node) + " killed";
      }
      case 3:
        return paused(leading, is_first || below(2) == 0);
      case 4:
        return paused(1 - leading, is_first || below(2) == 0);
      case 5:
        servers_[at(1 - leading)]->signal(SIGKILL);
        return "standby killed";
      default:
        servers_[at(leading)]->signal(SIGKILL);
        return "leader " + std::to_string(leading) + " killed";
    }
  }
  std::string paused(int side, bool for_long) {
    servers_[at(side)]->signal(SIGSTOP);
    if (for_long) return "server " + std::to_string(side) + " paused";
    sleep_s(between(0.2, 1.5));
    servers_[at(side)]->signal(SIGCONT);
    return "server " + std::to_string(side) + " paused for a moment";
  }
  void heal() {
    link_->cut({});
    for (auto& server : servers_) server->signal(SIGCONT);
    for (int side = 0; side < kSides; ++side)
      if (!etcds_[at(side)]->running()) start_etcd(side);
  }

  /// By a new leader; the participant's lease of 2 s and the presence of 0.8 s are shorter.
  static constexpr double kSeatKept_s = 4.0;
  std::mt19937_64 random_;
  int changes_ = 0;
};

TEST_F(FaultSchedules, NothingThatWasAcknowledgedIsLost) { play(effort(2), 31); }
TEST_F(FaultSchedules, SoakNothingThatWasAcknowledgedIsLost) { play(effort(8), 1'000'003); }
TEST_F(FaultSchedules, UsersThatComeAnewLoseNothing) {
  const int count = effort(2);
  play(count, 47, First::kUserComesAnew);
  EXPECT_GE(came_anew(), count);
}

/// Both halves have users; with patience alone both servers would speak, and one of them in vain.
TEST_F(EtcdSite, OfTwoHalvesOneSpeaks) {
  link_->cut({0});  // the leader, its node, and anna
  const auto before = counts();
  EXPECT_TRUE(until(
      kPatience_s, [&] { return counts()[2] > before[2] + 60; }, [] {}))
      << errors();
  EXPECT_TRUE(leads(1)) << errors();
  const auto since = counts();
  sleep_s(2.0);
  EXPECT_LE(counts()[0], since[0]) << "the other half is told as well";
  link_->cut({});
  EXPECT_TRUE(whole_again()) << errors();
  EXPECT_EQ(what_is_wrong(), "");
  EXPECT_EQ(lost(), 0U);
}

TEST(CounterHistory, SeesWhatIsNotLinear) {
  CounterHistory history;
  for (int i = 1; i <= 5; ++i) history.asked(i);
  for (std::uint64_t seq = 1; seq <= 4; ++seq) history.acknowledged(seq, 5.5);
  history.refused(4);
  history.refused(5);
  history.acknowledged(5, 5.5);
  history.read(6.0, 6.5, 4);
  EXPECT_EQ(history.what_is_wrong(), "");
  CounterHistory lost = history, back = history, more = history;
  lost.read(6.0, 6.5, 2);
  EXPECT_NE(lost.what_is_wrong(), "") << "an acknowledged one is missing";
  back.read(7.0, 7.5, 3);
  EXPECT_NE(back.what_is_wrong(), "") << "it goes back";
  more.read(7.0, 7.5, 6);
  EXPECT_NE(more.what_is_wrong(), "") << "nobody asked for so many";
  history.read(5.0, 5.6, 0);
  EXPECT_EQ(history.what_is_wrong(), "") << "it began before that was acknowledged";
}

}  // namespace
}  // namespace mortise::test
