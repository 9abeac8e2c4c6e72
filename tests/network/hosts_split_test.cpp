// The net cut in two with users on either side, for so long that both servers speak; and healed.
#include "tests/network/hosts.h"

namespace mortise::test {
namespace {

class SplitHosts : public Hosts {
 protected:
  using Poses = std::map<std::uint64_t, std::vector<Pose>>;  ///< by tick, by part index

  /// Cut until both sides have said what the other has not.
  void cut_and_heal(const std::set<int>& leaders_side) {
    sleep_s(1.5);
    link_->cut(leaders_side);
    EXPECT_TRUE(until(
        kPatience_s,
        [&] {
          return said("taken over") && (noted("is not waited for") || noted("going on without"));
        },
        [] {}))
        << standby_->errors();
    sleep_s(HeldChannel::kPatienceCutOff_s + 1.0);  // a new leader of few is silent as long
    link_->cut({});
  }
  static Poses poses_of(const std::string& file) {
    Poses poses;
    const auto log = read_session_log(file);
    if (!log) {
      ADD_FAILURE() << log.error().text;
      return poses;
    }
    const auto verified = verify(*log, 1, [&](const World& world, const StepReport& report) {
      for (const Part& part : world.parts) poses[report.tick].push_back(part.X_WP);
    });
    EXPECT_TRUE(verified && !verified->difference) << file;
    return poses;
  }
  /// Words of this client that are not of the server of these poses: in all, and of those after
  /// the last change of servers.
  static std::pair<std::size_t, std::size_t> foreign(const Overheard& heard, const Poses& poses) {
    std::pair<std::size_t, std::size_t> count;
    for (const Overheard::Word& word : heard.words()) {
      const auto at = poses.find(word.tick);
      if (at == poses.end() && word.tick < poses.begin()->first) continue;  // of both
      if (at != poses.end() && identical(at->second.at(word.part.value - 1), word.X_WP)) continue;
      ++count.first;
      count.second += word.server + 1 == heard.servers();
    }
    return count;
  }
  /// `stayed` were with the one that leads in the end all the time; the others were with the other
  /// for some of it, and changed servers so often.
  void expect_one_truth(const std::string& file, std::span<const Hand> stayed, int their_changes,
                        std::span<const Hand> came, int changes) {
    const Poses poses = poses_of(file);
    ASSERT_FALSE(poses.empty());
    const auto expect = [&](const Hand& hand, const char* who) {
      EXPECT_GT(hand.heard->words().size(), 200u);
      EXPECT_EQ(foreign(*hand.heard, poses).second, 0u) << who;
      for (const auto& [id, part] : hand.person.client->parts())
        EXPECT_TRUE(identical(part.info.X_WP, poses.rbegin()->second.at(id.value - 1))) << who;
    };
    for (const Hand& hand : stayed) {
      expect(hand, "stayed");
      EXPECT_EQ(hand.changes, their_changes);
      EXPECT_EQ(foreign(*hand.heard, poses).first, 0u);
    }
    for (const Hand& hand : came) {
      expect(hand, "came");
      EXPECT_EQ(hand.changes, changes);
      EXPECT_GT(foreign(*hand.heard, poses).first, 0u) << "the other has said nothing";
    }
    EXPECT_EQ(lost(file, stayed), 0u);
  }
  std::span<const Hand> near() const { return std::span(hands_).first(2); }
  std::span<const Hand> far() const { return std::span(hands_).last(2); }
};

TEST_F(SplitHosts, OfTwoHalvesTheOneThatStoodByLeadsAndNobodySeesTwoTruths) {
  come_in(false);
  ASSERT_FALSE(HasFailure());
  cut_and_heal({kServerSide, 2});
  EXPECT_TRUE(until(
      kPatience_s, [&] { return superseded_.load(); }, [] {}))
      << "the first does not end";
  sleep_s(2.0);
  leave();
  standby_->signal(SIGTERM);
  EXPECT_EQ(standby_->wait(kPatience_s), 0) << standby_->errors();
  expect_one_truth(logs_to_restore(logs_, "default").at(0).string(), far(), 1, near(), 1);
}

class KeptMostHosts : public RoundOf<SplitHosts> {
 public:
  bool play() {
    come_in();
    if (HasFailure()) return true;
    cut_and_heal({kServerSide, 2, 4});
    if (noted("going on without")) return false;
    EXPECT_EQ(standby_->wait(kPatience_s), 1) << standby_->errors();
    sleep_s(2.0);
    leave();
    end_server();
    EXPECT_FALSE(superseded_);
    expect_one_truth(first_log_, near(), 0, far(), 2);
    return true;
  }
};

TEST(SplitHostsKeptMost, TheFirstLeadsAndNobodySeesTwoTruths) { play_rounds<KeptMostHosts>(); }

}  // namespace
}  // namespace mortise::test
