// The wall clock of a server and its clients jumps while people drag parts, and a server is killed
// and started again while the clock shows less than its log.
#include "tests/network/same_everywhere.h"
#include "tests/network/second_server.h"
#include "tests/network/wall_clock.h"

namespace mortise::test {
namespace {

constexpr std::int64_t kHour_s = 3600;

class ClockJump : public SecondServer {
 protected:
  void drag(double seconds) {
    moves_ = true;
    const std::size_t before = acknowledged_.size();
    turn(seconds);
    EXPECT_GT(acknowledged_.size(), before) << "nothing comes through";
    moves_ = false;
    turn(0.2);  // what is on its way
  }
  /// The step itself: nobody loses the server, and what is moved is moved.
  void step(std::int64_t seconds) {
    const int losses = losses_;
    wall_.step(seconds);
    drag(0.7);
    EXPECT_EQ(losses_, losses);
  }
  static std::map<PartId, Pose> poses(const Guest& guest) {
    std::map<PartId, Pose> poses;
    for (const auto& [id, part] : guest.client->parts()) poses[id] = part.info.X_WP;
    return poses;
  }
  Knowledge agreed(std::vector<Guest*> guests) {
    const Knowledge known = agreed_by(guests);
    EXPECT_EQ(known.open.size(), 1U) << "red in the base";
    return known;
  }
  /// Kills the server and starts it again on its log. All that was acknowledged is on disk by then.
  void kill_and_restore(std::unique_ptr<Program>& server) {
    turn(2.2);
    const auto poses_before = poses(*anna_);
    const auto clashes_before = clashes(*anna_);
    const UserId anna_id = anna_->client->user_id(anna_->user);
    const int losses = losses_;
    server->signal(SIGKILL);
    ASSERT_EQ(server->wait(kPatience_s), 128 + SIGKILL);
    server = start({"--restore", logs(), "--log", logs()});
    const auto is_in = [](const Guest& guest) {
      return guest.client->user_id(guest.user) && guest.client->synced();
    };
    const double begun_s = steady_s();
    while (steady_s() < begun_s + 15.0 &&
           !(losses_ == losses + kClients && is_in(*anna_) && is_in(*ben_) && is_in(*otto_)))
      turn(0.01);
    ASSERT_EQ(losses_, losses + kClients) << "all have seen that the server went";
    ASSERT_TRUE(is_in(*anna_) && is_in(*ben_) && is_in(*otto_)) << server->errors();
    std::printf("back in the session %.2f s after the new process started\n", steady_s() - begun_s);
    EXPECT_EQ(anna_->client->user_id(anna_->user), anna_id);
    for (const auto& [id, pose] : poses_before) EXPECT_TRUE(identical(poses(*anna_)[id], pose));
    EXPECT_EQ(clashes(*anna_), clashes_before);
    agreed({anna_.get(), ben_.get(), otto_.get()});
    ASSERT_TRUE(ben_->grab("blue"));
    drag(0.7);
  }

  WallClock wall_{folder_.path()};
};

TEST_F(ClockJump, AnHourOnAndAnHourBack) {
  std::unique_ptr<Program> server = lead();
  come_in();
  drag(0.5);
  step(kHour_s);
  kill_and_restore(server);
  step(-kHour_s);
  kill_and_restore(server);  // whose clock shows an hour less than its log
  EXPECT_NE(server->errors().find("s behind the last tick"), std::string::npos) << server->errors();
  kill_and_restore(server);  // and again: the last log is that of the server before
  step(-kHour_s);
  kill_and_restore(server);
  Guest late(domain_, "late");
  ASSERT_TRUE(late.joined());
  turn(0.3);
  const Knowledge known = agreed({anna_.get(), ben_.get(), otto_.get(), &late});
  EXPECT_GT(acknowledged_.size(), 100U);
  EXPECT_EQ(lost_of_acknowledged(*server), 0U) << "of " << acknowledged_.size();
  expect_in_log(known, first_log(), {anna_.get(), ben_.get()});
}

TEST_F(ClockJump, BeforeTheYear1970NobodyStarts) {
  wall_.step(-std::time(nullptr) - kHour_s);
  const std::unique_ptr<Program> server = lead();
  EXPECT_EQ(server->wait(kPatience_s), 1);
  const std::string said = server->errors();
  EXPECT_NE(said.find("shows a time before 1970; set it"), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

/// As a machine without a battery begins. Times and terms go on from there.
TEST_F(ClockJump, AClockThatWasNeverSetIsSaidAndServesASession) {
  wall_.step(-std::time(nullptr) + 60);
  std::unique_ptr<Program> server = lead();
  EXPECT_TRUE(says(*server, "the clock of this machine shows 1970-01-01")) << server->errors();
  come_in();
  drag(0.5);
  kill_and_restore(server);
  kill_and_restore(server);
  EXPECT_EQ(lost_of_acknowledged(*server), 0U) << "of " << acknowledged_.size();
  std::int64_t last_ns = 0;
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(logs())) files.insert(entry.path());
  EXPECT_EQ(files.size(), 3U);
  for (const auto& file : files) {  // in the order of their names
    EXPECT_NE(file.filename().string().find("-1970"), std::string::npos) << file;
    const auto log = read_session_log(file);
    ASSERT_TRUE(log) << log.error().text;
    ASSERT_FALSE(log->ticks.empty()) << file;
    EXPECT_GT(log->ticks.front().time_ns, last_ns) << file;
    last_ns = log->ticks.back().time_ns;
  }
  EXPECT_LT(last_ns, kHour_s * 1'000'000'000);
}

/// Its own clock shows an hour less than the ticks that it followed.
TEST_F(ClockJump, OneThatTakesOverGoesOnLaterThanTheOneThatLed) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  step(kHour_s);
  step(-kHour_s);
  (void)longest_gap_after([&] { first->signal(SIGKILL); });
  EXPECT_NE(second->errors().find("taken over at tick"), std::string::npos) << second->errors();
  EXPECT_NE(second->errors().find("s behind the last tick"), std::string::npos) << second->errors();
  drag(0.7);
  const Knowledge known = agreed({anna_.get(), ben_.get(), otto_.get()});
  EXPECT_EQ(lost_of_acknowledged(*second), 0U) << "of " << acknowledged_.size();
  expect_in_log(known, first_log(), {anna_.get(), ben_.get()});
  std::vector<std::int64_t> times_ns;
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(logs())) files.insert(entry.path());
  ASSERT_EQ(files.size(), 2U);
  for (const auto& file : files) {
    const auto log = read_session_log(file);
    ASSERT_TRUE(log) << log.error().text;
    for (const TickRecord& tick : log->ticks) times_ns.push_back(tick.time_ns);
    EXPECT_TRUE(std::is_sorted(times_ns.end() - static_cast<std::ptrdiff_t>(log->ticks.size()),
                               times_ns.end()))
        << file;
  }
  EXPECT_GT(times_ns.back() - times_ns.front(), kHour_s * 1'000'000'000);
}

}  // namespace
}  // namespace mortise::test
