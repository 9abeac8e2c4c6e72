// A server that runs for long while all that can come and go beside it does: does it grow? In the
// first quarter the leader itself is killed, again and again; who stood by is the server from then.
// An hour, unless MORTISE_SOAK_S says another time.
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <random>
#include <thread>

#include "tests/network/domain.h"
#include "tests/network/guest.h"
#include "tests/network/program.h"
#include "tests/support/growth.h"

namespace mortise::test {
namespace {

constexpr int kCrews = 4;
constexpr double kLong_s = 1800.0;  // a slope means something from here on
constexpr double kSlope_mb_per_h = 3.0;
// Of leaders; the next one stands by, and is in step, before the next kill.
constexpr double kFirstKill_s = 10.0, kBetweenKills_s = 45.0;
// Whoever takes over waits 4 s for the users of before; a name is free again after that.
constexpr double kNamesHeld_s = 5.5;
// Whatever the machine does; standby_test holds the figures.
constexpr double kTakesOver_s = 10.0, kInStep_s = 20.0;

double soak_s() {
  const char* seconds = std::getenv("MORTISE_SOAK_S");
  return seconds != nullptr ? std::atof(seconds) : 3600.0;
}

/// A program that is ended, and started again a little later, in one way or another.
class ComesAndGoes {
 public:
  ComesAndGoes(const TestFolder& folder, std::string name, std::vector<std::string> arguments,
               double first_s, double lives_s, unsigned seed)
      : folder_(folder),
        name_(std::move(name)),
        arguments_(std::move(arguments)),
        lives_s_(lives_s),
        random_(seed),
        next_s_(first_s) {}
  void turn(double now_s) {
    if (program_ && (now_s >= next_s_ || !program_->running())) {
      end();
      next_s_ = now_s + between(3.0, 6.0);  // who was killed is gone by then
    } else if (!program_ && now_s >= next_s_) {
      program_ = std::make_unique<Program>(folder_.path(), name_, arguments_);
      ++starts_;
      next_s_ = now_s + lives_s_ * between(0.5, 1.5);
    }
  }
  /// Who ends by itself, or on request, says that all was well.
  void end() {
    if (!program_) return;
    const bool ends_itself = !program_->running();
    const bool kill = !ends_itself && std::bernoulli_distribution(0.5)(random_);
    if (!ends_itself) program_->signal(kill ? SIGKILL : SIGTERM);
    killed_ += kill;
    const int code = program_->wait(20);
    EXPECT_NE(code, -1) << name_ << " does not end";
    // It may be told to end before it is ready for the signal, or has joined.
    const bool too_early =
        !ends_itself &&
        (code == 128 + SIGTERM ||
         program_->errors().find("before all users had joined") != std::string::npos);
    if (!kill && !too_early) {
      EXPECT_EQ(code, 0) << name_ << (ends_itself ? " ended: " : " was ended: ")
                         << program_->errors() << program_->out().substr(0, 2000);
    }
    in_step_ += program_->errors().find("in step") != std::string::npos;
    program_.reset();
  }
  /// Gives it away as it runs; another is started later.
  std::unique_ptr<Program> give(double now_s) {
    next_s_ = now_s + 3.0;
    return std::move(program_);
  }
  /// Who is away stays away until then.
  void not_before(double moment_s) {
    if (!program_) next_s_ = std::max(next_s_, moment_s);
  }
  /// Whether it runs, and has said so.
  bool says(const std::string& words) const {
    return program_ && program_->running() && program_->errors().find(words) != std::string::npos;
  }
  int starts() const { return starts_; }
  int killed() const { return killed_; }
  /// How many of them said that they are in step with the server.
  int in_step() const { return in_step_; }

