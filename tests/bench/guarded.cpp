#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <new>

#include "common/base/check.h"
#include "tests/bench/methods.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

// What a child leaves behind, whatever becomes of it.
struct Ledger {
  std::size_t at;  // the motion that it works on
  double spent_s;
  Answer answers[1];
};

class SharedLedger {
 public:
  explicit SharedLedger(std::size_t count) : bytes_(sizeof(Ledger) + count * sizeof(Answer)) {
    void* memory = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    MORTISE_CHECK(memory != MAP_FAILED, "no memory to share with a child process");
    ledger_ = new (memory) Ledger{};
    for (std::size_t i = 1; i < count; ++i) new (ledger_->answers + i) Answer{};
  }
  ~SharedLedger() { munmap(ledger_, bytes_); }
  SharedLedger(const SharedLedger&) = delete;
  SharedLedger& operator=(const SharedLedger&) = delete;
  Ledger* operator->() { return ledger_; }

 private:
  std::size_t bytes_;
  Ledger* ledger_;
};

// SIGPROF after so much CPU time of the process; its default is to end it.
void end_after(double cpu_s) {
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<time_t>(cpu_s);
  timer.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (cpu_s - std::floor(cpu_s)));
  setitimer(ITIMER_PROF, &timer, nullptr);
}

[[noreturn]] void work(const Method& method, const MotionSet& set, const Limits& limits,
                       SharedLedger& ledger) {
  while (ledger->at < set.items.size() && ledger->spent_s < limits.set_s) {
    const double begin_s = process_cpu_s();
    end_after(limits.query_s);
    ledger->answers[ledger->at] = method.ask(set.items[ledger->at].motion);
    end_after(0.0);
    ledger->spent_s += process_cpu_s() - begin_s;
    ++ledger->at;
  }
  _exit(0);
}

}  // namespace

std::vector<Answer> ask_all(const Method& method, const MotionSet& set) {
  std::vector<Answer> answers;
  for (const MotionSet::Item& item : set.items) answers.push_back(method.ask(item.motion));
  return answers;
}

std::vector<Answer> ask_guarded(const Method& method, const MotionSet& set, const Limits& limits) {
  SharedLedger ledger(set.items.size());
  std::fflush(nullptr);
  while (ledger->at < set.items.size() && ledger->spent_s < limits.set_s) {
    const pid_t child = fork();
    MORTISE_CHECK(child >= 0, "no child process for a peer");
    if (child == 0) {
      // A peer's words about its own troubles would end up in the middle of a table.
      if (std::freopen("/dev/null", "w", stdout) == nullptr) _exit(1);
      if (std::freopen("/dev/null", "w", stderr) == nullptr) _exit(1);
      work(method, set, limits, ledger);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
    const bool over_time = WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF;
    ledger->answers[ledger->at].outcome = over_time ? Outcome::kOverTime : Outcome::kCrashed;
    if (over_time) ledger->answers[ledger->at].time_s = limits.query_s;
    ledger->spent_s += over_time ? limits.query_s : 0.0;
    ++ledger->at;
  }
  return {ledger->answers, ledger->answers + set.items.size()};
}

}  // namespace mortise::bench
