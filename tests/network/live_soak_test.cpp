// A server that runs for long while all that can come and go beside it does: does it grow? In the
// first quarter the leader itself is killed, frozen, or its ticks hang, again and again; who stood
// by is the server from then. Crews and standbys are frozen now and then, to the end. An hour,
// unless MORTISE_SOAK_S says another time.
#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <cstdlib>
#include <optional>
#include <random>
#include <thread>

#include "tests/network/domain.h"
#include "tests/network/guest.h"
#include "tests/network/program.h"
#include "tests/network/stopped_thread.h"
#include "tests/support/growth.h"

namespace mortise::test {
namespace {

constexpr int kCrews = 4;
constexpr double kLong_s = 1800.0;  // a slope means something from here on
constexpr double kSlope_mb_per_h = 3.0;
// Of leaders; the next one stands by, and is in step, before the next fault.
constexpr double kFirstFault_s = 10.0, kBetweenFaults_s = 45.0;
// Of a leader that goes on, behind its back, when it is not the leader any more.
constexpr double kStaysStill_s = 1.0;
// Of a crew, which loses its seats by it, or of one that stands by, which is given up.
constexpr double kFrozen_s = 1.5, kCatchesUp_s = 3.0;
// Whoever takes over waits 4 s for the users of before; a name is free again after that.
constexpr double kNamesHeld_s = 5.5;
// Whatever the machine does; standby_test holds the figures.
constexpr double kTakesOver_s = kPatience_s, kInStep_s = kPatience_s;

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
    if (program_ && frozen_until_s_ != 0.0) {
      if (now_s < frozen_until_s_) return;
      program_->signal(SIGCONT);
      frozen_until_s_ = 0.0;
      awake_s_ = now_s + kCatchesUp_s;
    }
    if (program_ && now_s >= freezes_at_s_ && now_s + kFrozen_s < next_s_) {
      program_->signal(SIGSTOP);
      frozen_until_s_ = now_s + kFrozen_s;
      freezes_at_s_ = kNever_s;
      ++frozen_;
      return;
    }
    if (program_ && (now_s >= next_s_ || !program_->running())) {
      end();
      next_s_ = now_s + between(3.0, 6.0);  // who was killed is gone by then
    } else if (!program_ && now_s >= next_s_) {
      program_ = std::make_unique<Program>(folder_.path(), name_, arguments_);
      ++starts_;
      const double lives_s = lives_s_ * between(0.5, 1.5);
      next_s_ = now_s + lives_s;
      const bool freezes = std::bernoulli_distribution(0.25)(random_);
      freezes_at_s_ = freezes ? now_s + lives_s * between(0.3, 0.8) : kNever_s;
    }
  }
  /// Who ends by itself, or on request, says that all was well.
  void end() {
    if (!program_) return;
    program_->signal(SIGCONT);
    frozen_until_s_ = 0.0;
    const bool ends_itself = !program_->running();
    const bool kill = !ends_itself && std::bernoulli_distribution(0.5)(random_);
    if (!ends_itself) program_->signal(kill ? SIGKILL : SIGTERM);
    killed_ += kill;
    const int code = program_->wait(kPatience_s);
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
    if (frozen_until_s_ != 0.0) program_->signal(SIGCONT);
    frozen_until_s_ = 0.0;
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
  int frozen() const { return frozen_; }
  /// Whether it has had the time to catch up since it was frozen last.
  bool is_awake(double now_s) const { return frozen_until_s_ == 0.0 && now_s >= awake_s_; }
  /// How many of them said that they are in step with the server.
  int in_step() const { return in_step_; }

 private:
  static constexpr double kNever_s = 1e9;
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
  double freezes_at_s_ = kNever_s, frozen_until_s_ = 0.0;  ///< 0: it is not frozen
  double awake_s_ = 0.0;
  int starts_ = 0, killed_ = 0, frozen_ = 0, in_step_ = 0;
};

std::string domain() { return std::to_string(own_domain()); }

ComesAndGoes crew(const TestFolder& folder, int number) {
  const std::string one(1, static_cast<char>('k' + number));
  return {folder,
          "mortise-bot",
          {"--domain", domain(), "--users", "2", "--names", one + "a," + one + "b", "--behaviour",
           number % 2 ? "wander" : "share", "--wait", "60", "--duration", "20", "--json"},
          0.0,
          16.0,
          static_cast<unsigned>(number)};
}

void wait_until_up(Program& server) {
  while (server.running() && server.errors().find("session 'default' of") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

enum class Fault { kKilled, kTicksHang, kFrozen };
constexpr std::array kFaults = {Fault::kKilled, Fault::kTicksHang, Fault::kFrozen};

/// What was done to leaders, and how long nobody led.
class FaultTable {
 public:
  void add(Fault fault, double took_s) {
    Row& row = rows_[static_cast<std::size_t>(fault)];
    ++row.count;
    row.longest_s = std::max(row.longest_s, took_s);
    row.sum_s += took_s;
  }
  int count() const { return rows_[0].count + rows_[1].count + rows_[2].count; }
  void print(int killed, int frozen) const {
    constexpr const char* kNames[] = {"leader killed", "ticks of the leader hang", "leader frozen"};
    std::printf("| fault | times | taken over after, mean s | at most s |\n|---|---|---|---|\n");
    for (std::size_t i = 0; i < rows_.size(); ++i)
      std::printf("| %s | %d | %.2f | %.2f |\n", kNames[i], rows_[i].count,
                  rows_[i].sum_s / std::max(rows_[i].count, 1), rows_[i].longest_s);
    std::printf("| crew or standby killed | %d | - | - |\n", killed);
    std::printf("| crew or standby frozen for %.1f s | %d | - | - |\n", kFrozen_s, frozen);
  }

 private:
  struct Row {
    int count = 0;
    double sum_s = 0.0, longest_s = 0.0;
  };
  std::array<Row, kFaults.size()> rows_{};
};

/// Does it to the one that leads, and gives the one that stood by, which leads from then; none when
/// it does not take over. Who only stood still is told to go on, and ends.
std::unique_ptr<Program> fell_leader(Program& leader, Fault fault, ComesAndGoes& standby,
                                     FaultTable& table, double now_s) {
  std::optional<StoppedThread> hangs;
  if (fault == Fault::kTicksHang) {
    hangs.emplace(leader.pid());
    EXPECT_TRUE(hangs->held()) << "ptrace of another process";
  } else {
    leader.signal(fault == Fault::kKilled ? SIGKILL : SIGSTOP);
  }
  const double begin_s = steady_s(), end_s = begin_s + kTakesOver_s;
  while (!standby.says("taken over at")) {
    if (steady_s() > end_s) return nullptr;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  table.add(fault, steady_s() - begin_s);
  if (fault != Fault::kKilled) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kStaysStill_s));
    hangs.reset();
    leader.signal(SIGCONT);
  }
  EXPECT_EQ(leader.wait(kPatience_s), fault == Fault::kKilled ? 128 + SIGKILL : 1)
      << leader.errors();
  EXPECT_EQ(leader.errors().find("another server leads") != std::string::npos,
            fault != Fault::kKilled)
      << leader.errors();
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
                               "--log", logs, "--log-rotate", "4", "--metrics-port", "0",
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
  int taken_over = 0, in_step_again = 0;
  double since_s = 0.0, fault_s = kFirstFault_s;
  bool after_fault = false;  // and nobody stands by yet
  FaultTable faults;
  const auto leads = [&](std::unique_ptr<Program> next, double now_s) {
    std::printf("%.0f s: taken over\n", now_s);
    ++taken_over;
    server = std::move(next);
    seen.clear();
    since_s = now_s;
    for (int i = 0; i < kCrews; ++i) all[i].not_before(now_s + kNamesHeld_s);
  };
  wait_until_up(*server);
  const double begin_s = steady_s();
  // Who was felled last is waited for.
  for (double now_s = 0.0, sample_s = 0.0; now_s < lasts_s + (after_fault ? kInStep_s : 0.0);
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
    if (after_fault && standby.says("in step")) {
      after_fault = false;
      ++in_step_again;
    }
    if (now_s >= fault_s && !after_fault && standby.says("in step") && standby.is_awake(now_s)) {
      const Fault fault = kFaults[static_cast<std::size_t>(faults.count()) % kFaults.size()];
      auto next = fell_leader(*server, fault, standby, faults, now_s);
      ASSERT_TRUE(next) << "nobody took over at " << now_s << " s";
      after_fault = true;
      leads(std::move(next), now_s);
      sample_s = now_s;
      fault_s = now_s + kBetweenFaults_s <= lasts_s / 4.0 ? now_s + kBetweenFaults_s : lasts_s;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  int starts = 0, killed = 0, frozen = 0;
  for (ComesAndGoes& one : all) {
    one.end();
    starts += one.starts();
    killed += one.killed();
    frozen += one.frozen();
  }
  server->signal(SIGTERM);
  EXPECT_EQ(server->wait(kPatience_s), 0) << server->errors();
  EXPECT_GE(starts, 5);
  EXPECT_GE(faults.count(), 1);
  EXPECT_EQ(in_step_again, faults.count()) << "somebody stands by again";
  EXPECT_GE(standby.in_step() + taken_over, standby.starts() / 2) << "most live 15 s and more";

  const double third_s = (lasts_s - since_s) / 3.0;
  const double slope = resident_mb_per_h(seen, since_s + third_s);
  faults.print(killed, frozen);
  std::printf("%.0f s, %d programs came, %d leaders felled, %d take-overs; ", lasts_s, starts,
              faults.count(), taken_over);
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
