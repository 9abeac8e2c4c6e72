#include "client/bot/processes.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

#include "client/bot/crew.h"
#include "common/io/progress_log.h"

namespace mortise {
namespace {

struct Child {
  pid_t pid = -1;
  int pipe = -1;  ///< -1: read to its end
  std::vector<std::uint8_t> bytes;
};

[[noreturn]] void be_child(int k, int pipe, const std::function<int(int, ProcessReport&)>& work) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);  // a killed parent leaves nobody behind
  ProcessReport report;
  const int exit_code = work(k, report);
  const std::vector<std::uint8_t> bytes =
      exit_code == kExitOk ? to_bytes(report) : std::vector<std::uint8_t>{};
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(pipe, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  ::close(pipe);
  _exit(exit_code);  // what the parent made is the parent's to end
}

// Reads what is there; closes the pipe at its end.
void read_from(Child& child) {
  std::uint8_t buffer[65536];
  const ssize_t n = ::read(child.pipe, buffer, sizeof buffer);
  if (n < 0 && errno == EINTR) return;
  if (n > 0) {
    child.bytes.insert(child.bytes.end(), buffer, buffer + n);
    return;
  }
  ::close(child.pipe);
  child.pipe = -1;
}

void gather(std::vector<Child>& children) {
  bool told = false;
  while (true) {
    std::vector<pollfd> waits;
    std::vector<Child*> of;
    for (Child& child : children) {
      if (child.pipe < 0) continue;
      waits.push_back({child.pipe, POLLIN, 0});
      of.push_back(&child);
    }
    if (waits.empty()) return;
    const int ready = ::poll(waits.data(), waits.size(), 200);
    if (stop_is_asked() && !told) {
      told = true;
      for (const Child& child : children) kill(child.pid, SIGTERM);
    }
    if (ready <= 0) continue;
    for (std::size_t i = 0; i < waits.size(); ++i) {
      if (waits[i].revents != 0) read_from(*of[i]);
    }
  }
}

int exit_code_of(const Child& child) {
  int status = 0;
  while (waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : kExitRuntime;
}

}  // namespace

int run_processes(int count, const std::function<int(int, ProcessReport&)>& work,
                  std::vector<ProcessReport>& reports) {
  std::vector<Child> children;
  for (int k = 0; k < count; ++k) {
    int ends[2];
    if (pipe(ends) != 0) break;
    const pid_t pid = fork();
    if (pid == 0) {
      ::close(ends[0]);
      for (const Child& other : children) ::close(other.pipe);
      be_child(k, ends[1], work);
    }
    ::close(ends[1]);
    if (pid < 0) {
      ::close(ends[0]);
      break;
    }
    children.push_back({pid, ends[0], {}});
  }
  if (children.size() < static_cast<std::size_t>(count)) {
    log_error("only {} of {} processes could be started", children.size(), count);
  }
  gather(children);
  int worst = children.size() < static_cast<std::size_t>(count) ? kExitRuntime : kExitOk;
  for (std::size_t k = 0; k < children.size(); ++k) {
    const int exit_code = exit_code_of(children[k]);
    ProcessReport report;
    if (exit_code == kExitOk && from_bytes(children[k].bytes, report)) {
      reports.push_back(std::move(report));
      continue;
    }
    log_error("process {} ended with {} and without a report", k + 1, exit_code);
    worst = std::max(worst, exit_code == kExitOk ? static_cast<int>(kExitRuntime) : exit_code);
  }
  return worst;
}

}  // namespace mortise