 private:
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  const TestFolder& folder_;
  std::string name_;
  std::vector<std::string> arguments_;
  double lives_s_;
  std::mt19937 random_;
  std::unique_ptr<Program> program_;
  double next_s_;
  int starts_ = 0, killed_ = 0, in_step_ = 0;
};

std::string domain() { return std::to_string(own_domain()); }

ComesAndGoes crew(const TestFolder& folder, int number) {
  const std::string one(1, static_cast<char>('k' + number));
  return {folder,
          "mortise-bot",
          {"--domain", domain(), "--users", "2", "--names", one + "a," + one + "b", "--behaviour",
           number % 2 ? "wander" : "share", "--wait", "20", "--duration", "20", "--json"},
          0.0,
          16.0,
          static_cast<unsigned>(number)};
}

/// Kills the one that leads, and gives the one that stood by, which leads from then; none when it
/// does not take over.
std::unique_ptr<Program> kill_leader(Program& leader, ComesAndGoes& standby, double now_s) {
  leader.signal(SIGKILL);
  EXPECT_EQ(leader.wait(5), 128 + SIGKILL);
  const double end_s = steady_s() + kTakesOver_s;
  while (!standby.says("taken over at")) {
    if (steady_s() > end_s) return nullptr;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return standby.give(now_s);
}

TEST(LiveSoak, SoakAServerWhoseUsersAndStandbyComeAndGoDoesNotGrow) {
  const double lasts_s = soak_s();
  TestFolder folder;
  const std::string logs = (folder.path() / "logs").string();
  std::filesystem::create_directories(logs);
  auto server = std::make_unique<Program>(
      folder.path(), "mortise-server",
      std::vector<std::string>{MORTISE_SOURCE_DIR "/scenarios/gearbox.yaml", "--domain", domain(),
                               "--log", logs, "--log-rotate", "4", "--metrics-port", "0", "--quiet",
                               "--json"});
  std::vector<ComesAndGoes> all;
  for (int i = 0; i < kCrews; ++i) all.push_back(crew(folder, i));
  all.emplace_back(folder, "mortise-server",
                   std::vector<std::string>{"--standby-of", "default", "--restore", logs, "--log",
                                            logs, "--log-rotate", "4", "--metrics-port", "0",
                                            "--domain", domain(), "--json"},
                   2.0, 30.0, 99u);
  ComesAndGoes& standby = all.back();
  std::vector<Holdings> seen;
  int taken_over = 0, leaders_killed = 0, in_step_again = 0;
  double since_s = 0.0, kill_s = kFirstKill_s;
  bool after_kill = false;  // and nobody stands by yet
  const auto leads = [&](std::unique_ptr<Program> next, double now_s) {
    std::printf("%.0f s: taken over\n", now_s);
    ++taken_over;
    server = std::move(next);
    seen.clear();
    since_s = now_s;
    for (int i = 0; i < kCrews; ++i) all[i].not_before(now_s + kNamesHeld_s);
  };
  const double begin_s = steady_s();
  // Who was killed last is waited for.
  for (double now_s = 0.0, sample_s = 0.0; now_s < lasts_s + (after_kill ? kInStep_s : 0.0);
       now_s = steady_s() - begin_s) {
    for (ComesAndGoes& one : all) one.turn(now_s);
    if (now_s >= sample_s) {
      sample_s += std::min(10.0, lasts_s / 20.0);
      seen.push_back(holdings_of(server->pid(), now_s));
      std::printf("%.0f s: %.2f MB, %d threads, %d handles\n", now_s, seen.back().resident_mb,
                  seen.back().threads, seen.back().handles);
      std::fflush(stdout);
    }
    if (!server->running()) {
      // On a starved machine one that lives may be taken for gone, and steps aside; then the other
      // is looked at. One that just ends is a fault.
      ASSERT_NE(server->errors().find("another server leads"), std::string::npos)
          << server->wait(0) << ": " << server->errors();
      auto next = standby.give(now_s);
      ASSERT_TRUE(next && next->errors().find("taken over at") != std::string::npos)
          << server->errors();
      leads(std::move(next), now_s);
      sample_s = now_s;
    }
    if (after_kill && standby.says("in step")) {
      after_kill = false;
      ++in_step_again;
    }
    if (now_s >= kill_s && !after_kill && standby.says("in step")) {
      auto next = kill_leader(*server, standby, now_s);
      ASSERT_TRUE(next) << "nobody took over at " << now_s << " s";
      ++leaders_killed;
      after_kill = true;
      leads(std::move(next), now_s);
      sample_s = now_s;
      kill_s = now_s + kBetweenKills_s <= lasts_s / 4.0 ? now_s + kBetweenKills_s : lasts_s;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  int starts = 0, killed = 0;
  for (ComesAndGoes& one : all) {
    one.end();
    starts += one.starts();
    killed += one.killed();
  }
  server->signal(SIGTERM);
  EXPECT_EQ(server->wait(20), 0) << server->errors();
  EXPECT_GE(starts, 5);
  EXPECT_GE(leaders_killed, 1);
  EXPECT_EQ(in_step_again, leaders_killed) << "who was killed stands by again";
  EXPECT_GE(standby.in_step() + taken_over, standby.starts() / 2) << "most live 15 s and more";

  const double third_s = (lasts_s - since_s) / 3.0;
  const double slope = resident_mb_per_h(seen, since_s + third_s);
  std::printf("%.0f s, %d programs came, %d of them killed, %d leaders killed, %d take-overs; ",
              lasts_s, starts, killed, leaders_killed, taken_over);
  std::printf("%+.2f MB an hour from %.0f s on\n", slope, since_s + third_s);
  const auto grown = [&](int Holdings::*what) {
    const double early_s = since_s + 2 * third_s;
    return most(seen, what, early_s, lasts_s) - most(seen, what, since_s, early_s);
  };
  EXPECT_LE(grown(&Holdings::threads), 0);
  EXPECT_LE(grown(&Holdings::handles), 2);
  if (lasts_s - since_s >= kLong_s) {
    EXPECT_LE(slope, kSlope_mb_per_h);
  }
}

}  // namespace
}  // namespace mortise::test
