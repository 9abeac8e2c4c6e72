// A server that is told to go (SIGUSR1) while its session is to stay: what its users see of it.
#include "tests/network/second_server.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

constexpr double kHandOver_s = 0.5;  // as a client sees it; a tenth of that where nobody else works

class Drain : public SecondServer {
 protected:
  int drained(Program& server) {
    server.signal(SIGUSR1);
    for (const double end_s = steady_s() + 15.0; steady_s() < end_s && server.running();)
      turn(0.01);
    return server.wait(0);
  }
};

TEST_F(Drain, HandsTheSessionToTheOneThatStandsBy) {
  const int times = timed() ? 20 : 1;
  std::unique_ptr<Program> leader = lead();
  come_in();
  AllIn before = as_all_are();
  ASSERT_EQ(before.clashes.size(), 1u);
  std::vector<double> gaps_s;
  for (int tries = 0; static_cast<int>(gaps_s.size()) < times && tries < times + 4; ++tries) {
    std::unique_ptr<Program> second = stand_by();
    ASSERT_FALSE(HasFailure());
    before.losses = losses_;
    const double gap_s = longest_gap_after([&] { leader->signal(SIGUSR1); });
    const int code = leader->wait(15);
    if (leader->errors().find("another server leads") != std::string::npos) {
      std::printf("taken over before it was drained, on a starved machine: not counted\n");
      leader = std::move(second);
      continue;
    }
    gaps_s.push_back(gap_s);
    EXPECT_EQ(code, 0) << leader->errors();
    EXPECT_NE(leader->errors().find("drained: the server that stood by leads"), std::string::npos)
        << leader->errors();
    EXPECT_TRUE(says(*second, "hands over: taken over at tick")) << second->errors();
    expect_all_as(before);
    leader = std::move(second);
  }
  EXPECT_GT(acknowledged_.size(), 30u);
  EXPECT_EQ(lost_of_acknowledged(*leader), 0u);
  ASSERT_FALSE(gaps_s.empty());
  std::sort(gaps_s.begin(), gaps_s.end());
  std::printf("drained as a client sees it, %d times: %.0f ms at least, %.0f median, %.0f most\n",
              times, gaps_s.front() * 1e3, gaps_s[gaps_s.size() / 2] * 1e3, gaps_s.back() * 1e3);
  if (timed()) {
    EXPECT_LE(gaps_s.back(), kHandOver_s);
  }
}

TEST_F(Drain, AloneItEndsWithACheckpointFromWhichAnotherGoesOn) {
  std::unique_ptr<Program> first = lead();
  come_in();
  moves_ = true;
  turn(1.0);
  const UserId ben = ben_->client->user_id(0);
  EXPECT_FALSE(told_of_drain_);
  EXPECT_EQ(drained(*first), 0) << first->errors();
  EXPECT_TRUE(told_of_drain_);
  EXPECT_TRUE(says(*first, "; go on with --restore ")) << first->errors();
  moves_ = false;
  // Another host has the log and nothing else.
  const std::string there = folder_.path().string() + "/there";
  std::filesystem::create_directories(there);
  for (const auto& entry : std::filesystem::directory_iterator(logs()))
    std::filesystem::copy_file(entry.path(),
                               std::filesystem::path(there) / entry.path().filename());
  auto second = start({"--restore", there, "--log", logs()});
  EXPECT_TRUE(says(*second, "; 0 played again"))
      << "the checkpoint is that of the last tick: " << second->errors();
  for (const double end_s = steady_s() + 10.0;
       steady_s() < end_s && ben_->client->user_id(0) != ben;)
    turn(0.01);
  ASSERT_EQ(ben_->client->user_id(0), ben) << second->errors();
  ASSERT_TRUE(ben_->grab("blue"));
  moves_ = true;
  turn(1.0);
  EXPECT_GT(acknowledged_.size(), 60u);
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
}

/// The one that stands by is asked to go on, and hears nothing.
TEST_F(Drain, DoesNotWaitForEverForOneThatIsFrozen) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  moves_ = true;
  turn(0.3);
  second->signal(SIGSTOP);
  const double begun_s = steady_s();
  EXPECT_EQ(drained(*first), 0) << first->errors();
  if (timed()) {
    EXPECT_LT(steady_s() - begun_s, 4.0);
  }
  EXPECT_TRUE(says(*first, "the server that stands by was not seen to go on")) << first->errors();
  moves_ = false;
  second->signal(SIGKILL);
  second->wait(5);
  // Only the log of the one that led counts: the other's may end earlier.
  auto third = start({"--restore", logs(), "--log", logs()});
  EXPECT_TRUE(says(*third, "restored from")) << third->errors();
  EXPECT_TRUE(
      ben_->until(kPatience_s, [&] { return ben_->client->user_id(0) && ben_->client->synced(); }));
  third->signal(SIGTERM);
  EXPECT_EQ(third->wait(kPatience_s), 0);
}

TEST_F(Drain, WhoComesMeanwhileComesInWhereTheSessionGoesOn) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  Guest carl(domain_, "carl");
  // Met, not joined: it asks while the first is on its way out.
  first->signal(SIGUSR1);
  const bool joined = carl.until(10, [&] {
    turn(0.001);
    return carl.client->user_id(carl.user) && carl.client->synced();
  });
  EXPECT_TRUE(joined) << second->errors();
  EXPECT_EQ(first->wait(kPatience_s), 0) << first->errors();
  EXPECT_EQ(anna_->client->users().size(), 4u);
  second->signal(SIGTERM);
  EXPECT_EQ(second->wait(kPatience_s), 0);
}

TEST_F(Drain, OneThatStandsByJustGoes) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  EXPECT_EQ(drained(*second), 0);
  EXPECT_TRUE(first->running());
  const int losses = losses_;
  moves_ = true;
  turn(1.5);
  EXPECT_EQ(losses_, losses);
  EXPECT_EQ(drained(*first), 0);
  EXPECT_TRUE(says(*first, "; go on with --restore ")) << first->errors();
  // What it wrote while it stood by is no part of the session: that goes on from the other's log.
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(logs()))
    files += entry.is_regular_file();
  EXPECT_EQ(files, 1u);
  auto third = start({"--restore", logs(), "--log", logs()});
  EXPECT_TRUE(
      ben_->until(kPatience_s, [&] { return ben_->client->user_id(0) && ben_->client->synced(); }));
  EXPECT_GT(acknowledged_.size(), 60u);
  EXPECT_EQ(lost_of_acknowledged(*third), 0u);
}

}  // namespace
}  // namespace mortise::test
