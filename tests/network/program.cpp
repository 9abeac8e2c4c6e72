#include "tests/network/program.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

extern char** environ;

namespace mortise::test {
namespace {

// Who talks in these tests stands for a machine of his own, which no other test takes time from: a
// leader that gets no processor for 0.15 s counts as gone. Threads and programs that begin later
// have it as well. Where it is not allowed all take turns.
constexpr int kBeforeOthers = -10;
[[maybe_unused]] const int is_before_others = setpriority(PRIO_PROCESS, 0, kBeforeOthers);

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

std::filesystem::path program_path(const std::string& name) {
  return std::filesystem::path(MORTISE_BIN_DIR) / name;
}

Program::Program(const std::filesystem::path& folder, const std::string& name,
                 const std::vector<std::string>& arguments) {
  static std::atomic<int> count{0};
  const std::string stem =
      std::filesystem::path(name).filename().string() + "-" + std::to_string(++count);
  out_ = folder / (stem + ".out");
  errors_ = folder / (stem + ".err");
  const std::string program = program_path(name).string();
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_.c_str(), flags, 0644);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors_.c_str(), flags, 0644);
  if (posix_spawn(&pid_, program.c_str(), &actions, nullptr, argv.data(), environ) != 0) {
    pid_ = -1;
    std::ofstream(errors_) << program << " cannot be started\n";
  }
  posix_spawn_file_actions_destroy(&actions);
}

Program::~Program() {
  if (running()) {
    signal(SIGKILL);
    reap(0);
  }
}

void Program::signal(int number) const {
  if (pid_ > 0) kill(pid_, number);
}

bool Program::reap(int flags) {
  if (pid_ <= 0) return true;
  int status = 0;
  if (waitpid(pid_, &status, flags) != pid_) return false;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  pid_ = -1;
  return true;
}

bool Program::running() { return !reap(WNOHANG); }

int Program::wait(double limit_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  while (running()) {
    if (std::chrono::steady_clock::now() > end) return -1;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return exit_code_;
}

std::string Program::out() const { return text_of(out_); }
std::string Program::errors() const { return text_of(errors_); }

double Program::cpu_s() const {
  const std::string stat = text_of("/proc/" + std::to_string(pid_) + "/stat");
  std::istringstream fields(stat.substr(stat.rfind(')') + 2));  // behind the name, field 3 on
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;
  double user = 0.0, system = 0.0;  // fields 14 and 15, clock ticks
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

}  // namespace mortise::test
